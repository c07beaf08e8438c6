//! The text form of biases and filters, such as `slope-scaled:1.5` and `pcf:3`.

use super::{Bias, BiasSum, BiasUnit, NormalRule, ShadowFilter};
use std::{
    fmt::{self, Display, Formatter},
    str::FromStr,
};

/// Why a text is no bias or filter: what was found and what was expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShadowTextError(String);

impl Display for ShadowTextError {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for ShadowTextError {}

const BIASES: &str = "none, constant:AMOUNT, slope-scaled:AMOUNT, normal-offset:AMOUNT, \
                      receiver-plane:AMOUNT or adaptive (AMOUNT from 0 to 1000000, in texels, or in metres as in 0.02m), \
                      or a sum of constant, slope-scaled and one of normal-offset, normal-whole, normal-rest and normal-aside, as in \
                      constant:0.02m+normal-whole:2";
const FILTERS: &str = "hard, pcf:SIDE, bilinear:SIDE, poisson:TAPS:RADIUS, vogel:TAPS:RADIUS, pcss:TAPS, \
                       vsm:RADIUS, evsm:RADIUS or msm:RADIUS (SIDE from 1 to 31, odd for pcf; TAPS from 1 to 64, of pcss \
                       to 256; RADIUS in texels from 0 to 1024, of vsm, evsm and msm whole and to 64)";
/// Greatest amount of a bias and radius of a filter.
const MOST: f32 = 1e6;

/// The name and its arguments.
fn parts(text: &str) -> (&str, Vec<&str>) {
    let mut parts = text.trim().split(':');
    (parts.next().unwrap_or_default(), parts.collect())
}

fn unknown(what: &str, text: &str, expected: &str) -> ShadowTextError {
    ShadowTextError(format!("`{text}` is no {what}; expected {expected}"))
}

impl FromStr for Bias {
    type Err = ShadowTextError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let refuse = || unknown("shadow bias", text, BIASES);
        if text.contains('+') || text.trim_start().starts_with("normal-") {
            return sum(text).ok_or_else(refuse);
        }
        let (name, arguments) = parts(text);
        let argument = match arguments[..] {
            [] => None,
            [one] => Some(amount(one).ok_or_else(refuse)?),
            _ => return Err(refuse()),
        };
        match (name, argument) {
            ("none", None) => Ok(Self::None),
            ("constant", Some((amount, unit))) => Ok(Self::Constant { amount, unit }),
            ("slope-scaled", Some((amount, unit))) => Ok(Self::SlopeScaled { amount, unit }),
            ("receiver-plane", Some((amount, unit))) => Ok(Self::ReceiverPlane { amount, unit }),
            ("adaptive", None) => Ok(Self::default()),
            ("adaptive", Some((amount, BiasUnit::Texels))) => Ok(Self::Adaptive { amount }),
            _ => Err(refuse()),
        }
    }
}

/// The ways of a normal offset, by name.
const RULES: [(&str, NormalRule); 4] = [
    ("normal-offset", NormalRule::Sine),
    ("normal-whole", NormalRule::Whole),
    ("normal-rest", NormalRule::Rest),
    ("normal-aside", NormalRule::Aside),
];

/// `constant:0.02m+normal-whole:2`, each part at most once; a lone `normal-offset` is the bias of that name.
fn sum(text: &str) -> Option<Bias> {
    let mut sum = BiasSum::default();
    let mut seen = [false; 3];
    for part in text.trim().split('+') {
        let (name, arguments) = parts(part);
        let [argument] = arguments[..] else {
            return None;
        };
        let (amount, unit) = amount(argument)?;
        let rule = RULES.iter().find(|rule| rule.0 == name);
        let which = match (name, unit, rule) {
            ("constant", _, _) => {
                (sum.constant, sum.constant_unit) = (amount, unit);
                0
            }
            ("slope-scaled", BiasUnit::Texels, _) => {
                sum.slope = amount;
                1
            }
            (_, _, Some((_, rule))) => {
                (sum.normal, sum.normal_unit, sum.rule) = (amount, unit, *rule);
                2
            }
            _ => return None,
        };
        if std::mem::replace(&mut seen[which], true) {
            return None;
        }
    }
    Some(match seen {
        [false, false, true] if sum.rule == NormalRule::Sine => Bias::NormalOffset {
            amount: sum.normal,
            unit: sum.normal_unit,
        },
        _ => Bias::Sum(sum),
    })
}

/// `1.5` or `0.02m`.
fn amount(text: &str) -> Option<(f32, BiasUnit)> {
    let (number, unit) = match text.strip_suffix('m') {
        Some(number) => (number, BiasUnit::Metres),
        None => (text, BiasUnit::Texels),
    };
    Some((within(number, 0.0..=MOST)?, unit))
}

fn within<T: FromStr + PartialOrd>(text: &str, range: std::ops::RangeInclusive<T>) -> Option<T> {
    text.parse().ok().filter(|number| range.contains(number))
}

impl FromStr for ShadowFilter {
    type Err = ShadowTextError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (name, arguments) = parts(text);
        let filter = match (name, &arguments[..]) {
            ("hard", []) => Some(Self::Hard),
            ("pcf", [side]) => within(side, 1..=31)
                .filter(|side| side % 2 == 1)
                .map(|side| Self::Pcf { side }),
            ("bilinear", [side]) => within(side, 1..=31).map(|side| Self::Bilinear { side }),
            ("poisson", [taps, radius]) => {
                disk(taps, radius).map(|(taps, radius)| Self::Poisson { taps, radius })
            }
            ("vogel", [taps, radius]) => {
                disk(taps, radius).map(|(taps, radius)| Self::Vogel { taps, radius })
            }
            ("pcss", [taps]) => within(taps, 1..=256).map(|taps| Self::Pcss { taps }),
            ("vsm", [radius]) => within(radius, 0..=64).map(|radius| Self::Vsm { radius }),
            ("evsm", [radius]) => within(radius, 0..=64).map(|radius| Self::Evsm { radius }),
            ("msm", [radius]) => within(radius, 0..=64).map(|radius| Self::Msm { radius }),
            _ => None,
        };
        filter.ok_or_else(|| unknown("shadow filter", text, FILTERS))
    }
}

fn disk(taps: &str, radius: &str) -> Option<(u32, f32)> {
    Some((within(taps, 1..=64)?, within(radius, 0.0..=1024.0)?))
}

impl Display for Bias {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let mut amount = |name: &str, amount: f32, unit: BiasUnit| match unit {
            BiasUnit::Texels => write!(f, "{name}:{amount}"),
            BiasUnit::Metres => write!(f, "{name}:{amount}m"),
        };
        match *self {
            Self::None => f.write_str("none"),
            Self::Constant { amount: a, unit } => amount("constant", a, unit),
            Self::SlopeScaled { amount: a, unit } => amount("slope-scaled", a, unit),
            Self::NormalOffset { amount: a, unit } => amount("normal-offset", a, unit),
            Self::ReceiverPlane { amount: a, unit } => amount("receiver-plane", a, unit),
            Self::Adaptive { amount: a } => amount("adaptive", a, BiasUnit::Texels),
            Self::Sum(sum) => f.write_str(&sum_words(&sum)),
        }
    }
}

/// The parts that are not 0; `none` if all are.
fn sum_words(sum: &BiasSum) -> String {
    let rule = RULES.iter().find(|rule| rule.1 == sum.rule);
    let parts = [
        ("constant", sum.constant, sum.constant_unit),
        ("slope-scaled", sum.slope, BiasUnit::Texels),
        (rule.map_or("", |rule| rule.0), sum.normal, sum.normal_unit),
    ];
    let there = parts.iter().filter(|part| part.1 != 0.0);
    let words = there.map(|(name, amount, unit)| match unit {
        BiasUnit::Texels => format!("{name}:{amount}"),
        BiasUnit::Metres => format!("{name}:{amount}m"),
    });
    let words: Vec<String> = words.collect();
    if words.is_empty() {
        "none".to_owned()
    } else {
        words.join("+")
    }
}

impl Display for ShadowFilter {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match *self {
            Self::Hard => f.write_str("hard"),
            Self::Pcf { side } => write!(f, "pcf:{side}"),
            Self::Bilinear { side } => write!(f, "bilinear:{side}"),
            Self::Poisson { taps, radius } => write!(f, "poisson:{taps}:{radius}"),
            Self::Vogel { taps, radius } => write!(f, "vogel:{taps}:{radius}"),
            Self::Pcss { taps } => write!(f, "pcss:{taps}"),
            Self::Vsm { radius } => write!(f, "vsm:{radius}"),
            Self::Evsm { radius } => write!(f, "evsm:{radius}"),
            Self::Msm { radius } => write!(f, "msm:{radius}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_come_back() {
        for text in [
            "none",
            "constant:2",
            "slope-scaled:1.5",
            "normal-offset:0.75",
            "receiver-plane:0.02m",
            "adaptive:1",
            "constant:0.02m+normal-whole:2.5",
            "constant:1+slope-scaled:2+normal-rest:0.1m",
            "normal-aside:2",
        ] {
            assert_eq!(text.parse::<Bias>().unwrap().to_string(), text);
        }
        for text in [
            "hard",
            "pcf:3",
            "bilinear:1",
            "poisson:16:2.5",
            "vogel:32:4",
            "pcss:64",
            "vsm:2",
            "evsm:2",
            "msm:0",
        ] {
            assert_eq!(text.parse::<ShadowFilter>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn wrong_texts_say_what_was_expected() {
        for text in [
            "",
            "constant",
            "constant:NaN",
            "none:1",
            "adaptive:1m",
            "constant:-1",
            "slope-scaled:1:2",
            "constant:1+",
            "constant:1+constant:2",
            "slope-scaled:1m+constant:1",
            "normal-offset:1+normal-rest:1",
            "adaptive:1+constant:1",
        ] {
            let error = text.parse::<Bias>().unwrap_err().to_string();
            assert!(
                error.starts_with(&format!("`{text}` is no shadow bias; expected none,")),
                "{error}"
            );
        }
        for text in [
            "",
            "pcf",
            "pcf:2",
            "pcf:33",
            "vogel:16",
            "poisson:0:1",
            "vsm:inf",
            "msm:65",
        ] {
            let error = text.parse::<ShadowFilter>().unwrap_err().to_string();
            assert!(
                error.contains("is no shadow filter; expected hard,"),
                "{error}"
            );
        }
    }
}

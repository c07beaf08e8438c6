//! Sums of light without rounding, so that their order does not matter.

/// A sum of numbers of at least 0, in steps of 2⁻⁶⁴ (5e-20) up to 2⁶⁴ (1.8e19).
///
/// Addition of integers is associative: samples that come in any order, in one go or in parts that are merged later, give the same bits.
/// What a number has below a step is cut off; what goes beyond the end stays there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ExactSum(u128);

/// 2⁶⁴.
const STEPS: f64 = 18_446_744_073_709_551_616.0;

impl ExactSum {
    /// Adds a number; what is negative or NaN counts as 0.
    #[inline(always)]
    pub(crate) fn add(&mut self, value: f32) {
        self.merge(Self(steps(value)));
    }

    /// Adds another sum.
    #[inline(always)]
    pub(crate) fn merge(&mut self, other: Self) {
        self.0 = self.0.saturating_add(other.0);
    }

    /// What is left without a part that was summed beside it.
    pub(crate) fn without(self, part: Self) -> Self {
        Self(self.0.saturating_sub(part.0))
    }

    /// The sum of `count` numbers over their count; 0 for none.
    pub(crate) fn mean(self, count: u32) -> f32 {
        (self.0 as f64 / STEPS / f64::from(count.max(1))) as f32
    }
}

/// The whole steps in a number: its digits, moved to their place. Much faster than a conversion by way of f64.
#[inline(always)]
fn steps(value: f32) -> u128 {
    if !(value > 0.0) {
        return 0;
    }
    let bits = value.to_bits();
    let exponent = bits >> 23;
    // Numbers below the least normal one have no leading digit, and are far below a step.
    let digits = u128::from(bits & 0x007f_ffff | 0x0080_0000);
    match exponent {
        0..ONE_STEP => digits >> (ONE_STEP - exponent).min(24),
        ONE_STEP..BEYOND => digits << (exponent - ONE_STEP),
        _ => u128::MAX,
    }
}

/// The exponent of numbers whose last digit is a step: 1 has the exponent 127 and 23 digits after the point.
const ONE_STEP: u32 = 127 + 23 - 64;
/// The exponent of 2⁶⁴.
const BEYOND: u32 = 127 + 64;

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(values: &[f32]) -> ExactSum {
        let mut sum = ExactSum::default();
        values.iter().for_each(|&value| sum.add(value));
        sum
    }

    #[test]
    fn order_does_not_matter() {
        let values = [1e12, 3e-9, 0.1, 7.7e5, 1e-19, 0.3, 2.5e-7, 1e9];
        let mut halves = sum(&values[4..]);
        halves.merge(sum(&values[..4]));
        let mut reversed = values;
        reversed.reverse();
        assert_eq!(sum(&values), halves);
        assert_eq!(sum(&values), sum(&reversed));
    }

    #[test]
    fn means_are_rounded_once() {
        assert_eq!(sum(&[0.1; 7]).mean(7), 0.1);
        assert_eq!(sum(&[1e-6, 3e-6]).mean(2), 2e-6);
        assert_eq!(ExactSum::default().mean(0), 0.0);
        assert_eq!(sum(&[0.5, 0.25]).without(sum(&[0.25])), sum(&[0.5]));
    }

    /// What a conversion by way of f64 gives.
    #[test]
    fn steps_are_those_of_the_product() {
        let mut bits = 0_u32;
        for _ in 0..100_000 {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let value = f32::from_bits(bits);
            assert_eq!(steps(value), (f64::from(value) * STEPS) as u128, "{value}");
        }
        for value in [0.0, -0.0, 1.0, 5e-20, 5.5e-20, 1.8e19, 1.9e19, 1e-40] {
            assert_eq!(steps(value), (f64::from(value) * STEPS) as u128, "{value}");
        }
    }

    #[test]
    fn ends_hold() {
        assert_eq!(sum(&[-1.0, f32::NAN]), ExactSum::default());
        assert_eq!(sum(&[f32::INFINITY, f32::MAX, 1.0]).0, u128::MAX);
        assert_eq!(sum(&[1e-25]), ExactSum::default());
    }
}

//! A receiver as it is compared with the map: its depth, its plane, its bias.

use super::{Bias, BiasUnit, LightView, NormalRule, view::Projected};
use umbriel_kernels::glam::{Vec2, Vec3};

/// Greatest tangent by which [`Bias::SlopeScaled`] multiplies.
pub(crate) const MOST_SLOPE: f32 = 10.0;
/// The tangent, of 89.99 degrees, up to which [`Bias::Adaptive`] follows planes beyond that: a floor out to the horizon has light that grazes it.
const STEEPEST: f32 = 5730.0;
/// What [`Bias::Adaptive`] takes a receiver nearer by, in changes of depth over one texel, which are cut as for [`Bias::SlopeScaled`].
const ADAPTIVE_SLOPE: f32 = 1.25;
/// The same in texels, for what faces the light.
const ADAPTIVE_WIDTH: f32 = 0.05;

/// A point that asks whether it is lit, in the picture of one view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Receiver {
    /// Texel coordinates.
    pub(crate) at: Vec2,
    /// Depth in metres, without bias.
    pub(crate) z: f32,
    /// The texel that it lies in.
    pub(crate) own: Vec2,
    /// Biased depth as stored, that this texel is compared with.
    pub(crate) stored: f32,
    /// By how much more the next texels to the right and below are compared with; 0 for biases that do not follow the receiver's plane.
    pub(crate) plane: Vec2,
    /// Width of a texel here in metres.
    pub(crate) texel: f32,
    /// By how much it was taken nearer, in metres.
    pub(crate) bias: f32,
}

impl Receiver {
    /// The depth, as stored, that the texel `x`, `y` is compared with.
    #[inline(always)]
    pub(crate) fn at_texel(&self, x: i32, y: i32) -> f32 {
        let from = Vec2::new(x as f32, y as f32) - self.own;
        self.stored + (self.plane.x * from.x + self.plane.y * from.y)
    }
}

/// Tells whether a texel leaves light to a receiver. `NaN` is dark.
#[inline(always)]
pub(crate) fn is_lit(stored: f32, receiver: f32) -> bool {
    // Nothing is stored as 0: it must not hide what lies behind the map's end.
    stored <= receiver.max(0.0)
}

/// The change of stored depth a texel along the plane through `q`, in the view's axes, with normal `n`.
///
/// Stored depth is affine in the picture, so this is exact:
/// ```text
/// orthographic   d = 1 − z/far    ∇d = (n_x, n_y)/n_z · width/far
/// perspective    d = near/z       ∇d = (n_x, n_y)/(n·q) · near · width at 1
/// ```
/// A plane that the light only grazes is held off by a millionth.
///
/// Source: Isidoro, "Shadow Mapping: GPU-based Tips and Techniques", GDC 2006 (the orthographic one).
#[inline(always)]
fn plane_slope(view: &LightView, n: Vec3, q: Vec3) -> Vec2 {
    let facing = if view.perspective {
        n.dot(q) / q.length()
    } else {
        n.z
    };
    let facing = if facing.abs() < 1e-6 { -1e-6 } else { facing };
    let texel = view.texel_width(1.0);
    let scale = if view.perspective {
        view.near * texel / (facing * q.length())
    } else {
        texel / (facing * view.far)
    };
    n.truncate() * scale
}

/// How a point's plane lies in a texel.
struct Incline {
    projected: Projected,
    /// Width of a texel in metres.
    texel: f32,
    /// See [`plane_slope`].
    plane: Vec2,
    /// The change of depth over a texel, in metres.
    slope: f32,
    /// `slope` over the width of a texel.
    tan: f32,
}

#[inline(always)]
fn incline(view: &LightView, p: Vec3, ng: Vec3) -> Incline {
    let axes = |v: Vec3| Vec3::new(v.dot(view.right), v.dot(view.down), v.dot(view.forward));
    let projected = view.project(p);
    let texel = view.texel_width(projected.z);
    let plane = plane_slope(view, axes(ng), axes(p - view.origin));
    let slope = plane.length() * view.metres_per_stored(projected.z);
    Incline {
        projected,
        texel,
        plane,
        slope,
        // Texels of parallel light have one width, and so one division.
        tan: slope * (1.0 / texel),
    }
}

/// What a bias is made of at a receiver, in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BiasParts {
    /// How far the point is moved off its surface before it is looked up.
    pub moved: f32,
    /// Nearer to the light, everywhere the same number of metres or texels.
    pub constant: f32,
    /// Nearer to the light, the more the steeper the light falls.
    pub sloped: f32,
    /// Nearer to the light, for what rounding does to depths.
    pub rounding: f32,
    /// Further from the light, below 0 nearer: along the receiver's plane to the centre of its texel.
    pub plane: f32,
    /// The tangent of the angle between the light and the surface's normal, as the map sees it: the change of depth over a texel by the texel's width.
    pub tangent: f32,
}

/// The parts of the bias that [`receiver`] takes at a point. The point itself is looked up in the texel of the receiver.
pub(super) fn bias_parts(view: &LightView, bias: &Bias, p: Vec3, ng: Vec3) -> BiasParts {
    let seen = receiver(view, bias, p, ng);
    let moved = moved_off(view, bias, p, ng);
    let Incline { texel, tan, .. } = incline(view, moved, ng);
    let (constant, sloped, rounding) = match *bias {
        Bias::None | Bias::NormalOffset { .. } => (0.0, 0.0, 0.0),
        Bias::Constant { .. } | Bias::ReceiverPlane { .. } => (seen.bias, 0.0, 0.0),
        Bias::SlopeScaled { .. } => (0.0, seen.bias, 0.0),
        Bias::Sum(sum) => {
            let constant = in_metres(sum.constant, sum.constant_unit, texel);
            (constant, seen.bias - constant, 0.0)
        }
        Bias::Adaptive { amount } => {
            let rounding = rounding(view, moved, tan);
            let constant = amount * ADAPTIVE_WIDTH * texel;
            (constant, seen.bias - constant - rounding, rounding)
        }
    };
    let without = view.linear(taken_nearer(view, seen.z, seen.bias).max(0.0));
    BiasParts {
        moved: (moved - p).length(),
        constant,
        sloped,
        rounding,
        plane: view.linear(seen.stored.max(0.0)) - without,
        tangent: tan,
    }
}

/// The receiver at the world point `p` with the unit normal `ng`, both sides of which are alike.
///
/// With the width `w` of a texel at the receiver, the angle `θ` between normal and light, and `s = |∇z| w` the change of depth over a
/// texel as the map sees it (`w tan θ` on the view's axis):
/// ```text
/// constant        b = a w
/// slope-scaled    b = a min(s, 10 w)
/// normal offset   p + a w sin θ · n, b = 0
/// sum             both, with a₁ w + a₂ min(s, 10 w)
/// receiver plane  z follows the plane to the texel's centre, b = a w
/// adaptive        b = a (5/4 min(s, 10 w) + w/20) + ε; z follows what is cut of s to the texel's centre, if that is nearer
/// ```
/// Receiver plane and adaptive follow the plane from texel to texel of a filter, too. `ε` bounds what rounding does to depths. How one and a
/// quarter slopes score is told at [`Bias::Adaptive`]; beyond a tangent of 10 they would be too much on curved surfaces and, being cut, too little on flat
/// ones, which only the plane itself can tell apart.
///
/// Source: Dou, Yan, Kerzner, Dai & Wyman, "Adaptive Depth Bias for Shadow Maps", JCGT 3(4), 2014 (following the plane to the texel's centre);
/// Holbert, "Saying Goodbye to Shadow Acne", GDC 2011 (normal offset).
#[inline(always)]
pub(crate) fn receiver(view: &LightView, bias: &Bias, p: Vec3, ng: Vec3) -> Receiver {
    let p = moved_off(view, bias, p, ng);
    let Incline {
        projected,
        texel,
        plane,
        slope,
        tan,
    } = incline(view, p, ng);
    let z = projected.z;
    let b = match *bias {
        Bias::None | Bias::NormalOffset { .. } => 0.0,
        Bias::Constant { amount, unit } | Bias::ReceiverPlane { amount, unit } => {
            in_metres(amount, unit, texel)
        }
        Bias::SlopeScaled { amount, unit } => in_metres(amount, unit, texel) * tan.min(MOST_SLOPE),
        Bias::Sum(sum) => {
            let sloped = sum.slope * texel * tan.min(MOST_SLOPE);
            in_metres(sum.constant, sum.constant_unit, texel) + sloped
        }
        Bias::Adaptive { amount } => {
            let sloped = ADAPTIVE_SLOPE * slope.min(MOST_SLOPE * texel);
            amount * (sloped + ADAPTIVE_WIDTH * texel) + rounding(view, p, tan)
        }
    };
    let own = projected.at.floor();
    let to_center = own + 0.5 - projected.at;
    let change = plane.x * to_center.x + plane.y * to_center.y;
    let (to_own_center, plane) = followed(bias, plane, change, tan);
    Receiver {
        at: projected.at,
        z,
        own,
        stored: taken_nearer(view, z, b) + to_own_center,
        plane,
        texel,
        bias: b,
    }
}

/// The point as [`Bias::NormalOffset`] or a [`Bias::Sum`] moves it; for the others where it is.
#[inline(always)]
fn moved_off(view: &LightView, bias: &Bias, p: Vec3, ng: Vec3) -> Vec3 {
    let (amount, unit, rule) = match *bias {
        Bias::NormalOffset { amount, unit } => (amount, unit, NormalRule::Sine),
        Bias::Sum(sum) if sum.normal != 0.0 => (sum.normal, sum.normal_unit, sum.rule),
        _ => return p,
    };
    let from_light = if view.perspective {
        (p - view.origin).normalize_or(view.forward)
    } else {
        view.forward
    };
    let cos = from_light.dot(ng);
    let width = in_metres(amount, unit, view.texel_width(view.project(p).z));
    let rest = 1.0 - (-cos).clamp(0.0, 1.0);
    match rule {
        NormalRule::Sine => p + ng * (width * (1.0 - cos * cos).max(0.0).sqrt()),
        NormalRule::Whole => p + ng * width,
        NormalRule::Rest => p + ng * (width * rest),
        NormalRule::Aside => p + (ng - from_light * cos) * (width * rest),
    }
}

/// What a bias follows of the receiver's plane, whose change to the texel's centre is `change` and whose tangent is `tan`: the change of stored depth to that
/// centre, and from texel to texel.
#[inline(always)]
fn followed(bias: &Bias, plane: Vec2, change: f32, tan: f32) -> (f32, Vec2) {
    match bias {
        Bias::ReceiverPlane { .. } => (change, plane),
        Bias::Adaptive { .. } => {
            let cut = ((tan.min(STEEPEST) - MOST_SLOPE) / tan).max(0.0);
            (cut * change.max(0.0), plane)
        }
        _ => (0.0, Vec2::ZERO),
    }
}

#[inline(always)]
fn in_metres(amount: f32, unit: BiasUnit, texel: f32) -> f32 {
    match unit {
        BiasUnit::Texels => amount * texel,
        BiasUnit::Metres => amount,
    }
}

/// The stored depth of `z − b`; what would lie behind the light is infinitely near.
#[inline(always)]
fn taken_nearer(view: &LightView, z: f32, b: f32) -> f32 {
    let z = z - b;
    if view.perspective && z <= 0.0 {
        f32::INFINITY
    } else {
        view.stored(z)
    }
}

/// What rounding can do to the depth of a point: that of its place in the world and of the map's numbers, on a slope of tangent `tan`.
#[inline(always)]
fn rounding(view: &LightView, p: Vec3, tan: f32) -> f32 {
    let far = if view.perspective { 0.0 } else { view.far };
    let reach = p.abs().max_element() + (p - view.origin).abs().max_element();
    4.0 * f32::EPSILON * (reach * (1.0 + tan) + far)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow_map::view::axes;
    use umbriel_kernels::glam::DVec3;

    /// Each rule moves a point as far as it says, along the normal but for the last, which leaves the depth as it is.
    #[test]
    fn normals_move_by_their_rules() {
        let view = LightView::orthographic(&axes(DVec3::NEG_Y), DVec3::ZERO, 8.0, 20.0, 64);
        let (p, width) = (Vec3::new(1.0, -3.0, 2.0), 0.25);
        for angle in [0.0_f32, 0.3, 1.2] {
            let (sin, cos) = angle.sin_cos();
            let ng = Vec3::new(sin, cos, 0.0);
            for (name, length) in [
                ("offset", sin),
                ("whole", 1.0),
                ("rest", 1.0 - cos),
                ("aside", (1.0 - cos) * sin),
            ] {
                let bias: Bias = format!("normal-{name}:2").parse().unwrap();
                let step = moved_off(&view, &bias, p, ng) - p;
                let expected = 2.0 * width * length;
                assert!((step.length() - expected).abs() < 1e-5, "{name} {angle}");
                let aside = if name == "aside" { Vec3::X } else { ng };
                assert!((step - aside * expected).length() < 1e-5, "{name} {angle}");
            }
        }
    }

    /// What is said of a bias adds up to what it does.
    #[test]
    fn parts_add_up_to_the_bias() {
        let parallel = LightView::orthographic(&axes(DVec3::NEG_Y), DVec3::ZERO, 8.0, 20.0, 64);
        let spot = LightView::perspective(Vec3::Y, &axes(DVec3::NEG_Y), 1.0, 64, 0.01);
        let p = Vec3::new(1.0, -3.0, 2.0);
        for view in [parallel, spot] {
            for ng in [
                Vec3::Y,
                Vec3::new(0.6, 0.8, 0.0),
                Vec3::new(0.48, 0.64, 0.6),
            ] {
                for text in [
                    "none",
                    "constant:2",
                    "slope-scaled:1.5",
                    "normal-offset:2",
                    "receiver-plane:0.5",
                    "adaptive",
                    "constant:0.02m+slope-scaled:1.5+normal-whole:1",
                ] {
                    let bias: Bias = text.parse().unwrap();
                    let (seen, parts) = (
                        receiver(&view, &bias, p, ng),
                        bias_parts(&view, &bias, p, ng),
                    );
                    let sum = parts.constant + parts.sloped + parts.rounding;
                    assert!((sum - seen.bias).abs() <= 1e-5 * seen.bias, "{text}");
                    let [x, y] = [seen.own.x as i32, seen.own.y as i32];
                    let compared = view.linear(seen.at_texel(x, y));
                    let told = seen.z - sum + parts.plane;
                    assert!((compared - told).abs() < 1e-4, "{text} {compared} {told}");
                }
            }
        }
    }

    /// The parts of a sum are those of the biases of their names.
    #[test]
    fn sums_are_sums() {
        let view = LightView::orthographic(&axes(DVec3::NEG_Y), DVec3::ZERO, 8.0, 20.0, 64);
        let (p, ng) = (Vec3::new(1.0, -3.0, 2.0), Vec3::new(0.6, 0.8, 0.0));
        let bias = |text: &str| receiver(&view, &text.parse().unwrap(), p, ng).bias;
        let sum = bias("constant:0.02m+slope-scaled:1.5");
        let parts = bias("constant:0.02m") + bias("slope-scaled:1.5");
        assert!((sum - parts).abs() < 1e-6, "{sum} {parts}");
    }
}

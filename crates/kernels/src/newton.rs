//! Newton's method between two places of opposite sign.

/// The root of a function between `low` and `high`, where its values have opposite signs; `f_low` is the one at `low`, `at` gives value and
/// slope. Newton's method from `start`, or from the middle if that lies outside; by bisection wherever Newton's step leaves the bracket or
/// does not halve it.
///
/// Source: Press, Teukolsky, Vetterling & Flannery, "Numerical Recipes", 3rd ed., 2007, section 9.4.
#[inline]
pub(crate) fn bracketed_newton(
    mut at: impl FnMut(f64) -> (f64, f64),
    [mut low, mut high]: [f64; 2],
    f_low: f64,
    start: f64,
) -> f64 {
    let mut x = if low < start && start < high {
        start
    } else {
        0.5 * low + 0.5 * high
    };
    let mut last = high - low;
    // 200 halvings exhaust f64; Newton ends after a handful.
    for _ in 0..200 {
        let (f, slope) = at(x);
        if f == 0.0 {
            return x;
        }
        if (f < 0.0) == (f_low < 0.0) {
            low = x;
        } else {
            high = x;
        }
        let newton = x - f / slope;
        let step = (newton - x).abs();
        let next = if newton > low && newton < high && step <= 0.5 * last {
            newton
        } else {
            0.5 * low + 0.5 * high
        };
        last = (next - x).abs();
        if last <= f64::EPSILON * x.abs() || next <= low || next >= high {
            return next;
        }
        x = next;
    }
    x
}

//! Polynomials on [0, 1] by their Bernstein coefficients: from values to coefficients to roots.

use super::root::polish_in;
use arrayvec::ArrayVec;

/// The highest degree of polynomials that are solved so.
pub(super) const MOST_DEGREE: usize = 16;
/// Coefficients of a polynomial, `b₀ … bₙ`; those above its degree are 0.
pub(super) type Coefficients = [f64; MOST_DEGREE + 1];
/// Pieces narrower than 2 to the power of minus this that may hold several roots are handed back.
const HALVINGS: u32 = 12;

/// From the values of a polynomial at the nodes to its Bernstein coefficients.
///
/// ```text
/// p(s) = Σ bᵢ Bᵢ(s)     Bᵢ(s) = (n over i) sⁱ (1 − s)ⁿ⁻ⁱ     sⱼ = (1 − cos(π j/n))/2
/// ```
/// The nodes, Chebyshev's extrema, hold both ends; the matrix `Bᵢ(sⱼ)` is inverted once for a degree.
#[derive(Clone, Debug)]
pub(super) struct Basis {
    pub(super) degree: usize,
    /// Where the values are taken.
    pub(super) nodes: Coefficients,
    /// Column `j`: the coefficients of the polynomial that is 1 at node `j` and 0 at the others.
    columns: [Coefficients; MOST_DEGREE + 1],
    /// The greatest sum of a row's absolute values: how much an error of the values may grow.
    pub(super) growth: f64,
}

impl Basis {
    /// For `degree` from 1 to [`MOST_DEGREE`].
    pub(super) fn new(degree: usize) -> Self {
        let n = degree.clamp(1, MOST_DEGREE);
        let mut nodes = [0.0; MOST_DEGREE + 1];
        for (j, node) in nodes.iter_mut().enumerate().take(n + 1) {
            *node = 0.5 - 0.5 * (std::f64::consts::PI * j as f64 / n as f64).cos();
        }
        (nodes[0], nodes[n]) = (0.0, 1.0);
        let rows: Vec<Vec<f64>> = nodes[..=n].iter().map(|&s| bernstein_row(n, s)).collect();
        let inverse = inverted(rows);
        let mut columns = [[0.0; MOST_DEGREE + 1]; MOST_DEGREE + 1];
        for (i, row) in inverse.iter().enumerate() {
            for (j, &value) in row.iter().enumerate() {
                columns[j][i] = value;
            }
        }
        let sums = inverse.iter().map(|row| row.iter().map(|x| x.abs()).sum());
        Self {
            degree: n,
            nodes,
            columns,
            growth: sums.fold(1.0, f64::max),
        }
    }

    /// The coefficients of the polynomial with these values at the nodes.
    pub(super) fn coefficients(&self, values: &[f64]) -> Coefficients {
        let mut b = [0.0; MOST_DEGREE + 1];
        for (column, value) in self.columns[..=self.degree].iter().zip(values) {
            for (b, c) in b[..=self.degree].iter_mut().zip(column) {
                *b += c * value;
            }
        }
        // Exact, since the ends are nodes.
        b[0] = values[0];
        b[self.degree] = values[self.degree];
        b
    }
}

/// `Bᵢ(s)` for all `i`.
fn bernstein_row(n: usize, s: f64) -> Vec<f64> {
    let mut choose = 1.0;
    let mut row = Vec::with_capacity(n + 1);
    for i in 0..=n {
        row.push(choose * s.powi(i as i32) * (1.0 - s).powi((n - i) as i32));
        choose = choose * (n - i) as f64 / (i + 1) as f64;
    }
    row
}

/// The inverse of a square matrix by Gauss-Jordan elimination with row pivots.
pub(super) fn inverted(mut a: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = a.len();
    for (i, row) in a.iter_mut().enumerate() {
        row.extend((0..n).map(|j| if i == j { 1.0 } else { 0.0 }));
    }
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()));
        a.swap(k, pivot.unwrap_or(k));
        let scale = 1.0 / a[k][k];
        a[k].iter_mut().for_each(|x| *x *= scale);
        let row = a[k].clone();
        for (i, other) in a.iter_mut().enumerate() {
            if i != k {
                let factor = other[k];
                other
                    .iter_mut()
                    .zip(&row)
                    .for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    a.into_iter().map(|row| row[n..].to_vec()).collect()
}

/// What a search along a polynomial finds.
pub(super) enum Event {
    /// A simple root.
    Root(f64),
    /// A piece in which the polynomial is zero to rounding, or nearly has a multiple root: to be searched by other means.
    Unclear(f64, f64),
}

#[derive(Clone)]
struct Piece {
    low: f64,
    width: f64,
    halvings: u32,
    b: Coefficients,
}

/// Gives the roots on [0, 1] of the polynomial with coefficients `b`, each known to `error`, to `found`, in ascending order, until it
/// says that it has enough.
///
/// By Descartes' rule there are at most as many roots in a piece as its coefficients change sign, and just one for one change.
/// A coefficient of at most `error` in amount is counted with the sign that makes for more changes. A piece with
/// more is halved by de Casteljau's algorithm; where that does not help, or the polynomial is zero as far as `error` can tell,
/// it is handed to `found` as it is. A root of one change is polished on the piece's own coefficients.
///
/// Source: Lane & Riesenfeld, "Bounds on a Polynomial", BIT 21, 1981; Farouki, "The Bernstein Polynomial Basis: A Centennial
/// Retrospective", Computer Aided Geometric Design 29, 2012.
pub(super) fn each_polynomial_root(
    degree: usize,
    b: &Coefficients,
    error: f64,
    mut found: impl FnMut(Event) -> bool,
) {
    let mut pieces = ArrayVec::<Piece, { HALVINGS as usize + 2 }>::new();
    let (mut low, mut width, mut halvings, mut b) = (0.0, 1.0, 0, *b);
    loop {
        let changes = most_sign_changes(&b[..=degree], error);
        let opposite = (b[0] < 0.0) != (b[degree] < 0.0);
        if changes == 1 && opposite {
            let root = polish_in(|s| value(degree, &b, s), (0.0, b[0]), (1.0, b[degree]));
            if found(Event::Root(low + width * root)) {
                return;
            }
        } else if changes > 0 {
            if halvings == HALVINGS || b[..=degree].iter().all(|c| c.abs() <= error) {
                if found(Event::Unclear(low, low + width)) {
                    return;
                }
            } else {
                width *= 0.5;
                halvings += 1;
                let after = halve(degree, &mut b);
                pieces.push(Piece {
                    low: low + width,
                    width,
                    halvings,
                    b: after,
                });
                continue;
            }
        }
        let Some(next) = pieces.pop() else {
            return;
        };
        Piece {
            low,
            width,
            halvings,
            b,
        } = next;
    }
}

/// The most changes of sign that coefficients known to `error` may have.
#[inline]
fn most_sign_changes(b: &[f64], error: f64) -> i32 {
    let sure = |sign: f64| b.iter().all(|c| sign * c > error);
    if sure(1.0) || sure(-1.0) {
        return 0;
    }
    // The most changes so far if the last sign is minus or plus.
    const NEVER: i32 = i32::MIN / 2;
    let (mut minus, mut plus) = (0, 0);
    for (i, &c) in b.iter().enumerate() {
        let turn = i32::from(i > 0);
        let to_minus = (plus + turn).max(minus);
        let to_plus = (minus + turn).max(plus);
        minus = if c <= error { to_minus } else { NEVER };
        plus = if c >= -error { to_plus } else { NEVER };
    }
    minus.max(plus)
}

/// Makes `b` the coefficients of the first half and gives those of the second.
#[inline]
fn halve(degree: usize, b: &mut Coefficients) -> Coefficients {
    let mut after = [0.0; MOST_DEGREE + 1];
    for k in 0..degree {
        after[degree - k] = b[degree];
        for i in (k + 1..=degree).rev() {
            b[i] = 0.5 * (b[i - 1] + b[i]);
        }
    }
    after[0] = b[degree];
    after
}

/// Value and derivative at `s` by de Casteljau's algorithm.
fn value(degree: usize, b: &Coefficients, s: f64) -> (f64, f64) {
    let mut c = *b;
    let r = 1.0 - s;
    for k in (2..=degree).rev() {
        for i in 0..k {
            c[i] = r * c[i] + s * c[i + 1];
        }
    }
    (r * c[0] + s * c[1], degree as f64 * (c[1] - c[0]))
}

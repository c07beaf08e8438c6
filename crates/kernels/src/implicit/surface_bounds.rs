//! Where a surface is: boxes that hold all roots of a function, proved by intervals.

use super::bernstein::{MOST_DEGREE, inverted};
use super::{ImplicitSurface, Interval64, Scratch, Tape};
use glam::DVec3;

/// The reach of boxes that are tried: `2` to these powers.
const POWERS: std::ops::RangeInclusive<i32> = -14..=24;
/// How exact bounds are, over their edges, as long as that takes no more rounds or parts of boxes.
const THIN: f64 = 1.0 / 48.0;
const MOST_ROUNDS: u32 = 64;
const MOST_PARTS: usize = 8_000;
/// Halvings of a cube's faces for the leading form of a polynomial.
const FACE_LEVELS: u32 = 5;
/// The unit of the nodes is 2 to these powers.
const NODE_POWERS: [i32; 5] = [-12, -4, 4, 12, 20];

/// Where the leading form of a polynomial is all that matters; its 16th power is finite.
const FAR: f64 = (1_u64 << 40) as f64;

/// A box in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub(super) min: DVec3,
    pub(super) max: DVec3,
}

impl Cell {
    /// Its coordinates as intervals.
    pub(super) fn intervals(&self) -> [Interval64; 3] {
        std::array::from_fn(|i| Interval64 {
            lo: self.min[i],
            hi: self.max[i],
        })
    }

    /// One of its eight halves in each direction.
    pub(super) fn octant(&self, number: usize) -> Self {
        let middle = 0.5 * self.min + 0.5 * self.max;
        let (mut min, mut max) = (self.min, middle);
        for i in 0..3 {
            if number >> i & 1 == 1 {
                (min[i], max[i]) = (middle[i], self.max[i]);
            }
        }
        Self { min, max }
    }

    pub(super) fn diagonal(&self) -> f64 {
        (self.max - self.min).length()
    }

    /// How close roots may be to count as one: a part of the extent, but no less than what f64 tells apart here.
    pub(super) fn tolerance(&self) -> f64 {
        let far = self.min.abs().max(self.max.abs()).max_element();
        (ImplicitSurface::TOLERANCE * self.diagonal()).max(4.0 * f64::EPSILON * far)
    }

    /// The same, wider by the rounding of what is computed of its points.
    pub(super) fn widened(&self) -> Self {
        let far = self.min.abs().max(self.max.abs()).max_element();
        let slack = DVec3::splat(far * 1e-14 + self.diagonal() * 1e-12);
        Self {
            min: self.min - slack,
            max: self.max + slack,
        }
    }

    /// Whether it touches a side of the box around all of them, and is thick there.
    fn bears(&self, hull: &Self) -> bool {
        let thin = THIN * (hull.max - hull.min);
        let thick = (self.max - self.min).cmpgt(thin);
        let touches = self.min.cmple(hull.min) | self.max.cmpge(hull.max);
        (thick & touches).any()
    }

    fn including(self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }
}

/// What is in a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// The function has no value in it.
    Undefined,
    /// It has values and no root.
    NoRoot,
    /// There may be a root.
    Unknown,
}

pub(super) fn content(tape: &Tape, [x, y, z]: [Interval64; 3], scratch: &mut Scratch) -> Content {
    let f = tape.interval(x, y, z, scratch);
    if !(f.lo <= f.hi) {
        Content::Undefined
    } else if f.lo > 0.0 || f.hi < 0.0 {
        Content::NoRoot
    } else {
        Content::Unknown
    }
}

/// A cube around the origin that holds all roots, if intervals prove that there is one.
///
/// Outside of `[−R, R]³` are 26 boxes, each unbounded along one axis at least; `R` is the least power of two for which the
/// function has no root in any of them. Subtractions of what grows without bound tell nothing, so that polynomials
/// are also asked by their leading form.
pub(super) fn holding_cube(tape: &Tape, scratch: &mut Scratch) -> Option<Cell> {
    let by_intervals = POWERS
        .map(|power| 2.0_f64.powi(power))
        .find(|&reach| nothing_outside(tape, reach, scratch));
    let reach = match tape.degree() {
        Some(degree) if by_intervals.is_none() => polynomial_reach(tape, degree, scratch),
        _ => by_intervals,
    }?;
    Some(Cell {
        min: DVec3::splat(-reach),
        max: DVec3::splat(reach),
    })
}

fn nothing_outside(tape: &Tape, reach: f64, scratch: &mut Scratch) -> bool {
    let parts = [
        (f64::NEG_INFINITY, -reach),
        (-reach, reach),
        (reach, f64::INFINITY),
    ]
    .map(|(lo, hi)| Interval64 { lo, hi });
    (0..27).filter(|&i| i != 13).all(|i| {
        let part = [parts[i % 3], parts[i / 3 % 3], parts[i / 9]];
        content(tape, part, scratch) != Content::Unknown
    })
}

/// How far the roots of a polynomial go, measured by the greatest coordinate.
///
/// Along the ray `r·u` with `u` on the cube `max |uᵢ| = 1` the polynomial is `Σ cₖ(u) rᵏ`, of which the enclosures come
/// from its values at `n + 1` nodes in `r`. With `0 ∉ cₙ` all roots have
/// ```text
/// |r| ≤ 2 max |cₙ₋ₖ / cₙ|^(1/k)
/// ```
/// Faces are halved where the enclosure of `cₙ` holds 0. As that is too wide where the nodes are too near, farther ones are tried.
///
/// Source: Fujiwara, "Über die obere Schranke des absoluten Betrages der Wurzeln einer algebraischen Gleichung", Tôhoku Mathematical
/// Journal 10, 1916.
fn polynomial_reach(tape: &Tape, degree: u32, scratch: &mut Scratch) -> Option<f64> {
    let n = degree as usize;
    if !(1..=MOST_DEGREE).contains(&n) {
        return None;
    }
    let angle = |j: usize| std::f64::consts::PI * (j as f64 + 0.5) / (n + 1) as f64;
    let nodes: Vec<f64> = (0..=n).map(|j| angle(j).cos()).collect();
    let powers = |r: &f64| (0..=n as i32).map(|k| r.powi(k)).collect();
    let inverse = inverted(nodes.iter().map(powers).collect());
    // A little further out, for the roundings here.
    NODE_POWERS
        .map(|power| 2.0_f64.powi(power))
        .into_iter()
        .find_map(|unit| Some(unit * reach_from(tape, unit, &nodes, &inverse, scratch)? * 1.001))
        .filter(|reach| reach.is_finite() && *reach > 0.0)
}

/// The same in units of `unit`, from nodes of that size.
fn reach_from(
    tape: &Tape,
    unit: f64,
    nodes: &[f64],
    inverse: &[Vec<f64>],
    scratch: &mut Scratch,
) -> Option<f64> {
    let mut reach = 0.0_f64;
    // Since r may be negative, three faces are enough.
    let face = |axis: usize| {
        let mut min = DVec3::splat(-1.0);
        min[axis] = 1.0;
        let max = DVec3::ONE;
        (axis, Cell { min, max }, 0)
    };
    let mut cells: Vec<(usize, Cell, u32)> = (0..3).map(face).collect();
    while let Some((axis, cell, level)) = cells.pop() {
        let mut at = |r: f64| along_cone(tape, &cell, r * unit, scratch);
        let values: Option<Vec<Interval64>> = nodes.iter().map(|&r| at(r)).collect();
        let far = at(FAR)?;
        if let Some(root) = outermost(inverse, &values?, far) {
            reach = reach.max(root);
        } else if level < FACE_LEVELS {
            let quarter = |i: usize| (axis, quarter_of(&cell, axis, i), level + 1);
            cells.extend((0..4).map(quarter));
        } else {
            return None;
        }
    }
    Some(reach)
}

/// The function's values on the face `cell`, scaled by `r`.
fn along_cone(tape: &Tape, cell: &Cell, r: f64, scratch: &mut Scratch) -> Option<Interval64> {
    let (a, b) = (cell.min * r, cell.max * r);
    let scaled = Cell {
        min: a.min(b),
        max: a.max(b),
    };
    let [x, y, z] = scaled.intervals();
    let f = tape.interval(x, y, z, scratch);
    (f.lo <= f.hi && f.lo.is_finite() && f.hi.is_finite()).then_some(f)
}

/// The bound of the roots, from the enclosures of values; `None` if the leading coefficient may be 0.
///
/// Where `r` is huge, `f/rⁿ` is hardly different from `cₙ`, and encloses it more tightly than the interpolation.
fn outermost(inverse: &[Vec<f64>], values: &[Interval64], far: Interval64) -> Option<f64> {
    let greatest = |row: &Vec<f64>| -> f64 {
        let terms = row
            .iter()
            .zip(values)
            .map(|(w, f)| w.abs() * f.lo.abs().max(f.hi.abs()));
        terms.sum()
    };
    // Rounding of the matrix and the sums included.
    let c: Vec<f64> = inverse.iter().map(|row| 1.001 * greatest(row)).collect();
    let n = c.len() - 1;
    let rest: f64 = (1..=n).map(|k| c[n - k] * FAR.powi(-(k as i32))).sum();
    let scale = FAR.powi(-(n as i32));
    let least = (far.lo * scale).max(-far.hi * scale) - 1.001 * rest;
    let bounds = (1..=n).map(|k| (c[n - k] / least).powf(1.0 / k as f64));
    (least > 0.0).then(|| 2.0 * bounds.fold(0.0, f64::max))
}

fn quarter_of(cell: &Cell, axis: usize, number: usize) -> Cell {
    let mut quarter = *cell;
    let axes = [(axis + 1) % 3, (axis + 2) % 3];
    for (bit, i) in axes.into_iter().enumerate() {
        let middle = 0.5 * (cell.min[i] + cell.max[i]);
        if number >> bit & 1 == 0 {
            quarter.max[i] = middle;
        } else {
            quarter.min[i] = middle;
        }
    }
    quarter
}

/// What was found where a box was searched.
pub(super) enum Shrunk {
    /// The function has no value there.
    Undefined,
    /// It has no root there.
    Nothing,
    /// All roots in the box lie in this one.
    To(Cell),
}

/// A box around all roots in `cell`: around those of its parts in which roots cannot be excluded.
///
/// Only parts that touch a side of that box are halved, as long as they are wider than [`THIN`] of it.
pub(super) fn shrink(tape: &Tape, cell: Cell, scratch: &mut Scratch) -> Shrunk {
    let mut hull = cell;
    let mut has_value = false;
    let mut cells = vec![cell];
    let mut spent = 0;
    for _ in 0..MOST_ROUNDS {
        let (outer, mut kept): (Vec<Cell>, Vec<Cell>) =
            cells.iter().partition(|cell| cell.bears(&hull));
        if outer.is_empty() || spent > MOST_PARTS {
            break;
        }
        spent += 8 * outer.len();
        let parts = outer.iter().flat_map(|cell| (0..8).map(|i| cell.octant(i)));
        kept.extend(parts.filter(|part| {
            let content = content(tape, part.widened().intervals(), scratch);
            has_value |= content != Content::Undefined;
            content == Content::Unknown
        }));
        cells = kept;
        let Some(first) = cells.first() else {
            return if has_value {
                Shrunk::Nothing
            } else {
                Shrunk::Undefined
            };
        };
        hull = cells.iter().fold(*first, Cell::including);
    }
    Shrunk::To(hull)
}

//! Surfaces given by a formula, `f(x, y, z) = 0`: no root is missed, and there is nothing to tune.

use super::conjugate::conjugate;
use super::octree::{Octree, Run};
use super::poly_ray::Polynomial;
use super::root::{Budget, each_root, newton_between, polish_in};
use super::surface_bounds::{Cell, Shrunk, holding_cube, shrink};
use super::surface_line::{Segment, TapeLine};
use super::{Formula, Interval64, Scratch, Tape};
use crate::{Aabb, Interval, Ray, SurfaceHit};
use glam::{DVec3, Vec3};
use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};

/// Why there is no surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ImplicitError {
    /// The function is the same everywhere.
    Constant,
    /// The function takes more than [`ImplicitSurface::MOST_OPERATIONS`].
    TooLong,
    /// The function has no value anywhere in the bounds.
    Undefined,
    /// The function has values in the bounds, but is zero nowhere.
    NoSurface,
    /// It could not be proved that the surface ends anywhere: it needs `bounds`.
    NeedsBounds,
    /// The bounds given are empty, or not finite.
    BadBounds,
}

impl std::fmt::Display for ImplicitError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Constant => "the function is constant: it depends on none of x, y and z",
            Self::TooLong => {
                let most = ImplicitSurface::MOST_OPERATIONS;
                return write!(
                    f,
                    "the function is too long: more than {most} operations are left when equal parts are shared"
                );
            }
            Self::Undefined => "the function has no value anywhere in the bounds",
            Self::NoSurface => "the function is zero nowhere in the bounds",
            Self::NeedsBounds => {
                "the surface may go on for ever: give `bounds`, the box in which it is drawn"
            }
            Self::BadBounds => "`bounds` must be finite, with its least corner before its greatest",
        })
    }
}

impl std::error::Error for ImplicitError {}

/// The points of a box at which a function is zero.
///
/// Inside is where the function is negative. Where the bounds cut the surface it is open: bounds are a window, not a wall, and outside of
/// them there is nothing. To close it, intersect it with a body within the bounds: `max(f, box(…))`. A function that is
/// zero without a change of sign, such as a square, is a sheet around nothing.
///
/// Every ray is searched by enclosures that hold whatever rounding does: a root is missed only where two are closer
/// than [`ImplicitSurface::TOLERANCE`] of the extent and the function between them differs from zero by less than rounding.
#[derive(Debug)]
pub struct ImplicitSurface {
    formula: Formula,
    tape: Tape,
    /// Around all roots.
    cell: Cell,
    /// The bounds that were given, outside of which nothing is inside, or the same again.
    window: Cell,
    bounds: Aabb,
    method: Method,
    /// Bounds the rounding of the function's values within the bounds.
    value_error: f64,
    exhausted: AtomicU64,
}

/// How rays are searched.
#[derive(Debug)]
enum Method {
    Polynomial(Box<Polynomial>),
    Cells(Octree),
}

impl Method {
    /// The fastest one for a function.
    fn of(tape: &Tape, cell: Cell, value_error: f64, scratch: &mut Scratch) -> Self {
        let polynomial = match tape.degree() {
            Some(degree) => Polynomial::new(Some(degree), value_error),
            None => conjugate(tape, &cell, scratch).and_then(|conjugate| {
                let error = self::value_error(&conjugate.product, &cell, scratch);
                Polynomial::with_conjugate(conjugate, error)
            }),
        };
        match polynomial {
            Some(polynomial) => Self::Polynomial(Box::new(polynomial)),
            None => Self::Cells(Octree::build(tape, cell)),
        }
    }
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

impl PartialEq for ImplicitSurface {
    fn eq(&self, other: &Self) -> bool {
        self.formula == other.formula && self.bounds == other.bounds
    }
}

impl ImplicitSurface {
    /// Pieces of a ray of this part of the extent, the diagonal of the bounds, hold a root if intervals cannot exclude it.
    pub const TOLERANCE: f64 = 1e-9;
    /// Interval evaluations that a ray may take; then its nearest undecided piece counts as a root.
    pub const MOST_EVALUATIONS: u32 = 4096;
    /// Operations of a function, all of which most evaluations go through.
    pub const MOST_OPERATIONS: usize = 1 << 14;

    /// The surface within `bounds`, or, where it is proved that it ends, all of it.
    pub fn new(formula: Formula, bounds: Option<Aabb>) -> Result<Self, ImplicitError> {
        let tape = formula.tape().clone();
        if tape.is_constant() {
            return Err(ImplicitError::Constant);
        }
        if tape.ops() > Self::MOST_OPERATIONS {
            return Err(ImplicitError::TooLong);
        }
        let mut scratch = Scratch::default();
        let whole = match bounds {
            Some(bounds) => checked(bounds)?,
            None => holding_cube(&tape, &mut scratch).ok_or(ImplicitError::NeedsBounds)?,
        };
        let cell = match shrink(&tape, whole, &mut scratch) {
            Shrunk::To(cell) => cell,
            Shrunk::Nothing => return Err(ImplicitError::NoSurface),
            Shrunk::Undefined => return Err(ImplicitError::Undefined),
        };
        let value_error = value_error(&tape, &cell, &mut scratch);
        let method = Method::of(&tape, cell, value_error, &mut scratch);
        let (center, half) = (0.5 * (cell.min + cell.max), 0.5 * (cell.max - cell.min));
        Ok(Self {
            bounds: Aabb::from_reach(center, half),
            formula,
            tape,
            cell,
            window: if bounds.is_some() { whole } else { cell },
            method,
            value_error,
            exhausted: AtomicU64::new(0),
        })
    }

    /// What was written.
    pub fn formula(&self) -> &Formula {
        &self.formula
    }

    /// The box around all of the surface.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// How many searches along rays ran out of [`ImplicitSurface::MOST_EVALUATIONS`] so far.
    pub fn exhausted(&self) -> u64 {
        self.exhausted.load(Ordering::Relaxed)
    }

    /// Bytes on the heap, without the formula's.
    pub fn memory(&self) -> usize {
        match &self.method {
            Method::Polynomial(_) => 0,
            Method::Cells(octree) => octree.memory(),
        }
    }

    /// Whether a point is within the bounds and the function negative there.
    pub fn contains(&self, p: DVec3) -> bool {
        let Cell { min, max } = self.window;
        min.cmple(p).all() && p.cmple(max).all() && self.tape.value(p) < 0.0
    }

    /// Where the ray enters the window and where it leaves it, both at its start if it does not meet it.
    pub(crate) fn span(&self, ray: &Ray) -> [f32; 2] {
        let endless = Ray::new(ray.origin, ray.dir);
        let segment = Segment::new(&endless, self.window.min, self.window.max);
        segment.map_or([ray.t.min; 2], |s| [s.ray_t(s.t.lo), s.ray_t(s.t.hi)])
    }

    /// All hits in the ray's interval, ascending.
    pub(crate) fn all_hits(&self, ray: &Ray) -> Vec<SurfaceHit> {
        let mut hits: Vec<SurfaceHit> = Vec::new();
        self.each_root(ray, |t| {
            if ray.t.contains(t) && hits.last().is_none_or(|hit| hit.t < t) {
                hits.push(SurfaceHit { t, part: 0 });
            }
            false
        });
        hits
    }

    pub(super) fn tape(&self) -> &Tape {
        &self.tape
    }

    pub(super) fn cell(&self) -> &Cell {
        &self.cell
    }

    /// Gives the roots along a ray to `found`, in ascending order, until it says that it has enough.
    pub(crate) fn each_root(&self, ray: &Ray, found: impl FnMut(f32) -> bool) {
        self.search(ray, false, found);
    }

    /// Whether there is a root in the ray's interval: as [`intersect_implicit`] says, without the cost of its place.
    pub(crate) fn is_met(&self, ray: &Ray) -> bool {
        self.search(ray, true, |t| ray.t.contains(t))
    }

    /// Gives roots to `found` until it says that it has enough; whether it did. With `any` a root somewhere in the ray's interval is
    /// enough, even if its place is not known.
    fn search(&self, ray: &Ray, any: bool, mut found: impl FnMut(f32) -> bool) -> bool {
        let Some(segment) = Segment::new(ray, self.cell.min, self.cell.max) else {
            return false;
        };
        let mut budget = Budget {
            tolerance: segment.duration(self.cell.tolerance()),
            evaluations: Self::MOST_EVALUATIONS,
            exhausted: false,
        };
        let inside = any.then_some(ray.t);
        let mut found = |t: f64| found(segment.ray_t(t));
        let is_enough = SCRATCH.with_borrow_mut(|scratch| {
            let mut line = TapeLine {
                tape: &self.tape,
                segment,
                scratch,
            };
            match &self.method {
                Method::Polynomial(polynomial) => {
                    polynomial.each_root(&mut line, &mut budget, &mut found)
                }
                Method::Cells(octree) => {
                    self.each_root_in_cells(octree, line, inside, &mut budget, &mut found)
                }
            }
        });
        if budget.exhausted {
            self.exhausted.fetch_add(1, Ordering::Relaxed);
        }
        is_enough
    }

    /// Any root `inside` this interval of the ray is enough, if there is one.
    fn each_root_in_cells<'a>(
        &self,
        octree: &'a Octree,
        mut line: TapeLine<'a>,
        inside: Option<Interval>,
        budget: &mut Budget,
        found: &mut impl FnMut(f64) -> bool,
    ) -> bool {
        let segment = line.segment;
        let mut last = f64::NEG_INFINITY;
        let tolerance = budget.tolerance;
        let mut found = |t: f64| {
            let is_new = t > last + tolerance;
            last = last.max(t);
            is_new && found(t)
        };
        let is_inside = |t: f64| inside.is_some_and(|i| i.contains(segment.ray_t(t)));
        let (origin, dir) = (segment.origin(), segment.dir());
        let mut is_enough = false;
        octree.walk((origin, dir), segment.t, |leaf, center, t| {
            let (from, to) = (segment.at(t.lo) - center, segment.at(t.hi) - center);
            line.tape = &octree.tapes[leaf.tape as usize];
            is_enough = match leaf.run(from, to, dir) {
                Run::NoRoot => false,
                Run::Monotone(a, b) if changes_sign(a, b) && is_inside(t.lo) && is_inside(t.hi) => {
                    true
                }
                Run::Monotone(a, b) => match self.monotone_root(&mut line, t, (a, b)) {
                    Ends::NoRoot => false,
                    Ends::Root(root) => found(root),
                    Ends::Unclear => each_root(&mut line, t, budget, &mut found),
                },
                Run::Unknown => each_root(&mut line, t, budget, &mut found),
            };
            is_enough || budget.exhausted
        });
        is_enough
    }

    /// The root of a monotone piece: where Newton's method finds it between the ends, else by the signs there, unless rounding may hide
    /// one of them. `ends` encloses the values there.
    fn monotone_root(
        &self,
        line: &mut TapeLine,
        t: Interval64,
        ends: (Interval64, Interval64),
    ) -> Ends {
        let mut at = |t: f64| super::root::Line::at(line, t);
        if let Some(root) = newton_between(&mut at, t, ends) {
            return Ends::Root(root);
        }
        let [a, b] = [t.lo, t.hi].map(|t| line.tape.value(line.segment.at(t)));
        if !(a.abs() > self.value_error && b.abs() > self.value_error) {
            Ends::Unclear
        } else if (a < 0.0) == (b < 0.0) {
            Ends::NoRoot
        } else {
            let at = |t: f64| super::root::Line::at(line, t);
            Ends::Root(polish_in(at, (t.lo, a), (t.hi, b)))
        }
    }
}

/// Whether all values of one interval are negative and all of the other positive.
fn changes_sign(a: Interval64, b: Interval64) -> bool {
    (a.hi < 0.0 && b.lo > 0.0) || (a.lo > 0.0 && b.hi < 0.0)
}

/// What the values at the ends of a monotone piece tell.
enum Ends {
    NoRoot,
    Root(f64),
    Unclear,
}

fn checked(bounds: Aabb) -> Result<Cell, ImplicitError> {
    let (min, max): (Vec3, Vec3) = (bounds.min, bounds.max);
    if !(min.is_finite() && max.is_finite() && min.cmplt(max).all()) {
        return Err(ImplicitError::BadBounds);
    }
    Ok(Cell {
        min: min.as_dvec3(),
        max: max.as_dvec3(),
    })
}

/// Bounds the rounding of the function in a box: four times the greatest width of its enclosures at points of a lattice with the
/// corners, where the terms of polynomials are greatest. Poles do not count: no width is enough for what lies beside one.
fn value_error(tape: &Tape, cell: &Cell, scratch: &mut Scratch) -> f64 {
    const SIDE: usize = 5;
    let step = (cell.max - cell.min) / (SIDE - 1) as f64;
    let width = |i: usize| {
        let place = DVec3::new(
            (i % SIDE) as f64,
            (i / SIDE % SIDE) as f64,
            (i / SIDE / SIDE) as f64,
        );
        let p = cell.min + step * place;
        // As wide as the rounding of a point on a ray.
        let far = p.abs().max_element() * f64::EPSILON;
        let [x, y, z] = p.to_array().map(|x| Interval64 {
            lo: x - far,
            hi: x + far,
        });
        let f = tape.interval(x, y, z, scratch);
        f.hi - f.lo
    };
    4.0 * (0..SIDE.pow(3))
        .map(width)
        .filter(|w| w.is_finite())
        .fold(0.0, f64::max)
}

/// Intersects a ray with an implicit surface; gives the nearest `t` in the ray's interval.
///
/// Within the surface's bounds, the least `t` with
/// ```text
/// f(o + t d) = 0
/// ```
/// is found by interval subdivision, cell by cell of an octree, or, for polynomials, from their
/// Bernstein coefficients along the ray. A ray that only touches the surface hits it. Computed in f64.
///
/// Source: Mitchell, "Robust Ray Intersection with Interval Arithmetic", Graphics Interface 1990.
pub fn intersect_implicit(ray: &Ray, surface: &ImplicitSurface) -> Option<f32> {
    let mut nearest = None;
    surface.each_root(ray, |t| {
        let is_hit = ray.t.contains(t);
        if is_hit {
            nearest = Some(t);
        }
        is_hit
    });
    nearest
}

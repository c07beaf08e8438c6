//! Builds the octree of a function, level by level.

use super::octree::{EMPTY, LEAF, Leaf, Octree};
use super::surface_bounds::Cell;
use super::{Interval64, Scratch, Tape};
use glam::DVec3;
use rayon::prelude::*;

/// How far an octree grows.
pub(super) struct Growth;

impl Growth {
    /// Levels below the whole; no cell is smaller than 2⁻¹⁰ of it.
    pub(super) const MOST_LEVELS: u32 = 10;
    /// No level is begun that would divide more cells than this.
    const MOST_DIVIDED: usize = 50_000;
    /// Nor one in which these cells have more operations to go through together.
    const MOST_OPERATIONS: usize = 4_000_000;
    /// Nor one after the tree takes this many bytes. What the last level adds is at most eight leaves and tapes for each divided cell.
    const MOST_BYTES: usize = 32 << 20;
    /// Tapes are worth their memory if they leave out a quarter.
    const SHORTER: f64 = 0.75;
    /// The gradient counts as constant in a cell if no component varies by more than this part of its length.
    const VARIES: f64 = 0.35;
}

/// A cell that is not decided yet.
#[derive(Clone)]
struct Open {
    cell: Cell,
    leaf: Leaf,
    /// Where it is noted: a node and the number of a child.
    place: (usize, usize),
}

/// What was found in a cell.
enum Found {
    Empty,
    /// A leaf, if it is settled, with its tape if that is a new one.
    Cell(Leaf, bool, Option<Tape>),
}

impl Octree {
    /// The octree of a function over a box; the same on any number of threads.
    pub(super) fn build(tape: &Tape, cell: Cell) -> Self {
        let mut tree = Self {
            cell,
            nodes: Vec::new(),
            leaves: Vec::new(),
            tapes: vec![tape.clone()],
        };
        let mut open = match inspect(tape, 0, &cell, &mut Scratch::default()) {
            Found::Empty => return tree,
            Found::Cell(leaf, _, _) => vec![Open {
                cell,
                leaf,
                place: (0, 0),
            }],
        };
        for level in 0..Growth::MOST_LEVELS {
            let most = Growth::MOST_DIVIDED.min(Growth::MOST_OPERATIONS / tape.ops().max(1));
            let too_many = open.len() > most || tree.memory() > Growth::MOST_BYTES;
            if open.is_empty() || (level > 0 && too_many) {
                break;
            }
            open = tree.divide(&open, level);
        }
        for last in open {
            let number = tree.push_leaf(last.leaf);
            tree.nodes[last.place.0][last.place.1] = number;
        }
        tree
    }

    /// Makes nodes of cells and gives those of their children that are still to be divided.
    fn divide(&mut self, cells: &[Open], level: u32) -> Vec<Open> {
        let tapes = &self.tapes;
        let inspect_all = |scratch: &mut Scratch, open: &Open| -> [Found; 8] {
            let number = open.leaf.tape;
            let tape = &tapes[number as usize];
            std::array::from_fn(|i| inspect(tape, number, &open.cell.octant(i), scratch))
        };
        let found: Vec<[Found; 8]> = cells
            .par_iter()
            .map_init(Scratch::default, inspect_all)
            .collect();
        let mut next = Vec::new();
        for (open, children) in cells.iter().zip(found) {
            let node = self.nodes.len();
            self.nodes.push([EMPTY; 8]);
            if level > 0 {
                self.nodes[open.place.0][open.place.1] = node as u32;
            }
            for (i, child) in children.into_iter().enumerate() {
                let Found::Cell(mut leaf, is_settled, tape) = child else {
                    continue;
                };
                if let Some(tape) = tape {
                    leaf.tape = self.tapes.len() as u32;
                    self.tapes.push(tape);
                }
                if is_settled && level > 0 {
                    self.nodes[node][i] = self.push_leaf(leaf);
                } else {
                    let cell = open.cell.octant(i);
                    next.push(Open {
                        cell,
                        leaf,
                        place: (node, i),
                    });
                }
            }
        }
        next
    }

    fn push_leaf(&mut self, leaf: Leaf) -> u32 {
        self.leaves.push(leaf);
        (self.leaves.len() - 1) as u32 | LEAF
    }
}

fn inspect(tape: &Tape, number: u32, cell: &Cell, scratch: &mut Scratch) -> Found {
    let wide = cell.widened();
    let [x, y, z] = wide.intervals();
    let f = tape.interval(x, y, z, scratch);
    if !(f.lo <= 0.0 && 0.0 <= f.hi) {
        return Found::Empty;
    }
    let shorter = tape.shorten(scratch);
    let shorter = shorter.filter(|t| (t.ops() as f64) < Growth::SHORTER * tape.ops() as f64);
    let tape = shorter.as_ref().unwrap_or(tape);
    let (_, slope) = tape.slopes(x, y, z, scratch);
    let slope = slope.map(|s| {
        let slack = 1e-12 * s.lo.abs().max(s.hi.abs());
        Interval64 {
            lo: s.lo - slack,
            hi: s.hi + slack,
        }
    });
    let steepest = DVec3::from(slope.map(|s| s.lo.abs().max(s.hi.abs())));
    let middle = middle_value(tape, cell, (wide.max - cell.max).dot(steepest), scratch);
    let reach = 0.5 * (wide.max - wide.min).dot(steepest);
    if middle.lo > reach || middle.hi < -reach {
        return Found::Empty;
    }
    let length = DVec3::from(slope.map(|s| 0.5 * (s.lo + s.hi))).length();
    let is_settled = slope.iter().all(|s| s.hi - s.lo <= Growth::VARIES * length);
    let leaf = Leaf {
        middle,
        slope,
        tape: number,
    };
    Found::Cell(leaf, is_settled, shorter)
}

/// The function in the middle of a cell, wider by `slack`, or anything where it has no value.
fn middle_value(tape: &Tape, cell: &Cell, slack: f64, scratch: &mut Scratch) -> Interval64 {
    let middle = 0.5 * cell.min + 0.5 * cell.max;
    let [x, y, z] = middle.to_array().map(Interval64::point);
    let f = tape.interval(x, y, z, scratch);
    if f.lo <= f.hi && slack.is_finite() {
        Interval64 {
            lo: f.lo - slack,
            hi: f.hi + slack,
        }
    } else {
        Interval64 {
            lo: f64::NEG_INFINITY,
            hi: f64::INFINITY,
        }
    }
}

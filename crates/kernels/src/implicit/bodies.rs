//! Bodies as signed distances at the point (x, y, z), and what is made of them.
//!
//! Source: Ricci, "A Constructive Geometry for Computer Graphics", The Computer Journal 16(2), 1973; Hart, "Sphere Tracing",
//! The Visual Computer 12, 1996.

use super::graph::{Graph, Id, XYZ};
use super::op::Code;

/// A body, or a body that is moved; whatever is not a name of one is zero.
pub(super) fn body(graph: &mut Graph, name: &str, arguments: &[Id]) -> Id {
    let [x, y, z] = XYZ;
    match (name, arguments) {
        ("sphere", &[r]) => {
            let d = length(graph, &[x, y, z]);
            graph.binary(Code::Sub, d, r)
        }
        ("box", sides @ &[_, _, _]) => block(graph, sides),
        ("torus", &[big, small]) => {
            let ring = length(graph, &[x, z]);
            let ring = graph.binary(Code::Sub, ring, big);
            let d = length(graph, &[ring, y]);
            graph.binary(Code::Sub, d, small)
        }
        ("cylinder", &[r, h]) => {
            let ring = length(graph, &[x, z]);
            let side = graph.binary(Code::Sub, ring, r);
            let cap = slab(graph, y, h);
            outside_of(graph, &[side, cap])
        }
        ("capsule", &[r, h]) => {
            let cap = slab(graph, y, h);
            let beyond = positive(graph, cap);
            let d = length(graph, &[x, beyond, z]);
            graph.binary(Code::Sub, d, r)
        }
        ("plane", &[h]) => graph.binary(Code::Sub, y, h),
        ("smooth_union", &[a, b, k]) => smooth_union(graph, a, b, k),
        ("at", &[px, py, pz, of]) => {
            let moved = [(x, px), (y, py), (z, pz)].map(|(x, p)| graph.binary(Code::Sub, x, p));
            graph.substitute(of, moved)
        }
        ("scale", &[s, of]) => {
            let shrunk = XYZ.map(|x| graph.binary(Code::Div, x, s));
            let f = graph.substitute(of, shrunk);
            graph.binary(Code::Mul, f, s)
        }
        ("rotate_x", &[angle, of]) => rotate(graph, angle, of, [1, 2]),
        ("rotate_y", &[angle, of]) => rotate(graph, angle, of, [2, 0]),
        ("rotate_z", &[angle, of]) => rotate(graph, angle, of, [0, 1]),
        _ => graph.constant(0.0),
    }
}

/// `a (1 − t) + b t`
pub(super) fn mix(graph: &mut Graph, a: Id, b: Id, t: Id) -> Id {
    let one = graph.constant(1.0);
    let rest = graph.binary(Code::Sub, one, t);
    let (a, b) = (
        graph.binary(Code::Mul, a, rest),
        graph.binary(Code::Mul, b, t),
    );
    graph.binary(Code::Add, a, b)
}

/// `√(a² + b² + …)`
fn length(graph: &mut Graph, components: &[Id]) -> Id {
    let mut squares = components
        .iter()
        .map(|&a| graph.binary(Code::Mul, a, a))
        .collect::<Vec<Id>>();
    let first = squares.remove(0);
    let sum = squares
        .iter()
        .fold(first, |sum, &a| graph.binary(Code::Add, sum, a));
    graph.unary(Code::Sqrt, sum)
}

/// `|a| − h`
fn slab(graph: &mut Graph, a: Id, h: Id) -> Id {
    let a = graph.unary(Code::Abs, a);
    graph.binary(Code::Sub, a, h)
}

/// `max(a, 0)`
fn positive(graph: &mut Graph, a: Id) -> Id {
    let zero = graph.constant(0.0);
    graph.binary(Code::Max, a, zero)
}

/// The distance from what lies on the negative side of faces at right angles: `|max(d, 0)| + min(max d, 0)`.
fn outside_of(graph: &mut Graph, distances: &[Id]) -> Id {
    let beyond: Vec<Id> = distances.iter().map(|&d| positive(graph, d)).collect();
    let outside = length(graph, &beyond);
    let (first, others) = (distances[0], &distances[1..]);
    let deepest = others
        .iter()
        .fold(first, |a, &b| graph.binary(Code::Max, a, b));
    let zero = graph.constant(0.0);
    let inside = graph.binary(Code::Min, deepest, zero);
    graph.binary(Code::Add, outside, inside)
}

fn block(graph: &mut Graph, sides: &[Id]) -> Id {
    let faces: Vec<Id> = XYZ
        .iter()
        .zip(sides)
        .map(|(&x, &side)| slab(graph, x, side))
        .collect();
    outside_of(graph, &faces)
}

/// `min(a, b) − h² k/4` with `h = max(k − |a − b|, 0)/k`.
///
/// Source: Quilez, "Smooth minimum", 2013.
fn smooth_union(graph: &mut Graph, a: Id, b: Id, k: Id) -> Id {
    let apart = graph.binary(Code::Sub, a, b);
    let apart = graph.unary(Code::Abs, apart);
    let near = graph.binary(Code::Sub, k, apart);
    let near = positive(graph, near);
    let h = graph.binary(Code::Div, near, k);
    let h2 = graph.binary(Code::Mul, h, h);
    let quarter = graph.constant(0.25);
    let depth = graph.binary(Code::Mul, k, quarter);
    let dent = graph.binary(Code::Mul, h2, depth);
    let least = graph.binary(Code::Min, a, b);
    graph.binary(Code::Sub, least, dent)
}

/// A body turned in the plane of two axes, from the first towards the second: the function at the point turned back.
fn rotate(graph: &mut Graph, angle: Id, of: Id, [i, j]: [usize; 2]) -> Id {
    let (c, s) = (graph.unary(Code::Cos, angle), graph.unary(Code::Sin, angle));
    let mut product = |a: Id, b: Id| graph.binary(Code::Mul, a, b);
    let (cu, sv) = (product(c, XYZ[i]), product(s, XYZ[j]));
    let (cv, su) = (product(c, XYZ[j]), product(s, XYZ[i]));
    let mut turned = XYZ;
    turned[i] = graph.binary(Code::Add, cu, sv);
    turned[j] = graph.binary(Code::Sub, cv, su);
    graph.substitute(of, turned)
}

//! The tree of rays, for people.

use super::{
    Job,
    names::{percent, short},
    words::met,
};
use umbriel_formats::render::{RayKind, RayTree, Term, TermSource, kernels::glam::Vec3};

/// Rays that are told one by one; there may be hundreds between mirrors.
const MOST: usize = 64;

/// The tree, a line a ray: its weight, what it meets, and what it brings.
pub(super) fn lines(job: &Job, tree: &RayTree) -> Vec<String> {
    let (count, terms) = (tree.rays.len(), tree.terms.len());
    let rays = if count == 1 { "ray" } else { "rays" };
    let mut lines = vec![format!(
        "Whitted's rays: {count} {rays}, the sum of {terms} terms is {}; each with its number, its weight, what it meets, and what it and those after it bring",
        nit(tree.radiance())
    )];
    add(job, tree, 0, "  ", "", &mut lines);
    if lines.len() > MOST {
        let left = lines.len() - MOST;
        lines.truncate(MOST);
        lines.push(format!("  and {left} lines more: see --json"));
    }
    lines
}

fn add(job: &Job, tree: &RayTree, number: u32, first: &str, rest: &str, lines: &mut Vec<String>) {
    let ray = &tree.rays[number as usize];
    lines.push(format!(
        "{first}{number} {} {}: {}; {} {}",
        ray_kind(ray.kind),
        weight(ray.weight),
        met(job, ray),
        nit(tree.brought_by(number)),
        job.hex(tree.brought_by(number)),
    ));
    let (below, indent) = match number {
        0 => ("  ".to_owned(), "  "),
        _ => (rest.to_owned(), rest),
    };
    for term in tree.terms.iter().filter(|term| term.ray == number) {
        if let Some(words) = term_words(job, term) {
            lines.push(format!("{indent}     {words}"));
        }
    }
    let after: Vec<u32> = (0..tree.rays.len() as u32)
        .filter(|&i| tree.rays[i as usize].parent == Some(number))
        .collect();
    for (i, &child) in after.iter().enumerate() {
        let last = i + 1 == after.len();
        let (branch, beside) = if last {
            ("└─ ", "   ")
        } else {
            ("├─ ", "│  ")
        };
        add(
            job,
            tree,
            child,
            &format!("{below}{branch}"),
            &format!("{below}{beside}"),
            lines,
        );
    }
}

/// In a word.
pub(super) fn ray_kind(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Eye => "eye",
        RayKind::Passed => "passed",
        RayKind::Mirrored => "mirrored",
        RayKind::Refracted => "refracted",
    }
}

/// One number where all colours are weighted alike.
fn weight(weight: Vec3) -> String {
    if weight.x == weight.y && weight.y == weight.z {
        return format!("x {}", short(weight.x));
    }
    format!("x ({})", weight.to_array().map(short).join(", "))
}

fn nit(radiance: Vec3) -> String {
    format!("({})", radiance.to_array().map(short).join(", "))
}

fn term_words(job: &Job, term: &Term) -> Option<String> {
    if term.radiance == Vec3::ZERO && !matches!(term.source, TermSource::Light(_)) {
        return None;
    }
    let what = match term.source {
        // Its line says so already.
        TermSource::Sky => return None,
        TermSource::Own => "own and ambient light".to_owned(),
        TermSource::Light(number) => {
            let name = job.bvh.scene().lights[number as usize].name();
            format!(
                "light {name:?}, {} of it",
                percent(term.fraction.max_element())
            )
        }
    };
    Some(format!("{what}: {}", nit(term.radiance)))
}

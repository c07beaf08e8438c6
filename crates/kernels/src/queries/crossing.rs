//! Where a ray goes into a body and comes out of it.

/// Which way a ray goes through a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// From the front to the back: into a closed body.
    Enter,
    /// From the back to the front: out of a closed body.
    Leave,
}

impl Way {
    pub(super) fn other(self) -> Self {
        match self {
            Self::Enter => Self::Leave,
            Self::Leave => Self::Enter,
        }
    }
}

/// A ray meets the surface of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Ray parameter, in units of the length of the ray's direction.
    pub t: f32,
    /// Number of the triangle, or the part of the surface.
    pub primitive: u32,
    /// Barycentric weight of the triangle's second corner; 0 for surfaces.
    pub u: f32,
    /// Barycentric weight of the triangle's third corner; 0 for surfaces.
    pub v: f32,
    /// Into the body or out of it.
    pub way: Way,
}

/// The crossings of many rays, ray by ray, in the order in which each ray passes them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Crossings {
    all: Vec<Crossing>,
    /// Where the crossings of each ray end.
    ends: Vec<usize>,
}

impl Crossings {
    /// Number of rays.
    pub fn rays(&self) -> usize {
        self.ends.len()
    }

    /// The crossings of ray `i`; none for a number that there is not.
    pub fn of(&self, i: usize) -> &[Crossing] {
        let end = self.ends.get(i).copied().unwrap_or(self.all.len());
        let start = match i {
            0 => 0,
            _ => self.ends.get(i - 1).copied().unwrap_or(end),
        };
        if i < self.ends.len() {
            &self.all[start..end]
        } else {
            &[]
        }
    }

    /// The crossings of one ray after the other.
    pub fn iter(&self) -> impl Iterator<Item = &[Crossing]> {
        (0..self.rays()).map(|i| self.of(i))
    }

    /// The crossings of all rays.
    pub fn as_slice(&self) -> &[Crossing] {
        &self.all
    }

    /// Ends the crossings of a ray.
    pub(super) fn push(&mut self, crossings: impl IntoIterator<Item = Crossing>) {
        self.all.extend(crossings);
        self.ends.push(self.all.len());
    }

    /// Those of more rays after these.
    pub(super) fn append(&mut self, more: &Self) {
        let offset = self.all.len();
        self.all.extend_from_slice(&more.all);
        self.ends.extend(more.ends.iter().map(|end| offset + end));
    }
}

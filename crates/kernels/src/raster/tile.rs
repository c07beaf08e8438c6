//! One tile of a picture while it is drawn: pixels in blocks of 4 x 4, so that one vector holds a block.

/// One tile of a picture; its memory is reused from tile to tile.
#[derive(Clone, Debug, Default)]
pub struct TileImage {
    /// `[x0, y0, x1, y1]` in pixels, without the ends.
    pub rect: [u32; 4],
    /// Depths row by row; larger is nearer, 0 where nothing is.
    pub depth: Vec<f32>,
    /// `first_id` of the draw + number of the triangle, row by row; `u32::MAX` where nothing is; empty if not wanted.
    pub ids: Vec<u32>,
    pub(super) blocks: Blocks,
}

/// Pixels in a block.
pub(super) const BLOCK: usize = 16;

/// Blocks of 4 x 4 pixels, sixteen in a square of 16 x 16 pixels, squares row by row.
#[derive(Clone, Debug, Default)]
pub(super) struct Blocks {
    /// Squares in a row.
    pub(super) columns: usize,
    pub(super) depth: Vec<f32>,
    /// Empty if not wanted.
    pub(super) ids: Vec<u32>,
    /// A depth that no pixel of a square is further away than: what is, is hidden.
    pub(super) furthest: Vec<f32>,
}

impl Blocks {
    /// Room for a tile with nothing on it.
    pub(super) fn clear(&mut self, [x0, y0, x1, y1]: [u32; 4], with_ids: bool) {
        let [columns, rows] = [x1 - x0, y1 - y0].map(|side| side.div_ceil(16) as usize);
        self.columns = columns;
        let pixels = columns * rows * 256;
        self.depth.clear();
        self.depth.resize(pixels, 0.0);
        self.furthest.clear();
        self.furthest.resize(columns * rows, 0.0);
        self.ids.clear();
        self.ids.resize(if with_ids { pixels } else { 0 }, u32::MAX);
    }
}

/// Copies row `y` of a tile out of its blocks.
pub(super) fn copy_row<T: Copy>(blocks: &[T], columns: usize, y: usize, row: &mut [T]) {
    // Where the row lies in each square.
    let within = (y % 16 / 4) * 64 + (y % 4) * 4;
    let squares = blocks[y / 16 * columns * 256..].as_chunks::<256>().0;
    let (whole, rest) = row.as_chunks_mut::<16>();
    for (to, square) in whole.iter_mut().zip(squares) {
        for (to, block) in to.as_chunks_mut::<4>().0.iter_mut().zip(0..) {
            let at = (within + block * BLOCK) & 255;
            to.copy_from_slice(&square[at..at + 4]);
        }
    }
    if let Some(square) = squares.get(whole.len()) {
        for (to, block) in rest.chunks_mut(4).zip(0..) {
            let at = within + block * BLOCK;
            to.copy_from_slice(&square[at..at + to.len()]);
        }
    }
}

//! One tile of a picture while it is drawn: pixels in blocks of 4 x 4, so that one vector holds a block.

/// One tile of a picture; its memory is reused from tile to tile.
#[derive(Clone, Debug, Default)]
pub struct TileImage {
    /// `[x0, y0, x1, y1]` in pixels, without the ends.
    pub rect: [u32; 4],
    pub(super) blocks: Blocks,
}

impl TileImage {
    /// Pixels of a patch across and down: four blocks of 4 x 4 side by side, each row by row, as they lie in memory.
    pub const PATCH: [u32; 2] = [16, 4];

    /// Column and row within a patch of its pixel `i`.
    #[inline(always)]
    pub const fn place_in_patch(i: usize) -> [usize; 2] {
        [i / BLOCK * 4 + i % 4, i % BLOCK / 4]
    }

    /// `first_id` of the draw + number of the triangle of each pixel of a patch; `u32::MAX` where nothing is. Pixels that the last patches have beyond
    /// the tile may hold any.
    #[inline]
    pub fn patch_ids(&self, column: usize, row: usize) -> &[u32; 64] {
        let square = row / 4 * self.blocks.columns + column;
        let patches = self.blocks.ids.as_chunks::<64>().0;
        &patches[square * 4 + row % 4]
    }

    /// Copies the ids of row `y` of the tile, from its first pixel on.
    pub fn row_ids(&self, y: usize, row: &mut [u32]) {
        copy_row(&self.blocks.ids, self.blocks.columns, y, row);
    }

    /// Copies the depths of row `y` of the tile, from its first pixel on; larger is nearer, 0 where nothing is.
    pub fn row_depths(&self, y: usize, row: &mut [f32]) {
        copy_row(&self.blocks.depth, self.blocks.columns, y, row);
    }
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

/// The blocks of a tile, or of a band of a picture, while they are drawn.
#[derive(Debug)]
pub(super) struct BlocksMut<'a> {
    pub(super) columns: usize,
    pub(super) depth: &'a mut [f32],
    pub(super) ids: &'a mut [u32],
    pub(super) furthest: &'a mut [f32],
}

impl Blocks {
    pub(super) fn lend(&mut self) -> BlocksMut<'_> {
        BlocksMut {
            columns: self.columns,
            depth: &mut self.depth,
            ids: &mut self.ids,
            furthest: &mut self.furthest,
        }
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

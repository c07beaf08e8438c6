//! Several pictures on one labelled sheet.

use embedded_graphics::{
    Pixel,
    draw_target::DrawTarget,
    geometry::{OriginDimensions, Point, Size},
    mono_font::{MonoFont, MonoTextStyle, iso_8859_1},
    pixelcolor::Rgb888,
    prelude::{Drawable, RgbColor},
    text::{Baseline, Text},
};
use std::convert::Infallible;

/// A picture with words below it.
#[derive(Clone, Debug)]
pub(crate) struct Panel {
    /// First line, in a larger type.
    pub(crate) title: String,
    /// What follows it; broken into lines where the picture ends.
    pub(crate) caption: String,
    pub(crate) picture: Bitmap,
}

/// Pixels as shown: red, green, blue, alpha; rows from top to bottom.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bitmap {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) pixels: Vec<[u8; 4]>,
}

const TITLE: &MonoFont = &iso_8859_1::FONT_9X18_BOLD;
const TEXT: &MonoFont = &iso_8859_1::FONT_8X13;
/// Pixels between panels and around them.
const GAP: usize = 12;
const PAPER: [u8; 4] = [255; 4];
const INK: Rgb888 = Rgb888::BLACK;

/// Lays the panels out in rows of `columns`; a cell is as wide as the widest picture.
pub(crate) fn compose(panels: &[Panel], columns: usize) -> Bitmap {
    let widest = panels.iter().map(|p| p.picture.width).max().unwrap_or(0);
    let columns = columns.clamp(1, panels.len().max(1));
    let rows: Vec<&[Panel]> = panels.chunks(columns).collect();
    let heights: Vec<usize> = rows
        .iter()
        .map(|row| row.iter().map(|p| height(p, widest)).max().unwrap_or(0))
        .collect();
    let mut sheet = Bitmap::blank(
        columns * (widest + GAP) + GAP,
        heights.iter().map(|h| h + GAP).sum::<usize>() + GAP,
    );
    let mut top = GAP;
    for (row, height) in rows.into_iter().zip(heights) {
        for (column, panel) in row.iter().enumerate() {
            draw(
                &mut sheet,
                panel,
                GAP + column * (widest + GAP),
                top,
                widest,
            );
        }
        top += height + GAP;
    }
    sheet
}

/// A picture with the meaning of its colours (0xRRGGBB) below it, in as many rows as they take.
pub(crate) fn with_legend(picture: Bitmap, entries: &[(u32, String)]) -> Bitmap {
    let row = line_height(TEXT);
    let swatch = row - 4;
    let mut places = Vec::new();
    let (mut left, mut rows) = (0, 1);
    for (_, words) in entries {
        let letters = words.chars().count() * TEXT.character_size.width as usize;
        let width = swatch + 4 + letters + GAP;
        if left > 0 && left + width > picture.width + GAP {
            (left, rows) = (0, rows + 1);
        }
        places.push((left, rows - 1));
        left += width;
    }
    let mut whole = Bitmap::blank(picture.width, picture.height + 4 + rows * row);
    whole.paste(&picture, 0, 0);
    for ((color, words), (left, number)) in entries.iter().zip(places) {
        let top = picture.height + 4 + number * row;
        let [_, r, g, b] = color.to_be_bytes();
        for y in top..top + swatch {
            for x in left..(left + swatch).min(whole.width) {
                whole.pixels[y * whole.width + x] = [r, g, b, 255];
            }
        }
        whole.write(words, TEXT, left + swatch + 4, top);
    }
    whole
}

fn height(panel: &Panel, width: usize) -> usize {
    let lines = wrap(&panel.caption, columns_of(TEXT, width)).len();
    panel.picture.height + GAP / 2 + line_height(TITLE) + lines * line_height(TEXT)
}

fn line_height(font: &MonoFont) -> usize {
    font.character_size.height as usize + 3
}

fn columns_of(font: &MonoFont, width: usize) -> usize {
    (width / font.character_size.width as usize).max(1)
}

fn draw(sheet: &mut Bitmap, panel: &Panel, left: usize, top: usize, width: usize) {
    sheet.paste(&panel.picture, left, top);
    let mut y = top + panel.picture.height + GAP / 2;
    let title = wrap(&panel.title, columns_of(TITLE, width));
    sheet.write(title.first().map_or("", String::as_str), TITLE, left, y);
    y += line_height(TITLE);
    for line in wrap(&panel.caption, columns_of(TEXT, width)) {
        sheet.write(&line, TEXT, left, y);
        y += line_height(TEXT);
    }
}

/// Breaks a text between words into lines of at most `columns` characters; longer words are cut.
fn wrap(text: &str, columns: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut free = columns;
    for word in text.split_whitespace() {
        let word: String = word.chars().take(columns).collect();
        let length = word.chars().count();
        let space = usize::from(free < columns);
        if space + length > free {
            lines.push(String::new());
            free = columns;
        }
        if let Some(line) = lines.last_mut() {
            if free < columns {
                line.push(' ');
                free -= 1;
            }
            line.push_str(&word);
            free -= length;
        }
    }
    lines
}

impl Bitmap {
    fn blank(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![PAPER; width * height],
        }
    }

    /// Copies what is not transparent of a picture that fits.
    fn paste(&mut self, picture: &Self, left: usize, top: usize) {
        for (y, row) in picture
            .pixels
            .chunks_exact(picture.width.max(1))
            .enumerate()
        {
            let start = (top + y) * self.width + left;
            let paper = self.pixels[start..start + row.len()].iter_mut();
            for (paper, &pixel) in paper.zip(row).filter(|(_, pixel)| pixel[3] > 0) {
                *paper = pixel;
            }
        }
    }

    /// Writes one line; what is outside of the sheet is cut off.
    fn write(&mut self, line: &str, font: &MonoFont, left: usize, top: usize) {
        let place = Point::new(left as i32, top as i32);
        let style = MonoTextStyle::new(font, INK);
        let Ok(_) = Text::with_baseline(line, place, style, Baseline::Top).draw(self);
    }
}

impl OriginDimensions for Bitmap {
    fn size(&self) -> Size {
        Size::new(self.width as u32, self.height as u32)
    }
}

impl DrawTarget for Bitmap {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        for Pixel(Point { x, y }, color) in pixels {
            let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else {
                continue;
            };
            if x < self.width && y < self.height {
                self.pixels[y * self.width + x] = [color.r(), color.g(), color.b(), 255];
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(width: usize, height: usize, color: u8, caption: &str) -> Panel {
        Panel {
            title: "title".to_owned(),
            caption: caption.to_owned(),
            picture: Bitmap {
                width,
                height,
                pixels: vec![[color, 0, 0, 255]; width * height],
            },
        }
    }

    #[test]
    fn words_are_not_broken_unless_they_must() {
        assert_eq!(wrap("one two three", 7), ["one two", "three"]);
        assert_eq!(wrap("one two three", 3), ["one", "two", "thr"]);
        assert_eq!(wrap("", 5), [""]);
    }

    #[test]
    fn pictures_stand_in_their_cells_and_words_below() {
        let panels = [
            panel(80, 20, 1, "a caption that is longer than its picture"),
            panel(60, 30, 2, ""),
            panel(80, 20, 3, "short"),
        ];
        let sheet = compose(&panels, 2);
        assert_eq!(sheet.width, 2 * 80 + 3 * GAP);
        let at = |x: usize, y: usize| sheet.pixels[y * sheet.width + x];
        assert_eq!(at(GAP, GAP), [1, 0, 0, 255]);
        assert_eq!(at(2 * GAP + 80, GAP), [2, 0, 0, 255]);
        assert_eq!(at(0, 0), PAPER);
        let inked = |top: usize| {
            (top..top + line_height(TITLE))
                .flat_map(|y| (GAP..GAP + 80).map(move |x| (x, y)))
                .any(|(x, y)| at(x, y) == [0, 0, 0, 255])
        };
        assert!(inked(GAP + 20 + GAP / 2), "the title is written");
        assert_eq!(sheet.pixels.iter().filter(|p| p[0] == 3).count(), 80 * 20);
    }

    #[test]
    fn no_panels_make_an_empty_sheet() {
        assert_eq!(compose(&[], 3).pixels.len(), (2 * GAP) * GAP);
    }
}

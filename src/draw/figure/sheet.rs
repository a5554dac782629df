//! A table of images as one SVG: title, labelled columns and rows, legends of the error maps,
//! caption. It is for the eye: the images are JPEGs.

use super::element::{path, rectangle, words};
use super::ink::style;
use super::text::{AXIS, Anchor, Font, LABEL, LINE, MIDDLE, TITLE, escape, px, stack};
use crate::base::pixels::Rgb8Image;
use crate::draw::colormap::ColorScale;
use crate::draw::markdown::significant;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use image::codecs::jpeg::JpegEncoder;

#[derive(Clone, Debug, PartialEq)]
pub enum Tile {
    /// An image with a note below it; a smaller one is magnified to the sheet's tile size.
    Image {
        image: Rgb8Image,
        note: String,
    },
    /// Why there is no image.
    Missing(String),
    Blank,
}

/// The label of a row or column.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    pub label: String,
    /// A wider gap is before it.
    pub starts_group: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct TileRow {
    pub head: Head,
    /// One tile per column.
    pub tiles: Vec<Tile>,
}

/// A sheet with at least one row and one column.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactSheet {
    pub title: String,
    pub caption: String,
    /// Size of every image, pixels.
    pub tile: [u32; 2],
    pub columns: Vec<Head>,
    pub rows: Vec<TileRow>,
    pub legends: Vec<(&'static str, ColorScale)>,
}

const JPEG_QUALITY: u8 = 90;
const MARGIN: f64 = 24.0;
const GAP: f64 = 4.0;
const GROUP_GAP: f64 = 16.0;
/// Between title, grid, legends and caption, and between labels and images.
const BLOCK_GAP: f64 = 14.0;
/// Narrowest page.
const WIDTH_MIN: f64 = 460.0;
/// Groups of rows that would make the table higher, in widths of the page, are left out.
const HEIGHT_MAX: f64 = 2.0;
const ROW_LABEL_MAX: f64 = 170.0;
const LINES_MAX: usize = 6;
/// Size of a colour bar, pixels, and the number of its colours.
const BAR: [f64; 2] = [256.0, 12.0];
const BAR_STEPS: u32 = 64;

/// The gap before a row or column.
fn gap_before(head: &Head) -> f64 {
    if head.starts_group { GROUP_GAP } else { GAP }
}

/// The lines of a label, none wider than `room`.
fn wrapped(head: &Head, room: f64) -> Vec<String> {
    head.label
        .lines()
        .flat_map(|line| AXIS.wrap(line, room, LINES_MAX))
        .collect()
}

impl ContactSheet {
    pub fn svg(&self) -> String {
        let row_labels: Vec<Vec<String>> = self
            .rows
            .iter()
            .map(|row| wrapped(&row.head, ROW_LABEL_MAX))
            .collect();
        let lefts = self.column_lefts(&row_labels);
        let right = lefts[lefts.len() - 1] + f64::from(self.tile[0]);
        let width = (right + MARGIN).max(WIDTH_MIN);
        let mut page = Page {
            body: String::new(),
            y: MARGIN,
        };
        page.paragraph(&self.title, TITLE, width);
        self.draw_column_heads(&mut page, &lefts);
        let shown_count = self.draw_rows(&mut page, &row_labels, &lefts, width);
        for (label, scale) in &self.legends {
            page.legend(label, scale, lefts[0]);
        }
        page.y += BLOCK_GAP;
        let row_count = self.rows.len();
        let left_out = if shown_count < row_count {
            format!(" These are the first {shown_count} of {row_count} rows.")
        } else {
            String::new()
        };
        page.paragraph(&format!("{}{left_out}", self.caption), AXIS, width);
        let height = px((page.y + MARGIN).ceil());
        let width = px(width.ceil());
        let title = escape(&self.title);
        let style = style();
        let body = page.body;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"fig\" width=\"{width}\" \
             height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
             <title>{title}</title>\n<style>{style}image{{image-rendering:pixelated}}</style>\n\
             <rect class=\"fig-ground\" width=\"{width}\" height=\"{height}\"/>\n{body}</svg>\n"
        )
    }

    /// Left edges of the columns, behind the labels of rows.
    fn column_lefts(&self, row_labels: &[Vec<String>]) -> Vec<f64> {
        let mut lefts = vec![MARGIN + AXIS.widest(row_labels.iter().flatten()) + BLOCK_GAP];
        for (i, head) in self.columns.iter().enumerate().skip(1) {
            lefts.push(lefts[i - 1] + f64::from(self.tile[0]) + gap_before(head));
        }
        lefts
    }

    /// Draws the labels of columns, which end on one line.
    fn draw_column_heads(&self, page: &mut Page, lefts: &[f64]) {
        let tile_width = f64::from(self.tile[0]);
        let labels: Vec<Vec<String>> = self
            .columns
            .iter()
            .map(|head| wrapped(head, tile_width))
            .collect();
        let line_count = labels.iter().map(Vec::len).max().unwrap_or(0);
        page.y += BLOCK_GAP + line_count as f64 * AXIS.line();
        for (label, left) in labels.iter().zip(lefts) {
            let top = page.y - label.len() as f64 * AXIS.line();
            page.lines(label, [left + tile_width / 2.0, top], AXIS, Anchor::Middle);
        }
    }

    /// Draws whole groups of rows, at least one, down to [`HEIGHT_MAX`]. Returns the number of
    /// rows.
    fn draw_rows(
        &self,
        page: &mut Page,
        labels: &[Vec<String>],
        lefts: &[f64],
        width: f64,
    ) -> usize {
        let tile_height = f64::from(self.tile[1]);
        let start = page.y;
        let mut shown_count = 0;
        while shown_count < self.rows.len() {
            let group_end = (shown_count + 1..self.rows.len())
                .find(|&row| self.rows[row].head.starts_group)
                .unwrap_or(self.rows.len());
            let group_height = (group_end - shown_count) as f64 * tile_height;
            if shown_count > 0 && page.y - start + group_height > HEIGHT_MAX * width {
                break;
            }
            let group = shown_count..group_end;
            for (row, label) in self.rows[group.clone()].iter().zip(&labels[group]) {
                self.draw_row(page, row, label, lefts);
            }
            shown_count = group_end;
        }
        shown_count
    }

    fn draw_row(&self, page: &mut Page, row: &TileRow, label: &[String], lefts: &[f64]) {
        let tile_height = f64::from(self.tile[1]);
        page.y += gap_before(&row.head);
        let label_top = page.y + (tile_height - label.len() as f64 * AXIS.line()) / 2.0;
        page.lines(
            label,
            [lefts[0] - BLOCK_GAP / 2.0, label_top],
            AXIS,
            Anchor::End,
        );
        for (tile, left) in row.tiles.iter().zip(lefts) {
            page.tile(tile, [*left, page.y], self.tile);
        }
        let has_note = |tile: &Tile| matches!(tile, Tile::Image { note, .. } if !note.is_empty());
        page.y += tile_height;
        if row.tiles.iter().any(has_note) {
            page.y += LABEL.line();
        }
    }
}

/// A page that is drawn from top to bottom, down to `y`.
struct Page {
    body: String,
    y: f64,
}

impl Page {
    fn lines(&mut self, lines: &[String], [x, top]: [f64; 2], font: Font, anchor: Anchor) {
        let baseline = top + font.size * (LINE / 2.0 + MIDDLE);
        self.body
            .extend(stack(lines, "", [x, baseline], font, anchor).map(|line| words(&line)));
    }

    fn paragraph(&mut self, text: &str, font: Font, width: f64) {
        let lines = font.wrap(text, width - 2.0 * MARGIN, usize::MAX);
        self.lines(&lines, [MARGIN, self.y], font, Anchor::Start);
        self.y += lines.len() as f64 * font.line();
    }

    fn tile(&mut self, tile: &Tile, [x, y]: [f64; 2], size: [u32; 2]) {
        let [width, height] = size.map(f64::from);
        let middle = x + width / 2.0;
        match tile {
            Tile::Blank => {}
            Tile::Image { image, note } => {
                let data = BASE64_STANDARD.encode(jpeg(image));
                let [x, top] = [x, y].map(px);
                self.body += &format!(
                    "<image x=\"{x}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" \
                     href=\"data:image/jpeg;base64,{data}\"/>\n"
                );
                self.lines(
                    std::slice::from_ref(note),
                    [middle, y + height],
                    LABEL,
                    Anchor::Middle,
                );
            }
            Tile::Missing(reason) => {
                self.body += &path("fig-grid", "", &rectangle([x, y, width, height]));
                let lines = LABEL.wrap(reason, width - 2.0 * GAP, LINES_MAX);
                let top = y + (height - lines.len() as f64 * LABEL.line()) / 2.0;
                self.lines(&lines, [middle, top], LABEL, Anchor::Middle);
            }
        }
    }

    /// Label, colour bar and ticks with their values.
    fn legend(&mut self, label: &str, scale: &ColorScale, left: f64) {
        self.y += BLOCK_GAP;
        self.lines(&[label.to_owned()], [left, self.y], LABEL, Anchor::Start);
        self.y += LABEL.line();
        let [width, height] = BAR;
        let step_width = width / f64::from(BAR_STEPS);
        for step in 0..BAR_STEPS {
            let [r, g, b] = scale
                .palette
                .color(f64::from(step) / f64::from(BAR_STEPS - 1));
            let x = left + f64::from(step) * width / f64::from(BAR_STEPS);
            // Half a pixel wider, or seams would show.
            let data = rectangle([x, self.y, step_width + 0.5, height]);
            self.body += &path("", &format!(" fill=\"rgb({r},{g},{b})\""), &data);
        }
        for tick in scale.ticks() {
            let x = left + scale.share(tick) * width;
            let label = tick_label(tick);
            self.lines(&[label], [x, self.y + height], LABEL, Anchor::Middle);
        }
        self.y += height + LABEL.line();
    }
}

/// A tick of a colour bar: two digits, without zeros behind the decimal point.
fn tick_label(tick: f64) -> String {
    let label = significant(tick, 2).replace('-', "\u{2212}");
    if label.contains('.') {
        label.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        label
    }
}

fn jpeg(image: &Rgb8Image) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY);
    let encoded = encoder.encode(
        image.data.as_flattened(),
        image.width,
        image.height,
        image::ExtendedColorType::Rgb8,
    );
    encoded.expect("a picture in memory can be encoded");
    bytes
}

//! Draws a table of images: title, labelled columns and rows, legends of the error maps, caption.

use crate::pixels::Rgb8Image;
use crate::table::colormap::ColorScale;
use crate::table::markdown::significant;
use crate::table::text::{self, Anchor, Style};
use rayon::prelude::*;

#[derive(Clone, Debug, PartialEq)]
pub enum Tile {
    /// An image of the sheet's tile size, with a note below it.
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

/// A sheet with at least one row.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactSheet {
    pub title: String,
    pub caption: String,
    /// Size of every image, pixels.
    pub tile: [u32; 2],
    pub columns: Vec<Head>,
    /// One tile per column.
    pub rows: Vec<(Head, Vec<Tile>)>,
    pub legends: Vec<(&'static str, ColorScale)>,
}

const PAGE_COLOR: [u8; 3] = [255; 3];
const INK: [u8; 3] = [26; 3];
const FAINT_INK: [u8; 3] = [84; 3];
const EMPTY_TILE_COLOR: [u8; 3] = [244; 3];
const FRAME_COLOR: [u8; 3] = [188; 3];

const MARGIN: u32 = 24;
const GAP: u32 = 4;
const GROUP_GAP: u32 = 16;
/// Between labels and images.
const LABEL_GAP: u32 = 10;
/// Between title, grid, legends and caption.
const BLOCK_GAP: u32 = 18;
/// Narrowest page between the margins.
const CONTENT_MIN: u32 = 420;
/// Largest published page, pixels.
pub const PUBLISHED_SIZE: [u32; 2] = [1200, 2400];
const ROW_LABEL_MAX: f32 = 170.0;
const LABEL_LINES: usize = 4;
const REASON_LINES: usize = 6;
const BAR: [u32; 2] = [280, 14];
const TICK_LENGTH: u32 = 4;

const TITLE: Style = Style { size: 20.0, color: INK, is_bold: true };
const LABEL: Style = Style { size: 14.0, color: INK, is_bold: false };
const NOTE: Style = Style { size: 13.0, color: FAINT_INK, is_bold: false };
const CAPTION: Style = Style { size: 14.0, color: INK, is_bold: false };

/// The labels of the columns, the rows each with the gap before it, and the legends; all have the page's width.
struct Grid {
    width: u32,
    header: Rgb8Image,
    rows: Vec<(u32, Rgb8Image)>,
    legends: Vec<Rgb8Image>,
}

impl ContactSheet {
    /// Draws the page. Groups of rows that would make it taller than a published one are left out; the caption counts them.
    pub fn page(&self) -> Rgb8Image {
        let Grid { width, header, rows, legends } = self.grid();
        let height_max = width.max(PUBLISHED_SIZE[0]) * PUBLISHED_SIZE[1] / PUBLISHED_SIZE[0];
        let height = |rows: &[(u32, Rgb8Image)]| rows.iter().map(|(gap, row)| gap + row.height).sum::<u32>();
        let count = rows.len();
        let mut ends = (1..=count).filter(|end| *end == count || self.rows[*end].0.starts_group);
        let shown = ends.rfind(|end| height(&rows[..*end]) <= height_max).unwrap_or(1);
        let left_out = format!(" These are the first {shown} of {count} rows.");
        let caption = format!("{}{}", self.caption, if shown < count { &left_out } else { "" });
        let mut page = vec![(MARGIN, paragraph(&self.title, TITLE, width)), (BLOCK_GAP, header)];
        page.extend(
            rows.into_iter().take(shown).enumerate().map(|(i, (gap, row))| (if i == 0 { 0 } else { gap }, row)),
        );
        page.extend(legends.into_iter().map(|legend| (BLOCK_GAP, legend)));
        page.extend([(BLOCK_GAP, paragraph(&caption, CAPTION, width)), (MARGIN, empty(width, 0))]);
        let mut data = Vec::with_capacity((width * height(&page)) as usize);
        for (gap, block) in &page {
            data.resize(data.len() + (gap * width) as usize, PAGE_COLOR);
            data.extend_from_slice(&block.data);
        }
        Rgb8Image::new(width, height(&page), data)
    }

    fn grid(&self) -> Grid {
        let [tile_width, tile_height] = self.tile;
        let wrap = |head: &Head, width: f32, lines: usize| text::wrap_hard(&head.label, LABEL, width, lines);
        // Each swept axis has a line.
        let lines = ((tile_height as f32 / LABEL.line_height()) as usize).max(LABEL_LINES);
        let row_labels: Vec<Vec<String>> = self.rows.iter().map(|(head, _)| wrap(head, ROW_LABEL_MAX, lines)).collect();
        let labels: Vec<Vec<String>> =
            self.columns.iter().map(|head| wrap(head, (tile_width + GAP) as f32, LABEL_LINES)).collect();
        let label_width = row_labels.iter().flatten().map(|line| text::width(line, LABEL)).fold(0.0, f32::max);
        let gap = |head: &Head| if head.starts_group { GROUP_GAP } else { GAP };
        let mut lefts = vec![MARGIN + if label_width > 0.0 { label_width.ceil() as u32 + LABEL_GAP } else { 0 }];
        for (i, head) in self.columns.iter().enumerate().skip(1) {
            lefts.push(lefts[i - 1] + tile_width + gap(head));
        }
        let grid_right = lefts[lefts.len() - 1] + tile_width;
        let legend_label = |(label, _): &(&str, _)| text::width(label, LABEL).ceil() as u32 + LABEL_GAP;
        let legend_label = self.legends.iter().map(legend_label).max().unwrap_or(0);
        let legend_width = legend_label + BAR[0] + LABEL_GAP;
        let width = grid_right.max(MARGIN + CONTENT_MIN.max(legend_width)) + MARGIN;

        let lines_most = labels.iter().map(Vec::len).max().unwrap_or(0) as f32;
        let mut header = empty(width, (lines_most * LABEL.line_height()) as u32 + LABEL_GAP);
        for (lines, left) in labels.iter().zip(&lefts) {
            let top = (lines_most - lines.len() as f32) * LABEL.line_height();
            draw_lines(&mut header, lines, Anchor::Center, *left as f32 + 0.5 * tile_width as f32, top, LABEL);
        }
        let row = |((head, tiles), lines): (&(Head, Vec<Tile>), &Vec<String>)| {
            let has_note = |tile: &Tile| matches!(tile, Tile::Image { note, .. } if !note.is_empty());
            let note = if tiles.iter().any(has_note) { NOTE.line_height() as u32 + GAP } else { 0 };
            let mut row = empty(width, tile_height + note);
            let top = 0.5 * (tile_height as f32 - lines.len() as f32 * LABEL.line_height());
            draw_lines(&mut row, lines, Anchor::Right, (lefts[0] - LABEL_GAP) as f32, top, LABEL);
            tiles.iter().zip(&lefts).for_each(|(tile, left)| draw_tile(&mut row, tile, *left, self.tile));
            (gap(head), row)
        };
        // Legends are centred below the grid, within the margins.
        let left = ((lefts[0] + grid_right) / 2).saturating_sub(legend_width / 2);
        let bar_left = left.min(width - MARGIN - legend_width).max(MARGIN) + legend_label;
        let legends = self.legends.iter().map(|(label, scale)| legend(label, scale, bar_left, width)).collect();
        let rows = self.rows.par_iter().zip(&row_labels).map(row).collect();
        Grid { width, header, rows, legends }
    }
}

fn empty(width: u32, height: u32) -> Rgb8Image {
    Rgb8Image::filled(width, height, PAGE_COLOR)
}

/// Lines between the margins.
fn paragraph(words: &str, style: Style, width: u32) -> Rgb8Image {
    let lines = text::wrap_hard(words, style, (width - 2 * MARGIN) as f32, usize::MAX);
    let mut block = empty(width, (lines.len() as f32 * style.line_height()) as u32);
    draw_lines(&mut block, &lines, Anchor::Left, MARGIN as f32, 0.0, style);
    block
}

fn draw_tile(row: &mut Rgb8Image, tile: &Tile, left: u32, [width, height]: [u32; 2]) {
    let middle = left as f32 + 0.5 * width as f32;
    match tile {
        Tile::Blank => {}
        Tile::Image { image, note } => {
            for (y, pixels) in image.data.chunks_exact(width as usize).enumerate() {
                let start = y * row.width as usize + left as usize;
                row.data[start..start + width as usize].copy_from_slice(pixels);
            }
            let lines = text::wrap_hard(note, NOTE, width as f32, 1);
            draw_lines(row, &lines, Anchor::Center, middle, height as f32 + 1.0, NOTE);
        }
        Tile::Missing(reason) => {
            fill(row, [left, 0], [width, height], FRAME_COLOR);
            fill(row, [left + 1, 1], [width.saturating_sub(2), height.saturating_sub(2)], EMPTY_TILE_COLOR);
            let lines = text::wrap_hard(reason, NOTE, width as f32 - 2.0 * GAP as f32, REASON_LINES);
            let top = 0.5 * (height as f32 - lines.len() as f32 * NOTE.line_height());
            draw_lines(row, &lines, Anchor::Center, middle, top, NOTE);
        }
    }
}

/// Label, colour bar and ticks with their values; the bar begins at `left`.
fn legend(label: &str, scale: &ColorScale, left: u32, page_width: u32) -> Rgb8Image {
    let [width, height] = BAR;
    let mut block = empty(page_width, height + TICK_LENGTH + NOTE.line_height() as u32);
    let baseline = LABEL.baseline_at(0.5 * height as f32);
    text::draw(&mut block, label, Anchor::Right, (left - LABEL_GAP) as f32, baseline, LABEL);
    for x in 0..width {
        fill(&mut block, [left + x, 0], [1, height], scale.palette.color(f64::from(x) / f64::from(width - 1)));
    }
    for tick in scale.ticks() {
        let x = left + (scale.place(tick) * f64::from(width - 1)).round() as u32;
        fill(&mut block, [x, height], [1, TICK_LENGTH], INK);
        let value = significant(tick, 2).replace('-', "−");
        let value = if value.contains('.') { value.trim_end_matches('0').trim_end_matches('.') } else { &value };
        draw_lines(&mut block, &[value.to_owned()], Anchor::Center, x as f32, (height + TICK_LENGTH) as f32, NOTE);
    }
    block
}

fn draw_lines(block: &mut Rgb8Image, lines: &[String], anchor: Anchor, x: f32, top: f32, style: Style) {
    for (i, line) in lines.iter().enumerate() {
        let centre = top + (i as f32 + 0.5) * style.line_height();
        text::draw(block, line, anchor, x, style.baseline_at(centre), style);
    }
}

fn fill(block: &mut Rgb8Image, corner: [u32; 2], size: [u32; 2], color: [u8; 3]) {
    for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
        block.data[((corner[1] + y) * block.width + corner[0] + x) as usize] = color;
    }
}

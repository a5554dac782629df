//! A table of images as one picture: labelled columns and rows, a title, a caption and the legends of its error maps.
//!
//! White page, thin gaps, dark text of 15 pixels. All tiles have one size; a case without an image shows why.

use super::colormap::ColorScale;
use super::markdown::significant;
use super::text::{self, Anchor, Style};
use crate::pixels::Rgb8Image;

/// One place of a sheet.
#[derive(Clone, Debug, PartialEq)]
pub enum Tile {
    Image {
        image: Rgb8Image,
        /// A few words or numbers below the image; empty for none.
        note: String,
    },
    /// No image, and why.
    Missing(String),
    /// No image is meant to be here.
    Blank,
}

/// The colours of error maps in words and numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    pub label: String,
    pub scale: ColorScale,
}

/// What a sheet shows.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactSheet {
    pub title: String,
    /// Below the images; long ones are wrapped. Empty for none.
    pub caption: String,
    pub column_labels: Vec<String>,
    /// To the left of the rows; a line break starts a new line.
    pub row_labels: Vec<String>,
    /// Rows of tiles, one tile a column.
    pub rows: Vec<Vec<Tile>>,
    /// Columns that begin a group: a wider gap stands before them. 0 has no effect.
    pub column_group_starts: Vec<usize>,
    /// The same for rows.
    pub row_group_starts: Vec<usize>,
    /// Each image pixel becomes a square of this side, ≥ 1.
    pub scale: u32,
    pub legends: Vec<Legend>,
}

/// Why a sheet cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ContactSheetError {
    #[error("a sheet needs at least one row and one column")]
    Empty,
    #[error("the sheet {title:?} has {found} {what}, expected {expected}")]
    Count { title: String, what: &'static str, found: usize, expected: usize },
    #[error(
        "the image in row {row}, column {column} of the sheet {title:?} is {}x{}, the first one {}x{}",
        found[0], found[1], expected[0], expected[1]
    )]
    Size { title: String, row: usize, column: usize, found: [u32; 2], expected: [u32; 2] },
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
/// Side of a tile when no image gives it.
const EMPTY_SIDE: u32 = 96;
/// Narrowest page between the margins: a title must have room.
const CONTENT_MIN: u32 = 420;
const ROW_LABEL_MAX: f32 = 170.0;
const LABEL_LINES: usize = 4;
const REASON_LINES: usize = 6;
const LEGEND_BAR: [u32; 2] = [280, 14];
/// Width of a bar with the half of its last tick's value that stands out.
const LEGEND_BAR_ROOM: u32 = LEGEND_BAR[0] + LABEL_GAP;
const TICK_LENGTH: u32 = 4;
const TICK_DIGITS: usize = 2;

const TITLE: Style = Style { size: 20.0, color: INK, is_bold: true };
const LABEL: Style = Style { size: 15.0, color: INK, is_bold: false };
const NOTE: Style = Style { size: 13.0, color: FAINT_INK, is_bold: false };
const CAPTION: Style = Style { size: 14.0, color: INK, is_bold: false };
/// Sizes that labels are shrunk through, all labels of a kind together.
const LABEL_SIZES: [f32; 3] = [15.0, 14.0, 13.0];
const NOTE_SIZES: [f32; 1] = [13.0];

impl ContactSheet {
    /// The sheet in pages that are at most `height_max` pixels tall where a row and its labels allow it; each has the column labels, the
    /// legends and the caption. Rows of a group stay together where a page has room for them all.
    pub fn pages(self, height_max: u32) -> Result<Vec<Self>, ContactSheetError> {
        let layout = Layout::new(&self)?;
        if layout.page[1] <= height_max {
            return Ok(vec![self]);
        }
        let room = height_max.saturating_sub(layout.page[1] - (layout.grid_bottom - layout.row_tops[0]));
        let count = self.rows.len();
        let bottom = |row: usize| if row + 1 < count { layout.row_tops[row + 1] - GAP } else { layout.grid_bottom };
        let fits = |from: usize, to: usize| bottom(to - 1) - layout.row_tops[from] <= room;
        let mut groups: Vec<usize> = self.row_group_starts.iter().copied().filter(|start| *start > 0).collect();
        groups.push(count);
        let mut starts = vec![0];
        let mut from = 0;
        while from < count {
            // As many groups as fit; of a group that is too tall, as many rows.
            let whole = groups.iter().copied().filter(|end| *end > from && fits(from, *end)).max();
            let to = whole
                .unwrap_or_else(|| (from + 1..=count).take_while(|end| fits(from, *end)).last().unwrap_or(from + 1));
            starts.push(to);
            from = to;
        }
        let page_count = starts.len() - 1;
        let ranges: Vec<(usize, usize)> = starts.windows(2).map(|pair| (pair[0], pair[1])).collect();
        let mut rows = self.rows.into_iter();
        let page = |(page, (from, to)): (usize, (usize, usize))| Self {
            title: format!("{} (page {} of {page_count})", self.title, page + 1),
            caption: self.caption.clone(),
            column_labels: self.column_labels.clone(),
            row_labels: self.row_labels[from..to].to_vec(),
            rows: rows.by_ref().take(to - from).collect(),
            column_group_starts: self.column_group_starts.clone(),
            row_group_starts: self.row_group_starts.iter().filter_map(|start| start.checked_sub(from)).collect(),
            scale: self.scale,
            legends: self.legends.clone(),
        };
        Ok(ranges.into_iter().enumerate().map(page).collect())
    }

    /// Width and height of the picture, pixels.
    pub fn size(&self) -> Result<[u32; 2], ContactSheetError> {
        Ok(Layout::new(self)?.page)
    }

    /// The picture.
    pub fn render(&self) -> Result<Rgb8Image, ContactSheetError> {
        let layout = Layout::new(self)?;
        let [width, height] = layout.page;
        let mut page = Rgb8Image::filled(width, height, PAGE_COLOR);
        self.draw_labels(&mut page, &layout);
        for (row, tiles) in self.rows.iter().enumerate() {
            for (column, tile) in tiles.iter().enumerate() {
                let corner = [layout.column_lefts[column], layout.row_tops[row]];
                draw_tile(&mut page, tile, &layout, corner, self.scale);
            }
        }
        let mut top = layout.grid_bottom + BLOCK_GAP;
        for legend in &self.legends {
            draw_legend(&mut page, legend, layout.legend_bar_left(), top);
            top += legend_height() + GROUP_GAP;
        }
        draw_lines(&mut page, &layout.caption, Anchor::Left, MARGIN as f32, layout.caption_top as f32, CAPTION);
        Ok(page)
    }

    fn draw_labels(&self, page: &mut Rgb8Image, layout: &Layout) {
        draw_lines(page, &layout.title, Anchor::Left, MARGIN as f32, MARGIN as f32, TITLE);
        let [tile_width, tile_height] = layout.tile;
        let (style, labels) = &layout.column_labels;
        for (lines, left) in labels.iter().zip(&layout.column_lefts) {
            // Lower edges line up, next to the images.
            let top = layout.row_tops[0] as f32 - LABEL_GAP as f32 - lines.len() as f32 * style.line_height();
            draw_lines(page, lines, Anchor::Center, *left as f32 + 0.5 * tile_width as f32, top, *style);
        }
        let (style, labels) = &layout.row_labels;
        let right = (layout.column_lefts[0] - LABEL_GAP) as f32;
        for (lines, top) in labels.iter().zip(&layout.row_tops) {
            let height = lines.len() as f32 * style.line_height();
            let first = *top as f32 + 0.5 * (tile_height as f32 - height);
            draw_lines(page, lines, Anchor::Right, right, first, *style);
        }
    }
}

/// Labels broken into lines, in one style.
type Labels = (Style, Vec<Vec<String>>);

/// Places of everything, in pixels from the upper left corner.
struct Layout {
    page: [u32; 2],
    title: Vec<String>,
    column_labels: Labels,
    row_labels: Labels,
    tile: [u32; 2],
    note: Style,
    column_lefts: Vec<u32>,
    row_tops: Vec<u32>,
    grid_right: u32,
    grid_bottom: u32,
    legend_label_width: u32,
    caption: Vec<String>,
    caption_top: u32,
}

impl Layout {
    fn new(sheet: &ContactSheet) -> Result<Self, ContactSheetError> {
        let tile = tile_size(sheet)?.map(|side| side * sheet.scale);
        let column_labels =
            text::fit(&sheet.column_labels, LABEL, &LABEL_SIZES, tile[0] as f32 + GAP as f32, LABEL_LINES);
        // Each swept axis has a line: as many as stand beside a tile.
        let row_lines = ((tile[1] as f32 / LABEL.line_height()) as usize).max(LABEL_LINES);
        let row_labels = text::fit(&sheet.row_labels, LABEL, &LABEL_SIZES, ROW_LABEL_MAX, row_lines);
        let label_width = row_labels.1.iter().flatten().map(|line| text::width(line, row_labels.0)).fold(0.0, f32::max);
        let (note, note_heights) = note_style(sheet, tile[0]);

        let gaps = |count: usize, group_starts: &[usize]| -> Vec<u32> {
            (1..count).map(|i| if group_starts.contains(&i) { GROUP_GAP } else { GAP }).collect()
        };
        let label_space = if label_width > 0.0 { label_width.ceil() as u32 + LABEL_GAP } else { 0 };
        let mut column_lefts = vec![MARGIN + label_space];
        for (i, gap) in gaps(sheet.column_labels.len(), &sheet.column_group_starts).into_iter().enumerate() {
            column_lefts.push(column_lefts[i] + tile[0] + gap);
        }
        let grid_right = column_lefts[column_lefts.len() - 1] + tile[0];
        let legend_label = |legend: &Legend| text::width(&legend.label, LABEL).ceil() as u32 + LABEL_GAP;
        let legend_label_width = sheet.legends.iter().map(legend_label).max().unwrap_or(0);
        let legend_right = MARGIN + legend_label_width + LEGEND_BAR_ROOM;
        let content_right = grid_right.max(MARGIN + CONTENT_MIN).max(legend_right);

        let content_width = (content_right - MARGIN) as f32;
        let title = text::wrap_hard(&sheet.title, TITLE, content_width, usize::MAX);
        let caption = text::wrap_hard(&sheet.caption, CAPTION, content_width, usize::MAX);
        let lines_height = |lines: usize, style: Style| (lines as f32 * style.line_height()) as u32;
        let label_lines = column_labels.1.iter().map(Vec::len).max().unwrap_or(0);
        let title_bottom = MARGIN + lines_height(title.len(), TITLE);
        let title_gap = if title.is_empty() { 0 } else { BLOCK_GAP };
        let mut row_tops = vec![title_bottom + title_gap + lines_height(label_lines, column_labels.0) + LABEL_GAP];
        for (i, gap) in gaps(sheet.rows.len(), &sheet.row_group_starts).into_iter().enumerate() {
            row_tops.push(row_tops[i] + tile[1] + note_heights[i] + gap);
        }
        let last = sheet.rows.len() - 1;
        let grid_bottom = row_tops[last] + tile[1] + note_heights[last];
        let legend_count = sheet.legends.len() as u32;
        let legends_bottom = match legend_count {
            0 => grid_bottom,
            _ => grid_bottom + BLOCK_GAP + legend_count * legend_height() + (legend_count - 1) * GROUP_GAP,
        };
        let caption_top = if caption.is_empty() { legends_bottom } else { legends_bottom + BLOCK_GAP };
        let page = [content_right + MARGIN, caption_top + lines_height(caption.len(), CAPTION) + MARGIN];
        Ok(Self {
            page,
            title,
            column_labels,
            row_labels,
            tile,
            note,
            column_lefts,
            row_tops,
            grid_right,
            grid_bottom,
            legend_label_width,
            caption,
            caption_top,
        })
    }

    /// Left edge of all colour bars: legends are centred below the grid, as far as the margins allow.
    fn legend_bar_left(&self) -> u32 {
        let middle = (self.column_lefts[0] + self.grid_right) / 2;
        let width = self.legend_label_width + LEGEND_BAR_ROOM;
        let left = middle.saturating_sub(width / 2).min(self.page[0] - MARGIN - width).max(MARGIN);
        left + self.legend_label_width
    }
}

/// Checks counts and sizes; the size of every image before scaling.
fn tile_size(sheet: &ContactSheet) -> Result<[u32; 2], ContactSheetError> {
    let columns = sheet.column_labels.len();
    if columns == 0 || sheet.rows.is_empty() {
        return Err(ContactSheetError::Empty);
    }
    let count = |what, found, expected| {
        let title = sheet.title.clone();
        if found == expected { Ok(()) } else { Err(ContactSheetError::Count { title, what, found, expected }) }
    };
    count("row labels", sheet.row_labels.len(), sheet.rows.len())?;
    assert!(sheet.scale >= 1, "a contact sheet cannot be scaled by 0");
    let mut size = None;
    for (row, tiles) in sheet.rows.iter().enumerate() {
        count("tiles in a row", tiles.len(), columns)?;
        for (column, tile) in tiles.iter().enumerate() {
            let Tile::Image { image, .. } = tile else { continue };
            let found = [image.width, image.height];
            let expected = *size.get_or_insert(found);
            if found != expected {
                return Err(ContactSheetError::Size { title: sheet.title.clone(), row, column, found, expected });
            }
        }
    }
    Ok(size.unwrap_or([EMPTY_SIDE; 2]))
}

/// Style of the notes, and the height that each row needs for them.
fn note_style(sheet: &ContactSheet, tile_width: u32) -> (Style, Vec<u32>) {
    let note = |tile: &Tile| match tile {
        Tile::Image { note, .. } if !note.is_empty() => Some(note.clone()),
        _ => None,
    };
    let notes: Vec<String> = sheet.rows.iter().flatten().filter_map(note).collect();
    let (style, _) = text::fit(&notes, NOTE, &NOTE_SIZES, tile_width as f32, 1);
    let height = style.line_height() as u32 + GAP;
    let has_note = |tiles: &Vec<Tile>| tiles.iter().any(|tile| note(tile).is_some());
    (style, sheet.rows.iter().map(|tiles| if has_note(tiles) { height } else { 0 }).collect())
}

fn draw_tile(page: &mut Rgb8Image, tile: &Tile, layout: &Layout, corner: [u32; 2], scale: u32) {
    let [left, top] = corner;
    let [width, height] = layout.tile;
    let middle = left as f32 + 0.5 * width as f32;
    match tile {
        Tile::Blank => {}
        Tile::Image { image, note } => {
            draw_enlarged(page, image, corner, scale as usize);
            for line in text::wrap_hard(note, layout.note, width as f32, 1) {
                let centre = (top + height) as f32 + 0.5 * layout.note.line_height() + 1.0;
                text::draw(page, &line, Anchor::Center, middle, layout.note.baseline_at(centre), layout.note);
            }
        }
        Tile::Missing(reason) => {
            fill(page, [left, top], [width, height], FRAME_COLOR);
            fill(page, [left + 1, top + 1], [width.saturating_sub(2), height.saturating_sub(2)], EMPTY_TILE_COLOR);
            let room = width as f32 - 2.0 * GAP as f32;
            let (style, reasons) = text::fit(std::slice::from_ref(reason), NOTE, &NOTE_SIZES, room, REASON_LINES);
            for lines in reasons {
                let first = top as f32 + 0.5 * (height as f32 - lines.len() as f32 * style.line_height());
                draw_lines(page, &lines, Anchor::Center, middle, first, style);
            }
        }
    }
}

/// Each pixel as a square of `scale` pixels.
fn draw_enlarged(page: &mut Rgb8Image, image: &Rgb8Image, [left, top]: [u32; 2], scale: usize) {
    let (stride, width) = (page.width as usize, image.width as usize * scale);
    for (y, row) in image.data.chunks_exact(image.width as usize).enumerate() {
        let start = (top as usize + y * scale) * stride + left as usize;
        let drawn = start..start + width;
        row.iter().zip(page.data[drawn.clone()].chunks_exact_mut(scale)).for_each(|(pixel, run)| run.fill(*pixel));
        (1..scale).for_each(|copy| page.data.copy_within(drawn.clone(), start + copy * stride));
    }
}

fn legend_height() -> u32 {
    LEGEND_BAR[1] + TICK_LENGTH + NOTE.line_height() as u32
}

/// Label, colour bar and ticks with their values; the bar begins at `bar_left`.
fn draw_legend(page: &mut Rgb8Image, legend: &Legend, bar_left: u32, top: u32) {
    let [width, height] = LEGEND_BAR;
    let label_baseline = LABEL.baseline_at(top as f32 + 0.5 * height as f32);
    text::draw(page, &legend.label, Anchor::Right, (bar_left - LABEL_GAP) as f32, label_baseline, LABEL);
    for x in 0..width {
        let color = legend.scale.palette.color(f64::from(x) / f64::from(width - 1));
        fill(page, [bar_left + x, top], [1, height], color);
    }
    for tick in legend.scale.ticks() {
        let x = bar_left + (legend.scale.place(tick) * f64::from(width - 1)).round() as u32;
        fill(page, [x, top + height], [1, TICK_LENGTH], INK);
        let centre = (top + height + TICK_LENGTH) as f32 + 0.5 * NOTE.line_height();
        let value = tick_text(tick);
        text::draw(page, &value, Anchor::Center, x as f32, NOTE.baseline_at(centre), NOTE);
    }
}

/// A number as figures print it: no trailing zeros, a true minus sign.
fn tick_text(value: f64) -> String {
    let text = significant(value, TICK_DIGITS).replace('-', "−");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

fn draw_lines(page: &mut Rgb8Image, lines: &[String], anchor: Anchor, x: f32, top: f32, style: Style) {
    for (i, line) in lines.iter().enumerate() {
        let centre = top + (i as f32 + 0.5) * style.line_height();
        text::draw(page, line, anchor, x, style.baseline_at(centre), style);
    }
}

fn fill(page: &mut Rgb8Image, corner: [u32; 2], size: [u32; 2], color: [u8; 3]) {
    for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
        set(page, corner[0] + x, corner[1] + y, color);
    }
}

fn set(page: &mut Rgb8Image, x: u32, y: u32, color: [u8; 3]) {
    page.data[y as usize * page.width as usize + x as usize] = color;
}

//! Contact sheets as pictures.

use splitsum::pixels::Rgb8Image;
use splitsum::run::sheets::draw::{ContactSheet, Head, PUBLISHED_SIZE, Tile};
use splitsum::table::colormap::RELATIVE_ERROR;

fn head(label: &str, starts_group: bool) -> Head {
    Head { label: label.to_owned(), starts_group }
}

fn flat(color: [u8; 3], note: &str) -> Tile {
    Tile::Image { image: Rgb8Image::filled(90, 60, color), note: note.to_owned() }
}

fn tile_color(row: u8, column: u8) -> [u8; 3] {
    [10 + 40 * row, 200, 20 + 60 * column]
}

/// A sheet of 3 columns and 2 rows; the tile at (row, column) has its own flat colour, and the last tile is missing.
fn sheet() -> ContactSheet {
    let tile = |row: u8, column: u8| flat(tile_color(row, column), "relMSE 0.0123");
    ContactSheet {
        title: "A title".into(),
        caption: "A caption that is long enough to be broken over two lines at the width of this small sheet.".into(),
        tile: [90, 60],
        columns: vec![
            head("reference", false),
            head("sampled-unfiltered with a name that is far too long", true),
            head("split-sum", false),
        ],
        rows: vec![
            (head("α = 0.1", true), vec![tile(0, 0), tile(0, 1), tile(0, 2)]),
            (head("relative\nerror", false), vec![tile(1, 0), tile(1, 1), Tile::Missing("device lost".into())]),
        ],
        legends: vec![("relative error", RELATIVE_ERROR)],
    }
}

/// Left, top, right, bottom (past the end) and pixel count of a colour.
fn extent(page: &Rgb8Image, is_wanted: impl Fn([u8; 3]) -> bool) -> ([u32; 4], usize) {
    let mut extent = [u32::MAX, u32::MAX, 0, 0];
    let mut count = 0;
    for (x, y) in (0..page.height).flat_map(|y| (0..page.width).map(move |x| (x, y))) {
        if is_wanted(page.get(x, y)) {
            extent = [extent[0].min(x), extent[1].min(y), extent[2].max(x + 1), extent[3].max(y + 1)];
            count += 1;
        }
    }
    (extent, count)
}

#[test]
fn tiles_form_a_grid_and_nothing_covers_them() {
    let page = sheet().page();
    let place = |row, column| {
        let (extent, count) = extent(&page, |color| color == tile_color(row, column));
        assert_eq!(count, 90 * 60, "row {row}, column {column} is partly covered");
        assert_eq!([extent[2] - extent[0], extent[3] - extent[1]], [90, 60]);
        [extent[0], extent[1]]
    };
    let [a, b, c] = [0, 1, 2].map(|column| place(0, column));
    let [d, e] = [0, 1].map(|column| place(1, column));
    assert_eq!((a[1] == b[1] && b[1] == c[1], d[1] == e[1], a[0] == d[0], b[0] == e[0]), (true, true, true, true));
    assert!(d[1] > a[1] + 60, "rows must not overlap");
    let [group_gap, gap] = [b[0] - a[0] - 90, c[0] - b[0] - 90];
    assert!(group_gap > gap && gap > 0, "gaps {group_gap} and {gap}");
    let (ink, _) = extent(&page, |color| color != [255; 3]);
    let margins = [ink[0], ink[1], page.width - ink[2], page.height - ink[3]];
    assert!(margins.iter().all(|margin| *margin >= 20), "{margins:?}");
}

#[test]
fn a_tall_sheet_leaves_out_groups_of_rows() {
    let row = |i: u8| (head(&format!("row {i}"), i.is_multiple_of(7)), vec![flat([i, 7, 9], ""); 3]);
    let page = ContactSheet { rows: (0..60).map(row).collect(), ..sheet() }.page();
    assert!(page.height > PUBLISHED_SIZE[1] / 2 && page.height < PUBLISHED_SIZE[1] + 500, "{}", page.height);
    let shown: Vec<u8> = (0..60).filter(|i| page.data.contains(&[*i, 7, 9])).collect();
    // The first rows, in whole groups of seven.
    assert!(shown.len() > 7 && shown.len() < 60 && shown.len().is_multiple_of(7), "{shown:?}");
    assert_eq!(shown, (0..shown.len() as u8).collect::<Vec<u8>>());
}

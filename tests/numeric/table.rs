//! Tables on disk, in Markdown and as pictures.

use splitsum::pixels::{GrayImage, Rgb8Image};
use splitsum::table::colormap::{
    ColorScale, FLIP_ERROR, NAN_COLOR, OFF_MASK_COLOR, Palette, RELATIVE_ERROR, Range, SIGNED_ERROR,
};
use splitsum::table::contact_sheet::{ContactSheet, ContactSheetError, Legend, Tile};
use splitsum::table::csv::{Cell, Table, TableError, TableWriter, guarded, to_text, unguarded};
use splitsum::table::markdown::{Align, MarkdownTable, inline, link, paragraph, significant};
use std::io::Write;

const COLUMNS: [&str; 3] = ["method", "rmse", "samples"];

/// Rows with everything that CSV must protect.
fn rows() -> Vec<[Cell; 3]> {
    vec![
        ["split-sum".into(), 0.1.into(), Cell::Integer(0)],
        ["a,b \"quoted\"\nsecond line".into(), (1.0 / 3.0).into(), Cell::Integer(u64::MAX)],
        ["=1+1".into(), f64::INFINITY.into(), Cell::Integer(4)],
        ["".into(), Cell::Missing, Cell::Missing],
        ["ünïcödé α".into(), (-1.5e-300).into(), Cell::Integer(16)],
    ]
}

#[test]
fn csv_bytes_are_exact() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("errors.csv");
    let mut writer = TableWriter::create(&path, &COLUMNS).unwrap();
    for (i, row) in rows().iter().enumerate() {
        writer.append(row).unwrap();
        // Each row is in the file while the writer lives.
        assert_eq!(Table::read(&path).unwrap().rows.len(), i + 1);
    }
    let expected = "method,rmse,samples\nsplit-sum,0.1,0\n\"a,b \"\"quoted\"\"\nsecond line\",0.3333333333333333,\
                    18446744073709551615\n'=1+1,inf,4\n,,\nünïcödé α,-1.5e-300,16\n";
    assert_eq!(std::fs::read_to_string(&path).unwrap(), expected);
    let table = Table::read(&path).unwrap();
    assert_eq!(table.columns, COLUMNS);
    assert_eq!(table.rows[1][0], "a,b \"quoted\"\nsecond line");
    let numbers = [Some(0.1), Some(1.0 / 3.0), Some(f64::INFINITY), None, Some(-1.5e-300)];
    assert_eq!(table.numbers("rmse").unwrap(), numbers);
}

#[test]
fn no_text_is_a_formula_and_all_of_it_comes_back() {
    let formulas =
        ["=1+1", "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\t=1", "\r=1", "'=1", "''-x", "-", "=", "-1 = x"];
    let plain = ["-1.5", "+2", "-inf", "1=2", "a-b", "'tis", "''", "", "builtin:sky", "\u{2212}1"];
    for text in formulas.into_iter().chain(plain) {
        let field = guarded(text);
        assert_eq!(unguarded(&field), text);
        assert_eq!(
            formulas.contains(&text),
            field.starts_with('\'') && field.len() > text.len(),
            "{text:?} as {field:?}"
        );
        // What a spreadsheet sees is neither a formula nor what was written before it was guarded.
        assert!(!field.starts_with(['=', '+', '-', '@', '\t', '\r']) || field.parse::<f64>().is_ok(), "{field:?}");
    }
    let bytes = to_text(&["a".to_owned()], formulas.map(|text| [Cell::from(text)]).iter().map(|row| &row[..]));
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), bytes).unwrap();
    let read = Table::read(&folder.path().join("t.csv")).unwrap().rows;
    assert_eq!(read.concat(), formulas);
}

#[test]
fn csv_numbers_read_back_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("numbers.csv");
    let mut writer = TableWriter::create(&path, &["x"]).unwrap();
    let mut numbers = vec![f64::MIN_POSITIVE, 5e-324, f64::MAX, 1e16, 9.999e15, 1e-5, 9.9e-6, 0.1 + 0.2, -0.0, 1e23];
    numbers.extend((1u64..200).map(|i| f64::from_bits(i.wrapping_mul(0x9e37_79b9_7f4a_7c15) & !(1 << 62))));
    for number in &numbers {
        writer.append(&[Cell::Number(*number)]).unwrap();
    }
    let read = Table::read(&path).unwrap().numbers("x").unwrap();
    assert_eq!(read.len(), numbers.len());
    for (read, number) in read.into_iter().zip(numbers) {
        assert_eq!(read.unwrap().to_bits(), number.to_bits());
    }
    let longest = std::fs::read_to_string(&path).unwrap().lines().map(str::len).max().unwrap();
    assert!(longest <= 24, "a number of {longest} characters");
}

#[test]
fn a_table_that_was_cut_anywhere_resumes_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("errors.csv");
    let mut writer = TableWriter::create(&path, &COLUMNS).unwrap();
    rows().iter().for_each(|row| writer.append(row).unwrap());
    let whole = std::fs::read(&path).unwrap();
    for cut in 0..=whole.len() {
        std::fs::write(&path, &whole[..cut]).unwrap();
        let (mut writer, table) = TableWriter::resume(&path, &COLUMNS).unwrap();
        assert!(table.rows.iter().all(|row| row.len() == COLUMNS.len()));
        rows()[table.rows.len()..].iter().for_each(|row| writer.append(row).unwrap());
        assert_eq!(std::fs::read(&path).unwrap(), whole, "cut after {cut} bytes");
    }
    std::fs::remove_file(&path).unwrap();
    assert!(TableWriter::resume(&path, &COLUMNS).unwrap().1.rows.is_empty());
}

#[test]
fn table_errors_name_file_and_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("errors.csv");
    let mut writer = TableWriter::create(&path, &COLUMNS).unwrap();
    rows().iter().for_each(|row| writer.append(row).unwrap());
    // Torn, and of another plan: not ours to repair.
    std::fs::OpenOptions::new().append(true).open(&path).unwrap().write_all(b"torn").unwrap();
    let before = std::fs::read(&path).unwrap();
    let error = TableWriter::resume(&path, &["method", "mae"]).unwrap_err();
    assert!(matches!(error, TableError::Columns { .. }) && error.to_string().contains("errors.csv"));
    assert_eq!(std::fs::read(&path).unwrap(), before, "a table of another plan must stay as it was");
    let (_, table) = TableWriter::resume(&path, &COLUMNS).unwrap();
    let message = table.numbers("method").unwrap_err().to_string();
    assert!(message.contains("row 1, column method: \"split-sum\" is not a number"), "{message}");
    assert!(table.column("rms").unwrap_err().to_string().contains("no column \"rms\""));
    std::fs::write(&path, "a,b\n1,2\n3\n").unwrap();
    let message = Table::read(&path).unwrap_err().to_string();
    assert!(message.contains("line: 3"), "{message}");
    let missing = TableWriter::create(&folder.path().join("no/such/folder.csv"), &COLUMNS).unwrap_err().to_string();
    assert!(missing.contains("no/such/folder.csv"), "{missing}");
}

#[test]
fn markdown_is_aligned_and_escaped() {
    let mut table = MarkdownTable::new(&[("method", Align::Left), ("N", Align::Right), ("a|b", Align::Right)]);
    table.row(&["split-sum", "", "0.0123"]);
    table.row(&["α\nβ", "16", "1"]);
    let expected = "\
| method    |   N |   a\\|b |
|-----------|----:|-------:|
| split-sum |     | 0.0123 |
| α β       |  16 |      1 |
";
    assert_eq!(table.to_string(), expected);
}

#[test]
fn hostile_names_stay_text_in_markdown() {
    for (text, expected) in [
        ("sky < 4 and [0, 1] (of `ggx`)", "sky < 4 and [0, 1] (of `ggx`)"),
        ("<script>x</script>", "\\<script>x\\</script>"),
        ("\\<img onerror=x>", "\\\\\\<img onerror=x>"),
        // What the program itself wrote as Markdown.
        ("reference 64 \\*", "reference 64 \\*"),
        ("[a](javascript:x)", "[a\\](javascript:x)"),
        ("a\n# b\u{1b}[31m\u{202e}c", "a # b\\u{1b}[31m\\u{202e}c"),
    ] {
        assert_eq!(inline(text), expected);
    }
    for (text, expected) in [
        ("# head", "\\# head"),
        ("  - item", "\\- item"),
        ("12. item", "12\\. item"),
        ("`a` b", "`a` b"),
        ("```a", "\\```a"),
    ] {
        assert_eq!(paragraph(text), expected);
    }
    assert_eq!(link("a]<b>[\n", "tables/a (b)\n[c.png"), "[a\\]\\<b>\\[\\\\n](tables/a%20%28b%29%0A%5Bc.png)");
    let mut table = MarkdownTable::new(&[("name", Align::Left)]);
    table.row(&["<b>[x](y)"]);
    assert!(table.to_string().contains("| \\<b>[x\\](y) |"), "{table}");
}

#[test]
fn numbers_for_reading() {
    for (number, digits, expected) in [
        (0.012345, 3, "0.0123"),
        (1.5, 3, "1.50"),
        (0.9996, 3, "1.00"),
        (-12.345, 3, "-12.3"),
        (123456.7, 3, "123457"),
        (1234567.0, 3, "1.23e6"),
        (0.00012, 2, "0.00012"),
        (0.000012, 2, "1.2e-5"),
        (0.00009999, 2, "0.00010"),
        (7.0, 0, "7"),
        (0.0, 3, "0"),
        (-0.0, 3, "0"),
        (f64::INFINITY, 3, "inf"),
        (f64::NEG_INFINITY, 3, "-inf"),
        (f64::NAN, 3, "NaN"),
    ] {
        assert_eq!(significant(number, digits), expected);
    }
}

/// Relative luminance of an sRGB colour.
fn luminance(color: [u8; 3]) -> f64 {
    let linear = color.map(|code| {
        let c = f64::from(code) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    });
    0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
}

#[test]
fn palettes_are_the_published_ones() {
    // matplotlib's magma at 0, 128/255 and 1: (0.001462, 0.000466, 0.013866), (0.716387, 0.214982, 0.475290),
    // (0.987053, 0.991438, 0.749504), which d3's table of 8-bit codes, ours, holds to
    // one code.
    let magma = |t| Palette::Magma.color(t);
    assert_eq!([magma(0.0), magma(128.0 / 255.0), magma(1.0)], [[0, 0, 4], [182, 54, 121], [252, 253, 191]]);
    let blue_red = |t| Palette::BlueRed.color(t);
    assert_eq!([blue_red(0.0), blue_red(0.5), blue_red(1.0)], [[5, 48, 97], [247, 247, 247], [103, 0, 31]]);
    assert_eq!(blue_red(0.05), [19, 75, 135]);
    for palette in [Palette::Magma, Palette::BlueRed] {
        assert_eq!([palette.color(-3.0), palette.color(7.0)], [palette.color(0.0), palette.color(1.0)]);
        assert_eq!(palette.color(f64::NAN), NAN_COLOR);
    }
    // Order by lightness, so that a grey print still reads; one code of rounding is allowed.
    let rises = |colors: Vec<f64>| colors.windows(2).all(|pair| pair[1] > pair[0] - 1e-3);
    assert!(rises((0..=100).map(|i| luminance(magma(f64::from(i) / 100.0))).collect()));
    assert!(rises((0..=50).map(|i| luminance(blue_red(f64::from(i) / 100.0))).collect()));
    assert!(rises((0..=50).map(|i| luminance(blue_red(1.0 - f64::from(i) / 100.0))).collect()));
}

#[test]
fn ranges_are_fixed() {
    assert!((RELATIVE_ERROR.place(10f64.powf(-1.5)) - 0.5).abs() < 1e-12);
    assert_eq!([RELATIVE_ERROR.place(0.0), RELATIVE_ERROR.place(-1.0)], [0.0, 0.0]);
    assert_eq!([RELATIVE_ERROR.color(0.0), RELATIVE_ERROR.color(50.0)], [[0, 0, 4], [252, 253, 191]]);
    assert_eq!(RELATIVE_ERROR.color(f64::NAN), NAN_COLOR);
    assert_eq!(RELATIVE_ERROR.ticks(), [1e-3, 1e-2, 1e-1, 1.0]);
    assert_eq!(SIGNED_ERROR.color(0.0), [247; 3]);
    assert_eq!(SIGNED_ERROR.ticks(), [-0.5, -0.25, 0.0, 0.25, 0.5]);
    assert_eq!((FLIP_ERROR.place(0.25), FLIP_ERROR.ticks().len()), (0.25, 5));
    let narrow = ColorScale { palette: Palette::Magma, range: Range::Log { lo: 2e-3, hi: 0.5 } };
    assert_eq!(narrow.ticks(), [1e-2, 1e-1]);
    let map = GrayImage::new(3, 1, vec![0.0, 1.0, 1.0]);
    let mask = GrayImage::new(3, 1, vec![1.0, 1.0, 0.0]);
    let [first, last] = [0.0, 1.0].map(|t| Palette::Magma.color(t));
    assert_eq!(RELATIVE_ERROR.image(&map, &mask).data, [first, last, OFF_MASK_COLOR]);
}

/// A sheet of 3 columns and 2 rows; the tile at (row, column) is flat in a colour of its own, but the last is missing.
fn sheet() -> ContactSheet {
    let tile = |row: u8, column: u8| match (row, column) {
        (1, 2) => Tile::Missing("device lost".into()),
        _ => Tile::Image { image: Rgb8Image::filled(30, 20, tile_color(row, column)), note: "relMSE 0.0123".into() },
    };
    ContactSheet {
        title: "A title".into(),
        caption: "A caption that is long enough to be broken over two lines at the width of this small sheet.".into(),
        column_labels: ["reference", "sampled-unfiltered with a name that is far too long", "split-sum"]
            .map(String::from)
            .into(),
        row_labels: vec!["α = 0.1".into(), "relative\nerror".into()],
        rows: (0..2).map(|row| (0..3).map(|column| tile(row, column)).collect()).collect(),
        column_group_starts: vec![1],
        row_group_starts: vec![],
        scale: 3,
        legends: vec![Legend { label: "relative error".into(), scale: RELATIVE_ERROR }],
    }
}

fn tile_color(row: u8, column: u8) -> [u8; 3] {
    [10 + 40 * row, 200, 20 + 60 * column]
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
fn tiles_stand_in_a_grid_and_nothing_covers_them() {
    let page = sheet().render().unwrap();
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
fn every_text_and_the_legend_are_drawn() {
    let full = sheet().render().unwrap();
    let ink = |page: &Rgb8Image| extent(page, |color| color != [255; 3]).1;
    let cuts: [fn(&mut ContactSheet); 6] = [
        |sheet| sheet.title.clear(),
        |sheet| sheet.caption.clear(),
        |sheet| sheet.column_labels[0].clear(),
        |sheet| sheet.row_labels[1].clear(),
        |sheet| sheet.legends.clear(),
        |sheet| sheet.rows[0][0] = Tile::Image { image: Rgb8Image::filled(30, 20, [1; 3]), note: String::new() },
    ];
    for (i, cut) in cuts.iter().enumerate() {
        let mut less = sheet();
        cut(&mut less);
        let lost = ink(&full) - ink(&less.render().unwrap());
        assert!(lost > 40, "text {i} has {lost} pixels of ink");
    }
    let reason = |text: &str| {
        let mut sheet = sheet();
        sheet.rows[1][2] = Tile::Missing(text.into());
        extent(&sheet.render().unwrap(), |color| color[0] == color[1] && color[1] == color[2] && color[0] < 160).1
    };
    assert!(reason("device lost") > reason("") + 40, "the reason of a missing image must be readable");
    for t in [0.0, 1.0] {
        let (bar_end, _) = extent(&full, |color| color == Palette::Magma.color(t));
        assert!(bar_end[3] > bar_end[1], "an end of the colour bar is missing");
    }
}

/// `1e-2` broken after `1e-` would read as two numbers.
#[test]
fn a_line_break_never_parts_a_number() {
    let page = |reason: String| {
        let labels = vec![String::new()];
        let (column_labels, row_labels) = (labels.clone(), labels);
        ContactSheet { scale: 1, column_labels, row_labels, rows: vec![vec![Tile::Missing(reason)]], ..sheet() }
            .render()
            .unwrap()
    };
    // Narrow letters: one of these lengths leaves room for all but the last digit.
    for length in 1..40 {
        let filler = "i".repeat(length);
        let broken = page(format!("{filler} 1e-\n2"));
        assert!(page(format!("{filler} 1e-2")).data != broken.data, "{length} letters before the number");
    }
}

#[test]
fn sheets_that_cannot_be_drawn_say_why() {
    let refused = |change: fn(&mut ContactSheet)| {
        let mut sheet = sheet();
        change(&mut sheet);
        sheet.render().expect_err("a broken sheet must be refused")
    };
    assert_eq!(refused(|sheet| sheet.rows.clear()), ContactSheetError::Empty);
    let message = refused(|sheet| drop(sheet.rows[1].pop())).to_string();
    assert_eq!(message, "the sheet \"A title\" has 2 tiles in a row, expected 3");
    let message = refused(|sheet| drop(sheet.row_labels.pop())).to_string();
    assert_eq!(message, "the sheet \"A title\" has 1 row labels, expected 2");
    let message = refused(|sheet| {
        sheet.rows[1][0] = Tile::Image { image: Rgb8Image::filled(30, 21, [0; 3]), note: String::new() }
    });
    assert!(message.to_string().contains("row 1, column 0") && message.to_string().contains("30x21"), "{message}");
}

#[test]
fn a_sheet_without_images_or_labels_is_drawn() {
    let mut bare = sheet();
    bare.title.clear();
    bare.caption.clear();
    bare.legends.clear();
    bare.column_labels = vec![String::new()];
    bare.row_labels = vec![String::new()];
    bare.rows = vec![vec![Tile::Missing(String::new())]];
    let page = bare.render().unwrap();
    assert!(page.width > 0 && page.height > 0);
    bare.rows = vec![vec![Tile::Image { image: Rgb8Image::filled(1, 1, [9; 3]), note: "long note".into() }]];
    bare.scale = 1;
    assert_eq!(extent(&bare.render().unwrap(), |color| color == [9; 3]).1, 1);
}

#[test]
fn a_tall_sheet_makes_pages_that_lose_no_row() {
    let rows: Vec<u8> = (0..20).collect();
    let tile = |i: u8| Tile::Image { image: Rgb8Image::filled(30, 20, [i; 3]), note: String::new() };
    let tall = ContactSheet {
        row_labels: rows.iter().map(|i| format!("row {i}")).collect(),
        rows: rows.iter().map(|i| vec![tile(*i), tile(100 + *i), tile(200)]).collect(),
        // Groups of three rows; the last has two.
        row_group_starts: rows.iter().map(|i| usize::from(*i)).filter(|i| i % 3 == 0).collect(),
        ..sheet()
    };
    let whole = tall.render().unwrap().height;
    let pages = tall.clone().pages(600).unwrap();
    assert!(whole > 600 && pages.len() > 1, "{whole}");
    for page in &pages {
        let height = page.render().unwrap().height;
        assert!(height <= 600, "{height}");
        assert_eq!(
            (&page.column_labels, &page.legends, &page.caption),
            (&tall.column_labels, &tall.legends, &tall.caption)
        );
    }
    assert!(pages[..pages.len() - 1].iter().all(|page| page.rows.len() % 3 == 0), "groups stay together");
    assert_eq!(pages.iter().flat_map(|page| page.rows.clone()).collect::<Vec<_>>(), tall.rows);
    assert_eq!(pages.iter().flat_map(|page| page.row_labels.clone()).collect::<Vec<_>>(), tall.row_labels);
    assert!(pages[1].title.ends_with(&format!("(page 2 of {})", pages.len())), "{}", pages[1].title);
    // A group that no page holds is split, and a page that holds no row has one all the same.
    let one_group = ContactSheet { row_group_starts: vec![0], ..tall.clone() };
    assert!(one_group.pages(600).unwrap().iter().all(|page| page.render().unwrap().height <= 600));
    assert_eq!(tall.clone().pages(1).unwrap().len(), 20);
    assert_eq!(tall.clone().pages(whole).unwrap(), [tall]);
}

#[test]
fn a_row_label_has_as_many_lines_as_its_tile_is_tall() {
    let tall = |label: &str| {
        let tile = Tile::Image { image: Rgb8Image::filled(30, 40, [9; 3]), note: String::new() };
        let rows = vec![vec![tile.clone(), tile.clone(), tile]];
        ContactSheet { scale: 4, row_labels: vec![label.to_owned()], rows, row_group_starts: vec![], ..sheet() }
            .render()
    };
    // 160 pixels are room for six lines.
    assert_ne!(tall("a 1\nb 2\nc 3\nd 4\ne 5\nf 6"), tall("a 1\nb 2\nc 3\nd 4\ne 5\nf 7"));
}

//! Tables on disk and in Markdown, and the colours of error maps.

use crate::snapshot::assert_snapshot;
use splitsum::base::color;
use splitsum::base::csv::{Cell, Table, to_text};
use splitsum::base::pixels::GrayImage;
use splitsum::draw::colormap::{
    ColorScale, FLIP_ERROR, NAN_COLOR, OFF_MASK_COLOR, Palette, RELATIVE_ERROR, Range, SIGNED_ERROR,
};
use splitsum::draw::markdown::{Align, MarkdownTable, inline, link, paragraph, significant};

/// The numbers of a column; an empty cell is `None`.
pub fn numbers(table: &Table, name: &str) -> Vec<Option<f64>> {
    let column = table.column(name).unwrap();
    table
        .rows
        .iter()
        .map(|row| (!row[column].is_empty()).then(|| row[column].parse().unwrap()))
        .collect()
}

const COLUMNS: [&str; 3] = ["method", "rmse", "samples"];

/// Rows with everything that CSV must protect.
fn rows() -> Vec<[Cell; 3]> {
    vec![
        ["split-sum".into(), 0.1.into(), Cell::Integer(0)],
        [
            "a,b \"quoted\"\nsecond line".into(),
            (1.0 / 3.0).into(),
            Cell::Integer(u64::MAX),
        ],
        ["=1+1".into(), f64::INFINITY.into(), Cell::Integer(4)],
        ["".into(), Cell::Missing, Cell::Missing],
        ["ünïcödé α".into(), (-1.5e-300).into(), Cell::Integer(16)],
    ]
}

#[test]
fn csv_bytes_are_exact() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("errors.csv");
    let text = to_text(
        &COLUMNS.map(str::to_owned),
        rows().iter().map(|row| &row[..]),
    );
    let expected = "method,rmse,samples\nsplit-sum,0.1,0\n\"a,b \"\"quoted\"\"\nsecond \
                    line\",0.3333333333333333,\
                    18446744073709551615\n=1+1,inf,4\n,,\nünïcödé α,-1.5e-300,16\n";
    assert_eq!(String::from_utf8(text.clone()).unwrap(), expected);
    std::fs::write(&path, &text).unwrap();
    let table = Table::read(&path).unwrap();
    assert_eq!(table.columns, COLUMNS);
    assert_eq!(table.rows[1][0], "a,b \"quoted\"\nsecond line");
    let numbers = [
        Some(0.1),
        Some(1.0 / 3.0),
        Some(f64::INFINITY),
        None,
        Some(-1.5e-300),
    ];
    assert_eq!(self::numbers(&table, "rmse"), numbers);
    // A file truncated anywhere is refused, or its remaining rows are complete.
    for cut in 0..text.len() {
        std::fs::write(&path, &text[..cut]).unwrap();
        let is_whole = Table::read(&path).is_ok_and(|cut| table.rows.starts_with(&cut.rows));
        assert!(
            is_whole || Table::read(&path).is_err(),
            "cut after {cut} bytes"
        );
    }
}

#[test]
fn csv_numbers_read_back_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("numbers.csv");
    let mut numbers = vec![
        f64::MIN_POSITIVE,
        5e-324,
        f64::MAX,
        1e16,
        9.999e15,
        1e-5,
        9.9e-6,
        0.1 + 0.2,
        -0.0,
        1e23,
    ];
    numbers.extend(
        (1u64..200).map(|i| f64::from_bits(i.wrapping_mul(0x9e37_79b9_7f4a_7c15) & !(1 << 62))),
    );
    let rows: Vec<[Cell; 1]> = numbers
        .iter()
        .map(|number| [Cell::Number(*number)])
        .collect();
    std::fs::write(
        &path,
        to_text(&["x".to_owned()], rows.iter().map(|row| &row[..])),
    )
    .unwrap();
    let read = self::numbers(&Table::read(&path).unwrap(), "x");
    assert_eq!(read.len(), numbers.len());
    for (read, number) in read.into_iter().zip(numbers) {
        assert_eq!(read.unwrap().to_bits(), number.to_bits());
    }
    let longest = std::fs::read_to_string(&path)
        .unwrap()
        .lines()
        .map(str::len)
        .max()
        .unwrap();
    assert!(longest <= 24, "a number of {longest} characters");
}

#[test]
fn table_errors_name_file_and_place() {
    let folder = tempfile::tempdir().unwrap();
    let read = |text: &str| {
        std::fs::write(folder.path().join("t.csv"), text).unwrap();
        Table::read(&folder.path().join("t.csv"))
    };
    let table = read("method,rmse\nsplit-sum,1\n").unwrap();
    let faults = [
        table.column("rms").unwrap_err(),
        read("a,b\n1,2\n3\n").unwrap_err(),
        read("a,b\n1,2\n3,").unwrap_err(),
        read("a,b\n1,\"2\n").unwrap_err(),
        Table::read(&folder.path().join("none.csv")).unwrap_err(),
    ];
    let faults = faults.map(|fault| {
        fault
            .to_string()
            .replace(&format!("{}/", folder.path().display()), "")
    });
    assert_snapshot("tables_that_are_refused", &faults.join("\n"));
}

#[test]
fn hostile_names_stay_text_in_markdown() {
    for (text, expected) in [
        (
            "sky < 4 and [0, 1] (of `ggx`)",
            "sky < 4 and [0, 1] (of `ggx`)",
        ),
        ("<script>x</script>", "\\<script>x\\</script>"),
        ("\\<img onerror=x>", "\\\\\\<img onerror=x>"),
        // Markdown written by the program itself.
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
        ("**a** b", "**a** b"),
        ("```a", "\\```a"),
    ] {
        assert_eq!(paragraph(text), expected);
    }
    assert_eq!(
        link("a]<b>[\n", "tables/a (b)\n[c.png"),
        "[a\\]\\<b>\\[\\\\n](tables/a%20%28b%29%0A%5Bc.png)"
    );
    let mut table = MarkdownTable::new(&[("name", Align::Left)]);
    table.row(&["<b>[x](y)|z"]);
    assert!(
        table.to_string().contains("| \\<b>[x\\](y)\\|z |"),
        "{table}"
    );
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
        (0.000012, 2, "1.2e-5"),
        (0.00009999, 2, "0.00010"),
        (-0.0, 3, "0"),
        (f64::INFINITY, 3, "inf"),
        (f64::NEG_INFINITY, 3, "-inf"),
        (f64::NAN, 3, "NaN"),
    ] {
        assert_eq!(significant(number, digits), expected);
    }
}

/// Relative luminance of an sRGB colour.
pub fn luminance(code: [u8; 3]) -> f64 {
    color::luminance(code.map(|code| color::srgb_decode(f32::from(code) / 255.0)))
}

#[test]
fn palettes_match_the_published_ones() {
    // matplotlib's magma at 0, 128/255 and 1: (0.001462, 0.000466, 0.013866), (0.716387, 0.214982,
    // 0.475290), (0.987053, 0.991438, 0.749504), which d3's table of 8-bit codes, ours, holds to
    // one code.
    let magma = |t| Palette::Magma.color(t);
    assert_eq!(
        [magma(0.0), magma(128.0 / 255.0), magma(1.0)],
        [[0, 0, 4], [182, 54, 121], [252, 253, 191]]
    );
    let blue_red = |t| Palette::BlueRed.color(t);
    assert_eq!(
        [blue_red(0.0), blue_red(0.5), blue_red(1.0)],
        [[5, 48, 97], [247, 247, 247], [103, 0, 31]]
    );
    assert_eq!(blue_red(0.05), [19, 75, 135]);
    for palette in [Palette::Magma, Palette::BlueRed] {
        assert_eq!(
            [palette.color(-3.0), palette.color(7.0)],
            [palette.color(0.0), palette.color(1.0)]
        );
        assert_eq!(palette.color(f64::NAN), NAN_COLOR);
    }
    // Order by lightness, so that a grey print still reads; one code of rounding is allowed.
    let rises = |colors: Vec<f64>| colors.windows(2).all(|pair| pair[1] > pair[0] - 1e-3);
    assert!(rises(
        (0..=100)
            .map(|i| luminance(magma(f64::from(i) / 100.0)))
            .collect()
    ));
    assert!(rises(
        (0..=50)
            .map(|i| luminance(blue_red(f64::from(i) / 100.0)))
            .collect()
    ));
    assert!(rises(
        (0..=50)
            .map(|i| luminance(blue_red(1.0 - f64::from(i) / 100.0)))
            .collect()
    ));
}

#[test]
fn ranges_are_fixed() {
    assert!((RELATIVE_ERROR.share(10f64.powf(-1.5)) - 0.5).abs() < 1e-12);
    assert_eq!(
        [RELATIVE_ERROR.share(0.0), RELATIVE_ERROR.share(-1.0)],
        [0.0, 0.0]
    );
    assert_eq!(RELATIVE_ERROR.ticks(), [1e-3, 1e-2, 1e-1, 1.0]);
    assert_eq!(SIGNED_ERROR.color(0.0), [247; 3]);
    assert_eq!(SIGNED_ERROR.ticks(), [-0.5, -0.25, 0.0, 0.25, 0.5]);
    assert_eq!(
        (FLIP_ERROR.share(0.25), FLIP_ERROR.ticks().len()),
        (0.25, 5)
    );
    let narrow = ColorScale {
        palette: Palette::Magma,
        range: Range::Log { lo: 2e-3, hi: 0.5 },
    };
    assert_eq!(narrow.ticks(), [1e-2, 1e-1]);
    let map = GrayImage::new(3, 1, vec![0.0, 1.0, 1.0]);
    let mask = GrayImage::new(3, 1, vec![1.0, 1.0, 0.0]);
    let [first, last] = [0.0, 1.0].map(|t| Palette::Magma.color(t));
    assert_eq!(
        RELATIVE_ERROR.image(&map, &mask).data,
        [first, last, OFF_MASK_COLOR]
    );
}

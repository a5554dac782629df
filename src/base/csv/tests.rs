use super::{Cell, Table, to_text};

/// The numbers of a column; an empty cell is `None`.
fn column(table: &Table, name: &str) -> Vec<Option<f64>> {
    let column = table.column(name).unwrap();
    let cells = table.rows.iter().map(|row| row[column].as_str());
    cells
        .map(|cell| (!cell.is_empty()).then(|| cell.parse().unwrap()))
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
    assert_eq!(column(&table, "rmse"), numbers);
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
    let read = column(&Table::read(&path).unwrap(), "x");
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
    assert_eq!(
        faults,
        [
            "t.csv: \"rms\" is not a column; did you mean \"rmse\"?",
            "t.csv: line 3: the row has 1 cells; expected 2, as the header",
            "t.csv: ends within a row; it is probably truncated",
            "t.csv: ends within a row; it is probably truncated",
            "none.csv: No such file or directory (os error 2)",
        ]
    );
}

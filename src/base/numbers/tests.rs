use super::significant;

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

use super::{Exact, ReferenceStop, StopReason};
use crate::instrument::shade::reference_pass::Convergence;

#[test]
fn a_reference_stops_where_its_least_certain_term_does() {
    let term = |sample_count, relative_error, is_met| Convergence {
        term: "shade-specular",
        sample_count,
        relative_error,
        is_met,
    };
    let stop = |terms: &[Convergence], wanted| {
        let stop = ReferenceStop::from_terms(terms, wanted).unwrap();
        (stop.samples, stop.relative_error, stop.stopped_by)
    };
    let fast = term(16, 2e-3, true);
    let slow = term(64, 5e-3, false);
    // The fewest samples, the largest error.
    assert_eq!(
        stop(&[fast, slow], Some(3e-3)),
        (16, Exact(5e-3), StopReason::Samples)
    );
    assert_eq!(
        stop(&[slow, fast], None),
        (16, Exact(5e-3), StopReason::Samples)
    );
    assert_eq!(
        stop(&[fast], Some(3e-3)),
        (16, Exact(2e-3), StopReason::RelativeError)
    );
    assert_eq!(ReferenceStop::from_terms(&[], Some(3e-3)), None);
}

#[test]
fn exact_numbers_read_back_bit_for_bit() {
    for number in [0.1 + 0.2, 5e-324, -0.0, f64::INFINITY, f64::MAX] {
        let text = serde_json::to_string(&Exact(number)).unwrap();
        let read: Exact = serde_json::from_str(&text).unwrap();
        assert_eq!(read.0.to_bits(), number.to_bits(), "{text}");
    }
}

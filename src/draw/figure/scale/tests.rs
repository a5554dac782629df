use super::{Axis, ScaleKind, Tick, ticks};

/// The labels of ticks with room for `most`.
fn labels(kind: &ScaleKind, data: &[f64], most: usize) -> Vec<String> {
    let ticks = ticks(kind, data, |ticks: &[Tick]| ticks.len() <= most);
    ticks.into_iter().map(|tick| tick.label).collect()
}

fn log(lo: f64, hi: f64) -> ScaleKind {
    ScaleKind::Log { lo, hi }
}

fn linear(lo: f64, hi: f64) -> ScaleKind {
    ScaleKind::Linear { lo, hi }
}

#[test]
fn ticks_are_the_densest_round_numbers_that_have_room() {
    let data = &[0.1];
    assert_eq!(
        labels(&log(0.01, 1.0), data, 9),
        ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1"]
    );
    assert_eq!(
        labels(&log(0.01, 1.0), data, 5),
        ["0.01", "0.03", "0.1", "0.3", "1"]
    );
    assert_eq!(labels(&log(0.01, 1.0), data, 3), ["0.01", "0.1", "1"]);
    assert_eq!(
        labels(&linear(-0.5, 0.5), data, 9),
        ["\u{2212}0.4", "\u{2212}0.2", "0.0", "0.2", "0.4"]
    );
    // Beyond plain numbers all labels are powers of ten.
    assert_eq!(
        labels(&log(1e-6, 1e-2), data, 5),
        ["10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²"]
    );
}

#[test]
fn ticks_of_counts_are_the_counts() {
    let tried = [1.0, 4.0, 16.0, 64.0];
    assert_eq!(labels(&log(0.9, 70.0), &tried, 9), ["1", "4", "16", "64"]);
    assert_eq!(labels(&log(0.9, 300.0), &tried, 3), ["1", "16", "256"]);
    // Between two counts a tick would mean nothing.
    assert_eq!(labels(&linear(0.9, 3.1), &[1.0, 3.0], 9), ["1", "2", "3"]);
}

#[test]
fn an_axis_maps_its_domain_to_pixels() {
    let axis = Axis::new(&linear(-1.0, 3.0), 100.0, 200.0);
    assert_eq!(
        [-1.0, 0.0, 3.0].map(|x| axis.pixel(x)),
        [100.0, 125.0, 200.0]
    );
    assert_eq!([-2.0, 1.0, 4.0].map(|x| axis.outside(x)), [-1.0, 0.0, 1.0]);
    // Pixels run down, so the start of an axis may be its larger end.
    let axis = Axis::new(&log(0.01, 1.0), 200.0, 100.0);
    assert!((axis.pixel(0.1) - 150.0).abs() < 1e-9);
    assert_eq!([axis.pixel(0.0), axis.outside(0.0)], [200.0, -1.0]);
    let names = ["a", "b"].map(str::to_owned).to_vec();
    let axis = Axis::new(&ScaleKind::Steps(names), 0.0, 100.0);
    assert_eq!(
        [axis.pixel(0.0), axis.pixel(1.0), axis.step()],
        [25.0, 75.0, 50.0]
    );
}

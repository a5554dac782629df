//! Groups, pairs and distinct images of a frame, on synthetic runs.

use super::paper::{F64, Made, finished};
use splitsum::experiment::axis::{AxisId, Point};
use splitsum::experiment::value::Value;
use splitsum::study::finished::Finished;
use splitsum::study::frame::curve::curves;
use splitsum::study::frame::{Frame, Row, group_by_axes, pair};

fn axis(name: &str) -> AxisId {
    AxisId::find(name).unwrap()
}

fn flat(axes: &str) -> Finished {
    finished(axes, |_| Some(Made::error(1.0)))
}

#[test]
fn a_row_is_in_every_group_that_it_does_not_contradict() {
    let run =
        flat("method = [\"sampled\", \"split-sum\"]\nsamples = [1, 4, 16]\nalpha = [0.1, 0.5]\n");
    let frame = Frame::new(&run, None);
    let rows: Vec<&Row> = frame.rows.iter().collect();
    let sizes = |axes: &[&str]| -> Vec<usize> {
        let axes: Vec<AxisId> = axes.iter().map(|name| axis(name)).collect();
        group_by_axes(&rows, &axes)
            .iter()
            .map(|(_, own)| own.len())
            .collect()
    };
    assert_eq!(sizes(&["alpha"]), [4, 4]);
    // The split sum draws no samples, so it is in the group of every count.
    assert_eq!(sizes(&["samples"]), [4, 4, 4]);
    assert_eq!(
        sizes(&["method", "samples"]),
        [2, 2, 2, 2],
        "with the method the two contradict each other"
    );
    assert_eq!(group_by_axes(&rows, &[]).len(), 1);
}

#[test]
fn a_pair_differs_in_one_axis_alone() {
    let run = flat(
        "method = [\"sampled\", \"sampled-unfiltered\", \"split-sum\"]\nsamples = [4, \
         16]\nlod_bias = [0, 1]\nalpha = [0.1, 0.5]\n",
    );
    let frame = Frame::new(&run, None);
    let rows: Vec<&Row> = frame.rows.iter().collect();
    let biases = pair(&rows, axis("lod_bias"), &Value::Number(0.0));
    // Two counts and two alphas of `sampled`: the others have no level bias.
    assert_eq!(biases.len(), 4);
    for (row, base) in &biases {
        assert_eq!(row.samples(), base.samples());
        assert_eq!(row.point.get("alpha"), base.point.get("alpha"));
        assert_eq!(row.point.get("method"), base.point.get("method"));
    }
    // The method without level bias is paired with the default bias of the other, at the same count
    // and alpha.
    let methods = pair(&rows, axis("method"), &Value::from("sampled"));
    assert_eq!(
        methods.len(),
        4,
        "the split sum has no partner: it draws no samples"
    );
    for (row, base) in &methods {
        assert_eq!(row.samples(), base.samples());
        assert_eq!(
            (base.point.get("lod_bias"), row.point.get("lod_bias")),
            (&Value::Number(0.0), &Value::Unset)
        );
    }
}

#[test]
fn each_image_counts_once() {
    // Black metal: neither the diffuse method nor f0 of dielectrics has an effect; methods without
    // tables ignore their format.
    let axes = "alpha = [0.1, 0.5]\nalbedo = [0]\nf0 = [0.04, 0.9]\nmetallic = [1]\nstorage_format \
                = [\"f32\", \"f16\"]\n\
                method = [\"split-sum\", \"sampled\"]\nsamples = [1, 4, 16, 64]\n";
    let run = finished(axes, |_| Some(Made::error(1.0)));
    let frame = Frame::new(&run, None);
    // Two alphas of four counts, and of two formats of the split sum.
    assert_eq!(frame.rows.len(), 2 * 4 + 2 * 2);
    let copies: usize = frame.rows.iter().map(|row| row.copies.len()).sum();
    assert_eq!(copies + frame.rows.len(), run.cells.len());
    assert!(!frame.shape.is_swept(axis("f0")) && frame.shape.is_swept(axis("storage_format")));
    // On a surface that is not a metal, f0 has an effect.
    let run = finished(&axes.replace("metallic = [1]", "metallic = [0]"), |_| {
        Some(Made::error(1.0))
    });
    assert_eq!(Frame::new(&run, None).rows.len(), 2 * (2 * 4 + 2 * 2));
}

#[test]
fn of_equal_images_the_one_with_a_score_is_kept() {
    let axes = "albedo = [0]\nmetallic = [1]\nf0 = [0.04, 0.9]\nmethod = [\"split-sum\"]\n";
    let is_broken = |point: &Point| *point.get("f0") == Value::Color([0.04; 3]);
    let run = finished(axes, |point| (!is_broken(point)).then(|| Made::error(0.5)));
    let frame = Frame::new(&run, None);
    let [row] = frame.rows.as_slice() else {
        panic!("{:?}", frame.rows)
    };
    assert_eq!((frame.error(row), row.copies.len()), (Some(0.5), 1));
    assert!(*row.copies[0] == *run.cells[0].id && row.cell.id == run.cells[1].id);
}

#[test]
fn of_several_tone_curves_the_plain_one_counts() {
    let run = finished(
        "exposure = [10, 1, 5]\nalpha = [0.1, 0.5]\nmethod = [\"split-sum\"]\n",
        |point| {
            Some(Made {
                flip: point.get("exposure").number(),
                ..Made::error(0.3)
            })
        },
    );
    let frame = Frame::new(&run, None);
    assert_eq!(frame.rows.len(), 6);
    assert_eq!(
        frame
            .images()
            .iter()
            .map(|row| row.flip())
            .collect::<Vec<_>>(),
        [Some(1.0); 2]
    );
}

#[test]
fn a_curve_has_the_geometric_mean_of_its_point_sets() {
    let axes =
        "method = [\"sampled\"]\nsamples = [16, 4]\npoint_set = [0, 1]\nalpha = [0.1, 0.5]\n";
    let run = finished(axes, |point| {
        let luck = if *point.get("point_set") == Value::Count(0) {
            4.0
        } else {
            0.25
        };
        let floor = if *point.get("samples") == Value::Count(4) {
            1e-12
        } else {
            0.02
        };
        Some(Made {
            floor,
            ..Made::error(luck * 2.0)
        })
    });
    let frame = Frame::new(&run, None);
    let images = frame.images();
    let curves = curves(&frame, &images, &frame.case_axes());
    assert_eq!(curves.len(), 2);
    for curve in &curves {
        assert_eq!(curve.count_ends(), [4, 16]);
        assert!(
            curve
                .points
                .iter()
                .all(|point| (point.error - 2.0).abs() < F64 && point.rows.len() == 2)
        );
        // 0.5 is 25 floors of a mean square, 5 in units of the difference: not above the noise.
        assert_eq!(
            curve
                .points
                .iter()
                .map(|point| point.is_resolved)
                .collect::<Vec<_>>(),
            [true, false]
        );
    }
}

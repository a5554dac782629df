//! How answers are drawn, worded in tables, and published.

use super::answers::Made;
use crate::runner::runs::{contents, finished, plan};
use splitsum::study::answers::break_even::range_text;
use splitsum::study::answers::plot::scale::{Kind, Scale, tick_text};
use splitsum::study::answers::publish::{PublishError, publish, write_page};
use splitsum::study::answers::run_folder::RunFolder;

#[test]
fn axes_hold_their_data_and_name_round_values() {
    let ticks = |scale: &Scale| scale.ticks.iter().map(|(_, text)| text.clone()).collect::<Vec<_>>();
    let log = Scale::of(Kind::Log, [2e-6, 0.4, f64::NAN, 0.0]).unwrap();
    assert!(log.lo < 2e-6 && log.hi > 0.4);
    assert_eq!(ticks(&log), ["10⁻⁵", "10⁻⁴", "0.001", "0.01", "0.1"]);
    assert!(log.minor.iter().all(|x| (log.lo..=log.hi).contains(x)) && log.minor.len() > 30);
    assert_eq!(ticks(&Scale::of(Kind::Log, [3.0, 30.0]).unwrap()), ["5", "10", "20"]);
    assert_eq!(ticks(&Scale::of(Kind::Linear, [0.0, 0.24]).unwrap()), ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25"]);
    assert_eq!(ticks(&Scale::of(Kind::Log, [0.9, 1.1]).unwrap()), ["0.7", "1", "1.2"]);
    assert_eq!(Scale::of(Kind::Log, [0.0, -1.0]), None);
    assert!((log.place(log.lo).unwrap()).abs() < 1e-9 && (log.place(log.hi).unwrap() - 1.0).abs() < 1e-9);
    assert_eq!(log.place(0.0), None);
    let tried = Scale::of(Kind::Log, [1.0, 256.0]).unwrap().with_ticks(&[1.0, 4.0, 16.0, 64.0, 256.0], 3);
    assert_eq!(ticks(&tried), ["1", "16", "256"]);
    assert_eq!([1e-5, 2e-7, 12_000_000.0].map(tick_text), ["10⁻⁵", "2·10⁻⁷", "1.2·10⁷"]);
}

#[test]
fn pictures_are_whole_and_names_in_them_are_inert() {
    let mut made = Made::new(&["environment", "alpha", "method", "samples"]);
    for environment in ["a<b>&\"c.hdr", "builtin:sky"] {
        for alpha in ["0.1", "0.5"] {
            let environment = format!("\"{}\"", environment.replace('"', "\"\""));
            made.add(&[&environment, alpha, "split-sum", ""], 0.3);
            [1, 4, 16]
                .iter()
                .for_each(|n| made.add(&[&environment, alpha, "sampled", &n.to_string()], 2.0 / f64::from(*n)));
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (_, answered) = made.answers(dir.path(), [0.5, 1.0, 1.5]);
    let pictures: Vec<_> = answered.files.iter().filter(|(name, _)| name.ends_with(".svg")).collect();
    let expected = ["convergence", "break_even", "break_even_by_n_dot_v", "error_by_n_dot_v_and_alpha"];
    for name in expected {
        let name = format!("{name}.svg");
        assert!(pictures.iter().any(|(known, _)| *known == name), "{name} of {:?}", answered.record.files);
    }
    for (name, svg) in pictures {
        assert!(svg.trim_end().ends_with("</svg>") && svg.contains("<title>"), "{name}");
        assert!(!svg.contains("NaN") && !svg.contains("a<b>"), "{name}");
        assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count(), "{name}");
        // Widths that stand for dashes are replaced.
        assert!(!svg.contains("stroke-width=\"1001\"") && !svg.contains("stroke-width=\"2001\""), "{name}");
    }
    assert!(answered.files.iter().any(|(_, text)| text.contains("stroke-dasharray")));
}

/// What a reader needs to reckon the times again, and the first page of the sheets whatever its shape.
#[test]
fn a_published_run_has_its_raw_samples_and_its_first_sheet() {
    let text = "name = \"timed\"\nsize = [32, 32]\nreference = { samples = 32 }\n[axes]\nmethod = [\"sampled\", \"split-sum\"]\n\
                samples = [4]\nalpha = { linspace = [0.05, 1, 40] }\n[timing]\nwarmup = 1\nrounds = 6\n";
    let (dir, results) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let run = finished(&plan(text), dir.path());
    let stale = results.path().join("timed/timings/0123456789abcdef.json");
    assert!(publish(&run, results.path(), false).unwrap().is_empty());
    std::fs::write(&stale, "{}").unwrap();
    publish(&run, results.path(), false).unwrap();
    let published = results.path().join("timed");
    assert!(!stale.exists() && contents(&published.join("timings")) == contents(&run.join("timings")));
    // The published folder answers as the run does.
    let [there, here] = [&published, &run].map(|dir| RunFolder::read(dir).unwrap().timings);
    assert!(there == here && !there.is_empty());
    let summary = std::fs::read_to_string(published.join("summary.md")).unwrap();
    assert!(summary.contains("[timed_1](timed_1.png)") && summary.contains("timed_2"), "{summary}");
    let sheet = splitsum::pixels::png::read_rgb8(&published.join("timed_1.png")).unwrap();
    let whole = splitsum::pixels::png::read_rgb8(&run.join("tables/timed_1.png")).unwrap();
    assert!([sheet.width, sheet.height] == [whole.width, whole.height] && sheet.height <= 2400, "{}", sheet.height);
    // A page of an older run may be taller: it is shrunk.
    splitsum::pixels::png::write_rgb8(
        &run.join("tables/timed_1.png"),
        &splitsum::pixels::Rgb8Image::filled(900, 4000, [9; 3]),
    )
    .unwrap();
    publish(&run, results.path(), false).unwrap();
    let sheet = splitsum::pixels::png::read_rgb8(&published.join("timed_1.png")).unwrap();
    assert_eq!([sheet.width, sheet.height], [540, 2400]);
    // Too many samples for git stay where they are, and the summary says so.
    for i in 0..3 {
        std::fs::write(run.join(format!("timings/{i:016x}.json")), vec![b' '; 400 << 10]).unwrap();
    }
    let notes = publish(&run, results.path(), false).unwrap();
    assert!(notes.len() == 1 && notes[0].contains("timings: left out, 1.2"), "{notes:?}");
    assert!(contents(&published.join("timings")).is_empty());
    assert!(std::fs::read_to_string(published.join("summary.md")).unwrap().contains("timings/ (1.2"));
}

#[test]
fn maps_over_n_dot_v_show_their_intervals() {
    // Eight cases of each alpha; break-even with three point sets.
    let mut made = Made::new(&["alpha", "environment", "method", "samples", "point_set"]);
    for alpha in ["0.1", "0.5"] {
        for case in 0..8u32 {
            let environment = format!("builtin:e{case}");
            let scale = 1.0 + f64::from(case);
            made.add(&[alpha, &environment, "split-sum", "", ""], 0.1 * scale);
            for (set, luck) in [("0", 0.9), ("1", 1.0), ("2", 1.15)] {
                for n in [1, 4, 16, 64] {
                    made.add(&[alpha, &environment, "sampled", &n.to_string(), set], luck * scale / f64::from(n));
                }
            }
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (answers, answered) = made.answers(dir.path(), [0.5, 1.0, 2.0]);
    // Of eight cases the median lies between the first and the last with 1 - 2 / 2^8, and no narrower pair holds it with 95 %.
    let table = answers.heat.iter().find(|table| table.method == "split-sum").unwrap();
    let found = table.errors[0][1].unwrap();
    assert!((found.median - 0.45).abs() < 1e-12, "{found:?}");
    let [lo, hi] = found.interval.unwrap();
    assert!((lo - 0.1).abs() < 1e-12 && (hi - 0.8).abs() < 1e-12, "{found:?}");
    let file = |name: &str| &answered.files.iter().find(|(known, _)| known == name).unwrap().1;
    let head = file("error_by_n_dot_v_and_alpha.csv").lines().next().unwrap();
    assert!(head.ends_with(",relmse_eps1e-2,median_lo,median_hi"), "{head}");
    assert!(answered.summary.contains("| 0.45 (0.10–0.80) |"), "{}", answered.summary);
    assert!(file("error_by_n_dot_v_and_alpha.svg").contains("\n0.10–0.80\n"));
    // 10 / n meets 1 at 10 samples, whatever the bin.
    let bin = &answers.pairs[0].cases[0].bins[0];
    let range = range_text(bin.crossing.interval.unwrap(), answers.pairs[0].tried());
    assert!(range.contains('–'), "{range}");
    assert!(answered.summary.contains(&format!("| 16 ({range}) |")), "{}", answered.summary);
    assert!(file("break_even_by_n_dot_v.svg").contains(&format!("\n{range}\n")));
}

#[test]
fn a_range_is_told_in_the_room_of_a_cell() {
    let inf = f64::INFINITY;
    for (ends, text) in [
        ([11.3, 19.0], "11–19"),
        ([0.0, 4.2], "≤ 4.2"),
        ([12.0, inf], "≥ 12"),
        ([64.0, inf], "> 64"),
        ([0.0, 1.0], "≤ 1"),
        ([0.0, inf], "?"),
    ] {
        assert_eq!(range_text(ends, [1, 64]), text, "{ends:?}");
    }
}

#[test]
fn published_runs_have_a_page() {
    let mut made = Made::new(&["method", "samples"]);
    made.add(&["split-sum", ""], 0.3);
    [1, 4, 16].iter().for_each(|n| made.add(&["sampled", &n.to_string()], 2.0 / f64::from(*n)));
    let (dir, results) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (_, answered) = made.answers(dir.path(), [1.0; 3]);
    answered.write().unwrap();
    assert!(publish(dir.path(), results.path(), false).unwrap().is_empty());
    let stale = results.path().join("made/answers/old.svg");
    std::fs::write(&stale, "old").unwrap();
    publish(dir.path(), results.path(), false).unwrap();
    assert!(!stale.exists(), "an earlier picture does not stand beside new ones");
    for name in ["summary.md", "errors.csv", "provenance.json", "answers/break_even.csv", "answers/convergence.svg"] {
        assert!(results.path().join("made").join(name).exists(), "{name}");
    }
    let page = std::fs::read_to_string(write_page(results.path()).unwrap()).unwrap();
    assert!(page.contains("[made](made/summary.md)") && page.contains(&answered.record.answer.sentence), "{page}");
    // The same plan, run anew, takes its place; another plan only with leave; files that nobody published never.
    let published = results.path().join("made/provenance.json");
    let own = std::fs::read(&published).unwrap();
    let mut other: serde_json::Value = serde_json::from_slice(&own).unwrap();
    other["plan_hash"] = "0123456789abcdef".into();
    std::fs::write(&published, other.to_string()).unwrap();
    let error = publish(dir.path(), results.path(), false).unwrap_err();
    assert!(error.is_misuse() && error.to_string().contains("of plan 0123456789abcdef of "), "{error}");
    assert!(error.to_string().contains("give --replace") && error.to_string().lines().count() == 1, "{error}");
    assert!(std::fs::read(&published).unwrap() != own, "nothing was written");
    publish(dir.path(), results.path(), true).unwrap();
    assert!(std::fs::read(&published).unwrap() == own);
    let foreign = tempfile::tempdir().unwrap();
    std::fs::create_dir(foreign.path().join("made")).unwrap();
    std::fs::write(foreign.path().join("made/thesis.tex"), "years of work").unwrap();
    let error = publish(dir.path(), foreign.path(), true).unwrap_err();
    assert!(
        matches!(error, PublishError::NotPublished { .. }) && foreign.path().join("made/thesis.tex").exists(),
        "{error}"
    );

    let inside = publish(&results.path().join("made"), results.path(), false);
    assert!(matches!(inside, Err(PublishError::Itself { .. })), "{inside:?}");
    assert!(results.path().join("made/errors.csv").exists());
}

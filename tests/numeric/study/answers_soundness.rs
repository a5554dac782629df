//! What answers must not do: speak of damaged tables, count one image twice, claim what no interval supports, leave gaps unnamed.

use super::answers::Made;
use splitsum::study::answers::Answered;
use splitsum::study::answers::break_even::BreakEven;
use splitsum::study::answers::plot::scale::tick_text;
use splitsum::study::answers::times::{TimeLevel, ratio_at};
use splitsum::table::csv::Table;
use std::path::Path;

/// Every file below a folder with its content.
fn contents(dir: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found: Vec<(String, Vec<u8>)> = Vec::new();
    for entry in std::fs::read_dir(dir).unwrap().flatten() {
        let path = entry.path();
        match path.is_dir() {
            true => found.extend(contents(&path)),
            false => found.push((path.display().to_string(), std::fs::read(&path).unwrap())),
        }
    }
    found.sort();
    found
}

fn curve() -> Made {
    let mut made = Made::new(&["method", "samples"]);
    made.add(&["split-sum", ""], 0.3);
    [1, 4, 16].iter().for_each(|n| made.add(&["sampled", &n.to_string()], 2.0 / f64::from(*n)));
    made
}

#[test]
fn damaged_tables_are_refused_by_name_and_old_answers_stay() {
    let dir = tempfile::tempdir().unwrap();
    let (_, answered) = curve().answers(dir.path(), [1.0; 3]);
    answered.write().unwrap();
    let path = |name: &str| dir.path().join(name);
    let read = |name: &str| std::fs::read_to_string(path(name)).unwrap();
    let (errors, bins) = (read("errors.csv"), read("errors_by_n_dot_v.csv"));
    let lines = |text: &str, count: usize| text.lines().take(count).map(|line| format!("{line}\n")).collect::<String>();
    let mut row_short = lines(&errors, 2);
    row_short.push_str("0009,sampled,1\n");
    let damages = [
        ("errors.csv", String::new(), "the file is empty"),
        ("errors.csv", lines(&errors, 1), "no rows"),
        ("errors.csv", errors[..errors.len() - 3].to_owned(), "ends within a row"),
        ("errors.csv", row_short, "found record with 3 fields"),
        ("errors.csv", errors.replace("verdict", "verdicts"), "no column \"verdict\""),
        ("errors.csv", errors.replace("3e-1", "3e-l"), "\"3e-l\" is not a number"),
        ("errors.csv", errors.replace("0001,", "0000,"), "4 rows of 3 cells"),
        ("errors_by_n_dot_v.csv", String::new(), "the file is empty"),
        ("errors_by_n_dot_v.csv", lines(&bins, 4), "no row of cell 0001"),
    ];
    // A run that drew something and has no rows is damaged; one of no cells is not.
    let provenance = read("provenance.json");
    assert!(provenance.contains("\"cell_count\":4"), "{provenance}");
    let before = contents(&path("answers"));
    for (name, text, expected) in damages {
        std::fs::write(path(name), &text).unwrap();
        let message = Answered::of_run(dir.path()).unwrap_err().to_string();
        assert!(message.contains(&path(name).display().to_string()) && message.contains(expected), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        std::fs::write(path("errors.csv"), &errors).unwrap();
        std::fs::write(path("errors_by_n_dot_v.csv"), &bins).unwrap();
    }
    assert_eq!(contents(&path("answers")), before);
    assert!(Answered::of_run(dir.path()).is_ok());
}

#[test]
fn fewer_rows_than_records_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    curve().write(dir.path(), [1.0; 3]);
    std::fs::create_dir(dir.path().join("failed")).unwrap();
    let record = |i: usize| {
        let json = serde_json::json!({ "cell": format!("{i:04x}"), "label": "", "reason": "" });
        std::fs::write(dir.path().join(format!("failed/{i:04x}.json")), json.to_string()).unwrap();
    };
    (0..4).for_each(record);
    assert!(Answered::of_run(dir.path()).is_ok());
    record(4);
    let message = Answered::of_run(dir.path()).unwrap_err().to_string();
    assert!(message.contains("errors.csv: 4 rows, but the folder has records of 5 cells"), "{message}");
    // What cannot be read is no record.
    std::fs::remove_file(dir.path().join("failed/0004.json")).unwrap();
    std::fs::create_dir(dir.path().join("cells")).unwrap();
    std::fs::write(dir.path().join("cells/0004.json"), "{").unwrap();
    assert!(Answered::of_run(dir.path()).is_ok());
}

#[test]
fn answers_are_written_all_or_none() {
    let dir = tempfile::tempdir().unwrap();
    let (_, answered) = curve().answers(dir.path(), [1.0; 3]);
    answered.write().unwrap();
    let mut other = curve();
    other.add(&["sampled", "64"], 0.05);
    let (_, changed) = other.answers(dir.path(), [1.0; 3]);
    // The last file to be written cannot be: a folder has its name.
    let summary = dir.path().join("summary.md");
    std::fs::remove_file(&summary).unwrap();
    std::fs::create_dir(&summary).unwrap();
    let before = contents(&dir.path().join("answers"));
    changed.write().unwrap_err();
    assert_eq!(contents(&dir.path().join("answers")), before, "and nothing half-written is left");
    std::fs::remove_dir(&summary).unwrap();
    changed.write().unwrap();
    assert_ne!(contents(&dir.path().join("answers")), before);
}

#[test]
fn each_image_counts_once() {
    let mut made = Made::new(&["alpha", "albedo", "f0", "metallic", "diffuse", "storage_format", "method", "samples"]);
    // Black metal: neither the diffuse method nor, for a method without tables, their format reaches a pixel; f0 of dielectrics does not.
    for (alpha, fixed) in [("0.1", 0.3), ("0.5", 0.05)] {
        for diffuse in ["sh9", "irradiance-map"] {
            for format in ["f32", "f16"] {
                for f0 in ["0.04", "0.9"] {
                    let tables = if format == "f16" { 1.5 } else { 1.0 };
                    made.add(&[alpha, "0", f0, "1", diffuse, format, "split-sum", ""], fixed * tables);
                    for n in [1, 4, 16, 64] {
                        made.add(
                            &[alpha, "0", f0, "1", diffuse, format, "sampled", &n.to_string()],
                            2.0 / f64::from(n),
                        );
                    }
                }
            }
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (answers, answered) = made.answers(dir.path(), [1.0; 3]);
    assert_eq!(answers.curves.len(), 2, "one for each alpha");
    let [pair] = answers.pairs.as_slice() else { panic!("{:?}", answers.pairs) };
    // The split sum reads the tables: its two formats are two images.
    assert_eq!(pair.cases.len(), 4);
    let sentence = &answered.record.answer.sentence;
    assert!(sentence.contains("the median of 4 cases (2 alphas, 2 values of storage_format)"), "{sentence}");
    // 2 alphas of 4 counts, and of 2 formats of the split sum.
    let copies = "68 of the 80 cells differ from another one only in what cannot reach their pixels";
    assert!(answered.summary.contains(copies) && answered.summary.contains("of 12 cells"), "{}", answered.summary);
    assert!(answers.effects.iter().all(|effect| !["diffuse", "f0"].contains(&effect.axis.as_str())));
    let formats: Vec<_> = answers.effects.iter().filter(|effect| effect.axis == "storage_format").collect();
    assert!(formats.iter().all(|effect| effect.method == "split-sum") && formats[0].n == 2, "{formats:?}");

    // On a surface that is neither, all of it counts.
    let mut plain = Made::new(&["albedo", "diffuse", "method", "samples"]);
    for diffuse in ["sh9", "irradiance-map"] {
        plain.add(&["0.5", diffuse, "split-sum", ""], 0.3);
        [1, 4].iter().for_each(|n| plain.add(&["0.5", diffuse, "sampled", &n.to_string()], 1.0 / f64::from(*n)));
    }
    let dir = tempfile::tempdir().unwrap();
    assert_eq!(plain.answers(dir.path(), [1.0; 3]).0.pairs[0].cases.len(), 2);
}

#[test]
fn a_clip_above_the_peak_is_the_same_light() {
    let mut made = Made::new(&["environment_clip_log2", "method", "samples"]);
    let mut lights = "environment,environment_clip_log2,mean_luminance,peak_luminance,dynamic_range_stops\n".to_owned();
    // From 2^4 on nothing is cut off.
    for (clip, peak) in [("2", 4.0), ("4", 10.0), ("6", 10.0), ("8", 10.0)] {
        lights += &format!("builtin:sky,{clip},1,{peak},{}\n", f64::log2(peak));
        made.add(&[clip, "split-sum", ""], 0.3);
        [1, 4, 16].iter().for_each(|n| made.add(&[clip, "sampled", &n.to_string()], 2.0 / f64::from(*n)));
    }
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("environments.csv"), lights.replace("builtin:sky", "")).unwrap();
    assert_eq!(made.answers(dir.path(), [1.0; 3]).0.pairs[0].cases.len(), 2);
}

#[test]
fn the_same_linear_image_under_many_exposures_counts_once() {
    let mut made = Made::new(&["alpha", "exposure", "method", "samples"]);
    for alpha in ["0.1", "0.5"] {
        for exposure in ["1", "2", "4"] {
            made.add(&[alpha, exposure, "split-sum", ""], 0.3);
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (_, answered) = made.answers(dir.path(), [1.0; 3]);
    assert!(
        answered.record.answer.facts.iter().chain([&answered.record.answer.sentence]).all(|s| !s.contains("6 cells"))
    );
}

#[test]
fn a_ratio_between_tried_counts_has_an_interval() {
    let level = |samples, ratio: f64| TimeLevel {
        samples,
        ratio,
        interval: [ratio * 0.5, ratio * 2.0],
        rounds: 15,
        tables_ms: 30.0,
        fixed_ms: 2.0,
        is_cpu: true,
    };
    let levels = [level(4, 1.0), level(16, 4.0)];
    let (ratio, [lo, hi]) = ratio_at(&levels, 8.0).unwrap();
    assert!((ratio - 2.0).abs() < 1e-9 && (lo - 1.0).abs() < 1e-9 && (hi - 4.0).abs() < 1e-9, "{ratio} {lo} {hi}");
    assert_eq!(ratio_at(&levels, 16.0), Some((4.0, [2.0, 8.0])));
    assert_eq!(ratio_at(&levels, 20.0), None);
}

/// The x coordinates of everything drawn, with the frames' ends.
fn panel_ends_and_marks(svg: &str) -> (Vec<f64>, Vec<f64>) {
    let number = |text: &str, name: &str| -> Option<f64> {
        let start = text.find(&format!("{name}=\""))? + name.len() + 2;
        text[start..].split('"').next()?.parse().ok()
    };
    let frames = svg.split("<rect").filter(|rect| rect.contains("fill=\"none\""));
    // Panels are wide, marks of series are not, and the picture itself begins at 0.
    let panels = frames.map(|rect| [number(rect, " x").unwrap(), number(rect, "width").unwrap()]);
    let ends = panels.filter(|[x, width]| *x > 0.0 && *width > 100.0).flat_map(|[x, width]| [x, x + width]);
    (ends.collect(), svg.split("<circle").skip(1).filter_map(|circle| number(circle, "cx")).collect())
}

#[test]
fn marks_that_stand_aside_stay_inside_their_panel() {
    // Eight series with bars: together they would stand 35 pixels wide.
    let mut made = Made::new(&["environment", "environment_clip_log2", "brdf", "method", "samples"]);
    let mut lights = "environment,environment_clip_log2,mean_luminance,peak_luminance,dynamic_range_stops\n".to_owned();
    for clip in 0..5 {
        lights += &format!("builtin:sky,{clip},1,{},{clip}\n", 2f64.powi(clip));
        for n in [1, 2, 4, 8, 16, 32, 64, 128] {
            for (brdf, luck) in [("ggx", 1.0), ("phong", 2.0)] {
                made.add(&["builtin:sky", &clip.to_string(), brdf, "sampled", &n.to_string()], luck / f64::from(n));
            }
        }
    }
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("environments.csv"), lights).unwrap();
    let (_, answered) = made.answers(dir.path(), [1.0; 3]);
    let (_, svg) = answered.files.iter().find(|(name, _)| name == "dynamic_range.svg").unwrap();
    let (ends, marks) = panel_ends_and_marks(svg);
    assert!(ends.len() == 2 && marks.len() > 5, "{ends:?} {marks:?}");
    // The legend's mark stands below the panel, inside its ends, too. A circle has a radius of 4.
    assert!(marks.iter().all(|x| x - 4.0 >= ends[0] && x + 4.0 <= ends[1]), "{ends:?} {marks:?}");
}

#[test]
fn people_read_rounded_numbers_and_files_have_all() {
    let alpha = "0.223606797749979";
    let mut made = Made::new(&["alpha", "method", "samples"]);
    for alpha in [alpha, "0.5"] {
        made.add(&[alpha, "split-sum", ""], 0.3);
        made.add(&[alpha, "sampled-unfiltered", "1"], 0.4);
        [1, 4, 16].iter().for_each(|n| made.add(&[alpha, "sampled", &n.to_string()], 2.0 / f64::from(*n)));
    }
    let dir = tempfile::tempdir().unwrap();
    let (_, answered) = made.answers(dir.path(), [0.5, 1.0, 1.5]);
    assert!(!answered.summary.contains(alpha) && answered.summary.contains("0.2236"), "{}", answered.summary);
    for (name, text) in &answered.files {
        match name.ends_with(".csv") {
            true => assert!(text.contains(alpha) || !text.contains("alpha"), "{name}"),
            false => assert!(!text.contains(alpha), "{name}"),
        }
    }
    assert_eq!(tick_text(0.223606797749979), "0.224");
}

#[test]
fn what_an_experiment_leaves_out_is_named() {
    let mut made = Made::new(&["alpha", "brdf", "method", "samples"]);
    for alpha in ["0.1", "0.5"] {
        for brdf in ["ggx", "phong"] {
            if (alpha, brdf) == ("0.5", "phong") {
                continue;
            }
            made.add(&[alpha, brdf, "split-sum", ""], 0.3);
            let counts: &[u32] = if brdf == "phong" { &[1, 4] } else { &[1, 4, 16] };
            counts.iter().for_each(|n| made.add(&[alpha, brdf, "sampled", &n.to_string()], 2.0 / f64::from(*n)));
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let experiment = "name = \"made\"\n[axes]\nalpha = [0.1, 0.5]\nbrdf = [\"ggx\", \"phong\"]\nmethod = [\"split-sum\", \"sampled\"]\n\
                      samples = [1, 4, 16]\n[[exclude]]\nalpha = 0.5\nbrdf = \"phong\"\nwhy = \"too slow\"\n\
                      [[exclude]]\nsamples = 16\nmethod = \"sampled\"\nbrdf = \"phong\"\nwhy = \"too slow\"\n";
    std::fs::write(dir.path().join("experiment.toml"), experiment).unwrap();
    let (answers, answered) = made.answers(dir.path(), [1.0; 3]);
    let [pair] = answers.pairs.as_slice() else { panic!("{:?}", answers.pairs) };
    assert_eq!((pair.cases.len(), &pair.excluded), (3, &vec![vec!["0.5".to_owned(), "phong".to_owned()]]));
    let row = |words: [&str; 2]| {
        let is_it = |line: &&str| line.split('|').skip(1).map(str::trim).take(2).eq(words);
        answered.summary.lines().find(is_it).unwrap_or_else(|| panic!("no {words:?} in {}", answered.summary))
    };
    assert_eq!(row(["0.5", "phong"]).matches("excluded").count(), 7, "the method, three counts and three answers");
    let short = row(["0.1", "phong"]);
    assert_eq!(short.matches("excluded").count(), 1, "{short}");
    let svg = &answered.files.iter().find(|(name, _)| name == "break_even_by_n_dot_v.svg").unwrap().1;
    assert_eq!(svg.matches("\nexcluded\n").count(), 3, "one for each bin");
    assert!(svg.contains("Hatched:"));
    assert_eq!(pair.cases[0].whole.break_even, BreakEven::From(16));
    answered.write().unwrap();
    assert_eq!(Table::read(&dir.path().join("answers/break_even.csv")).unwrap().rows.len(), 3);
}

#[test]
fn an_effect_whose_interval_holds_1_is_not_claimed() {
    let answer = |factors: [f64; 3]| {
        let mut made = Made::new(&["alpha", "method", "samples", "lod_bias"]);
        for (alpha, factor) in ["0.1", "0.5", "1"].into_iter().zip(factors) {
            made.add(&[alpha, "sampled", "16", "0"], 0.3);
            made.add(&[alpha, "sampled", "16", "1"], 0.3 * factor);
        }
        let dir = tempfile::tempdir().unwrap();
        made.answers(dir.path(), [1.0; 3]).1.record.answer.sentence
    };
    let (sure, unsure) = (answer([2.0, 2.1, 1.9]), answer([0.1, 10.0, 2.0]));
    assert!(sure.contains("multiplies the error") && !sure.contains("does not tell"), "{sure}");
    assert!(
        unsure.contains("may multiply")
            && unsure.contains("errs less in 1 of 3, and the interval does not tell which one errs less"),
        "{unsure}"
    );
}

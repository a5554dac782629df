//! What an experiment asks by what it sweeps, on made-up runs whose answers are known.

use super::answers::Made;
use splitsum::study::answers::Answered;
use splitsum::study::answers::Answers;
use splitsum::study::answers::effects::Effect;
use splitsum::study::answers::run_folder::RunFolder;
use splitsum::study::answers::study::Study;
use std::fmt::Write;
use std::path::Path;

const F64: f64 = 1e-9;

#[test]
fn tables_are_enough_from_where_no_larger_one_gains() {
    // The error falls with the samples up to 64, and a third level halves it; a small map, which cannot have three levels, seems to cost
    // nothing beside two.
    let mut made = Made::new(&["alpha", "method", "prefilter_size", "prefilter_level_count", "prefilter_sample_count"]);
    for (alpha, scale) in [("0.1", 1.0), ("0.5", 3.0)] {
        for (samples, of_samples) in [("256", 1.0), ("64", 1.01), ("16", 1.5), ("1024", 0.99)] {
            for (levels, of_levels) in [("3", 1.0), ("2", 2.0)] {
                for size in ["256x128", "64x32"] {
                    if size == "256x128" || levels == "2" {
                        made.add(&[alpha, "split-sum", size, levels, samples], scale * of_samples * of_levels);
                    }
                }
            }
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (answers, answered) = made.answers(dir.path(), [1.0; 3]);
    let enough = |axis: &str| answers.enough.iter().find(|one| one.axis == axis);
    let samples = enough("prefilter_sample_count").unwrap();
    assert_eq!(samples.value, "64");
    let beyond = samples.beyond.as_ref().unwrap();
    assert!(beyond.value == "1024" && (beyond.ratio - 0.99 / 1.01).abs() < F64, "{beyond:?}");
    let below = samples.below.as_ref().unwrap();
    assert!(below.value == "16" && (below.ratio - 1.5 / 1.01).abs() < F64 && below.n == 2, "{below:?}");
    let levels = enough("prefilter_level_count").unwrap();
    assert!(levels.value == "3" && levels.beyond.is_none() && (levels.below.as_ref().unwrap().ratio - 2.0).abs() < F64);
    assert!(enough("prefilter_size").is_none(), "no smaller map was tried with as many levels");
    let sentence = &answered.record.answer.sentence;
    for part in [
        "From prefilter_sample_count 64 on a larger one takes at most 5 %",
        "of prefilter_level_count 3 no larger one was tried",
    ] {
        assert!(sentence.contains(part), "{sentence}");
    }
    assert!(sentence.contains("prefilter_sample_count 16 multiplies the error by 1.49"), "{sentence}");
    assert!(
        dir.path().join("provenance.json").exists() && answered.files.iter().any(|(name, _)| name == "table_sizes.csv")
    );
}

#[test]
fn what_an_interval_leaves_open_is_no_large_number() {
    // Sizes of the tables of an estimator that is asked about: all pairs, as in effects.csv.
    let mut made = Made::new(&["environment", "method", "diffuse", "irradiance_size", "irradiance_sample_count"]);
    for (environment, sh9, small) in
        [("builtin:sky", 8.0, 2.0), ("builtin:studio", 0.5, 9.0), ("builtin:cap", 1.0, 1.5)]
    {
        made.add(&[environment, "none", "sh9", "", ""], sh9);
        for (samples, scale) in [("128x32", 1.0), ("32x8", 3.0)] {
            made.add(&[environment, "none", "irradiance-map", "64x32", samples], scale);
            made.add(&[environment, "none", "irradiance-map", "16x8", samples], small * scale);
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (answers, answered) = made.answers(dir.path(), [1.0; 3]);
    let answer = &answered.record.answer;
    assert!(answer.number == "1 of 3" && answer.unit.ends_with("to 22.7, undecided"), "{answer:?}");
    let size =
        answers.effects.iter().find(|effect| effect.axis == "irradiance_size" && effect.alpha.is_none()).unwrap();
    assert_eq!(size.n, 3);
    let facts: Vec<&String> = answer.facts.iter().filter(|fact| fact.contains("irradiance_size 16x8")).collect();
    assert!(matches!(facts.as_slice(), [one] if one.contains("3 cases")), "{:?}", answer.facts);
}

#[test]
fn what_is_enough_of_one_table_may_need_more_of_another() {
    // Four levels err by half of what three do, and only the larger map has room for them; its size itself gains nothing.
    let mut made = Made::new(&["alpha", "method", "prefilter_size", "prefilter_level_count"]);
    for (alpha, scale) in [("0.1", 1.0), ("0.5", 3.0)] {
        for (size, levels, error) in [("256x128", "3", 2.0), ("512x256", "3", 2.0), ("512x256", "4", 1.0)] {
            made.add(&[alpha, "split-sum", size, levels], scale * error);
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (answers, answered) = made.answers(dir.path(), [1.0; 3]);
    let [size, levels] = answers.enough.as_slice() else { panic!("{:?}", answers.enough) };
    assert_eq!((size.value.as_str(), size.together.as_str()), ("256x128", "512x256"));
    assert_eq!((levels.value.as_str(), levels.together.as_str()), ("4", "4"));
    let sentence = &answered.record.answer.sentence;
    assert!(sentence.starts_with("From prefilter_size 512x256 on a larger one takes at most 5 %"), "{sentence}");
}

#[test]
fn the_answer_is_about_the_table_whose_smaller_size_costs_most() {
    let mut made = Made::new(&["alpha", "method", "prefilter_sample_count", "prefilter_level_count"]);
    for (alpha, scale) in [("0.1", 1.0), ("0.5", 3.0)] {
        for (samples, of_samples) in [("256", 1.0), ("64", 1.2), ("1024", 1.0)] {
            for (levels, of_levels) in [("4", 1.0), ("3", 2.0), ("5", 1.0)] {
                made.add(&[alpha, "split-sum", samples, levels], scale * of_samples * of_levels);
            }
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let answer = made.answers(dir.path(), [1.0; 3]).1.record.answer;
    assert_eq!(answer.number, "4");
    assert!(answer.unit.starts_with("prefilter_level_count from which on"), "{}", answer.unit);
}

#[test]
fn the_median_of_break_even_has_the_interval_of_its_order_statistics() {
    // The error of sampling falls as 1 / n, so that the curves cross at a count of choice, once below what was tried and once above.
    let mut made = Made::new(&["alpha", "method", "samples"]);
    for (i, crossing) in [7.0, 0.5, 3.0, 100.0, 6.0, 2.0, 8.0, 5.0, 20.0].iter().enumerate() {
        let alpha = format!("0.{}", i + 1);
        made.add(&[&alpha, "split-sum", ""], 30.0);
        [1, 4, 16, 64]
            .iter()
            .for_each(|n| made.add(&[&alpha, "sampled", &n.to_string()], 30.0 * crossing / f64::from(*n)));
    }
    let dir = tempfile::tempdir().unwrap();
    let answer = made.answers(dir.path(), [1.0; 3]).1.record.answer;
    // Of nine cases the second from each end: both outermost pairs miss the median with 2 · 10 / 512 = 3.9 %.
    assert!(answer.sentence.contains("the median of 9 cases (9 alphas), 95 % 4 to 64."), "{}", answer.sentence);
    let fact = answer.facts.iter().find(|fact| fact.contains("curves cross")).unwrap();
    assert!(fact.contains("at 6.0 samples in the median (95 % 2.0 to 20, which"), "{fact}");
}

#[test]
fn thirty_to_forty_samples_are_held_against_the_split_sum_and_the_eye() {
    let mut made = Made::new(&["environment", "brdf", "method", "samples"]);
    for (environment, scale) in [("builtin:sky", 1.0), ("builtin:studio", 2.0)] {
        for (brdf, luck) in [("ggx", 1.0), ("phong", 4.0)] {
            made.add_text(&[environment, brdf, "split-sum", ""], &format!("{scale}"), 0.2);
            for (n, error, flip) in [("10", 2.0, 0.2), ("30", 0.5, 0.06), ("40", 0.25, 0.04), ("80", 0.1, 0.02)] {
                made.add_text(&[environment, brdf, "sampled", n], &format!("{}", scale * error * luck), flip);
            }
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (answers, answered) = made.answers(dir.path(), [1.0; 3]);
    let of = |model: Option<&str>, samples: u32| {
        let found = answers.sufficiency.iter().find(|one| one.model.as_deref() == model && one.samples == samples);
        found.unwrap_or_else(|| panic!("{model:?} {samples}"))
    };
    let ggx = of(Some("ggx"), 40).against.clone().unwrap();
    assert!((ggx.ratio - 0.25).abs() < F64 && ggx.n == 2 && ggx.better == 2, "{ggx:?}");
    assert!((ggx.interval[1] - ggx.interval[0]).abs() < F64, "both environments agree");
    let phong = of(Some("phong"), 40).against.clone().unwrap();
    assert!((phong.ratio - 1.0).abs() < F64 && phong.better == 0, "{phong:?}");
    // Over both: the geometric mean of 1/4 and 1, and an interval that holds 1 at 30 samples.
    let all = of(None, 40).against.clone().unwrap();
    assert!((all.ratio - 0.5).abs() < F64 && all.n == 4 && all.interval[0] < 0.25 && all.interval[1] > 1.0, "{all:?}");
    assert_eq!((of(None, 30).visible, of(None, 40).visible), (4, 0));
    let answer = &answered.record.answer;
    assert!(
        answer.sentence.starts_with("30 to 40 samples do not beat split-sum for sure, and do not hide the error"),
        "{}",
        answer.sentence
    );
    assert!(answer.facts.iter().any(|fact| fact.starts_with("ggx: ")), "{:?}", answer.facts);
    assert!(
        answer
            .facts
            .iter()
            .any(|fact| fact == "With sampled the difference is hidden from 40 samples on, of 10, 30, 40 and 80.")
    );
    assert!(answered.files.iter().any(|(name, _)| name == "sufficiency.csv"));
}

/// The folder of a furnace: rows of brdf, alpha, bias of the whole and of two bins.
fn furnace(dir: &Path, reference: &str, rows: &[(&str, &str, f64, [f64; 2])]) {
    let head = "cell,environment,brdf,alpha,method,samples,f0,metallic";
    let (mut errors, mut bins) = (String::new(), String::new());
    for (i, (brdf, alpha, bias, of_bins)) in rows.iter().enumerate() {
        let row = format!("{i:04x},builtin:constant,{brdf},{alpha},reference,64,1,0");
        writeln!(errors, "{row},0.1,{bias},1e-3,resolved").unwrap();
        for (b, bias) in of_bins.iter().enumerate() {
            writeln!(bins, "{row},{},{},100,0.1,{bias}", 0.5 * b as f64, 0.5 * (b + 1) as f64).unwrap();
        }
    }
    let put = |name: &str, text: String| std::fs::write(dir.join(name), text).unwrap();
    put("errors.csv", format!("{head},relmse,bias_rel,bias_rel_noise_floor,verdict\n{errors}"));
    put("errors_by_n_dot_v.csv", format!("{head},n_dot_v_from,n_dot_v_to,pixel_count,relmse,bias_rel\n{bins}"));
    let provenance = serde_json::json!({ "schema_version": 1, "name": "made", "question": "What?", "cell_count": rows.len(),
        "reference": { "method": reference, "samples": 64 }, "sessions": [] });
    put("provenance.json", provenance.to_string());
}

#[test]
fn a_furnace_tells_what_is_lost_and_what_creates() {
    let rows = [
        ("ggx", "0.1", -0.03, [-0.1, -0.01]),
        ("ggx", "1", -0.6, [-0.5, -0.7]),
        ("phong", "0.1", -0.005, [-0.02, 0.001]),
        ("phong", "1", -0.4, [0.4, -0.6]),
    ];
    let dir = tempfile::tempdir().unwrap();
    furnace(dir.path(), "none", &rows);
    let answered = Answered::of_run(dir.path()).unwrap();
    let runs = [RunFolder::read(dir.path()).unwrap()];
    let answers = Answers::new(&Study::new(&runs, &["made".to_owned()]).distinct(), &runs);
    let [.., last] = answers.furnace.as_slice() else { panic!() };
    assert_eq!((last.change, last.extremes), (-0.4, Some([(-0.6, [0.5, 1.0]), (0.4, [0.0, 0.5])])));
    let [lo, hi] = last.interval.unwrap();
    assert!((lo + 0.40196).abs() < 1e-6 && (hi + 0.39804).abs() < 1e-6, "1.96 standard errors of 0.001: {lo} {hi}");
    assert_eq!(
        answered.record.answer.sentence,
        "In a white furnace one scattering loses 0.50 % (phong) to 3.0 % (ggx) at alpha 0.1 and 40 % (phong) to 60 % (ggx) at alpha 1 of the \
         energy, each within ± 0.20 % (95 %); only phong creates any, up to 40 % (phong at alpha 1, n·v 0 to 0.5)."
    );
    // What creates energy is the first fact, with what the whole surface keeps.
    let answer = &answered.record.answer;
    assert_eq!(
        answer.facts[0],
        "phong creates energy at n·v 0 to 0.5: +40 % at alpha 1; over the whole surface −40 %."
    );
    assert_eq!(answer.unit, "of the energy is lost at most: ggx at alpha 1");
    for name in ["energy.csv", "energy.svg"] {
        assert!(answered.files.iter().any(|(known, _)| known == name), "{name}");
    }
    // Held against anything else, a constant environment is no furnace.
    furnace(dir.path(), "reference", &rows);
    let runs = [RunFolder::read(dir.path()).unwrap()];
    assert!(Answers::new(&Study::new(&runs, &["made".to_owned()]).distinct(), &runs).furnace.is_empty());
}

#[test]
fn pairs_within_the_noise_make_no_effect() {
    // Below 1e-2 an error of a made-up run is within ten times its noise.
    let effects = |errors: [(f64, f64); 3]| {
        let mut made = Made::new(&["alpha", "method", "samples", "lod_bias"]);
        for (alpha, (base, other)) in ["0.1", "0.5", "1"].into_iter().zip(errors) {
            made.add(&[alpha, "sampled", "16", "0"], base);
            made.add(&[alpha, "sampled", "16", "1"], other);
        }
        let dir = tempfile::tempdir().unwrap();
        made.answers(dir.path(), [1.0; 3]).0.effects
    };
    assert!(effects([(1e-3, 2e-3), (5e-3, 1e-3), (2e-3, 3e-3)]).is_empty(), "nothing is claimed from noise");
    let some = effects([(1e-3, 2e-3), (1.0, 2.0), (3e-3, 0.3)]);
    let all = some.iter().find(|effect| effect.alpha.is_none()).unwrap();
    assert_eq!((all.n, all.in_noise), (2, 1));
    assert!((all.ratio - 200f64.sqrt()).abs() < F64, "of 2 and 100: {all:?}");
}

/// The polylines of width 2 of a picture, that is the lines of its series and its hollow arrows, by their number of points.
fn lines(svg: &str) -> Vec<usize> {
    let of_width = svg.lines().filter(|line| line.contains("<polyline") && line.contains("stroke-width=\"2\""));
    of_width
        .map(|line| line.split("points=\"").nth(1).unwrap().split('"').next().unwrap().split_whitespace().count())
        .collect()
}

#[test]
fn never_is_an_arrow_beyond_the_drawing_and_joined_to_nothing() {
    let mut made = Made::new(&["alpha", "method", "samples"]);
    for (alpha, factor) in [("0.1", 1.0), ("0.25", 1.0), ("0.5", 100.0)] {
        made.add(&[alpha, "split-sum", ""], 1.0);
        for (n, error) in [("4", 4.0), ("16", 0.5), ("64", 0.2)] {
            made.add(&[alpha, "sampled", n], error * factor);
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let (_, answered) = made.answers(dir.path(), [1.0; 3]);
    let svg = &answered.files.iter().find(|(name, _)| name == "break_even.svg").unwrap().1;
    assert!(svg.contains("&gt; 64") && svg.contains("never up to 64 samples"), "the band has a name");
    // The line joins the two cases that cross; the third is an arrow of five corners. The legend adds a line of two.
    let mut found = lines(svg);
    found.sort_unstable();
    assert_eq!(found, [2, 2, 5]);
}

#[test]
fn different_environments_are_no_trend() {
    let dir = tempfile::tempdir().unwrap();
    let mut made = Made::new(&["environment", "environment_clip_log2", "method", "samples"]);
    for (environment, error) in [("builtin:sky", 1.0), ("builtin:studio", 4.0)] {
        for n in ["4", "16"] {
            made.add(&[environment, "", "sampled", n], error);
        }
    }
    made.write(dir.path(), [1.0; 3]);
    let light = "environment,environment_clip_log2,mean_luminance,peak_luminance,dynamic_range_stops\n\
                 builtin:sky,,1,8,3\nbuiltin:studio,,1,4096,12\n";
    std::fs::write(dir.path().join("environments.csv"), light).unwrap();
    let answered = Answered::of_run(dir.path()).unwrap();
    let svg = &answered.files.iter().find(|(name, _)| name == "dynamic_range.svg").unwrap().1;
    assert_eq!(lines(svg), [0usize; 0], "two lights make no line");
    assert!(svg.contains("12.0 stops") && svg.contains("they differ in more than their range"));
}

#[test]
fn an_error_that_saturates_is_said_to_be_level_from_there() {
    let mut made = Made::new(&["environment", "environment_clip_log2", "method", "samples"]);
    let mut lights = "environment,environment_clip_log2,mean_luminance,peak_luminance,dynamic_range_stops\n".to_owned();
    for (clip, error) in [0.01, 0.1, 0.5, 0.55, 0.5, 0.52].into_iter().enumerate() {
        lights += &format!("builtin:sky,{clip},1,{},{clip}\n", 1 << clip);
        made.add(&["builtin:sky", &clip.to_string(), "split-sum", ""], error);
    }
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("environments.csv"), lights).unwrap();
    let sentence = made.answers(dir.path(), [1.0; 3]).1.record.answer.sentence;
    let expected = "The error of split-sum in sky grows from 0.010 at 0 stops to 0.50 at 2.0 stops, and is level beyond (within a factor of 1.1 \
                    up to 5.0 stops).";
    assert_eq!(sentence, expected);
}

#[test]
fn pairs_of_one_case_count_once_whatever_else_is_swept() {
    // The effect is 2 in one case and 8 in the other, at each of three sizes of another table.
    let mut made = Made::new(&["alpha", "method", "prefilter_size", "dfg_size"]);
    for (alpha, factor) in [("0.1", 2.0), ("0.5", 8.0)] {
        for (dfg, own) in [("32", 1.0), ("64", 1.5), ("128", 0.5)] {
            made.add(&[alpha, "split-sum", "256x128", dfg], own);
            made.add(&[alpha, "split-sum", "64x32", dfg], own * factor);
        }
    }
    let (answers, _) = made.answers(tempfile::tempdir().unwrap().path(), [1.0; 3]);
    let is_own = |e: &&Effect| e.axis == "prefilter_size" && e.alpha.is_none();
    let effect = answers.effects.iter().find(is_own).unwrap();
    assert!(effect.n == 2 && (effect.ratio - 4.0).abs() < 1e-9 && effect.interval[1] > 1e3, "{effect:?}");
}

#[test]
fn values_with_names_are_called_by_them() {
    let mut made = Made::new(&["alpha", "method", "samples", "lod_bias"]);
    for alpha in ["0.1", "0.5"] {
        for (bias, error) in [("0", 1.0), ("0.5", 1.2), ("1", 2.0), ("1.2924812503605780", 3.0)] {
            made.add(&[alpha, "sampled", "40", bias], error);
        }
    }
    let facts = made.answers(tempfile::tempdir().unwrap().path(), [1.0; 3]).1.record.answer.facts;
    let said = "Presets of engines for lod_bias, as multiples of the error of sampled 40 with 0: filament ×2.00 (1, 95 % 2.00 to 2.00), \
                godot ×3.00 (1.292, 95 % 3.00 to 3.00).";
    assert!(facts.iter().any(|fact| fact == said), "{facts:?}");
}

#[test]
fn bias_that_outweighs_the_noise_is_counted() {
    let header = "alpha,method,samples,relmse,relmse_noise_floor,flip,verdict,var_hat_rel,bias2_hat_rel";
    let dir = tempfile::tempdir().unwrap();
    let mut made = Made::new(&["alpha", "method", "samples"]);
    for alpha in ["0.1", "0.5"] {
        for n in ["30", "40"] {
            made.add(&[alpha, "sampled", n], 0.5);
        }
    }
    made.write(dir.path(), [1.0; 3]);
    let rows = ["0.1,sampled,30,0.5,0,0.1,resolved,0.3,0.2", "0.5,sampled,30,0.5,0,0.1,resolved,0.2,0.3"];
    let more = ["0.1,sampled,40,0.5,0,0.1,resolved,0.1,0.2", "0.5,sampled,40,0.5,0,0.1,resolved,0.1,0.3"];
    let written = std::fs::read_to_string(dir.path().join("errors.csv")).unwrap();
    let ids: Vec<&str> = written.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    // In the order of the cells: alpha, then count.
    let own = [rows[0], more[0], rows[1], more[1]];
    let text: Vec<String> = ids.iter().zip(own).map(|(id, row)| format!("{id},{row}")).collect();
    std::fs::write(dir.path().join("errors.csv"), format!("cell,{header}\n{}\n", text.join("\n"))).unwrap();
    let facts = Answered::of_run(dir.path()).unwrap().record.answer.facts;
    let said = "With sampled the bias, which more samples cannot remove, outweighs the noise in 1 of 2 cases at 30 and 2 of 2 cases at 40.";
    assert!(facts.iter().any(|fact| fact == said), "{facts:?}");
}

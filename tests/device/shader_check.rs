//! `shader_check`: a known error of a function is found, with its size and sign.

use crate::harness::with_pipeline;
use splitsum::bake::judge::shader::{ErrorKind, Row, ShaderVerdict, View, check};
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::MaskingShadowing;
use splitsum::instrument::pipeline::Pipeline;
use splitsum::instrument::shade::{Method, from_file};

fn rows(pipeline: &mut Pipeline, method: &'static Method) -> Vec<Row> {
    check(pipeline, method, MaskingShadowing::Correlated).unwrap()
}

fn verdict(rows: &[Row]) -> String {
    ShaderVerdict::new(rows).to_string()
}

fn rows_of_file(pipeline: &mut Pipeline, name: &str, text: &str) -> Vec<Row> {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join(name), text).unwrap();
    rows(
        pipeline,
        from_file::load_function(&format!("file:{name}"), dir.path(), "ibl").unwrap(),
    )
}

/// The textbook's split sum with other statements before the lookup, and a factor.
fn glsl(statements: &str, factor: &str) -> String {
    format!(
        "#include \"lib/split_sum.glsl\"
        vec3 ibl(vec3 n, vec3 v, float r, vec3 f0) {{
            vec2 a_b = albedo_pair(dfg, dot(n, v), r * r);
            vec3 direction = reflect(-v, n);
            {statements}
            return prefiltered_radiance(direction, r) * (f0 * a_b.x + a_b.y) * {factor};
        }}"
    )
}

/// Asserts that what `error` finds in pairs of views is at most `most`, and at most a tenth of it
/// in half of them: lookups err more beside the corners of the cube.
fn assert_small(own: &[Row], base: &[Row], most: f64, error: impl Fn(&Row, &View, &View) -> f64) {
    for (row, base) in own.iter().zip(base) {
        let mut errors: Vec<f64> = row
            .views
            .iter()
            .zip(&base.views)
            .map(|(own, base)| error(row, own, base).abs())
            .collect();
        errors.sort_by(f64::total_cmp);
        let [median, worst] = [errors[errors.len() / 2], errors[errors.len() - 1]];
        assert!(
            worst <= most && median <= 0.1 * most,
            "alpha {}, f0 {}: {median} {worst}",
            row.alpha,
            row.f0
        );
    }
}

/// At alpha 1 with F = 1 and separable masking the lobe is `1/(π (1 + n·v) (1 + n·l))`: its first
/// moment is along n, and the mirror direction off by the angle of the view.
#[test]
fn the_textbook_errs_by_the_angle_of_the_view_at_alpha_1() {
    with_pipeline(|pipeline| {
        let rows = check(
            pipeline,
            Method::listed("split-sum"),
            MaskingShadowing::Separable,
        )
        .unwrap();
        let row = rows
            .iter()
            .position(|row| (row.alpha, row.f0) == (1.0, 1.0))
            .unwrap();
        let row = &rows[row..=row];
        assert_small(row, row, 0.4, |_, own, _| {
            own.errors.direction - own.n_dot_v.acos().to_degrees()
        });
        assert_small(&rows, &rows, 2e-3, |_, own, _| own.errors.gain);
        let words = verdict(&rows);
        assert!(
            words.contains("degrees towards the mirror direction at alpha 1, f0 1"),
            "{words}"
        );
    });
}

#[test]
fn a_fitted_lookup_errs_less_than_the_textbook() {
    with_pipeline(|pipeline| {
        let [one, textbook] =
            ["split-sum-one", "split-sum"].map(|name| rows(pipeline, Method::listed(name)));
        for (one, textbook) in one.iter().zip(&textbook) {
            let [error, textbook_error] = [one, textbook]
                .map(|row| row.ranked(ErrorKind::Direction)[0].errors.direction.abs());
            assert!(
                error < textbook_error,
                "alpha {}, f0 {}: {error} {textbook_error}",
                one.alpha,
                one.f0
            );
        }
    });
}

#[test]
fn a_known_error_is_found_with_its_size() {
    with_pipeline(|pipeline| {
        let plain = rows(pipeline, Method::listed("split-sum"));
        assert_small(&plain, &plain, 2e-3, |_, own, _| own.errors.gain);
        let bright = rows_of_file(pipeline, "bright.glsl", &glsl("", "1.1"));
        assert_small(&bright, &plain, 1e-3, |_, own, base| {
            (1.0 + own.errors.gain) / (1.0 + base.errors.gain) - 1.1
        });
        assert_small(&bright, &plain, 1e-2, |_, own, base| {
            own.errors.direction - base.errors.direction
        });
        assert!(
            verdict(&bright).starts_with("wrong: 10.")
                && verdict(&bright).contains("% too bright at every alpha")
        );
        let pi = rows_of_file(pipeline, "pi.glsl", &glsl("", "3.14159265"));
        assert!(
            verdict(&pi).starts_with("wrong: times pi at every alpha and f0"),
            "{}",
            verdict(&pi)
        );

        // Towards the normal, in the plane of incidence.
        let turn = "vec3 side = normalize(n - dot(n, direction) * direction);
            direction = cos(radians(5.0)) * direction + sin(radians(5.0)) * side;";
        let turned = rows_of_file(pipeline, "turned.glsl", &glsl(turn, "1.0"));
        assert_small(&turned, &plain, 0.8, |_, own, base| {
            base.errors.direction - own.errors.direction - 5.0
        });
        assert_small(&turned, &plain, 1e-3, |_, own, base| {
            own.errors.gain - base.errors.gain
        });

        // The next rougher level of the five.
        let blurred = rows_of_file(
            pipeline,
            "blurred.glsl",
            &glsl("r = min(r + 0.25, 1.0);", "1.0"),
        );
        let expected = |row: &Row| (row.alpha.sqrt() + 0.25).min(1.0).powi(2);
        assert_small(&blurred, &plain, 1e-2, |row, own, _| {
            own.alpha / expected(row) - 1.0
        });
        assert_small(&plain, &plain, 1e-2, |row, own, _| {
            own.alpha / row.alpha - 1.0
        });
        let words = verdict(&blurred);
        assert!(
            words.contains("the level is too blurred (as of alpha 0.25 for 0.06) at alpha 0.0625"),
            "{words}"
        );
    });
}

/// The same function in both languages; names of the file may be ours.
#[test]
fn a_function_in_wgsl_is_the_same_function() {
    let wgsl = "const PI: f32 = 2.0;
        fn reflectance(f0: vec3f, a_b: vec2<f32>) -> vec3f { return f0 * a_b.x + a_b.y; }
        fn ibl(n: vec3f, v: vec3f, r: f32, f0: vec3f) -> vec3f {
            var direction = mix(reflect(-v, n), n, r / PI);
            return prefiltered_radiance(normalize(direction), r) * reflectance(f0, \
            albedo_pair(dot(n, v), r));
        }";
    with_pipeline(|pipeline| {
        let glsl = glsl("direction = normalize(mix(direction, n, r / 2.0));", "1.0");
        let [glsl, wgsl] = [("a.glsl", &*glsl), ("a.wgsl", wgsl)]
            .map(|(name, text)| rows_of_file(pipeline, name, text));
        assert_small(&wgsl, &glsl, 1e-4, |_, own, base| {
            own.errors.gain - base.errors.gain
        });
        assert_small(&wgsl, &glsl, 1e-2, |_, own, base| {
            own.errors.direction - base.errors.direction
        });
    });
}

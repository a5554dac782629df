//! Verdicts of the judge of bakes: errors, axes, widths and gains, conventions of tables and SH, on
//! bakes made here.

use super::files::faces;
use glam::{DVec2, DVec3};
use splitsum::bake::convention::{Axes, Convention, PRESETS, Preset, TABLE_AXES, TABLE_CHANNELS};
use splitsum::bake::judge::{Judging, Limits, Truth, guess, level, sh as sh_score, table};
use splitsum::bake::{Bake, Map, Stated, sh};
use splitsum::base::glsl::constants::ALPHA_MIN;
use splitsum::base::math::equirect::direction_from_uv;
use splitsum::base::math::equirect_quadrature::EquirectQuadrature;
use splitsum::base::math::quadrature::Tolerance;
use splitsum::base::math::spherical_harmonics::{DEGREE, irradiance};
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::brdf::{Ggx, MaskingShadowing};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::precompute::dfg::chebyshev;
use splitsum::instrument::precompute::dfg::reference::{dfg_by, dfg_within};
use splitsum::instrument::precompute::prefilter::reference::prefilter;
use splitsum::instrument::precompute::prefilter::{Kernel, harmonic};
use splitsum::instrument::precompute::sh9::reference::turned;
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::Path;

/// Six broad lights of their own colours on a floor, and a small hot one off every axis and plane
/// of symmetry.
pub fn marked_light() -> Environment {
    let lights = [
        (DVec3::X, DVec3::new(4.0, 0.5, 0.5)),
        (-DVec3::X, DVec3::new(0.5, 2.0, 2.5)),
        (DVec3::Y, DVec3::new(0.5, 6.0, 0.5)),
        (-DVec3::Y, DVec3::new(1.0, 0.2, 1.0)),
        (DVec3::Z, DVec3::new(0.5, 0.5, 8.0)),
        (-DVec3::Z, DVec3::new(3.0, 3.0, 0.2)),
    ];
    let hot = DVec3::new(0.35, 0.6, 0.72).normalize();
    light_of(|d| {
        let broad: DVec3 = lights
            .iter()
            .map(|(axis, color)| *color * (8.0 * (d.dot(*axis) - 1.0)).exp())
            .sum();
        let sharp = DVec3::splat(60.0) * (200.0 * (d.dot(hot) - 1.0)).exp();
        broad + sharp + 0.05
    })
}

/// A map of 128x64 texels by their directions.
pub fn light_of(radiance: impl Fn(DVec3) -> DVec3) -> Environment {
    let uv = |x: u32, y: u32| (DVec2::new(x.into(), y.into()) + 0.5) / DVec2::new(128.0, 64.0);
    let texel = |x, y| radiance(direction_from_uv(uv(x, y))).as_vec3().to_array();
    Environment::from_image("made", RgbImage::from_fn(128, 64, texel))
}

const ALPHAS: [f64; 3] = [0.1, 0.2, 0.6];

/// The exact levels of the marked light, as a file with those axes.
fn exact_map(truth: &Truth, layout: usize, axes: Axes, change: impl Fn(f64) -> (f64, f64)) -> Map {
    let layout = &LAYOUTS[layout];
    let level = |alpha: &f64| {
        let (alpha, gain) = change(*alpha);
        let (map, width) = (
            truth.prefiltered(alpha),
            if layout.name == "equirect" { 48 } else { 24 },
        );
        faces(layout, [width, 24], |d| gain * map.value(axes.to_world(d)))
    };
    Map {
        layout,
        levels: ALPHAS.iter().map(level).collect(),
    }
}

#[test]
fn every_orientation_is_found_in_every_layout() {
    let light = marked_light();
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &ALPHAS);
    let mut convention = PRESETS[0].convention();
    convention.alphas = Some(ALPHAS.to_vec());
    assert_eq!(Axes::all().count(), 48);
    for (i, axes) in Axes::all().enumerate() {
        assert_eq!(Axes::parse(&axes.to_string()), Ok(axes));
        let d = DVec3::new(0.3, -0.5, 0.8);
        assert_eq!(axes.to_world(axes.to_file(d)), d);
        let map = exact_map(&truth, i % LAYOUTS.len(), axes, |alpha| (alpha, 1.0));
        let fits = guess::axes(&truth, &map, &convention).unwrap();
        assert_eq!(fits[0].axes, axes, "{fits:?}");
        assert!(
            fits[0].correlation > 0.99 && guess::is_clear(fits[0], fits[1]),
            "{fits:?}"
        );
        convention.axes = axes;
        for score in level::score(&truth, &map, &convention).unwrap() {
            assert!(
                score.errors.relmse < 1e-12 && score.errors.bias_rel.abs() < 1e-6,
                "{score:?}"
            );
        }
    }
}

/// Under one hot texel the judge is nearer to adaptive cubature than the series of a bake, so it
/// can judge our own bakes.
#[test]
fn the_judge_is_more_exact_than_the_judged_bake() {
    let sun = |x: u32, y: u32| {
        if [x, y] == [80, 12] {
            [1e4; 3]
        } else {
            [0.5; 3]
        }
    };
    let light = Environment::from_image("sun", RgbImage::from_fn(128, 64, sun));
    let directions: Vec<DVec3> = [[80.5, 12.5], [84.0, 14.0], [80.5, 44.5]]
        .map(|[x, y]: [f64; 2]| direction_from_uv(DVec2::new(x, y) / DVec2::new(128.0, 64.0)))
        .to_vec();
    let quadrature = EquirectQuadrature::new(128, 64, |x, y| light.image.get(x, y));
    let tolerance = Tolerance {
        relative: 1e-5,
        max_part_count: 100_000,
    };
    for alpha in [0.1, 1.0] {
        let off = [Truth::new, Truth::judging].map(|truth| {
            let map = truth(&light, Kernel::cosine(&Ggx), &[alpha]).prefiltered(alpha);
            let off = |direction: &DVec3| {
                let exact = prefilter(
                    &quadrature,
                    Kernel::cosine(&Ggx),
                    alpha,
                    *direction,
                    tolerance,
                )
                .value;
                ((map.value(*direction) - exact) / exact)
                    .abs()
                    .max_element()
            };
            directions.iter().map(off).fold(0.0, f64::max)
        });
        assert!(off[0] > 1e-7 && off[1] < 0.4 * off[0], "{alpha}: {off:?}");
    }
}

/// A bake of another width and gain gets both named, a bake of noise neither.
#[test]
fn a_fit_finds_the_width_and_the_gain_that_were_baked() {
    let light = marked_light();
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &ALPHAS);
    let mut convention = PRESETS[0].convention();
    convention.alphas = Some(ALPHAS.to_vec());
    let map = exact_map(&truth, 0, Axes::SAME, |alpha| (1.5 * alpha, 1.25));
    for score in level::score(&truth, &map, &convention).unwrap() {
        let fit = score.fit.unwrap();
        assert!(
            (fit.alpha / (1.5 * score.alpha) - 1.0).abs() < 0.01,
            "{score:?}"
        );
        assert!(
            (fit.gain - 1.25).abs() < 0.003 && fit.left < 1e-3,
            "{score:?}"
        );
        assert!(
            score.verdict.to_string().contains("25.0 % too bright"),
            "{}",
            score.verdict
        );
    }
    let verdicts: Vec<String> = level::score(&truth, &map, &convention)
        .unwrap()
        .into_iter()
        .map(|score| score.verdict.to_string())
        .collect();
    assert!(
        verdicts[0].starts_with("too blurred (alpha 0.150 for 0.100)"),
        "{verdicts:?}"
    );

    let mut noisy = exact_map(&truth, 0, Axes::SAME, |alpha| (alpha, 1.0));
    for (i, texel) in noisy
        .levels
        .iter_mut()
        .flatten()
        .flat_map(|face| &mut face.data)
        .enumerate()
    {
        // Column by column: a fit of every other column finds a gain.
        *texel = texel.map(|value| value * if i % 2 == 0 { 0.7 } else { 1.3 });
    }
    for score in level::score(&truth, &noisy, &convention).unwrap() {
        // d = 0.3 r where r² is far above ε.
        assert!(
            score.errors.relmse > 0.04 && score.errors.relmse < 0.09,
            "{score:?}"
        );
        assert!(
            score
                .verdict
                .to_string()
                .contains("noise from texel to texel"),
            "{}",
            score.verdict
        );
    }
    let lost = exact_map(&truth, 0, Axes::SAME, |alpha| {
        (alpha, 1.0 / std::f64::consts::PI)
    });
    let score = &level::score(&truth, &lost, &convention).unwrap()[0];
    assert!(
        score.verdict.to_string().contains("times 1/pi"),
        "{}",
        score.verdict
    );
    assert!(
        (score.errors.bias_rel - (1.0 / std::f64::consts::PI - 1.0)).abs() < 1e-6,
        "{score:?}"
    );
}

/// Under a hot lamp, whose lobe is not a mirror's, the environment identifies a mirror level, and a
/// level of another width identifies its width.
#[test]
fn a_light_is_known_by_a_mirror_and_by_levels_of_other_widths() {
    let mut image = marked_light().image;
    image.data[12 * 128 + 80] = [3e4; 3];
    let light = Environment::from_image("lamp", image);
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &ALPHAS);
    let mut convention = PRESETS[0].convention();
    let mut known = |alphas: &[f64], map: &Map| {
        convention.alphas = Some(alphas.to_vec());
        let fits = guess::axes(&truth, map, &convention).unwrap();
        assert!(
            fits[0].axes == Axes::SAME && fits[0].correlation > guess::SAME_LIGHT,
            "{fits:?}"
        );
        let dark = |face: &RgbImage| face.map(|texel| texel.map(|x| x / 1024.0));
        let dark = map
            .levels
            .iter()
            .map(|faces| faces.iter().map(dark).collect())
            .collect();
        let of_dark = guess::axes(
            &truth,
            &Map {
                layout: map.layout,
                levels: dark,
            },
            &convention,
        )
        .unwrap();
        assert!(
            (of_dark[0].correlation - fits[0].correlation).abs() < 1e-6,
            "a gain changes nothing"
        );
    };
    let mirror = faces(&LAYOUTS[0], [64; 2], |d| light.radiance(d));
    known(
        &[0.0],
        &Map {
            layout: &LAYOUTS[0],
            levels: vec![mirror],
        },
    );
    known(
        &[0.3, 0.5, 1.0],
        &exact_map(&truth, 0, Axes::SAME, |alpha| (alpha, 1.0)),
    );
}

/// Unity reads seven levels of any cube. What files say about another preset does not count.
#[test]
fn levels_of_unity_are_sixths() {
    let unity = Preset::listed("unity").convention();
    let stated = Stated {
        preset: Some("bevy".to_owned()),
        alphas: Some(vec![0.5]),
        ..Stated::default()
    };
    let by = |name: &str| {
        Judging::by(Preset::listed(name), &stated)
            .unwrap()
            .convention
            .alphas
    };
    assert_eq!(
        (by("unity"), by("bevy")),
        (unity.alphas.clone(), stated.alphas.clone())
    );
    let by = |count: usize| unity.alphas(count).unwrap();
    assert_eq!(
        (by(7)[..7].to_vec(), by(8)[6..].to_vec()),
        (by(9)[..7].to_vec(), vec![1.0, 1.0])
    );
    for (k, alpha) in by(3).into_iter().enumerate() {
        // m(r) = r (1.7 - 0.7 r) is k/6.
        let r = alpha.sqrt();
        assert!((r * (1.7 - 0.7 * r) - k as f64 / 6.0).abs() < 1e-12);
    }
}

/// One texel a face, exact at its centre: a quarter of a face away a lookup blends it with two
/// neighbours and their corner.
#[test]
fn lookups_between_texels_are_judged() {
    let light = marked_light();
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &ALPHAS);
    let mut convention = PRESETS[0].convention();
    (convention.alphas, convention.scale) = (Some(ALPHAS.to_vec()), 0.5);
    let exact = |alpha, direction: DVec3| truth.prefiltered(alpha).value(direction);
    let level = |alpha: &f64| faces(&LAYOUTS[0], [1; 2], |d| exact(*alpha, d) / 0.5);
    let map = Map {
        layout: &LAYOUTS[0],
        levels: ALPHAS.iter().map(level).collect(),
    };
    let unit = |axis: usize, sign: f64| {
        DVec3::from_array(std::array::from_fn(|i| if i == axis { sign } else { 0.0 }))
    };
    for score in level::score(&truth, &map, &convention).unwrap() {
        let mut squares = Vec::new();
        for (axis, [a, b, c]) in (0..3)
            .flat_map(|axis| [1.0, -1.0].map(|a| (axis, a)))
            .flat_map(|(axis, a)| {
                [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[b, c]| (axis, [a, b, c]))
            })
        {
            let axes = [
                unit(axis, a),
                unit((axis + 1) % 3, b),
                unit((axis + 2) % 3, c),
            ];
            let [own, left, right] = axes.map(|axis| exact(score.alpha, axis));
            let found =
                0.5625 * own + 0.1875 * (left + right) + 0.0625 * (own + left + right) / 3.0;
            let right = exact(
                score.alpha,
                (axes[0] + 0.5 * (axes[1] + axes[2])).normalize(),
            );
            let relative =
                (found - right).powf(2.0) / (right.powf(2.0) + truth.epsilon().squared_epsilon());
            squares.push(relative.element_sum() / 3.0);
        }
        let expected = squares.iter().sum::<f64>() / squares.len() as f64;
        let between = score.between.unwrap();
        assert!(
            (between / expected - 1.0).abs() < 1e-5,
            "{between} {expected}"
        );
        assert!(
            score.errors.relmse < 1e-12 && score.coarseness().is_some(),
            "{score:?}"
        );
    }
    // The verdict names the largest; irradiance has a scale of its own.
    let judging = Judging {
        brdf: &Ggx,
        convention: Convention {
            irradiance_scale: 2.0,
            ..convention
        },
    };
    let (kernel, alpha) = Truth::of_irradiance();
    let exact = Truth::new(&light, kernel, &[alpha]).prefiltered(alpha);
    let half = faces(&LAYOUTS[0], [1; 2], |d| exact.value(d) / 2.0);
    let irradiance = Some(Map {
        layout: &LAYOUTS[0],
        levels: vec![half],
    });
    let bake = Bake {
        specular: Some(map),
        irradiance,
        ..Bake::default()
    };
    let judged = judging.judge(&light, &bake, |_| ()).unwrap();
    let most = judged
        .levels
        .iter()
        .filter_map(|score| score.between)
        .fold(0.0, f64::max);
    let (said, most) = (judged.verdict(), 100.0 * most.sqrt());
    assert!(
        said.ends_with(&format!("err by up to {most:.1} % rms")),
        "{said}"
    );
}

#[test]
fn bands_are_the_convolution() {
    let light = marked_light();
    let harmonics = harmonic::harmonics(&light.image, 160);
    let factors = harmonic::factors(Kernel::cosine(&Ggx), 0.1, 160);
    let map = harmonics.convolved(&factors);
    let directions: Vec<DVec3> = Axes::all()
        .map(|axes| axes.to_world(DVec3::new(0.2, 0.5, -0.9).normalize()))
        .collect();
    for (direction, bands) in directions.iter().zip(harmonics.bands(160, &directions)) {
        let sum: DVec3 = bands
            .iter()
            .zip(&factors)
            .map(|(band, factor)| *band * *factor)
            .sum();
        assert!(
            (sum - map.value(*direction)).abs().max_element() < 1e-7,
            "{sum} {}",
            map.value(*direction)
        );
    }
}

/// cmgen's polynomials give irradiance over π; our reader gives the same from its file.
#[test]
fn coefficients_of_cmgen_are_irradiance_by_its_polynomials() {
    let numbers: [[f64; 3]; 9] = std::array::from_fn(|k| {
        [
            0.5 - 0.1 * k as f64,
            0.2 + 0.05 * k as f64,
            -0.3 + 0.11 * k as f64,
        ]
    });
    let line = |[r, g, b]: &[f64; 3]| {
        format!("({r:.15}, {g:.15}, {b:.15}); // L, irradiance, pre-scaled base\n")
    };
    let text: String = numbers.iter().map(line).collect();
    let found = sh::parse(Path::new("sh.txt"), &text).unwrap();
    // The same numbers without a word, as shaders have them.
    let bare: String = numbers
        .iter()
        .map(|[r, g, b]| format!("{{ {r:.15}f, {g:.15}f, {b:.15}f }},\n"))
        .collect();
    assert_eq!(sh::parse(Path::new("sh.txt"), &bare).unwrap(), found);
    let refused = sh::parse(Path::new("sh.txt"), "1 2 3 4").unwrap_err();
    assert!(
        refused.to_string().contains("it has 4 numbers"),
        "{refused}"
    );
    for axes in Axes::all() {
        let n = axes.to_world(DVec3::new(0.48, -0.6, 0.64));
        let DVec3 { x, y, z } = n;
        let polynomials = [
            1.0,
            y,
            z,
            x,
            y * x,
            y * z,
            3.0 * z * z - 1.0,
            z * x,
            x * x - y * y,
        ];
        let expected: DVec3 = numbers
            .iter()
            .zip(polynomials)
            .map(|(c, p)| DVec3::from_array(*c) * p)
            .sum();
        let own = irradiance(&found.radiance, n) / std::f64::consts::PI;
        assert!(
            (own - expected).abs().max_element() < 1e-12,
            "{own} {expected}"
        );
    }
    for (name, text, part) in [
        ("sh.txt", "", "it has 0 coefficients"),
        (
            "sh.txt",
            "(1, 2); // irradiance, pre-scaled",
            "line 1 is not a coefficient",
        ),
        (
            "sh.txt",
            "( 1, 2, 3); // L00, radiance",
            "line 1 is not a coefficient",
        ),
        (
            "sh.txt",
            "( 1, 2, 3); // L00, irradiance",
            "line 1 is not a coefficient",
        ),
        (
            "sh.json",
            "{\"radiance\": [[1, 2, 3]]}",
            "\"radiance\" has 1 triples",
        ),
        ("sh.json", "{", "cannot be read"),
    ] {
        let message = sh::parse(Path::new(name), text).unwrap_err().to_string();
        assert!(
            message.contains(part) && message.contains(name),
            "{message}"
        );
    }
}

#[test]
fn coefficients_of_the_light_itself_have_no_error_and_windows_are_named() {
    let light = marked_light();
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &[]);
    let quadrature =
        splitsum::base::math::equirect_quadrature::EquirectQuadrature::new(128, 64, |x, y| {
            light.image.get(x, y)
        });
    let radiance = splitsum::instrument::precompute::sh9::reference::project_bilinear(&quadrature);
    let of = |radiance| {
        sh_score::score(
            &truth,
            &sh::Coefficients {
                radiance,
                factors: [1.0; 9],
            },
            Axes::SAME,
        )
    };
    let exact = of(radiance);
    assert!(
        exact.errors.relmse < 1e-12
            && exact.max_error < 1e-3
            && exact.verdict.to_string().starts_with("good"),
        "{exact:?}"
    );
    let sh = Some(sh::Coefficients {
        radiance: radiance.map(|x| 2.0 * x),
        factors: [1.0; 9],
    });
    let judging = Judging::stated(&Stated::default()).unwrap();
    let judged = judging
        .judge(
            &light,
            &Bake {
                sh,
                ..Bake::default()
            },
            |_| (),
        )
        .unwrap();
    assert_eq!(
        Limits {
            fail_above: Some(1e-3),
            ..Limits::default()
        }
        .failures(&judged)
        .len(),
        1
    );
    let window = [1.0, 0.9, 0.9, 0.9, 0.6, 0.6, 0.6, 0.6, 0.6];
    let windowed = of(std::array::from_fn(|k| radiance[k] * window[k]));
    assert!(
        windowed
            .verdict
            .to_string()
            .contains("degree 1 times 0.90, degree 2 times 0.60"),
        "{windowed:?}"
    );
    // Other orders and signs, and a lost convolution.
    let (order, unconvolved) = ([0, 3, 2, 1, 8, 7, 6, 5, 4], [1.0, 1.5, 4.0]);
    let unscaled = [
        0.282_095, 0.488_603, 0.488_603, 0.488_603, 1.092_548, 1.092_548, 0.315_392, 1.092_548,
        0.546_274,
    ];
    let planar = |place: usize| radiance[place % 9][place / 9];
    let forms: [(&str, &dyn Fn(usize) -> DVec3); 6] = [
        ("one channel after the other", &|k| {
            DVec3::from_array([0, 1, 2].map(|c| planar(3 * k + c)))
        }),
        ("not pre-scaled by the factors of the basis", &|k| {
            radiance[k] / unscaled[k]
        }),
        ("order m = l to -l", &|k| radiance[order[k]]),
        ("odd m have the other sign", &|k| {
            if k % 2 == 1 {
                -radiance[k]
            } else {
                radiance[k]
            }
        }),
        ("not convolved with the cosine", &|k| {
            radiance[k] * unconvolved[DEGREE[k]]
        }),
        ("in the order B, G, R; times 2", &|k| {
            2.0 * DVec3::new(radiance[k].z, radiance[k].y, radiance[k].x)
        }),
    ];
    for (words, form) in forms {
        let verdict = of(std::array::from_fn(form)).verdict.to_string();
        assert!(verdict.contains(words), "{words}: {verdict}");
    }
    // With maps of another light no factor is named, but axes that explain the error are.
    let mirrored = Axes::parse("-x+y+z").unwrap();
    let mut mirrored = sh_score::score(
        &truth,
        &sh::Coefficients {
            radiance: turned(&radiance, |d| mirrored.to_world(d)),
            factors: [1.0; 9],
        },
        Axes::SAME,
    );
    let mut doubted = windowed;
    for score in [&mut doubted, &mut mirrored] {
        score.doubt();
    }
    assert!(
        !doubted.verdict.to_string().contains("times"),
        "{doubted:?}"
    );
    assert!(
        mirrored.verdict.causes()[0].kind() == "axes"
            && mirrored.verdict.to_string().contains("-x+y+z"),
        "{mirrored:?}"
    );
}

/// The search identifies any axes, channels and masking of a table, and the shift of a shifted one.
#[test]
fn conventions_of_a_table_are_found() {
    // Most tables hold the same numbers in other places.
    let known = RefCell::new(HashMap::new());
    let table =
        |way: usize, channels: usize, masking: MaskingShadowing, node: fn(DVec2) -> DVec2| {
            RgbImage::from_fn(16, 16, |x, y| {
                let at = TABLE_AXES[way]
                    .parameters(node(DVec2::new(x.into(), y.into())))
                    .clamp(DVec2::splat(1e-3), DVec2::ONE);
                // No narrower than the device shades.
                let alpha = (at.y * at.y).max(ALPHA_MIN.into());
                let exact = || dfg_within(&Ggx, masking, at.x, alpha, 1e-5);
                let exact = *known
                    .borrow_mut()
                    .entry(at.to_array().map(f64::to_bits))
                    .or_insert_with(exact);
                let (a, b) = (exact.f0_scale as f32, exact.f90_scale as f32);
                [[a, b, 0.0], [b, a, 0.0], [b, a + b, 0.0]][channels]
            })
        };
    let (correlated, centres) = (MaskingShadowing::Correlated, |at: DVec2| (at + 0.5) / 16.0);
    for way in 0..TABLE_AXES.len() {
        let found = table::search(&table(way, way % 3, correlated, centres), &Ggx).swap_remove(0);
        let names = (found.axes.name, found.channels.name, found.masking.name());
        assert_eq!(
            names,
            (
                TABLE_AXES[way].name,
                TABLE_CHANNELS[way % 3].name,
                "correlated"
            ),
            "{:e}",
            found.rms
        );
    }
    let mut convention = PRESETS[0].convention();
    convention.masking = correlated;
    let exact = table::score(&table(0, 0, correlated, centres), &Ggx, &convention);
    assert!(
        exact.max_error < 1e-5 && exact.verdict.to_string().starts_with("good"),
        "{exact:?}"
    );
    let off = table(0, 0, correlated, centres).map(|pair| pair.map(|x| x + 0.01));
    let off = table::score(&off, &Ggx, &convention);
    assert!(
        (off.rms - 0.01).abs() < 1e-5 && (off.max_error - 0.01).abs() < 2e-5,
        "{off:?}"
    );
    type Nodes = fn(DVec2) -> DVec2;
    let moved: [(&str, Nodes); 4] = [
        ("1 texel too high", |at| (at + DVec2::new(0.5, 1.5)) / 16.0),
        ("0.5 texel too far right and too low", |at| at / 16.0),
        ("its texels are at i/(n - 1)", |at| at / 15.0),
        ("its rows are at i/(n - 1)", |at| {
            DVec2::new((at.x + 0.5) / 16.0, at.y / 15.0)
        }),
    ];
    for (words, nodes) in moved {
        let score = table::score(&table(0, 0, correlated, nodes), &Ggx, &convention);
        assert!(
            score.verdict.to_string().contains(words),
            "{words}: {score:?}"
        );
    }
    // Other integrals; at other n·v the table of direct light is nothing known.
    type Width = fn(f64) -> f64;
    type Facet = fn(f64, f64) -> [f64; 2];
    let (own, schlick): (Facet, _) = (|v_dot_h, _| [v_dot_h; 2], MaskingShadowing::Schlick);
    let integral = |masking: MaskingShadowing, of_masking: Width, facet: Facet, other: f64| {
        let texel = |x: u32, y: u32| {
            let at = (DVec2::new(x.into(), y.into()) + 0.5) / 16.0;
            let widths = [(at.y * at.y).max(ALPHA_MIN.into()), of_masking(at.y)];
            let pair = dfg_by(&Ggx, masking, at.x.powf(other), widths, 1e-3, facet);
            [pair.f0_scale as f32, pair.f90_scale as f32, 0.0]
        };
        table::score(&RgbImage::from_fn(16, 16, texel), &Ggx, &convention)
            .verdict
            .to_string()
    };
    let integrals: [(&str, MaskingShadowing, Width, Facet); 5] = [
        ("of direct light", schlick, |r| (r + 1.0).powi(2) / 4.0, own),
        ("k = alpha^2/2", schlick, |r| r.powi(4), own),
        ("k = alpha/4", schlick, |r| r * r / 2.0, own),
        (
            "Fresnel of n·h",
            correlated,
            |r| r * r,
            |v_dot_h, n_dot_h| [v_dot_h, n_dot_h],
        ),
        (
            "without the factor v·h",
            correlated,
            |r| r * r,
            |v_dot_h, _| [1.0, v_dot_h],
        ),
    ];
    for (words, masking, width, facet) in integrals {
        let verdict = integral(masking, width, facet, 1.0);
        assert!(verdict.contains(words), "{words}: {verdict}");
    }
    assert!(!integral(schlick, |r| (r + 1.0).powi(2) / 4.0, own, 2.0).contains("direct"));
    // Scale and bias the other way round, and decoded once too often.
    let decoded = table(0, 1, correlated, centres).map(|pair| pair.map(|x| x.powf(2.2)));
    let decoded = table::score(&decoded, &Ggx, &convention);
    assert!(
        decoded
            .verdict
            .to_string()
            .contains("--table-channels bias-scale; decoded with gamma 2.2"),
        "{decoded:?}"
    );
    let encoded = table(0, 0, correlated, centres).map(|pair| pair.map(|x| x.powf(1.0 / 2.2)));
    let encoded = table::score(&encoded, &Ggx, &convention);
    assert!(
        encoded
            .verdict
            .to_string()
            .contains("encoded with gamma 2.2")
            && encoded.verdict.causes()[0].kind() == "encoding",
        "{encoded:?}"
    );
    // A black row between the compared ones stands out.
    let exact = chebyshev::table(64, |at| table::exact(&Ggx, correlated, at, 1e-4));
    let mut whole = exact.map(|pair| [pair.x as f32, pair.y as f32, 0.0]);
    assert!(
        table::score(&whole, &Ggx, &convention)
            .verdict
            .to_string()
            .starts_with("good")
    );
    whole.data[30 * 64..31 * 64].fill([0.0; 3]);
    let black = table::score(&whole, &Ggx, &convention);
    assert!(
        black.max_error > 0.5 && !black.verdict.to_string().starts_with("good"),
        "{black:?}"
    );
}

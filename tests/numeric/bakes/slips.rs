//! The judge names slips that are put into an exact bake.

use super::files::faces;
use super::scores::{light_of, marked_light};
use glam::{DVec3, Vec3Swizzles};
use splitsum::bake::convention::{Axes, Preset};
use splitsum::bake::judge::{Judged, Judging, Limits, Truth, as_json};
use splitsum::bake::{Bake, Map, Stated, TexelOrder, sh};
use splitsum::base::math::equirect::direction_from_uv;
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::brdf::{Beckmann, Brdf, Ggx, Phong};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::precompute::prefilter::{Kernel, WEIGHTS};
use std::f64::consts::PI;

pub const SIDE: u32 = 24;
const ALPHAS: [f64; 3] = [0.1, 0.2, 0.6];
const TWO: [f64; 2] = [0.2, 0.6];

pub fn of_levels(levels: Vec<Vec<RgbImage>>) -> Map {
    Map {
        layout: &LAYOUTS[0],
        levels,
    }
}

/// The exact cube of these widths, along turned directions.
pub fn cube(truth: &Truth, alphas: &[f64], turn: impl Fn(DVec3) -> DVec3) -> Map {
    let level = |alpha: &f64| {
        let map = (*alpha > 0.0).then(|| truth.prefiltered(*alpha));
        let value = |d| {
            map.as_ref()
                .map_or_else(|| truth.environment.radiance(d), |map| map.value(d))
        };
        faces(&LAYOUTS[0], [SIDE; 2], |d| value(turn(d)))
    };
    of_levels(alphas.iter().map(level).collect())
}

pub fn exact(truth: &Truth, alphas: &[f64]) -> Map {
    cube(truth, alphas, |direction| direction)
}

pub fn judged_bake(light: &Environment, bake: Bake, alphas: Option<&[f64]>) -> Judged {
    let mut judging = Judging::stated(&Stated::default()).unwrap();
    judging.convention.alphas = alphas.map(<[f64]>::to_vec);
    judging.judge(light, &bake, |_| ()).unwrap()
}

pub fn judged(light: &Environment, map: Map, alphas: Option<&[f64]>) -> Judged {
    judged_bake(
        light,
        Bake {
            specular: Some(map),
            ..Bake::default()
        },
        alphas,
    )
}

fn assert_named(judged: &Judged, words: &str) {
    let verdict = judged.verdict();
    assert!(verdict.contains(words), "{words}: {verdict}");
}

pub fn each_texel(map: &mut Map, change: impl Fn([f32; 3]) -> [f32; 3]) {
    map.levels
        .iter_mut()
        .flatten()
        .flat_map(|face| &mut face.data)
        .for_each(|texel| *texel = change(*texel));
}

fn each_face(map: &mut Map, change: impl Fn(&mut Vec<RgbImage>)) {
    map.levels.iter_mut().for_each(change);
}

/// Puts texels of each face at other places of it.
fn each_place(map: &mut Map, from: impl Fn(u32, u32) -> [u32; 2]) {
    for face in map.levels.iter_mut().flatten() {
        *face = RgbImage::from_fn(SIDE, SIDE, |x, y| face.get(from(x, y)[0], from(x, y)[1]));
    }
}

/// A sun is few texels: relMSE hardly counts it, and it is most of the light.
#[test]
fn a_level_whose_mean_is_off_is_not_good() {
    let sun = DVec3::new(0.9, 0.1, 0.4).normalize();
    let light = light_of(|d| {
        DVec3::splat(if d.angle_between(sun) < 0.03 {
            1e4
        } else {
            1.0
        })
    });
    let right = of_levels(vec![faces(&LAYOUTS[0], [64; 2], |d| light.radiance(d))]);
    let alphas = Some(&[0.0][..]);
    assert_named(&judged(&light, right.clone(), alphas), "good");
    let mut cut = right.clone();
    each_texel(&mut cut, |rgb| rgb.map(|x| x.min(100.0)));
    assert_named(
        &judged(&light, cut, alphas),
        "level 0: cut at 100: its mean is off by -",
    );
    let mut bright = right;
    each_texel(&mut bright, |rgb| {
        rgb.map(|x| if x > 100.0 { 1.2 * x } else { x })
    });
    assert_named(
        &judged(&light, bright, alphas),
        "level 0: its mean is off by +",
    );
}

#[test]
fn slips_of_faces_and_texels_are_named() {
    let light = marked_light();
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &TWO);
    let right = exact(&truth, &TWO);
    type Slip = fn(&mut Map);
    let slips: &[(&str, Slip)] = &[
        ("good: every part", |_| ()),
        ("levels 0 to 1: face -z is black", |map| {
            each_face(map, |faces| faces[5].data.fill([0.0; 3]))
        }),
        ("faces +x and -z are swapped", |map| {
            each_face(map, |faces| faces.swap(0, 5))
        }),
        ("every face is flipped top to bottom", |map| {
            each_place(map, |x, y| [x, SIDE - 1 - y])
        }),
        // The top left texel of a face that was turned clockwise was at the bottom left.
        ("face +y is turned by 90° clockwise", |map| {
            each_face(map, |faces| {
                faces[2] = RgbImage::from_fn(SIDE, SIDE, |x, y| faces[2].get(y, SIDE - 1 - x))
            });
        }),
        // Two slips at once, and what is left without them.
        (
            "faces +x and -z are swapped; times pi: --scale 0.318; 0.0 % rms if fixed",
            |map| {
                each_face(map, |faces| faces.swap(0, 5));
                each_texel(map, |rgb| rgb.map(|x| x * PI as f32));
            },
        ),
        ("in the order B, G, R; encoded as sRGB", |map| {
            each_texel(map, |[r, g, b]| [b, g, r].map(srgb))
        }),
        ("levels 0 to 1: encoded as sRGB: decode it; 0.0 %", |map| {
            each_texel(map, |rgb| rgb.map(srgb))
        }),
        ("encoded with gamma 2.2: decode it; cut at 1", |map| {
            each_texel(map, |rgb| rgb.map(|x| x.powf(1.0 / 2.2).min(1.0)));
        }),
        (
            "--axes=-x+y+z; besides, levels 0 to 1: times 2: --scale 0.5",
            |map| {
                each_face(map, |faces| faces.swap(0, 1));
                each_place(map, |x, y| [SIDE - 1 - x, y]);
                each_texel(map, |rgb| rgb.map(|x| 2.0 * x));
            },
        ),
        ("every texel is black", |map| each_texel(map, |_| [0.0; 3])),
        ("channels in the order A, R, G", |map| {
            each_texel(map, |[r, g, _]| [1.0, r, g])
        }),
        ("luminance in every channel", |map| {
            each_texel(map, |rgb| [splitsum::base::color::luminance(rgb) as f32; 3])
        }),
        ("half floats read as 16-bit", |map| {
            each_texel(map, |rgb| {
                rgb.map(|x| f32::from(half::f16::from_f32(x).to_bits()) / 65535.0)
            });
        }),
        // The first level that is wrong by itself, then the mean of the level before it.
        ("level 1: channels in the order B, G, R", |map| {
            map.levels[1]
                .iter_mut()
                .flat_map(|face| &mut face.data)
                .for_each(|rgb| rgb.reverse());
        }),
        ("level 1: the mean of the level before it", |map| {
            let mean =
                |face: &RgbImage| face.area_means(SIDE / 2, SIDE / 2, |rgb| rgb.map(f64::from));
            map.levels[1] = map.levels[0]
                .iter()
                .map(|face| mean(face).map(|rgb| rgb.map(|x| x as f32)))
                .collect();
        }),
        (
            "face +x is black; face -z is black; times 2: --scale 0.5",
            |map| {
                each_face(map, |faces| {
                    [0, 5]
                        .iter()
                        .for_each(|face| faces[*face].data.fill([0.0; 3]))
                });
                each_texel(map, |rgb| rgb.map(|x| 2.0 * x));
            },
        ),
        ("times 8: --scale 0.125", |map| {
            each_texel(map, |rgb| rgb.map(|x| 8.0 * x))
        }),
        ("decoded with gamma 2.2", |map| {
            each_texel(map, |rgb| rgb.map(|x| x.powf(2.2)))
        }),
        ("red, green and blue times 2.00, 1.00 and 0.00", |map| {
            each_texel(map, |[r, g, _]| [2.0 * r, g, 0.0])
        }),
        ("levels 0 to 1: cut at 1; ", |map| {
            each_texel(map, |rgb| rgb.map(|x| x.min(1.0)))
        }),
        ("RGBM read", |map| {
            each_texel(map, |rgb| {
                let shared =
                    (255.0 * (rgb.into_iter().fold(0.0, f32::max) / 6.0).min(1.0)).ceil() / 255.0;
                rgb.map(|x| (x / 6.0 / shared).min(1.0))
            });
        }),
        ("RGBD read", |map| {
            each_texel(map, |rgb| {
                let divisor = (255.0 / rgb.into_iter().fold(0.0, f32::max))
                    .floor()
                    .clamp(1.0, 255.0)
                    / 255.0;
                rgb.map(|x| x * divisor)
            });
        }),
        // Larson's u' and v' by three.js's primaries, and the second byte of 2 log2 Y + 127.
        ("LogLuv read", |map| {
            each_texel(map, |[r, g, b]| {
                let [x, y, sum] = [
                    [0.2209, 0.1138, 0.0102],
                    [0.3390, 0.6780, 0.1130],
                    [0.4184, 0.7319, 0.2969],
                ]
                .map(|row: [f32; 3]| row[0] * r + row[1] * g + row[2] * b);
                [x / sum, y / sum, (2.0 * y.log2() + 127.0).floor() / 255.0]
            });
        }),
        ("faces in the order +x +y +z -x -y -z; expected", |map| {
            each_face(map, |faces| {
                *faces = [0, 2, 4, 1, 3, 5].map(|face| faces[face].clone()).to_vec()
            });
        }),
        ("encoded as ln(1 + x); 0.0 %", |map| {
            each_texel(map, |rgb| rgb.map(f32::ln_1p))
        }),
        // The constants of SMPTE ST 2084 as it states them.
        ("encoded as PQ with 1 at 100 nits; ", |map| {
            each_texel(map, |rgb| {
                rgb.map(|x| {
                    let y = (x / 100.0).powf(2610.0 / 16384.0);
                    let [c2, c3] = [2413.0, 2392.0].map(|c| c / 4096.0 * 32.0);
                    ((3424.0 / 4096.0 + c2 * y) / (1.0 + c3 * y)).powf(2523.0 / 4096.0 * 128.0)
                })
            });
        }),
        ("converted to CIE XYZ", |map| {
            each_texel(map, |[r, g, b]| {
                [
                    0.4124 * r + 0.3576 * g + 0.1805 * b,
                    0.2126 * r + 0.7152 * g + 0.0722 * b,
                    0.0193 * r + 0.1192 * g + 0.9505 * b,
                ]
            });
        }),
        // Bytes of Radiance's format.
        ("RGBE read", |map| {
            each_texel(map, |rgb| {
                let exponent = rgb.into_iter().fold(0.0, f32::max).log2().floor() as i32 + 1;
                rgb.map(|x| (x * 256.0 / 2.0_f32.powi(exponent)).floor() / 255.0)
            });
        }),
    ];
    for (words, slip) in slips {
        let mut map = right.clone();
        slip(&mut map);
        assert_named(&judged(&light, map, Some(&TWO)), words);
    }
    // One texel a face has neither a turn nor a few texels that stand out.
    let smooth = truth.prefiltered(0.6);
    let small = faces(&LAYOUTS[0], [1; 2], |d| smooth.value(d).zyx());
    let small = of_levels(vec![small; 2]);
    assert!(
        judged(&light, small, Some(&[0.6; 2]))
            .verdict()
            .contains("in the order B, G, R")
    );
}

fn srgb(x: f32) -> f32 {
    if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    }
}

#[test]
fn slips_of_the_light_and_of_the_kernel_are_named() {
    let light = marked_light();
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &TWO);
    // A lone sun that is turned is also near its mirror image.
    let sun = DVec3::new(0.70, 0.66, -0.28).normalize();
    let sunny = light_of(|d| 0.02 * light.radiance(d) + 500.0 * (300.0 * (d.dot(sun) - 1.0)).exp());
    let cases = [
        (
            &light,
            DVec3::Y,
            37.0_f64,
            "37° about y: lat-long offset 0.103",
        ),
        (&light, DVec3::X, -12.0, "-12° about x"),
        (&sunny, DVec3::Y, 36.0, "36° about y: "),
    ];
    for (light, axis, degrees, words) in cases {
        let turn = glam::DQuat::from_axis_angle(axis, degrees.to_radians());
        let turned = cube(
            &Truth::new(light, Kernel::cosine(&Ggx), &TWO),
            &TWO,
            |direction| turn * direction,
        );
        assert_named(
            &judged(light, turned, Some(&TWO)),
            &format!("turned by {words}"),
        );
    }
    type At = fn(f64, f64) -> f64;
    let grids: [(&str, At); 2] = [
        ("i/n; expected centres", |i, n| i / n),
        ("i/(n - 1), from edge to edge", |i, n| i / (n - 1.0)),
    ];
    for (words, at) in grids {
        let level = |alpha: &f64| {
            let map = truth.prefiltered(*alpha);
            let texel = |face, x: u32, y: u32| {
                let uv = glam::DVec2::new(at(x.into(), SIDE.into()), at(y.into(), SIDE.into()));
                map.value((LAYOUTS[0].direction)(face, uv))
                    .as_vec3()
                    .to_array()
            };
            (0..6)
                .map(|face| RgbImage::from_fn(SIDE, SIDE, |x, y| texel(face, x, y)))
                .collect()
        };
        let map = of_levels(ALPHAS[..2].iter().map(level).collect());
        assert_named(&judged(&light, map, Some(&ALPHAS[..2])), words);
    }
    // Levels of several sizes in the order of another format, as a reader of this one finds them.
    let levels = TWO.iter().zip([24, 12]).map(|(alpha, side)| {
        let map = truth.prefiltered(*alpha);
        faces(&LAYOUTS[0], [side; 2], |d| map.value(d))
    });
    let right = of_levels(levels.collect());
    let [by_level, by_face] = TexelOrder::ALL;
    for (right_order, read_as) in [(by_face, by_level), (by_level, by_face)] {
        let read = right.reordered(read_as);
        assert_named(&judged(&light, read, Some(&TWO)), &right_order.to_string());
    }
    // Convolutions keep the mean, which tells where a source was cut.
    type Change = fn([f32; 3]) -> [f32; 3];
    let sources: [(&str, Change); 9] = [
        ("cut at 5: what is brighter is black", |rgb| {
            if rgb.iter().any(|x| *x > 5.0) {
                [0.0; 3]
            } else {
                rgb
            }
        }),
        (
            "tone-mapped by Hable's curve, white at 11.2, exposed by 2",
            |rgb| {
                let curve = |x: f32| {
                    (x * (0.15 * x + 0.1 * 0.5) + 0.2 * 0.02) / (x * (0.15 * x + 0.5) + 0.2 * 0.3)
                        - 0.02 / 0.3
                };
                rgb.map(|x| curve(2.0 * x) / curve(11.2))
            },
        ),
        ("cut at 1: LDR", |rgb| rgb.map(|x| x.min(1.0))),
        ("cut at 10", |rgb| rgb.map(|x| x.min(10.0))),
        ("cut at 10 with its hue", |rgb| {
            rgb.map(|x| x * (10.0 / rgb.into_iter().fold(10.0, f32::max)))
        }),
        ("cut at 10; times pi", |rgb| {
            rgb.map(|x| x.min(10.0) * PI as f32)
        }),
        ("decoded with gamma 2.2 though linear", |rgb| {
            rgb.map(|x| x.powf(2.2))
        }),
        ("tone-mapped by Reinhard", |rgb| rgb.map(|x| x / (1.0 + x))),
        ("cut at 1 and encoded as sRGB", |rgb| {
            rgb.map(|x| srgb(x.min(1.0)))
        }),
    ];
    for (words, change) in sources {
        let source = Environment::from_image("source", light.image.map(change));
        let of_source = Truth::new(&source, Kernel::cosine(&Ggx), &ALPHAS);
        let judged = judged(&light, exact(&of_source, &ALPHAS), Some(&ALPHAS));
        assert!(
            judged.verdict().contains(&format!("source {words}")),
            "{words}: {}",
            judged.verdict()
        );
        let causes = judged.causes();
        assert!(
            causes
                .iter()
                .all(|cause| cause.kind() == "source" || words.contains(&cause.to_string()[..5])),
            "{causes:?}"
        );
    }
    for brdf in [&Beckmann as &'static dyn Brdf, &Phong] {
        let of_model = Truth::new(&light, Kernel::cosine(brdf), &TWO);
        let words = format!("of another model: --brdf {}", brdf.name());
        assert_named(&judged(&light, exact(&of_model, &TWO), Some(&TWO)), &words);
    }
    let (kernel, alpha) = Truth::of_irradiance();
    let cut = Environment::from_image("cut", light.image.map(|texel| texel.map(|x| x.min(10.0))));
    type Recolor = fn([f32; 3]) -> [f32; 3];
    let order: Recolor = |[r, g, b]| [g, b, r];
    let gain: Recolor = |texel| texel.map(|x| x * PI as f32);
    let uniform = Kernel::new(
        &Phong,
        WEIGHTS.iter().find(|weight| weight.name == "none").unwrap(),
        Default::default(),
    );
    let slips = [
        ("channels in the order G, B, R", &light, kernel, order),
        ("source cut at 10; times pi", &cut, kernel, gain),
        ("not weighted by the cosine", &light, uniform, |texel| texel),
    ];
    for (words, source, kernel, change) in slips {
        let exact = Truth::new(source, kernel, &[alpha]).prefiltered(alpha);
        let irradiance = faces(&LAYOUTS[0], [SIDE; 2], |d| exact.value(d));
        let mut map = of_levels(vec![irradiance]);
        each_texel(&mut map, change);
        let bake = Bake {
            irradiance: Some(map),
            ..Bake::default()
        };
        assert_named(
            &judged_bake(&light, bake, None),
            &format!("irradiance: {words}"),
        );
    }
    let turned = Truth::new(&light, kernel, &[alpha]).prefiltered(alpha);
    let turned = faces(&LAYOUTS[0], [SIDE; 2], |d| {
        turned.value(DVec3::new(d.z, d.y, -d.x))
    });
    let irradiance = Some(of_levels(vec![turned]));
    let bake = Bake {
        specular: Some(exact(&truth, &TWO)),
        irradiance,
        ..Bake::default()
    };
    let verdict = judged_bake(&light, bake, Some(&TWO)).verdict();
    assert!(
        verdict.contains("irradiance: other axes") && !verdict.contains("level"),
        "{verdict}"
    );
    let other = WEIGHTS.iter().find(|weight| weight.name == "none").unwrap();
    let kernel = Kernel::new(&Ggx, other, Default::default());
    for (source, words) in [
        (&light, "levels 0 to 1: "),
        (&cut, "levels 0 to 1: source cut at 10; "),
    ] {
        let of_other = Truth::new(source, kernel, &TWO);
        assert_named(
            &judged(&light, exact(&of_other, &TWO), Some(&TWO)),
            &format!("{words}not weighted by n·l: --weight none"),
        );
    }
    let of_half = light_of(|d| {
        if d.y > 0.0 {
            light.radiance(d)
        } else {
            DVec3::ZERO
        }
    });
    let of_half = Truth::new(&of_half, Kernel::cosine(&Ggx), &TWO);
    assert_named(
        &judged(&light, exact(&of_half, &TWO), Some(&TWO)),
        "source without its lower half",
    );
    let first = truth.prefiltered(0.3);
    let first = light_of(|d| first.value(d));
    let mut map = exact(&truth, &[0.3, 0.6]);
    map.levels[1] = exact(&Truth::new(&first, Kernel::cosine(&Ggx), &[0.6]), &[0.6])
        .levels
        .remove(0);
    assert_named(
        &judged(&light, map, Some(&[0.3, 0.6])),
        "level 1: filtered from the level before it",
    );
    // Plain mips are means of the map over ever larger texels.
    let mips: Vec<_> = (0..2)
        .map(|k| faces(&LAYOUTS[0], [SIDE >> k; 2], |d| light.radiance(d)))
        .collect();
    assert_named(&judged(&light, of_levels(mips), Some(&TWO)), "plain mips");
    // A different light.
    let mut image = light.image.clone();
    image.data.rotate_left(128 * 20 + 40);
    let another = Environment::from_image("another", image);
    assert_named(
        &judged(&another, exact(&truth, &TWO), Some(&TWO)),
        "another map",
    );
}

/// GGX by the cosine of a half vector.
fn d(alpha: f64, cos: f64) -> f64 {
    (alpha / (1.0 + cos * cos * (alpha * alpha - 1.0))).powi(2) / PI
}

/// Bakes that are sums over the texels of a map, with a weight left out or another direction.
#[test]
fn slips_of_sums_are_named() {
    let light = marked_light();
    let (width, height) = (light.image.width, light.image.height);
    let texel = |index: u32| {
        let (x, y) = (index % width, index / width);
        let uv = (glam::DVec2::new(x.into(), y.into()) + 0.5)
            / glam::DVec2::new(width.into(), height.into());
        (
            direction_from_uv(uv),
            (PI * uv.y).sin(),
            DVec3::from_array(light.image.get(x, y).map(f64::from)),
        )
    };
    let texels: Vec<(DVec3, f64, DVec3)> = (0..width * height).map(texel).collect();
    // By alpha, the cosine to the normal and a texel's own weight, the sine of the polar angle.
    type Weight = fn(f64, f64, f64) -> f64;
    let sums_of =
        |texels: &[(DVec3, f64, DVec3)], side: u32, alpha: f64, weight: Weight, whole: Weight| {
            faces(&LAYOUTS[0], [side; 2], |n| {
                let (sum, whole) =
                    texels
                        .iter()
                        .fold((DVec3::ZERO, 0.0), |(sum, all), (l, sin, radiance)| {
                            let cos = n.dot(*l);
                            (
                                sum + weight(alpha, cos, *sin) * *radiance,
                                all + whole(alpha, cos, *sin),
                            )
                        });
                sum / whole
            })
        };
    let sums = |side, alpha, weight, whole| sums_of(&texels, side, alpha, weight, whole);
    let half: Weight = |alpha, cos, sin| sin * d(alpha, cos) * cos.max(0.0).powi(2);
    let drawn: Weight = |alpha, cos, sin| sin * d(alpha, (0.5 + 0.5 * cos).sqrt());
    let own: Weight =
        |alpha, cos, weight| cos.max(0.0) * weight * d(alpha, (0.5 + 0.5 * cos).sqrt());
    let twice: Weight =
        |alpha, cos, sin| cos.max(0.0).powi(2) * sin * d(alpha, (0.5 + 0.5 * cos).sqrt());
    let plain: Weight = |alpha, cos, _| cos.max(0.0) * d(alpha, (0.5 + 0.5 * cos).sqrt());
    let coat: Weight = |alpha, cos, sin| {
        cos.max(0.0) * sin / (PI * alpha.ln() * ((alpha * alpha - 1.0) * (0.5 + 0.5 * cos) + 1.0))
    };
    let sheen: Weight = |alpha, cos, sin| cos.max(0.0) * sin * (0.5 - 0.5 * cos).powf(0.5 / alpha);
    let phong: Weight = |alpha, cos, sin| sin * cos.max(0.0).powf(2.0 / alpha.powi(2) - 2.0);
    let kernels: [(&str, Weight, Weight); 7] = [
        ("half vectors taken as l", half, half),
        ("weighted by n·l once too often", twice, twice),
        ("source summed without the solid angle", plain, plain),
        ("lobe of GTR", coat, coat),
        ("lobe of sheen", sheen, sheen),
        ("Phong's lobe about r, of the exponent for h", phong, phong),
        ("times the mean weight", own, drawn),
    ];
    for (words, weight, whole) in kernels {
        let levels = [0.3, 0.7]
            .map(|alpha| sums(12, alpha, weight, whole))
            .to_vec();
        assert_named(&judged(&light, of_levels(levels), Some(&[0.3, 0.7])), words);
    }
    let luminance =
        |radiance: DVec3| splitsum::base::color::luminance(radiance.as_vec3().to_array());
    let darker: Vec<_> = texels
        .iter()
        .map(|(l, sin, radiance)| (*l, sin / (1.0 + luminance(*radiance)), *radiance))
        .collect();
    let levels = [0.3, 0.7]
        .map(|alpha| sums_of(&darker, 12, alpha, own, own))
        .to_vec();
    assert_named(
        &judged(&light, of_levels(levels), Some(&[0.3, 0.7])),
        "weighted by 1/(1 + luminance)",
    );
    let polar = faces(&LAYOUTS[0], [6; 2], |n| {
        let (east, north) = n.any_orthonormal_pair();
        let cells = (0..32 * 64)
            .map(|k| [f64::from(k / 64) + 0.5, f64::from(k % 64) + 0.5].map(|x| x * PI / 64.0));
        let of = |[theta, phi]: [f64; 2]| {
            let (around, up) = (
                east * (2.0 * phi).cos() + north * (2.0 * phi).sin(),
                n * theta.cos(),
            );
            light.radiance(around * theta.sin() + up) * theta.cos()
        };
        cells.map(of).sum::<DVec3>() * PI / 2048.0
    });
    let irradiance = Some(of_levels(vec![polar]));
    let bake = Bake {
        irradiance,
        ..Bake::default()
    };
    assert_named(&judged_bake(&light, bake, None), "without sin θ; times 2");
    let cosine: Weight = |_, cos, _| cos.max(0.0);
    let irradiance = Some(of_levels(vec![sums(8, 1.0, cosine, cosine)]));
    let radiance = texels
        .iter()
        .fold([DVec3::ZERO; 9], |sh, (l, _, radiance)| {
            let y = splitsum::base::math::spherical_harmonics::basis(*l);
            std::array::from_fn(|k| sh[k] + y[k] * *radiance * (4.0 * PI / texels.len() as f64))
        });
    let sh = sh::parse(std::path::Path::new("sh.txt"), &sh::to_cmgen(&radiance)).unwrap();
    let bake = Bake {
        irradiance,
        sh: Some(sh),
        ..Bake::default()
    };
    let verdict = judged_bake(&light, bake, None);
    assert!(
        verdict
            .parts()
            .iter()
            .all(|part| part.verdict.to_string().contains("without the solid angle")),
        "{:?}",
        verdict.parts()
    );
}

/// Linear chains have the widths `(k/(n - 1))²`, quadratic ones `(1 - √(1 - k/(n - 1)))²`.
#[test]
fn chains_of_other_levels_are_named() {
    let light = marked_light();
    let linear = |k: u32, n: u32| (f64::from(k) / f64::from(n - 1)).powi(2);
    let quadratic = |k: u32, n: u32| (1.0 - (1.0 - f64::from(k) / f64::from(n - 1)).sqrt()).powi(2);
    let of = |alphas: Vec<f64>| {
        let truth = Truth::new(&light, Kernel::cosine(&Ggx), &alphas);
        judged(&light, exact(&truth, &alphas), None).verdict()
    };
    let right = of((0..5).map(|k| linear(k, 5)).collect());
    assert!(
        !right.contains("missing") && !right.contains("mapping"),
        "{right}"
    );
    let last = of((0..4).map(|k| linear(k, 6)).collect());
    assert!(
        last.contains("the last 2 of 6 levels are missing"),
        "{last}"
    );
    let first = of((2..6).map(|k| linear(k, 6)).collect());
    assert!(
        first.contains("the first 2 of 6 levels are missing"),
        "{first}"
    );
    // Levels of unknown width, narrower than any that is tried.
    assert!(!of(vec![0.0; 5]).contains("missing"));
    assert!(
        !of(vec![linear(1, 4), linear(2, 4)]).contains("missing"),
        "one width names no chain"
    );
    // A level of noise does not mean that levels are missing.
    let alphas: Vec<f64> = (0..4).map(|k| linear(k, 6)).collect();
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &alphas);
    let mut map = exact(&truth, &alphas);
    map.levels[3].iter_mut().for_each(|face| {
        let pixels = face.data.clone();
        face.data
            .iter_mut()
            .enumerate()
            .for_each(|(i, texel)| *texel = pixels[i * 7 % pixels.len()].map(|x| x * x));
    });
    let noisy = judged(&light, map, None).verdict();
    assert!(!noisy.contains("missing"), "{noisy}");
    let bent = of((0..5).map(|k| quadratic(k, 5)).collect());
    assert!(bent.contains("--level-mapping quadratic"), "{bent}");
    let filtered = of([
        &[0.1],
        &(1..5).map(|k| linear(k, 5)).collect::<Vec<_>>()[..],
    ]
    .concat());
    assert!(
        filtered.contains("level 0: 1.3 levels too blurred (alpha 0.100 for 0.000); "),
        "{filtered}"
    );
    let laws: [(&str, &dyn Fn(u32) -> f64); 4] = [
        (
            "roughness is squared twice: --alphas 0.0000,0.0039,0.0625,0.3164,1.0000",
            &|k| linear(k, 5).powi(2),
        ),
        ("roughness is not squared", &|k| linear(k, 5).sqrt()),
        ("each level has the width of the next one", &|k| {
            linear((k + 1).min(4), 5)
        }),
        ("each level has the width of the one before it", &|k| {
            linear(k.saturating_sub(1), 5)
        }),
    ];
    for (words, law) in laws {
        let verdict = of((0..5).map(law).collect());
        assert!(verdict.contains(words), "{words}: {verdict}");
    }
    // The first width of the quadratic chain is too narrow to fit, and the linear one three times
    // as wide.
    let alphas: Vec<f64> = (0..6).map(|k| linear(k, 6)).collect();
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &alphas);
    let mut judging = Judging::by(Preset::parse("cmgen").unwrap(), &Stated::default()).unwrap();
    judging.convention.axes = Axes::SAME;
    let bake = Bake {
        specular: Some(exact(&truth, &alphas)),
        ..Bake::default()
    };
    assert_named(
        &judging.judge(&light, &bake, |_| ()).unwrap(),
        "--level-mapping linear; nothing else",
    );
}

/// Level 10 fails, level 1 does not.
#[test]
fn levels_fail_by_their_whole_number() {
    let constant = |value: f32| vec![RgbImage::filled(4, 4, [value; 3]); 6];
    let levels = (0..11)
        .map(|k| constant(if k == 10 { 2.0 } else { 1.0 }))
        .collect();
    let alphas: Vec<f64> = (0..11).map(|k| f64::from(k) / 10.0).collect();
    let judged = judged(
        &Environment::from_image("even", RgbImage::filled(16, 8, [1.0; 3])),
        of_levels(levels),
        Some(&alphas),
    );
    let found = as_json(
        "even",
        "own",
        &Limits {
            fail_above: Some(1e-4),
            ..Limits::default()
        },
        &judged,
    );
    let passes = |k: usize| found["levels"][k]["passes"].as_bool().unwrap();
    assert!(passes(0) && passes(1) && !passes(10), "{found}");
}

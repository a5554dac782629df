//! Lookup, built-in formulas against their closed forms, and messages about bad input.

use crate::snapshot::assert_snapshot;
use glam::{DVec2, DVec3};
use splitsum::base::color::luminance;
use splitsum::base::math::equirect;
use splitsum::base::pixels::{Content, GrayImage, RgbImage, exr};
use splitsum::instrument::environment::{BUILTINS, Environment, LoadOptions};
use std::f64::consts::{PI, TAU};
use std::path::Path;

fn builtin_sized(spec: &str, size: [u32; 2]) -> Environment {
    let options = LoadOptions {
        builtin_size: size,
        ..LoadOptions::default()
    };
    Environment::load(spec, Path::new("."), &options).unwrap()
}

fn builtin(spec: &str) -> Environment {
    builtin_sized(spec, LoadOptions::default().builtin_size)
}

/// Sum over the texels of solid angle times `f(texel's luminance, its centre's direction)`.
fn integrate(image: &RgbImage, f: impl Fn(f64, DVec3) -> f64) -> f64 {
    let mut sum = 0.0;
    for y in 0..image.height {
        let omega = equirect::texel_solid_angle(y, image.width, image.height);
        for x in 0..image.width {
            let uv = DVec2::new(
                (f64::from(x) + 0.5) / f64::from(image.width),
                (f64::from(y) + 0.5) / f64::from(image.height),
            );
            sum += omega * f(luminance(image.get(x, y)), equirect::direction_from_uv(uv));
        }
    }
    sum
}

fn energy(image: &RgbImage) -> f64 {
    integrate(image, |luminance, _| luminance)
}

mod lookup {
    use super::*;

    fn environment() -> Environment {
        let image = RgbImage::from_fn(8, 4, |x, y| {
            [
                (1 + x * x) as f32,
                (y * y) as f32 + 0.25,
                ((x * 7 + y * 3) % 5) as f32,
            ]
        });
        Environment::from_image("test", image)
    }

    fn at(environment: &Environment, u: f64, v: f64) -> DVec3 {
        environment.radiance(equirect::direction_from_uv(DVec2::new(u, v)))
    }

    fn texel(environment: &Environment, x: u32, y: u32) -> DVec3 {
        DVec3::from(environment.image.get(x, y).map(f64::from))
    }

    #[test]
    fn between_centres_it_is_bilinear() {
        let environment = environment();
        let t = |x, y| texel(&environment, x, y);
        // A quarter of the way from column 2 to 3, three quarters from row 1 to 2.
        let expected = t(2, 1)
            .lerp(t(3, 1), 0.25)
            .lerp(t(2, 2).lerp(t(3, 2), 0.25), 0.75);
        assert!(at(&environment, 2.75 / 8.0, 2.25 / 4.0).abs_diff_eq(expected, 1e-12));
    }

    #[test]
    fn the_seam_wraps() {
        let environment = environment();
        let middle = 0.5 * (texel(&environment, 7, 1) + texel(&environment, 0, 1));
        assert!(at(&environment, 0.0, 1.5 / 4.0).abs_diff_eq(middle, 1e-12));
        // From both sides of -z.
        for x in [-1e-9, 1e-9] {
            let d = DVec3::new(x, 0.0, -1.0);
            let (left, right) = (
                environment.radiance(d),
                environment.radiance(DVec3::new(-x, 0.0, -1.0)),
            );
            assert!(left.abs_diff_eq(right, 1e-6), "{left} {right}");
        }
    }

    #[test]
    fn the_poles_clamp() {
        let environment = environment();
        for x in 0..8 {
            let u = (f64::from(x) + 0.5) / 8.0;
            assert!(at(&environment, u, 1e-9).abs_diff_eq(texel(&environment, x, 0), 1e-6));
            assert!(at(&environment, u, 1.0 - 1e-9).abs_diff_eq(texel(&environment, x, 3), 1e-6));
        }
        assert!(
            environment.radiance(DVec3::Y).is_finite()
                && environment.radiance(DVec3::NEG_Y).is_finite()
        );
    }

    #[test]
    fn the_hash_sees_size_and_pixels() {
        let hash = |width, height, value: f32| {
            Environment::from_image("test", RgbImage::filled(width, height, [value; 3])).hash
        };
        let base = hash(4, 2, 1.0);
        assert_eq!(base, hash(4, 2, 1.0));
        assert!(base != hash(2, 4, 1.0) && base != hash(4, 2, 1.0 + f32::EPSILON));
        assert_eq!(base.len(), 64);
    }
}

mod formulas {
    use super::*;

    #[test]
    fn every_builtin_is_valid_at_any_size() {
        for formula in BUILTINS {
            let spec = format!("builtin:{}", formula.name);
            for size in [[1, 1], [2, 1], [7, 5], [64, 32], [512, 256]] {
                let environment = builtin_sized(&spec, size);
                assert_eq!([environment.image.width, environment.image.height], size);
                assert!(
                    environment
                        .image
                        .data
                        .iter()
                        .flatten()
                        .all(|v| v.is_finite() && *v >= 0.0),
                    "{spec} {size:?}"
                );
                assert!(environment.warnings.is_empty());
            }
            for parameter in formula.parameters {
                assert!(
                    (parameter.min..=parameter.max).contains(&parameter.default),
                    "{spec}: {}",
                    parameter.name
                );
                for value in [parameter.min, parameter.max] {
                    let spec = format!("{spec}:{}={value}", parameter.name);
                    let environment = builtin_sized(&spec, [32, 16]);
                    assert!(
                        environment
                            .image
                            .data
                            .iter()
                            .flatten()
                            .all(|v| v.is_finite() && *v >= 0.0),
                        "{spec}"
                    );
                }
            }
        }
    }

    #[test]
    fn constant() {
        let environment = builtin("builtin:constant:radiance=2.5");
        assert!(
            environment
                .image
                .data
                .iter()
                .all(|texel| *texel == [2.5; 3])
        );
    }

    #[test]
    fn gradient_has_its_closed_irradiance() {
        // ∫ (m + s d.y) max(n.d, 0) dω / π = m + (2/3) s n.y; the map has a texel error of about
        // (π/256)²/6.
        let image = builtin("builtin:gradient").image;
        for n in [
            DVec3::Y,
            DVec3::NEG_Y,
            DVec3::X,
            DVec3::new(0.6, 0.64, -0.48),
        ] {
            let irradiance_over_pi = integrate(&image, |l, d| l * n.dot(d).max(0.0)) / PI;
            assert!(
                (irradiance_over_pi - (0.52 + n.y / 3.0)).abs() < 1e-4,
                "{n}: {irradiance_over_pi}"
            );
        }
    }

    #[test]
    fn checker_halves_the_sphere() {
        for size in [[512, 256], [50, 30]] {
            let image = builtin_sized("builtin:checker", size).image;
            // 1/8 of a texel of an odd size.
            let tolerance = if size[0] % 8 == 0 { 1e-9 } else { 0.01 };
            assert!(
                (energy(&image) / (4.0 * PI) - 0.5).abs() < tolerance,
                "{size:?}"
            );
        }
        let image = builtin("builtin:checker:low=0.25").image;
        assert_eq!(
            [image.get(63, 63), image.get(64, 63), image.get(64, 64)],
            [[1.0; 3], [0.25; 3], [1.0; 3]]
        );
    }

    /// A cap has the energy, centroid and interior of the exact cap, at any place and for any size
    /// of the map.
    #[test]
    fn cap_holds_its_solid_angle() {
        for (half_angle, azimuth, elevation) in [
            (10.0, 0.0, 30.0),
            (10.0, 180.0, 0.0),
            (0.265, 33.0, 35.0),
            (40.0, -120.0, 80.0),
            (25.0, 90.0, -90.0),
            (120.0, 10.0, 20.0),
        ] {
            let spec = format!(
                "builtin:cap:half_angle_deg={half_angle},radiance=100,ambient=0,azimuth_deg={azimuth},elevation_deg={elevation}"
            );
            for size in [[512, 256], [64, 32], [33, 17]] {
                let image = builtin_sized(&spec, size).image;
                let expected = 100.0 * TAU * (1.0 - f64::cos(f64::to_radians(half_angle)));
                let found = energy(&image);
                // The midpoint rule over latitudes; at a pole the span of a latitude has a corner.
                let tolerance = if f64::abs(elevation) + half_angle > 89.0 {
                    1e-4
                } else {
                    1e-5
                };
                assert!(
                    (found / expected - 1.0).abs() < tolerance,
                    "{spec} {size:?}: {found} {expected}"
                );
                assert!(
                    image.data.iter().all(|texel| texel[0] <= 100.0),
                    "{spec} {size:?}"
                );
            }
        }
        let environment = builtin("builtin:cap");
        let center = DVec3::new(0.0, 0.5, f64::sqrt(0.75));
        assert_eq!(environment.radiance(center), DVec3::splat(100.0));
        let ambient = f64::from(0.1f32);
        assert_eq!(environment.radiance(-center), DVec3::splat(ambient));
        // First moments of cap and ambient: the cap's direction is right, not only its size.
        let moment = integrate(&environment.image, |l, d| (l - ambient) * d.dot(center));
        let expected = (100.0 - ambient) * PI * f64::sin(10f64.to_radians()).powi(2);
        assert!(
            (moment / expected - 1.0).abs() < 1e-4,
            "{moment} {expected}"
        );
    }

    /// The sun's direction of `builtin:sky:elevation_deg=h,azimuth_deg=0`.
    fn sun_direction(elevation_deg: f64) -> DVec3 {
        let (sin, cos) = elevation_deg.to_radians().sin_cos();
        DVec3::new(0.0, sin, cos)
    }

    /// (irradiance of the sun on the horizontal, of the rest of the upper half), luminance.
    fn sun_and_sky(image: &RgbImage, elevation_deg: f64) -> (f64, f64) {
        let sun = sun_direction(elevation_deg);
        // Two texels around the disc; the aureole within counts as sun but is small beside it.
        let near = |d: DVec3| d.dot(sun) > (2.0 * PI / f64::from(image.height)).cos();
        let direct = integrate(image, |l, d| if near(d) { l * d.y.max(0.0) } else { 0.0 });
        let diffuse = integrate(image, |l, d| if near(d) { 0.0 } else { l * d.y.max(0.0) });
        (direct, diffuse)
    }

    #[test]
    fn sky_has_unit_mean_and_a_sun_of_exact_energy() {
        let spec = "builtin:sky:elevation_deg=35,azimuth_deg=0";
        let sizes =
            [[512, 256], [1024, 512], [256, 128]].map(|size| builtin_sized(spec, size).image);
        for image in &sizes {
            assert!(
                (energy(image) / (4.0 * PI) - 1.0).abs() < 1e-5,
                "{}",
                image.width
            );
        }
        // The aureole counts twice if the texels are larger, so sizes are compared at the disc
        // alone: the part above its ring.
        let excess = |image: &RgbImage| {
            let sun = sun_direction(35.0);
            let floor = 20.0;
            integrate(image, |l, d| {
                if d.dot(sun) > 0.999 && l > floor {
                    l - floor
                } else {
                    0.0
                }
            })
        };
        let [middle, fine, coarse] = sizes.each_ref().map(excess);
        assert!(
            (middle / fine - 1.0).abs() < 0.02 && (middle / coarse - 1.0).abs() < 0.06,
            "{fine} {middle} {coarse}"
        );
        let (direct, diffuse) = sun_and_sky(&sizes[1], 35.0);
        assert!(
            (2.0..5.0).contains(&(direct / diffuse)),
            "sun to sky {}",
            direct / diffuse
        );
        // Haze moves light from the sun to the sky.
        let hazy = builtin(&format!("{spec},turbidity=8")).image;
        let (hazy_direct, hazy_diffuse) = sun_and_sky(&hazy, 35.0);
        assert!(hazy_direct / hazy_diffuse < 0.5 * direct / diffuse);
    }

    #[test]
    fn sky_has_lambertian_ground() {
        for elevation in [5.0, 60.0] {
            let image = builtin(&format!(
                "builtin:sky:elevation_deg={elevation},azimuth_deg=0,albedo=0.5"
            ))
            .image;
            let ground = luminance(image.get(0, 255));
            assert!((128..256).all(|y| luminance(image.get(17, y)) == ground));
            let irradiance = integrate(&image, |l, d| l * d.y.max(0.0));
            // The cosine is taken at texel centres, which is coarse for a low sun.
            assert!(
                (ground / (0.5 * irradiance / PI) - 1.0).abs() < 0.01,
                "{ground} {irradiance}"
            );
            // Away from the sun the zenith is blue, and the low sun is redder than the sky.
            let [r, _, b] = image.get(0, 0);
            assert!(b > r);
        }
        let low = builtin("builtin:sky:elevation_deg=4,azimuth_deg=0").image;
        let sun = low
            .data
            .iter()
            .copied()
            .max_by(|a, b| luminance(*a).total_cmp(&luminance(*b)))
            .unwrap();
        assert!(sun[0] > 2.0 * sun[2], "{sun:?}");
    }
}

mod loading {
    use super::*;
    use tempfile::TempDir;

    #[test]
    fn specs_of_formulas_are_checked() {
        let specs = [
            "builtin:skye",
            "builtin:",
            "builtin:cap:half_angle=3",
            "builtin:studio:x=1",
            "builtin:cap:radiance=bright",
            "builtin:cap:radiance=-1",
            "builtin:cap:radiance=nan",
            "builtin:sky:elevation_deg=91",
            "builtin:cap:radiance",
            "builtin:cap:radiance=1,radiance=2",
            "sky",
            "",
        ];
        let refusal = |spec: &str, builtin_size| {
            let options = LoadOptions {
                builtin_size,
                ..LoadOptions::default()
            };
            Environment::load(spec, Path::new("."), &options)
                .unwrap_err()
                .to_string()
        };
        let mut shown = specs.map(|spec| refusal(spec, [512, 256])).to_vec();
        shown.push(refusal("builtin:sky", [1 << 16, 1 << 15]));
        assert_snapshot("environments_that_are_refused", &shown.join("\n"));
    }

    fn write(folder: &TempDir, name: &str, image: &RgbImage) {
        let alpha = GrayImage::filled(image.width, image.height, 1.0);
        exr::write_rgba(&folder.path().join(name), image, &alpha, &[]).unwrap();
    }

    /// A wrong extension, a truncated file, and radiance too large for sums.
    #[test]
    fn bad_files_get_one_clear_message() {
        let folder = tempfile::tempdir().unwrap();
        let mut image = RgbImage::filled(4, 2, [1e15; 3]);
        write(&folder, "bright.exr", &image);
        let load = |spec: &str| Environment::load(spec, folder.path(), &LoadOptions::default());
        load("bright.exr").unwrap();
        image.data[6] = [1.0, 1.1e15, 1.0];
        write(&folder, "bright.exr", &image);
        for (name, bytes) in [
            ("map.tif", &b""[..]),
            (
                "cut.hdr",
                b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n\x01",
            ),
        ] {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        let shown = ["none.hdr", "map.tif", "cut.hdr", "bright.exr"]
            .map(|spec| load(spec).unwrap_err().to_string());
        let shown = shown
            .join("\n")
            .replace(&folder.path().display().to_string(), "DIR");
        assert_snapshot("environment_files_that_are_refused", &shown);
    }

    /// Two layers of one file are two environments. A number sign in a file's own name is part of
    /// the name.
    #[test]
    fn a_layer_is_chosen_behind_a_number_sign() {
        let folder = tempfile::tempdir().unwrap();
        let gray = |value| GrayImage::filled(4, 2, value);
        let channels = |first: f32| {
            let of = |layer: &str, value| {
                ["R", "G", "B"]
                    .map(|c| (format!("{layer}.{c}"), gray(value)))
                    .to_vec()
            };
            [of("day", first), of("night", 0.25)].concat()
        };
        exr::write_channels(
            &folder.path().join("sky.exr"),
            Content::Radiance,
            channels(1.0),
        )
        .unwrap();
        exr::write_channels(
            &folder.path().join("a#1.exr"),
            Content::Radiance,
            channels(4.0),
        )
        .unwrap();
        let load = |spec: &str| Environment::load(spec, folder.path(), &LoadOptions::default());
        let [sky, day, night] =
            ["sky.exr", "sky.exr#day", "sky.exr#night"].map(|spec| load(spec).unwrap());
        assert_eq!(
            (day.image.data[0], night.image.data[0]),
            ([1.0; 3], [0.25; 3])
        );
        assert_ne!(day.hash, night.hash);
        assert_eq!((sky.hash, night.name.as_str()), (day.hash, "sky.exr#night"));
        assert!(
            sky.warnings[0].contains("Only layer \"day\" is used; FILE#NAME reads another (night)")
        );
        assert!(day.warnings.is_empty(), "{:?}", day.warnings);
        assert_eq!(load("a#1.exr#night").unwrap().hash, night.hash);
        assert_eq!(load("a#1.exr").unwrap().image.data[0], [4.0; 3]);
        let message = load("sky.exr#noon").unwrap_err().to_string();
        assert!(
            message.contains("in layer \"noon\" (layers with colour: day, night)"),
            "{message}"
        );
        std::fs::write(folder.path().join("x.hdr"), b"").unwrap();
        let message = load("x.hdr#day").unwrap_err().to_string();
        assert!(
            message.contains("a Radiance picture has one image"),
            "{message}"
        );
    }

    #[test]
    fn invalid_texels_are_counted_and_placed() {
        let folder = tempfile::tempdir().unwrap();
        let mut image = RgbImage::filled(4, 2, [1.0; 3]);
        image.data[2] = [1.0, f32::NAN, -2.0];
        image.data[5] = [f32::INFINITY, f32::NEG_INFINITY, -0.0];
        write(&folder, "map.exr", &image);
        let message = Environment::load("map.exr", folder.path(), &LoadOptions::default())
            .unwrap_err()
            .to_string();
        let found =
            "1 NaN, 2 infinite, 1 negative channel values, the first at column 2, row 0: G = NaN";
        assert!(
            message.contains(found) && message.contains("--clamp-invalid"),
            "{message}"
        );
        let options = LoadOptions {
            clamp_invalid: true,
            ..LoadOptions::default()
        };
        let environment = Environment::load("map.exr", folder.path(), &options).unwrap();
        assert_eq!(environment.image.data[2], [1.0, 0.0, 0.0]);
        // A sun above the range of halves stays the brightest texel.
        assert_eq!(environment.image.data[5], [65504.0, 0.0, 0.0]);
        assert_eq!(environment.image.data[4], [1.0; 3]);
        let warning = &environment.warnings[0];
        assert!(
            warning.contains(found) && warning.contains("+infinity was set to 65504"),
            "{warning}"
        );
        image.data[5][1] = 1e6;
        image.data[5][0] = f32::INFINITY;
        write(&folder, "map.exr", &image);
        let environment = Environment::load("map.exr", folder.path(), &options).unwrap();
        assert_eq!(environment.image.data[5][0], 1e6);
    }

    /// Lossy compression makes tiny negatives of 0 (DWAA, B44); larger ones have another cause.
    #[test]
    fn tiny_negatives_become_zero_with_a_warning() {
        let folder = tempfile::tempdir().unwrap();
        let mut image = RgbImage::filled(4, 2, [1.0; 3]);
        image.data[3][2] = -9e-4;
        write(&folder, "map.exr", &image);
        let load = || Environment::load("map.exr", folder.path(), &LoadOptions::default());
        let environment = load().unwrap();
        assert_eq!(environment.image.data[3], [1.0, 1.0, 0.0]);
        assert!(
            environment.warnings[0].contains("1 negative"),
            "{:?}",
            environment.warnings
        );
        image.data[3][2] = -2e-3;
        write(&folder, "map.exr", &image);
        assert!(load().is_err());
    }

    /// A cross of 4x3 or 3x4 faces with nothing beside its arms; a picture of this size is read.
    #[test]
    fn a_cross_of_faces_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let load = || Environment::load("map.exr", folder.path(), &LoadOptions::default());
        for [width, height] in [[16, 12], [12, 16]] {
            let is_face = |x: u32, y: u32| match (width > height, x / 4, y / 4) {
                (true, column, row) => row == 1 || column == 1,
                (false, column, row) => column == 1 || row == 1,
            };
            let face = |x: u32, y: u32| if is_face(x, y) { [1.0; 3] } else { [0.0; 3] };
            write(&folder, "map.exr", &RgbImage::from_fn(width, height, face));
            let message = load().unwrap_err().to_string();
            assert!(message.contains("cross of six faces"), "{message}");
            assert!(message.contains("docs/bringing-maps.md"), "{message}");
            let picture = RgbImage::from_fn(width, height, |x, y| [x as f32, y as f32, 1.0]);
            write(&folder, "map.exr", &picture);
            assert!(load().unwrap().warnings[0].contains("aspect ratio"));
        }
    }

    #[test]
    fn a_strip_of_faces_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        for [width, height] in [[12, 2], [2, 12]] {
            write(
                &folder,
                "map.exr",
                &RgbImage::filled(width, height, [1.0; 3]),
            );
            let message = Environment::load("map.exr", folder.path(), &LoadOptions::default())
                .unwrap_err()
                .to_string();
            assert!(message.contains("strip of six faces"), "{message}");
        }
    }
}

#[test]
fn the_range_of_an_environment_is_peak_over_mean() {
    let flat = Environment::from_image("flat", RgbImage::filled(8, 4, [0.5; 3])).luminance;
    assert!(
        (flat.mean - 0.5).abs() < 1e-6 && flat.range_stops().unwrap().abs() < 1e-6,
        "{flat:?}"
    );
    // The upper half of the sphere has 2, the lower 0: mean 1, for any number of rows.
    let half = RgbImage::from_fn(8, 6, |_, y| if y < 3 { [2.0; 3] } else { [0.0; 3] });
    let half = Environment::from_image("half", half).luminance;
    assert!(
        (half.mean - 1.0).abs() < 1e-6 && (half.range_stops().unwrap() - 1.0).abs() < 1e-6,
        "{half:?}"
    );
    let black = Environment::from_image("black", RgbImage::filled(2, 2, [0.0; 3])).luminance;
    assert_eq!(black.range_stops(), None);
}

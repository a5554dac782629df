//! Bakes for any program: files hold the same tables as the f64 code.

use half::f16;
use splitsum::bake::container::read_texture;
use splitsum::bake::paste::taps;
use splitsum::bake::plain::Baking;
use splitsum::base::math::quadrature::Tolerance;
use splitsum::base::names::Listed;
use splitsum::base::pixels::exr;
use splitsum::instrument::brdf::{Brdf, Ggx, MaskingShadowing, Phong};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::precompute::prefilter::{Kernel, LevelMapping, LevelSpacing, reference};
use splitsum::instrument::precompute::taps::{Chain, TapCount, TapTable};
use splitsum::instrument::precompute::{PrecomputeSettings, exact_quadrature};

#[test]
fn files_hold_the_tables_in_f64() {
    let dir = tempfile::tempdir().unwrap();
    let file = |name: &str| dir.path().join(name);
    // Readers would take levels of an earlier bake for part of the map.
    std::fs::write(file("prefiltered_phong_7.exr"), "stale").unwrap();
    let environment = Environment::open("builtin:gradient").unwrap();
    let (masking, mapping) = (
        MaskingShadowing::Correlated,
        LevelMapping::listed("quadratic"),
    );
    let settings = PrecomputeSettings {
        prefilter_size: [16; 2],
        prefilter_level_count: 3,
        level_mapping: mapping,
        dfg_size: 4,
        ..PrecomputeSettings::default()
    };
    let baking = Baking {
        environment: &environment,
        settings,
        brdfs: &[&Phong as &dyn Brdf],
        masking,
    };
    // Levels of every model that is baked, even if no file can be written.
    let full = tempfile::tempdir().unwrap();
    let levels =
        ["prefiltered_ggx_7.exr", "prefiltered_phong_7.exr"].map(|name| full.path().join(name));
    levels
        .iter()
        .for_each(|level| std::fs::write(level, "stale").unwrap());
    std::fs::create_dir(full.path().join("sh9.json")).unwrap();
    assert!(
        Baking {
            brdfs: &[&Ggx, &Phong],
            ..baking
        }
        .bake(full.path())
        .is_err()
    );
    assert!(levels.iter().all(|level| !level.exists()));
    let files = baking.bake(dir.path()).unwrap();
    assert!(files.iter().all(|file| file.exists()) && !file("prefiltered_phong_7.exr").exists());
    let kernel = Kernel::cosine(&Phong);

    let level = exr::read(&file("prefiltered_phong_1.exr")).unwrap().rgb;
    let (quadrature, alpha) = (
        exact_quadrature(&environment.image),
        mapping.alpha_from_mip(1.0, 3),
    );
    let tolerance = Tolerance {
        relative: 1e-5,
        max_part_count: 100_000,
    };
    for (x, y) in [(1, 2), (6, 21), (4, 44)] {
        let uv = glam::DVec2::new(f64::from(x) + 0.5, f64::from(y % 8) + 0.5) / 8.0;
        let direction = (settings.layout.direction)(y / 8, uv);
        let exact = reference::prefilter(&quadrature, kernel, alpha, direction, tolerance).value;
        let found = glam::DVec3::from_array(level.get(x, y).map(f64::from));
        assert!(
            (found - exact).length() < 0.01 * exact.length(),
            "{x} {y}: {found} for {exact}"
        );
    }

    let chain = Chain::new(kernel, mapping, settings.prefilter_level_count);
    for (word, count) in [
        ("one", TapCount::One),
        ("two", TapCount::Two),
        ("four", TapCount::Four),
    ] {
        let table = TapTable::fit(&chain, &Phong, masking, count).texels;
        let (of_ggx, linear) = (Kernel::cosine(&Ggx), LevelMapping::listed("linear"));
        let fresh = TapTable::fit(
            &Chain::new(of_ggx, linear, 5),
            &Ggx,
            MaskingShadowing::Separable,
            count,
        )
        .texels;
        let spacing = LevelSpacing {
            mapping: linear,
            level_count: 5,
        };
        let of_program = taps(of_ggx, MaskingShadowing::Separable, spacing, count);
        assert_eq!(
            of_program.data,
            fresh
                .map(|texel| texel.map(|value| f16::from_f32(value).to_f32()))
                .data
        );
        let image = exr::read(&file(&format!("taps_{word}_phong.exr")))
            .unwrap()
            .rgb;
        let texture = read_texture(&file(&format!("taps_{word}_phong.ktx2"))).unwrap();
        let halves = &texture.levels[0][0];
        assert_eq!(
            (image.width, image.height, texture.texel),
            (table.width, table.height, "rgba16f")
        );
        for ((table, image), halves) in table.data.iter().zip(&image.data).zip(&halves.data) {
            assert_eq!(table[..3], image[..]);
            assert_eq!(
                table.map(|value| f16::from_f32(value).to_f32())[..3],
                halves[..]
            );
        }
    }
}

/// The first level of a list has a width; its harmonics go as far as its lobe needs.
#[test]
fn a_listed_first_level_is_the_exact_integral() {
    let dir = tempfile::tempdir().unwrap();
    let environment = Environment::open("builtin:studio").unwrap();
    let mapping = LevelMapping::of_list(&[0.12, 0.6, 1.0]).unwrap();
    let settings = PrecomputeSettings {
        prefilter_size: [16; 2],
        prefilter_level_count: 3,
        level_mapping: mapping,
        dfg_size: 4,
        ..PrecomputeSettings::default()
    };
    let baking = Baking {
        environment: &environment,
        settings,
        brdfs: &[&Ggx as &dyn Brdf],
        masking: MaskingShadowing::Correlated,
    };
    baking.bake(dir.path()).unwrap();
    let level = exr::read(&dir.path().join("prefiltered_ggx_0.exr"))
        .unwrap()
        .rgb;
    let quadrature = exact_quadrature(&environment.image);
    let tolerance = Tolerance {
        relative: 1e-5,
        max_part_count: 100_000,
    };
    let alpha = mapping.alpha_from_mip(0.0, 3);
    let largest = level.data.iter().flatten().fold(0.0, |a: f32, b| a.max(*b));
    for index in (0..level.data.len() as u32).step_by(61) {
        let [x, y] = [index % 16, index / 16];
        let uv = glam::DVec2::new(f64::from(x) + 0.5, f64::from(y % 16) + 0.5) / 16.0;
        let direction = (settings.layout.direction)(y / 16, uv);
        let kernel = Kernel::cosine(&Ggx);
        let exact = reference::prefilter(&quadrature, kernel, alpha, direction, tolerance).value;
        let found = glam::DVec3::from_array(level.get(x, y).map(f64::from));
        assert!(
            (found - exact).abs().max_element() < 1e-4 * f64::from(largest),
            "{x} {y}: {found} for {exact}"
        );
    }
}

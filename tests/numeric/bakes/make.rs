//! Bakes for engines: directions through writer and reader as each engine looks them up, exact
//! rounding, and the rules of each format.

use super::files;
use super::scores::{light_of, marked_light};
use glam::{DVec2, DVec3};
use half::f16;
use splitsum::bake::Stated;
use splitsum::bake::container::{
    Encoding, FORMATS, SRGB8, TEXELS, Texel, Texture, from_bytes, read_texture, read_texture_of,
};
use splitsum::bake::convention::{Axes, Preset, TABLE_AXES};
use splitsum::bake::given;
use splitsum::bake::judge::Part;
use splitsum::bake::make::{GOOD, Loss, Making, make};
use splitsum::bake::plain::Baking;
use splitsum::bake::sh;
use splitsum::bake::source::{Reading, read};
use splitsum::base::math::spherical_harmonics::{basis, irradiance};
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::brdf::{Beckmann, Brdf, Ggx, MaskingShadowing};
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::environment::{Environment, LoadOptions};
use splitsum::instrument::precompute::given::OWN;
use splitsum::instrument::precompute::prefilter::{Kernel, LevelMapping, LevelSpacing};
use splitsum::instrument::precompute::sh9::reference::turned;
use splitsum::instrument::precompute::taps;
use std::f64::consts::PI;
use std::path::Path;

type Lookup = (&'static str, fn(DVec3) -> DVec3);

/// Lookup direction of each engine's shader for a world direction (y up, right-handed), from the
/// source of those shaders.
const LOOKUPS: &[Lookup] = &[
    ("raw", |d| d),
    // `textureLod(light_iblSpecular, r, lod)`; cmgen mirrors its output to match.
    ("filament", |d| d),
    // Open3D draws with Filament.
    ("open3d", |d| d),
    // The centre of the map is +z here; the viewer puts it at -x, or turns by 90 degrees.
    ("khronos", |d| DVec3::new(d.z, d.y, -d.x)),
    // `environment_map.wesl`: cube maps are left-handed, z is negated.
    ("bevy", |d| DVec3::new(d.x, d.y, -d.z)),
    // `ImageBasedLightingStageFS.glsl`: y is up in the frame of the lookup.
    ("cesium", |d| d),
    // `WebGLMaterials.js`: x of cubes that are not rendered is negated.
    ("three", |d| DVec3::new(-d.x, d.y, d.z)),
    // `pbrBlockReflection`: z is negated in a right-handed scene.
    ("babylon", |d| DVec3::new(d.x, d.y, -d.z)),
    // `env` files are for the lookup of a mirrored cube.
    ("babylon-env", |d| DVec3::new(-d.x, d.y, d.z)),
    // `vtkOpenGLPolyDataMapper.cxx`: pictures are a quarter turn from ours.
    ("f3d", |d| DVec3::new(d.z, d.y, -d.x)),
    // A shader gives its samplerCube a direction of the world.
    ("godot", |d| d),
    // `reflectionCube.js`: x is negated.
    ("playcanvas", |d| DVec3::new(-d.x, d.y, d.z)),
    // `render/util.py`, latlong_to_cubemap: the centre of the map is -z.
    ("nvdiffrec", |d| DVec3::new(-d.x, d.y, -d.z)),
    // The world is left-handed.
    ("unity", |d| DVec3::new(-d.x, d.y, d.z)),
];

pub fn making<'a>(engine: &str, environment: &'a Environment) -> Making<'a> {
    let preset = Preset::listed(engine);
    let level_count = match engine {
        // The widths of an `.env` are for levels down to one texel.
        "babylon-env" => 7,
        _ => {
            let fixed = preset.convention().mapping.engine_levels;
            preset.product().level_count.or(fixed).unwrap_or(6)
        }
    };
    Making {
        irradiance_side: 16,
        table_side: 8,
        level_count,
        ..Making::new(preset, environment, 64)
    }
}

#[test]
fn every_direction_is_where_the_engine_looks() {
    let light = marked_light();
    // An atlas has no cube; `packed` compares it. SAPIEN's cubes end at 1; its test is the next one.
    assert_eq!(LOOKUPS.len() + 2, Preset::engines().count());
    let hot = DVec3::new(0.35, 0.6, 0.72).normalize();
    for (engine, lookup) in LOOKUPS {
        let dir = tempfile::tempdir().unwrap();
        let making = making(engine, &light);
        making.check().unwrap();
        let baked = make(&making, dir.path()).unwrap();
        assert!(
            baked
                .levels
                .iter()
                .all(|level| level.relmse < 2e-4 && level.loss.is_none()),
            "{engine} {baked:?}"
        );
        let bake = read(
            &[dir.path().display().to_string()],
            Reading {
                layout: None,
                brdf: "ggx",
                byte_color: None,
            },
        )
        .unwrap();
        let faces = &bake.specular.as_ref().unwrap().levels[0];
        let seen = |d: DVec3| {
            let (face, uv) = (LAYOUTS[0].face_uv)(lookup(d));
            DVec3::from_array(
                faces[face as usize]
                    .get((uv.x * 64.0) as u32, (uv.y * 64.0) as u32)
                    .map(f64::from),
            )
        };
        for d in [
            DVec3::X,
            -DVec3::X,
            DVec3::Y,
            -DVec3::Y,
            DVec3::Z,
            -DVec3::Z,
            hot,
        ] {
            let expected = light.radiance(d);
            assert!(
                ((seen(d) - expected) / expected).abs().max_element() < 0.06,
                "{engine} {d}: {} {expected}",
                seen(d)
            );
        }
        // No other direction is as bright: in a mirrored or turned map the hot texel would be
        // elsewhere.
        assert!(
            Axes::all()
                .skip(1)
                .all(|axes| seen(axes.to_world(hot)).min_element() < 0.5 * seen(hot).min_element())
        );
        // SH has the same axes as the map.
        if let Some(found) = &bake.sh {
            let own = |d: DVec3| irradiance(&found.radiance, lookup(d)) / PI;
            let exact = own(DVec3::Y) - own(-DVec3::Y);
            assert!(exact.y > 0.5, "{engine}: green shines from +y: {exact}");
            assert!(
                (own(DVec3::Z) - own(-DVec3::Z)).z > 0.5,
                "{engine}: blue shines from +z"
            );
            assert!(
                (own(DVec3::X) - own(-DVec3::X)).x > 0.3,
                "{engine}: red shines from +x"
            );
        }
        // A KTX file alone states its conventions as the folder does.
        let file = dir.path().join(making.preset.product().specular);
        if file
            .extension()
            .is_some_and(|form| form != "dds" && form != "env" && form != "vtm")
        {
            let alone = read(&[file.display().to_string()], Reading::default())
                .unwrap()
                .stated;
            let of = |stated: &Stated| {
                (
                    stated.preset.clone(),
                    stated.weight.clone(),
                    stated.masking.clone(),
                )
            };
            assert_eq!(of(&alone), of(&bake.stated), "{engine}");
            let pairs = alone
                .alphas
                .as_ref()
                .unwrap()
                .iter()
                .zip(bake.stated.alphas.as_ref().unwrap());
            let off = pairs.map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-6, "{engine}");
        }
        // No file is overwritten, by neither kind of bake.
        let plain = Baking {
            environment: &light,
            settings: Default::default(),
            brdfs: &[],
            masking: making.masking,
        };
        assert!(
            plain
                .bake(dir.path())
                .unwrap_err()
                .to_string()
                .contains("bake --for")
        );
        assert!(
            make(&making, dir.path())
                .unwrap_err()
                .to_string()
                .contains("exists")
        );
    }
}

/// SAPIEN's shader swaps y and z of a world with z up; its x is ours, its y our -z
/// (`deferred.frag`, specularIBL). It decodes the bytes as sRGB, and takes a KTX of linear bytes alone.
#[test]
fn srgb_codes_for_sapien_are_where_it_looks() {
    let radiance = |d: DVec3| 0.5 + 0.4 * d;
    let light = light_of(radiance);
    let folder = tempfile::tempdir().unwrap();
    let baked = make(&making("sapien", &light), folder.path()).unwrap();
    assert_eq!(baked.levels.len(), 5);
    for level in &baked.levels {
        assert!(level.relmse < 2e-5 && level.loss.is_none(), "{level:?}");
    }
    let file = std::fs::read(folder.path().join("environment.ktx")).unwrap();
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap());
    // glType, glFormat and glInternalFormat: GL_UNSIGNED_BYTE, GL_RGBA, GL_RGBA8.
    assert_eq!([word(16), word(24), word(28)], [0x1401, 0x1908, 0x8058]);
    let key_bytes = word(60) as usize;
    let texels = &file[64 + key_bytes + 4..][..6 * 64 * 64 * 4];
    let decoded = |code: u8| {
        let signal = f64::from(code) / 255.0;
        if signal <= 0.04045 {
            signal / 12.92
        } else {
            ((signal + 0.055) / 1.055).powf(2.4)
        }
    };
    for d in [
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::Z,
        DVec3::NEG_Z,
        DVec3::new(0.35, 0.6, 0.72).normalize(),
    ] {
        let sapien = DVec3::new(d.x, -d.z, d.y);
        let (face, uv) = (LAYOUTS[0].face_uv)(DVec3::new(sapien.x, sapien.z, sapien.y));
        let [x, y] = [uv.x, uv.y].map(|u| (u * 64.0) as usize);
        let at = 4 * ((face as usize * 64 + y) * 64 + x);
        let found = DVec3::from_array([0, 1, 2].map(|i| decoded(texels[at + i])));
        assert!(
            (found - radiance(d)).abs().max_element() < 0.02,
            "{d}: {found}"
        );
    }
}

/// Light above 1 is cut, and the message says that no other format helps.
#[test]
fn bright_maps_for_sapien_lose_light() {
    let light = light_of(|d| DVec3::splat(if d.x > 0.7 { 4.0 } else { 0.2 }));
    let folder = tempfile::tempdir().unwrap();
    let making = making("sapien", &light);
    let baked = make(&making, folder.path()).unwrap();
    let Some(Loss::Cut(cut)) = &baked.levels[0].loss else {
        panic!("{:?}", baked.levels[0]);
    };
    assert!(cut.enough.is_none() && cut.share > 0.4, "{cut:?}");
    let linear = Making {
        texel: Texel::listed("rgba16f"),
        ..making
    };
    let refusal = linear.check().unwrap_err();
    assert!(refusal.contains("needs one of srgb8"), "{refusal}");
}

/// Texels of bytes say nothing of their code: a key of our file does, or the preset of its program.
#[test]
fn bytes_are_read_by_a_key_or_a_preset_alone() {
    let gray = RgbImage::from_fn(8, 8, |_, _| [0.214_041; 3]);
    let levels = vec![vec![gray; 6]];
    let folder = tempfile::tempdir().unwrap();
    for extension in ["ktx", "ktx2"] {
        let write = |name: &str, keys: &[(String, String)]| {
            let format = FORMATS
                .iter()
                .find(|format| format.extension == extension)
                .unwrap();
            let file = (format.write)(&Encoding {
                texel: &SRGB8,
                levels: &levels,
                keys,
                is_packed: false,
            });
            // SAPIEN gives KTX 2 the extension of KTX 1.
            let path = folder.path().join(format!("{extension}-{name}.ktx"));
            std::fs::write(&path, file).unwrap();
            path
        };
        let seen = |texture: Texture| texture.levels[0][5].get(7, 0)[0];
        let plain = write("plain", &[]);
        let refusal = read_texture(&plain).unwrap_err().to_string();
        assert!(
            refusal.contains("0x8058") || refusal.contains("R8G8B8A8_UNORM"),
            "{refusal}"
        );
        let by_preset = Preset::listed("sapien").convention().byte_color;
        let found = read_texture_of(&plain, by_preset).unwrap();
        assert_eq!(found.texel, "srgb8");
        assert!((seen(found) - 0.214).abs() < 2e-3);
        let key = ("splitsum.bytes".to_owned(), "srgb".to_owned());
        let keyed = read_texture(&write("keyed", &[key])).unwrap();
        assert!((seen(keyed) - 0.214).abs() < 2e-3);
        let unknown = ("splitsum.bytes".to_owned(), "gamma".to_owned());
        read_texture(&write("unknown", &[unknown])).unwrap_err();
    }
}

/// The table of taps matches the levels of the engine's own formula, and the code is in its
/// language.
#[test]
fn taps_are_for_the_levels_of_the_engine() {
    let light = marked_light();
    for (engine, mapping, level_count, code) in [
        ("bevy", "linear", 6, "taps.wgsl"),
        ("filament", "quadratic", 5, "taps.glsl"),
        ("three", "quadratic", 6, "taps.glsl"),
        ("babylon", "linear", 4, "taps.glsl"),
        ("godot", "unity", 7, "taps.glsl"),
        ("playcanvas", "linear", 6, "taps.glsl"),
        ("unity", "unity", 7, "taps.hlsl"),
    ] {
        let dir = tempfile::tempdir().unwrap();
        let brdf: &'static dyn Brdf = if engine == "playcanvas" {
            &Beckmann
        } else {
            &Ggx
        };
        make(
            &Making {
                level_count,
                brdf,
                ..making(engine, &light)
            },
            dir.path(),
        )
        .unwrap();
        let weight = Preset::listed(engine).convention().weight;
        let kernel = Kernel::new(brdf, weight, MaskingShadowing::Correlated);
        let levels = taps::Chain::new(kernel, LevelMapping::listed(mapping), level_count);
        let table = taps::TapTable::fit(
            &levels,
            brdf,
            MaskingShadowing::Correlated,
            taps::TapCount::Two,
        )
        .texels;
        let found = read_texture(&dir.path().join("taps.ktx2")).unwrap();
        for (own, found) in table.data.iter().zip(&found.levels[0][0].data) {
            assert_eq!(
                own.map(|value| f16::from_f32(value).to_f32())[..3],
                found[..],
                "{engine}"
            );
        }
        let text = std::fs::read_to_string(dir.path().join(code)).unwrap();
        assert!(
            text.contains("tap_part(") && text.contains("//     "),
            "{engine}: {text}"
        );
    }
}

/// The levels of nvdiffrec's `build_mips` and `get_mip`, and taps for them.
#[test]
fn nvdiffrec_gets_levels_and_taps_of_its_spacing() {
    let light = marked_light();
    let dir = tempfile::tempdir().unwrap();
    make(&making("nvdiffrec", &light), dir.path()).unwrap();
    let manifest = std::fs::read_to_string(dir.path().join("bake.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(manifest["level_mapping"], "0.08:0.185:0.29:0.395:0.5:1");
    // `roughness = idx / (n - 2) * (0.5 - 0.08) + 0.08` for all but the last level.
    let mut due: Vec<f64> = (0..5).map(|k| 0.08 + f64::from(k) / 4.0 * 0.42).collect();
    due.push(1.0);
    let alphas = manifest["prefilter_alphas"].as_array().unwrap();
    assert_eq!(alphas.len(), due.len());
    for (alpha, roughness) in alphas.iter().zip(&due) {
        assert!((alpha.as_f64().unwrap().sqrt() - roughness).abs() < 1e-12);
    }
    let spacing = LevelSpacing::listed(&due).unwrap();
    let kernel = Kernel::new(
        &Ggx,
        Preset::listed("nvdiffrec").convention().weight,
        MaskingShadowing::Correlated,
    );
    let chain = taps::Chain::spaced(kernel, spacing);
    let table = taps::TapTable::fit(
        &chain,
        &Ggx,
        MaskingShadowing::Correlated,
        taps::TapCount::Two,
    );
    let found = read_texture(&dir.path().join("taps.ktx2")).unwrap();
    for (own, found) in table.texels.data.iter().zip(&found.levels[0][0].data) {
        let own = own.map(|value| f16::from_f32(value).to_f32());
        assert_eq!(own[..3], found[..]);
    }
}

/// A preset of a user may list widths for a product of as many levels.
#[test]
fn listed_widths_of_a_preset_need_as_many_levels() {
    let preset = |alphas: &str, count: u32| {
        let text = format!(
            "{{\"name\": \"own\", \"alphas\": {alphas}, \"product\": {{\"engine\": \"own\", \
             \"specular\": \"specular\", \"texel\": \"rgba32f\", \"level_count\": {count}}}}}"
        );
        Preset::from_json(text)
    };
    assert_eq!(
        preset("[0.01, 0.25, 1.0]", 3)
            .unwrap()
            .convention()
            .spacing(3)
            .unwrap()
            .level_count,
        3
    );
    let fault = preset("[0.01, 0.25, 1.0]", 4).unwrap_err();
    assert!(fault.contains("level_count = 3"), "{fault}");
    let wide = preset("[0.01, 0.25, 4.0]", 3).unwrap_err();
    assert!(wide.contains("each from 0 to 1"), "{wide}");
}

/// As given tables, all bakes are the same map and table, whatever their axes, order and pixel
/// format.
#[test]
fn given_tables_are_turned_to_our_axes() {
    let light = marked_light();
    let dir = tempfile::tempdir().unwrap();
    // Packed files have no cube of a listed level mapping.
    let has_cube = |preset: &&Preset| {
        let is_packed = ["rgbd", "rgbp"].contains(&preset.product().texel);
        !is_packed && preset.convention().has_mapping()
    };
    let loaded = Preset::engines().filter(has_cube).map(|preset| {
        let engine = preset.product().engine;
        let making = Making {
            masking: MaskingShadowing::Correlated,
            ..making(engine, &light)
        };
        make(&making, &dir.path().join(engine)).unwrap();
        let value = format!("file:{engine}");
        let map = given::map(&value, dir.path()).unwrap().unwrap();
        assert_eq!(map.levels.len(), making.level_count as usize);
        assert_eq!(
            (map.mapping.name, map.side),
            (preset.convention().mapping.name, 64)
        );
        // bake.json is not needed if the preset is given.
        let named = given::map(
            &format!(
                "file:{engine}/{}#{}",
                preset.product().specular,
                preset.name
            ),
            dir.path(),
        );
        assert_eq!(named.unwrap().unwrap().hash, map.hash);
        let table = (!preset.product().tables.is_empty())
            .then(|| given::table(&value, dir.path()).unwrap().unwrap());
        (map, table)
    });
    let loaded: Vec<_> = loaded.collect();
    let (own, own_table) = &loaded[0];
    for (map, table) in &loaded[1..] {
        for (a, b) in own.levels[0].iter().zip(&map.levels[0]) {
            let largest = a.iter().copied().fold(0.0, f32::max);
            assert!(
                (0..3).all(|i| (a[i] - b[i]).abs() < 0.02 * largest),
                "{}: {a:?} {b:?}",
                map.name
            );
        }
        for (a, b) in own_table
            .iter()
            .zip(table)
            .flat_map(|(own, table)| own.texels.iter().zip(&table.texels))
        {
            assert!(
                (0..2).all(|i| (a[i] - b[i]).abs() < 0.0021),
                "{}: {a:?} {b:?}",
                map.name
            );
        }
    }
    for axes in TABLE_AXES {
        let at = DVec2::new(0.2, 0.7);
        assert!(
            (axes.parameters(axes.uv(at)) - at).abs().max_element() < 1e-15,
            "{}",
            axes.name
        );
    }
    for (value, part) in [
        ("mine", "neither own nor file:PATH"),
        ("file:no.ktx2#khronos", "no.ktx2: cannot be read"),
        (
            "file:khronos/specular.ktx2#kronos",
            "did you mean \"khronos\"?",
        ),
        ("file:khronos/lut_ggx.png", "has no prefiltered map"),
        ("file:khronos/diffuse.ktx2", "has no prefiltered map"),
    ] {
        assert!(
            given::map(value, dir.path()).unwrap_err().contains(part),
            "{value}"
        );
    }
    assert!(
        given::table("file:bevy", dir.path())
            .unwrap_err()
            .contains("has no DFG table")
    );
    assert!(given::map(OWN, dir.path()).unwrap().is_none());
}

/// Godot loads complete chains only. The levels behind the last one that its shader reads are
/// exact, but too coarse for lookups.
#[test]
fn levels_that_an_engine_does_not_read_are_not_judged_between_texels() {
    use splitsum::bake::judge::{Truth, level};
    let preset = Preset::listed("godot");
    assert_eq!(
        (preset.side(), preset.product().levels(preset.side())),
        (512, 10)
    );
    let light = marked_light();
    let folder = tempfile::tempdir().unwrap();
    let baked = make(
        &Making {
            side: 128,
            level_count: 8,
            ..making("godot", &light)
        },
        folder.path(),
    )
    .unwrap();
    let bake = read(
        &[folder.path().display().to_string()],
        Reading {
            layout: None,
            brdf: "ggx",
            byte_color: None,
        },
    )
    .unwrap();
    let convention = preset.convention();
    let alphas = convention.alphas(8).unwrap();
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &alphas);
    let scores = level::score(&truth, bake.specular.as_ref().unwrap(), &convention).unwrap();
    assert_eq!(scores[6].between, Some(baked.last_between.relmse));
    assert!(
        scores[7].between.is_none() && scores[7].alpha == 1.0 && scores[7].errors.relmse < GOOD
    );
}

#[test]
fn turned_coefficients_equal_coefficients_of_the_turned_function() {
    let f =
        std::array::from_fn(|k| DVec3::new(1.0 + k as f64, 0.3 - 0.2 * k as f64, (k as f64).sin()));
    let value = |f: &[DVec3; 9], n: DVec3| -> DVec3 {
        f.iter().zip(basis(n)).map(|(value, y)| *value * y).sum()
    };
    for axes in Axes::all() {
        let turned = turned(&f, |n| axes.to_file(n));
        for n in [
            DVec3::new(0.48, -0.6, 0.64),
            DVec3::new(-0.8, 0.0, 0.6),
            DVec3::Y,
        ] {
            assert!(
                (value(&turned, n) - value(&f, axes.to_file(n)))
                    .abs()
                    .max_element()
                    < 1e-12
            );
        }
    }
    let text = sh::to_cmgen(&f);
    let found = sh::parse(Path::new("sh.txt"), &text).unwrap().radiance;
    assert!(
        found
            .iter()
            .zip(&f)
            .all(|(a, b)| (*a - *b).abs().max_element() < 1e-13),
        "{text}"
    );
}

/// Numbers of every size, equal and mixed.
fn numbers() -> Vec<[f32; 3]> {
    let random = |i: u32| (i.wrapping_mul(2_654_435_769) >> 8) as f32 / (1 << 24) as f32;
    let number = |i: u32| f32::exp2(24.0 * random(i) - 9.0);
    let mixed = (0..4000).map(|i| [number(3 * i), number(3 * i + 1), number(3 * i + 2)]);
    let even = (0..300).map(|i| [f32::exp2(i as f32 / 20.0 - 3.0); 3]);
    mixed
        .chain(even)
        .chain([
            [0.0; 3],
            [511.49, 1.0, 0.0],
            [511.5, 1.0, 511.0],
            [1.0; 3],
            [64512.0; 3],
        ])
        .collect()
}

/// A writer of the crate `ddsfile` agrees on every byte of the texels and of either header.
#[test]
fn dds_files_equal_another_writers() {
    for texel in TEXELS.iter().filter(|texel| texel.dxgi.is_some()) {
        for (faces, count) in [(1, 1), (1, 3), (6, 1), (6, 3)] {
            let levels: Vec<Vec<RgbImage>> = (0..count)
                .map(|k| vec![RgbImage::filled(4 >> k, 4 >> k, [0.0; 3]); faces])
                .collect();
            let dds = FORMATS.iter().find(|format| format.name == "dds").unwrap();
            let found = (dds.write)(&Encoding {
                texel,
                levels: &levels,
                keys: &[],
                is_packed: false,
            });
            let texels: Vec<Vec<Vec<u8>>> = (0..count)
                .map(|k| {
                    vec![found[found.len() - (4 >> k) * (4 >> k) * texel.bytes..].to_vec(); faces]
                })
                .collect();
            let mut other = files::dds(texel, 4, &texels);
            // The crate writes the codes of the older header without their flag.
            let old = [
                ("rg16f", 112),
                ("rgba16f", 113),
                ("rg32f", 115),
                ("rgba32f", 116),
            ];
            if let Some((_, code)) = old.iter().find(|(name, _)| *name == texel.name) {
                let rest = other[92..128].to_vec();
                other.splice(
                    80..148,
                    [[4_u32, *code, 0].map(u32::to_le_bytes).concat(), rest].concat(),
                );
            }
            assert!(
                found == other,
                "{}, {faces} faces, {count} levels",
                texel.name
            );
        }
    }
}

#[test]
fn numbers_are_written_to_the_nearest() {
    let numbers = numbers();
    let side = numbers.len().isqrt() as u32;
    let image = RgbImage::from_fn(side, side, |x, y| numbers[(y * side + x) as usize]);
    for texel in TEXELS {
        for format in FORMATS
            .iter()
            .filter(|format| !format.needs_dxgi || texel.dxgi.is_some())
        {
            let levels = [vec![image.clone()]];
            let file = |levels: &[Vec<RgbImage>]| {
                (format.write)(&Encoding {
                    texel,
                    levels,
                    keys: &[],
                    is_packed: false,
                })
            };
            let name = format!("x.{}", format.extension);
            let found = from_bytes(Path::new(&name), &file(&levels)).unwrap().levels;
            for (own, found) in image.data.iter().zip(&found[0][0].data) {
                let largest = own.iter().copied().fold(0.0, f32::max);
                for i in 0..texel.channels.min(3) {
                    // Half the distance of neighbouring numbers.
                    let floor = |value: f32, bits: i32| {
                        f32::exp2(value.max(f32::exp2(-14.0)).log2().floor() - bits as f32)
                    };
                    let half = match texel.name {
                        "rgb9e5" if largest < 511.5 => 0.5 * floor(largest, 8),
                        // A mantissa of 512 increases the exponent.
                        "rgb9e5" => floor(largest, 8),
                        "r11g11b10f" => 0.5 * floor(own[i], if i < 2 { 6 } else { 5 }),
                        name if name.ends_with("16f") => 0.5 * floor(own[i], 10),
                        _ => 0.0,
                    };
                    let off = (own[i] - found[i]).abs();
                    assert!(
                        off <= 1.001 * half,
                        "{} in {}: {own:?} {found:?}",
                        texel.name,
                        format.name
                    );
                }
            }
            // Numbers that a format can hold are read back exactly.
            assert!(
                from_bytes(Path::new(&name), &file(&found)).unwrap().levels == found,
                "{}",
                texel.name
            );
        }
    }
    assert_eq!(f16::MAX.to_f32(), TEXELS[0].largest);
}

/// [KTX 2.0, section 3]: parts in order, levels smallest first at the next multiples of a texel and
/// of 4, keys sorted and padded.
#[test]
fn ktx2_files_follow_the_rules_of_their_format() {
    let keys = [
        ("sh", "1 2 3"),
        ("KTXwriter", "x"),
        ("KTXorientation", "rd"),
    ]
    .map(|(a, b)| (a.to_owned(), b.to_owned()));
    for texel in TEXELS {
        for is_packed in [false, true] {
            let level = |side: u32| {
                vec![RgbImage::from_fn(side, side, |x, y| [x as f32, y as f32, 2.0]); 6]
            };
            let levels = [level(8), level(4), level(2)];
            let encoding = Encoding {
                texel,
                levels: &levels,
                keys: &keys,
                is_packed,
            };
            let file = (FORMATS[0].write)(&encoding);
            let reader = ktx2::Reader::new(&file[..]).unwrap();
            let (header, index) = (reader.header(), reader.header().index);
            assert_eq!(index.dfd_byte_offset, 80 + 24 * 3);
            assert_eq!(
                index.kvd_byte_offset,
                index.dfd_byte_offset + index.dfd_byte_length
            );
            let found: Vec<_> = reader
                .key_value_data()
                .map(|(key, _)| key.to_owned())
                .collect();
            assert_eq!(found, ["KTXorientation", "KTXwriter", "sh"]);
            let starts: Vec<usize> = reader
                .levels()
                .map(|level| level.data.as_ptr() as usize - file.as_ptr() as usize)
                .collect();
            assert!(starts[0] > starts[1] && starts[1] > starts[2], "{starts:?}");
            // `ktx validate` refuses one byte more.
            let next = |end: usize| {
                (end..).find(|start| is_packed || (start % texel.bytes == 0 && start % 4 == 0))
            };
            let mut end = (index.kvd_byte_offset + index.kvd_byte_length) as usize;
            for (level, start) in reader
                .levels()
                .zip(&starts)
                .collect::<Vec<_>>()
                .into_iter()
                .rev()
            {
                assert_eq!(Some(*start), next(end), "{starts:?}");
                end = start + level.data.len();
            }
            assert_eq!(end, file.len());
            assert_eq!(
                header.type_size,
                if texel.name.ends_with("16f") { 2 } else { 4 },
                "{}",
                texel.name
            );
            assert!(from_bytes(Path::new("x.ktx2"), &file).unwrap().is_cube());
        }
    }
}

/// If an engine takes any number of levels, lookups between the texels of the last level are as
/// good as its texels, also under a lamp. Unity's seven levels leave four texels, which are too
/// few.
#[test]
fn the_last_level_has_enough_texels_for_lookups() {
    let environment =
        Environment::load("builtin:studio", Path::new("."), &LoadOptions::default()).unwrap();
    let last = |engine: &str, level_count: Option<u32>| {
        let folder = tempfile::tempdir().unwrap();
        let making = making(engine, &environment);
        let level_count = level_count.unwrap_or_else(|| making.preset.product().levels(64));
        let baked = make(
            &Making {
                level_count,
                ..making
            },
            folder.path(),
        )
        .unwrap();
        let last = baked
            .levels
            .iter()
            .rfind(|level| level.part != Part::Irradiance);
        (last.unwrap().side, baked.last_between)
    };
    for (engine, sides) in [("khronos", 8), ("filament", 16)] {
        let (side, between) = last(engine, None);
        assert!(
            side == sides && between.relmse < GOOD && between.advice.is_none(),
            "{engine}: {side}, {between:?}"
        );
    }
    assert_eq!(Preset::listed("khronos").product().levels(8), 2);
    let (side, between) = last("khronos", Some(5));
    assert!(
        side == 4 && between.relmse > GOOD && between.advice.is_some(),
        "{side}, {between:?}"
    );
    let (_, between) = last("unity", None);
    let advice = between.advice.unwrap();
    assert!(advice.contains("7 levels; use faces of 512"), "{advice}");
    assert_eq!(
        ["unity", "khronos"].map(|engine| Preset::listed(engine).side()),
        [512, 256]
    );
}

/// A user's preset overrides what it names; a wrong name, field or number is refused by its name.
#[test]
fn a_preset_is_read_from_its_own_fields() {
    let read = |text: &str| Preset::from_json(text.to_owned()).map(Preset::convention);
    let own =
        read(r#"{"name": "own", "axes": "-z+y+x", "alphas": [0, 0.5], "weight": "masking", "scale": 0.5}"#).unwrap();
    assert_eq!(
        (own.axes.to_string().as_str(), own.weight.name, own.scale),
        ("-z+y+x", "masking", 0.5)
    );
    assert_eq!(
        (own.alphas(2).unwrap(), own.masking),
        (vec![0.0, 0.5], MaskingShadowing::Correlated)
    );
    for (text, why) in [
        (r#"{"axis": "+x+y+z"}"#, "axis"),
        (r#"{"axes": "+x+x+z"}"#, "+x+x+z"),
        (r#"{"weight": "fg"}"#, "fg"),
        (r#"{"alphas": [0, 16.5]}"#, "16.5"),
        (r#"{"irradiance_scale": -1}"#, "-1"),
        (r#"{"alphas": [0.5, 0]}"#, "ascending"),
        (r#"{"product": {}, "alphas": [0, 1]}"#, "alphas"),
        (r#"{"product": {}, "scale": 2}"#, "scale"),
        (r#"{"product": {"texel": "rgba17f"}}"#, "rgba17f"),
        (r#"{"product": {"last_side": 17}}"#, "last_side"),
        (r#"{"product": {"level_count": 1}}"#, "level_count"),
        (r#"{"product": {"language": "MSL"}}"#, "MSL"),
        (r#"{"product": {"specular": "../map.ktx2"}}"#, "../map.ktx2"),
        (r#"{"product": {"specular": ""}}"#, "without a folder"),
        (r#"{"product": {"specular": "map.jpg"}}"#, "map.jpg"),
        (r#"{"product": {"tables": ["dfg.bmp"]}}"#, "dfg.bmp"),
        (r#"{"product": {"sh": "taps.ktx2"}}"#, "taps.ktx2"),
    ] {
        let fault = read(text).unwrap_err();
        assert!(fault.contains(why) && !fault.contains("line 1"), "{fault}");
    }
}

/// Half of the sphere at 1e6: halves end at 65504, so level 0 keeps 65504/1e6 of its light.
#[test]
fn a_sun_above_the_largest_number_of_a_format_is_reported_with_the_light_it_costs() {
    let light = light_of(|d| DVec3::splat(if d.y > 0.0 { 1e6 } else { 0.0 }));
    let baked = |format: &str| {
        let dir = tempfile::tempdir().unwrap();
        let making = Making {
            texel: Texel::listed(format),
            ..making("khronos", &light)
        };
        make(&making, dir.path()).unwrap()
    };
    for (format, largest) in [
        ("rgba16f", 65504.0),
        ("rgb9e5", 65408.0),
        ("r11g11b10f", 64512.0),
    ] {
        let level = &baked(format).levels[0];
        let Some(Loss::Cut(loss)) = level.loss else {
            panic!("{format}: {level:?}");
        };
        let share = 1.0 - largest / 1e6;
        assert!((loss.share / share - 1.0).abs() < 0.01, "{loss:?}");
        assert_eq!(loss.enough.unwrap().name, "rgb32f");
        assert!(f64::from(loss.largest) > 0.99e6);
    }
    assert!(
        baked("rgba32f")
            .levels
            .iter()
            .all(|level| level.loss.is_none())
    );

    // A sun of two texels: relMSE alone hardly notices it.
    let sun = DVec3::new(0.3, 0.8, 0.5).normalize();
    let light = light_of(|d| {
        DVec3::splat(if d.angle_between(sun) < 0.04 {
            3e5
        } else {
            1.0
        })
    });
    let dir = tempfile::tempdir().unwrap();
    let baked = make(&making("khronos", &light), dir.path()).unwrap();
    let level = &baked.levels[0];
    assert!(level.relmse < 0.01 && level.bias_rel < -0.2, "{level:?}");
    let Some(Loss::Cut(loss)) = level.loss else {
        panic!("{level:?}");
    };
    assert!((loss.share + level.bias_rel).abs() < 1e-12);
}

#[test]
fn formats_that_an_engine_does_not_draw_are_refused() {
    let light = marked_light();
    let refusal = |format: &str| {
        let making = Making {
            texel: Texel::listed(format),
            ..making("filament", &light)
        };
        making.check()
    };
    assert!(
        refusal("rgb9e5")
            .unwrap_err()
            .contains("filament does not draw it")
    );
    for format in ["rgba16f", "rgb16f", "rgba32f", "rgb32f", "r11g11b10f"] {
        refusal(format).unwrap();
    }
}

#[test]
fn a_shipped_file_names_its_source_without_folders() {
    let mut light = marked_light();
    light.name = "/home/someone/maps/studio.hdr".to_owned();
    let dir = tempfile::tempdir().unwrap();
    make(&making("filament", &light), dir.path()).unwrap();
    let keys = read_texture(&dir.path().join("ibl.ktx")).unwrap().keys;
    let source = keys.iter().find(|(key, _)| key == "splitsum.source");
    assert_eq!(source.unwrap().1, "studio.hdr");
}

/// A preset of the user has the effect of the listed one with the same fields.
#[test]
fn given_tables_take_a_preset_from_a_file() {
    let light = marked_light();
    let dir = tempfile::tempdir().unwrap();
    make(&making("khronos", &light), &dir.path().join("baked")).unwrap();
    std::fs::write(dir.path().join("mine.toml"), "axes = \"-z+y+x\"\n").unwrap();
    let map = |preset: &str| {
        let value = format!("file:baked/specular.ktx2#{preset}");
        given::map(&value, dir.path()).unwrap().unwrap()
    };
    assert_eq!(map("mine.toml").hash, map("khronos").hash);
    assert_ne!(map("mine.toml").hash, map("bevy").hash);
    let fault = given::map("file:baked/specular.ktx2#none.toml", dir.path()).unwrap_err();
    assert!(fault.contains("none.toml"), "{fault}");
}

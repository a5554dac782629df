//! Anisotropy, coats and sheens of glTF files.

use super::gltf::{F32, loaded, quad, seen};
use crate::gltf_files::{png, textured, uri};
use glam::DVec3;
use serde_json::{Value, json};
use splitsum::instrument::scene::{MaterialOverride, Scene};
use std::f64::consts::FRAC_PI_6;

/// The anisotropy of a file: map and rotation turn the tangent, and blue scales the strength.
#[test]
fn an_anisotropy_has_its_direction_and_strength() {
    let plain = json!({ "anisotropyStrength": 0.5, "anisotropyRotation": FRAC_PI_6 });
    let mut mapped = plain.clone();
    mapped["anisotropyTexture"] = json!({ "index": 0 });
    for (anisotropy, degrees, strength) in [(plain, 30.0f64, 0.5), (mapped, 75.0, 0.4)] {
        let material = json!({ "extensions": { "KHR_materials_anisotropy": anisotropy } });
        // Halfway between the tangent and the bitangent, 0.8 long.
        let scene = loaded(&textured(
            quad(),
            material,
            &[png(1, 1, |_, _| [218, 218, 204])],
        ));
        assert!(scene.has_anisotropy(), "{degrees}");
        let [x, y, z, found] = seen(&scene.tangents(), [1, 1], DVec3::Z).normal_alpha.data[0];
        let (sin, cos) = degrees.to_radians().sin_cos();
        assert!(
            (x - cos).abs() < 1e-5 && (y - sin).abs() < 1e-5 && z.abs() < 1e-6,
            "{degrees}: {x} {y} {z}"
        );
        assert!((found - strength).abs() < F32, "{degrees}: {found}");
    }
}

/// The coat of a file as the g-buffers of its surface and of its weight: factors, channels, normal
/// map.
#[test]
fn a_clear_coat_has_its_own_maps_and_normal() {
    let coat = json!({
        "clearcoatFactor": 0.5, "clearcoatTexture": { "index": 0 },
        "clearcoatRoughnessFactor": 0.5, "clearcoatRoughnessTexture": { "index": 0 },
        "clearcoatNormalTexture": { "index": 1, "scale": 0.5 },
    });
    let material = json!({ "extensions": { "KHR_materials_clearcoat": coat } });
    let images = [
        png(1, 1, |_, _| [51, 102, 204]),
        png(1, 1, |_, _| [255, 128, 128]),
    ];
    let mut model = textured(quad(), material, &images);
    model["extensionsUsed"] = json!(["KHR_materials_clearcoat"]);
    model["extensionsRequired"] = json!(["KHR_materials_clearcoat"]);
    let scene = loaded(&model);
    let seen = |scene: &Scene| seen(scene, [1, 1], DVec3::Z);
    let (base, coat, weights) = (
        seen(&scene),
        seen(&scene.coat(1.0, |alpha| alpha)),
        seen(&scene.coat_weights()),
    );
    let [x, y, z, alpha] = coat.normal_alpha.data[0];
    let slope = 0.5 / (2.0 * 128.0 / 255.0 - 1.0);
    assert!(
        (alpha - 0.25 * 0.4 * 0.4).abs() < F32
            && (x / z - slope).abs() < 1e-3 * slope
            && y.abs() < 0.01
    );
    assert_eq!(base.normal_alpha.data[0][..3], [0.0, 0.0, 1.0]);
    assert!((weights.albedo_metallic.data[0][0] - 0.1).abs() < F32);
    assert_eq!(
        (coat.f0_material.data[0][0], coat.albedo_metallic.data[0]),
        (1.0, [0.0; 4])
    );
    assert!(scene.has_coat() && !scene.uncoated().has_coat());
    // Values of axes replace its maps.
    let set = |values: MaterialOverride| scene.apply(&values).materials[0].coat;
    let weight = set(MaterialOverride {
        coat: Some(1.0),
        ..MaterialOverride::default()
    });
    let alpha = set(MaterialOverride {
        coat_alpha: Some(0.5),
        ..MaterialOverride::default()
    });
    assert_eq!(
        (
            weight.weight,
            weight.weight_map,
            weight.roughness_map.is_some()
        ),
        (1.0, None, true)
    );
    assert_eq!(
        (alpha.alpha, alpha.roughness_map, alpha.weight_map.is_some()),
        (0.5, None, true)
    );
}

/// The sheen of a file: colour by its sRGB map, roughness by the alpha channel; a smooth one is
/// raised to the least width.
#[test]
fn a_sheen_has_its_color_and_roughness() {
    let sheen = json!({
        "sheenColorFactor": [0.5, 1.0, 0.0], "sheenColorTexture": { "index": 0 },
        "sheenRoughnessFactor": 0.5, "sheenRoughnessTexture": { "index": 0 },
    });
    let material = |sheen: Value| json!({ "extensions": { "KHR_materials_sheen": sheen } });
    let eight = image::DynamicImage::from(image::RgbaImage::from_pixel(
        1,
        1,
        image::Rgba([188, 188, 188, 204]),
    ));
    let image = || uri(eight.clone());
    let [scene, deep] = [image(), uri(eight.clone().into_rgba16())]
        .map(|image| loaded(&textured(quad(), material(sheen.clone()), &[image])));
    let seen = |scene: &Scene| seen(scene, [1, 1], DVec3::Z);
    let colors = seen(&scene.sheen_colors());
    for lobe in [&scene, &deep].map(|scene| seen(&scene.sheen())) {
        assert!((lobe.normal_alpha.data[0][3] - 0.25 * 0.8 * 0.8).abs() < F32);
    }
    let [r, g, b, _] = colors.albedo_metallic.data[0];
    assert!(
        (r - 0.251).abs() < 2e-3 && (g - 2.0 * r).abs() < F32 && b == 0.0,
        "{r} {g} {b}"
    );
    assert!(scene.has_sheen() && !scene.without_sheen().has_sheen());
    let smooth = loaded(&textured(
        quad(),
        material(json!({ "sheenColorFactor": [1, 1, 1] })),
        &[image()],
    ));
    assert_eq!(smooth.materials[0].sheen.alpha, 0.01);
}

/// The specular weight and colour of a file: F is `w min(f0 colour, 1)` at normal incidence and w at
/// grazing, but for metals.
#[test]
fn a_specular_extension_scales_the_dielectric_interface() {
    let specular = json!({
        "specularFactor": 0.5, "specularTexture": { "index": 0 },
        "specularColorFactor": [2, 1, 40], "specularColorTexture": { "index": 1 },
    });
    let images = [
        uri(image::RgbaImage::from_pixel(
            1,
            1,
            image::Rgba([0, 0, 0, 102]),
        )),
        png(1, 1, |_, _| [255, 0, 255]),
    ];
    for metallic in [0.0, 0.25, 1.0] {
        let material = json!({
            "pbrMetallicRoughness": { "metallicFactor": metallic, "baseColorFactor": [0.8, 0.8, 0.8, 1] },
            "extensions": { "KHR_materials_specular": specular },
        });
        let scene = loaded(&textured(quad(), material, &images));
        let seen = |scene: &Scene| seen(scene, [1, 1], DVec3::Z).f0_material.data[0];
        let [red, green, blue, _] = seen(&scene);
        let weight = seen(&scene.specular_weights())[0];
        let dielectric = [0.08, 0.0, 1.0].map(|f0| 0.2 * f0);
        let expected = dielectric.map(|f0| f0 * (1.0 - metallic) + 0.8 * metallic);
        for (f0, expected) in [red, green, blue].into_iter().zip(expected) {
            assert!(
                (weight * f0 - expected).abs() < F32,
                "{metallic}: {f0} {expected}"
            );
        }
        let f90 = 0.2 * (1.0 - metallic) + metallic;
        assert!((weight - f90).abs() < F32, "{metallic}: {weight}");
    }
    let set = MaterialOverride {
        f0: Some([0.5; 3]),
        ..MaterialOverride::default()
    };
    let plain = loaded(&textured(
        quad(),
        json!({ "extensions": { "KHR_materials_specular": specular } }),
        &images,
    ));
    assert!(plain.has_specular_weight() && !plain.apply(&set).has_specular_weight());
}

/// Emission: factor, sRGB texture and strength.
#[test]
fn emission_is_its_factor_texture_and_strength() {
    let material = json!({
        "emissiveFactor": [1, 0.5, 0], "emissiveTexture": { "index": 0 },
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 8 } },
    });
    let scene = loaded(&textured(quad(), material, &[png(1, 1, |_, _| [188; 3])]));
    assert_eq!(scene.warnings, Vec::<String>::new());
    let [red, green, blue, _] = seen(&scene.emission(), [1, 1], DVec3::Z)
        .albedo_metallic
        .data[0];
    // sRGB 188 is 0.50289 linear.
    let off = [red - 8.0 * 0.502_886_5, green - 4.0 * 0.502_886_5, blue];
    assert!(off.iter().all(|off| off.abs() < 1e-4), "{off:?}");
    assert!(scene.has_emission() && !scene.dark().has_emission());
}

/// Textures whose only source is a WebP file.
#[test]
fn webp_textures_are_read() {
    let mut file = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(1, 1, image::Rgb([188, 0, 255]))
        .write_to(&mut file, image::ImageFormat::WebP)
        .expect("a picture in memory");
    let base64 = base64::Engine::encode(&base64::prelude::BASE64_STANDARD, file.into_inner());
    let image =
        json!({ "uri": format!("data:image/webp;base64,{base64}"), "mimeType": "image/webp" });
    let material = json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } });
    let mut model = textured(quad(), material, &[image]);
    model["textures"] = json!([{ "extensions": { "EXT_texture_webp": { "source": 0 } } }]);
    model["extensionsUsed"] = json!(["EXT_texture_webp"]);
    model["extensionsRequired"] = json!(["EXT_texture_webp"]);
    let scene = loaded(&model);
    assert_eq!(scene.warnings, Vec::<String>::new());
    let [red, green, blue, _] = seen(&scene, [1, 1], DVec3::Z).albedo_metallic.data[0];
    assert!((red - 0.502_886_5).abs() < 1e-4 && green == 0.0 && blue == 1.0);
}

/// Maps that a factor of 0 multiplies are not read: their texture coordinates and images don't
/// matter.
#[test]
fn maps_without_effect_are_not_read() {
    let other_set = json!({ "index": 0, "texCoord": 1 });
    let material = json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": { "index": 1 },
            "metallicFactor": 0, "roughnessFactor": 0, "metallicRoughnessTexture": other_set,
        },
        "emissiveTexture": other_set,
        "normalTexture": { "index": 0, "texCoord": 1, "scale": 0 },
        "extensions": {
            "KHR_materials_clearcoat": {
                "clearcoatTexture": other_set, "clearcoatRoughnessTexture": other_set,
                "clearcoatNormalTexture": other_set,
            },
            "KHR_materials_sheen": { "sheenColorTexture": other_set, "sheenRoughnessTexture": other_set },
            "KHR_materials_anisotropy": { "anisotropyTexture": other_set },
            "KHR_materials_specular": {
                "specularFactor": 0, "specularTexture": other_set, "specularColorTexture": other_set,
            },
        },
    });
    let missing = json!({ "uri": "missing.png" });
    let scene = loaded(&textured(
        quad(),
        material,
        &[missing, png(1, 1, |_, _| [255; 3])],
    ));
    assert_eq!(scene.textures.len(), 1);
    // Without texture coordinates.
    let mut bare = textured(
        quad(),
        json!({ "emissiveTexture": { "index": 0 } }),
        &[json!({ "uri": "missing.png" })],
    );
    bare["meshes"][0]["primitives"][0]["attributes"]
        .as_object_mut()
        .expect("attributes")
        .remove("TEXCOORD_0");
    assert_eq!(loaded(&bare).textures.len(), 0);
}

/// Misspelt and older members are named, of the core material and of extensions.
#[test]
fn unknown_members_of_materials_are_named() {
    let material = json!({
        "name": "paint",
        "baseColor": [1, 1, 1],
        "extras": { "anything": 1 },
        "pbrMetallicRoughness": { "roughness": 0.5 },
        "extensions": {
            "KHR_materials_clearcoat": { "clearCoatFactor": 1, "extras": {} },
            "KHR_materials_anisotropy": { "anisotropy": 0.5 },
        },
    });
    let warnings = loaded(&textured(quad(), material, &[])).warnings;
    let [warning] = &warnings[..] else {
        panic!("{warnings:?}")
    };
    for part in [
        "material 0 (\"paint\")",
        "baseColor",
        "pbrMetallicRoughness.roughness",
        "KHR_materials_clearcoat.clearCoatFactor",
        "KHR_materials_anisotropy.anisotropy",
    ] {
        assert!(warning.contains(part), "{part}: {warning}");
    }
    assert!(!warning.contains("extras"), "{warning}");
}

/// Anisotropic files of Blender come with the flag that has the widths of its renders.
#[test]
fn anisotropy_by_blender_names_its_widths() {
    let material =
        json!({ "extensions": { "KHR_materials_anisotropy": { "anisotropyStrength": 0.5 } } });
    let mut model = textured(quad(), material, &[]);
    assert_eq!(loaded(&model).warnings, Vec::<String>::new());
    model["asset"]["generator"] = json!("Khronos glTF Blender I/O v5.2.3");
    let warnings = loaded(&model).warnings;
    assert!(
        warnings[0].contains("--anisotropy-widths disney"),
        "{warnings:?}"
    );
}

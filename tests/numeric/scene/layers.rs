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

//! The g-buffer against its f64 twin.

use crate::compare::{Tolerance, Worst, absolute, relative};
use crate::gbuffer_twin as reference;
use crate::gltf_files::{load, png, sheet, textured};
use crate::harness::{filter_error, poison_image, with_gpu};
use serde_json::json;
use splitsum::base::pixels::Pixels;
use splitsum::instrument::gbuffer::Gbuffer;
use splitsum::instrument::gbuffer::pass::{self, GbufferImages, SceneData};
use splitsum::instrument::gpu::Gpu;
use splitsum::instrument::scene::{Camera, CameraKind, MaterialOverride, Scene};
use splitsum::instrument::shade::coat::COAT_RENDERERS;
use std::path::Path;

/// The attachments start as NaN, which reveals a texel that is neither cleared nor written.
pub fn draw(gpu: &Gpu, scene: &Scene, camera: &Camera, size: [u32; 2]) -> Gbuffer<f32> {
    let target = GbufferImages::new(gpu, size).unwrap();
    target
        .attachments
        .iter()
        .for_each(|image| poison_image(gpu, image));
    let data = SceneData::new(gpu, scene).unwrap();
    let mut recorder = gpu.record("gbuffer").unwrap();
    pass::record(&mut recorder, &data, camera, target.all()).unwrap();
    recorder.submit().unwrap();
    target.read(gpu).unwrap()
}

type Attachment = (
    &'static str,
    fn(&Gbuffer<f32>) -> &Pixels<[f32; 4]>,
    fn(&Gbuffer<f64>) -> &Pixels<[f64; 4]>,
);
const ATTACHMENTS: [Attachment; 4] = [
    ("position", |g| &g.position_mask, |g| &g.position_mask),
    ("normal", |g| &g.normal_alpha, |g| &g.normal_alpha),
    ("albedo", |g| &g.albedo_metallic, |g| &g.albedo_metallic),
    ("f0", |g| &g.f0_material, |g| &g.f0_material),
];

#[test]
fn spheres_are_exact_to_f32() {
    // A ray's hit is known to f32 (1e-7); near the rim the error grows as 1 / n_dot_v.
    const F32_AT_THE_RIM: f64 = 1e-6;
    with_gpu(|gpu| {
        for (name, kind, size) in [
            ("sphere", CameraKind::Ortho, [128, 128]),
            ("sphere", CameraKind::Perspective, [97, 61]),
            ("spheres", CameraKind::Ortho, [150, 90]),
            ("spheres", CameraKind::Perspective, [64, 120]),
        ] {
            let material = MaterialOverride {
                anisotropy: Some(0.5),
                anisotropy_turn: Some(0.7),
                ..Default::default()
            };
            let plain = Scene::load(name, Path::new(".")).unwrap();
            let coat = MaterialOverride {
                coat: Some(0.6),
                coat_alpha: Some(0.8),
                ..MaterialOverride::default()
            };
            let coated = plain.apply(&coat);
            let mut scenes: Vec<Scene> = COAT_RENDERERS
                .iter()
                .map(|renderer| coated.below_coat(renderer.base))
                .collect();
            if kind == CameraKind::Perspective {
                scenes.push(plain.apply(&material).tangents());
            }
            for scene in &scenes {
                let camera = Camera::for_scene(kind, scene, size);
                let (actual, twin) = (
                    draw(gpu, scene, &camera, size),
                    reference::gbuffer(scene, &camera, size),
                );
                assert_eq!(actual.mask(), twin.mask(), "{name} {kind:?}");
                let n_dot_v = reference::gbuffer(&plain, &camera, size).n_dot_v(&camera);
                // The scene of spheres is 5 wide, and positions are absolute.
                let scale = scene.bounds().1.max_element();
                for (what, device, exact) in ATTACHMENTS {
                    let mut worst = Worst::new(
                        format!("{name} {kind:?} {what}"),
                        absolute(F32_AT_THE_RIM * scale),
                    );
                    for (i, (a, b)) in device(&actual)
                        .data
                        .iter()
                        .zip(&exact(&twin).data)
                        .enumerate()
                    {
                        // Materials are copied; positions and normals are computed.
                        let rim = if matches!(what, "position" | "normal") {
                            f64::from(n_dot_v.data[i])
                        } else {
                            1.0
                        };
                        for c in 0..4 {
                            worst.add((f64::from(a[c]) - b[c]) * rim, 0.0, || {
                                format!("pixel {i} n_dot_v {rim}")
                            });
                        }
                    }
                    worst.check();
                }
            }
        }
    });
}

#[test]
fn meshes_agree_inside_their_triangles() {
    with_gpu(|gpu| {
        // Vertices snap to a grid of this step in pixels: 1/256 on most devices, 1/16 at worst
        // (Vulkan's minimum). Two units is the side of the plane, here 53 pixels.
        let grid = 1.0 / f64::from(1 << gpu.sub_pixel_precision_bits());
        let sub_pixel = absolute(4.0 * grid / 53.0);
        for kind in [CameraKind::Ortho, CameraKind::Perspective] {
            let scene = Scene::load("plane", Path::new(".")).unwrap();
            // At this size no edge comes nearer than 1/16 to a column of pixel centres.
            let size = [56, 56];
            compare_mesh(gpu, &scene, kind, size, sub_pixel);
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tent.obj");
        // Two quads side by side, the left one seen from the front, the right one from behind; a
        // textured material.
        let obj = "mtllib tent.mtl\nusemtl cloth\nv -1 0 0.2\nv 0 0 0.2\nv 0 1 0\nv -1 1 0\nv 0.1 \
                   0 0\nv 0.1 1 0.3\nv 1 1 0.3\nv 1 0 0\n\
                   vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\nf 5/1 6/2 7/3 8/4\n";
        std::fs::write(&path, obj).unwrap();
        std::fs::write(
            folder.path().join("tent.mtl"),
            "newmtl cloth\nKd 0.5 0.25 1\nmap_Kd cloth.png\nPr 0.5\nPm 0.25\n",
        )
        .unwrap();
        let texture =
            image::RgbImage::from_fn(4, 3, |x, y| image::Rgb([60 * x as u8, 80 * y as u8, 200]));
        texture.save(folder.path().join("cloth.png")).unwrap();
        let scene = Scene::load(path.to_str().unwrap(), Path::new(".")).unwrap();
        assert_eq!(
            (scene.textures.len(), scene.warnings.len()),
            (1, 0),
            "{:?}",
            scene.warnings
        );
        for kind in [CameraKind::Ortho, CameraKind::Perspective] {
            compare_mesh(gpu, &scene, kind, [80, 64], sub_pixel);
        }
        // Every map, on a bent sheet seen from its front and from its back.
        for (is_double_sided, scale) in [(true, 1.0), (true, -1.0), (false, 1.0)] {
            let scene = mapped_sheet(is_double_sided, scale);
            compare_mesh(gpu, &scene, CameraKind::Perspective, [64, 64], sub_pixel);
            compare_mesh(
                gpu,
                &scene.tangents(),
                CameraKind::Perspective,
                [64, 64],
                sub_pixel,
            );
        }
        // What renderers change below a coat whose weight and roughness have maps.
        for renderer in COAT_RENDERERS {
            let scene = mapped_sheet(true, 1.0).below_coat(renderer.base);
            compare_mesh(gpu, &scene, CameraKind::Perspective, [64, 64], sub_pixel);
        }
        // Without tangents of its own.
        compare_mesh(
            gpu,
            &scene.tangents(),
            CameraKind::Perspective,
            [80, 64],
            sub_pixel,
        );
        compare_mesh(
            gpu,
            &far_sheet(),
            CameraKind::Perspective,
            [64, 64],
            sub_pixel,
        );
        let away = mapped_sheet(false, -1.0);
        let camera = Camera::for_scene(CameraKind::Perspective, &away, [64, 64]);
        assert!(
            draw(gpu, &away, &camera, [64, 64])
                .mask()
                .data
                .iter()
                .all(|mask| *mask == 0.0),
            "a back is seen"
        );
    });
}

/// The largest change of a surface's position from a pixel to one of its neighbours.
fn slope(position: &Pixels<[f64; 4]>, i: usize) -> f64 {
    let width = position.width as usize;
    let beside =
        [i.wrapping_sub(1), i + 1, i.wrapping_sub(width), i + width].map(|k| position.data.get(k));
    let own = position.data[i];
    let step = |other: &[f64; 4]| {
        (0..3)
            .map(|c| (other[c] - own[c]).abs())
            .fold(0.0, f64::max)
    };
    beside
        .into_iter()
        .flatten()
        .filter(|other| other[3] == 1.0)
        .map(step)
        .fold(0.0, f64::max)
}

/// Two triangles at an angle, with small maps, including a normal map.
fn mapped_sheet(is_double_sided: bool, z_scale: f64) -> Scene {
    let material = json!({
        "doubleSided": is_double_sided,
        "extensions": {
            "KHR_materials_anisotropy": {
                "anisotropyStrength": 0.8, "anisotropyRotation": 0.6, "anisotropyTexture": { "index": 3 },
            },
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.9, "clearcoatTexture": { "index": 3 },
                "clearcoatRoughnessFactor": 1, "clearcoatRoughnessTexture": { "index": 0 },
            },
        },
        "normalTexture": { "index": 2, "scale": 0.7 },
        "pbrMetallicRoughness": {
            "metallicFactor": 0.8, "roughnessFactor": 0.9,
            "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 },
        },
    });
    let image = |a: u32, b: u32| {
        png(2, 2, move |x, y| {
            [
                (a + 20 * x) as u8,
                (b + 30 * y) as u8,
                (200 + 10 * x + y) as u8,
            ]
        })
    };
    let mut model = textured(
        sheet(),
        material,
        &[
            image(90, 60),
            image(10, 100),
            image(120, 110),
            image(200, 60),
        ],
    );
    model["nodes"][0]["scale"] = json!([1, 1, z_scale]);
    load(&model).expect("a readable file")
}

/// The sheet with a map of three to four texels a pixel: slow waves, and a chequer of single texels
/// that only the first level has; turned, mirrored in u and clamped in v.
fn far_sheet() -> Scene {
    let transform = json!({ "offset": [-0.4, -0.3], "rotation": 0.5, "scale": [3, 2.5] });
    let info = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    let material = json!({ "pbrMetallicRoughness": { "metallicRoughnessTexture": info, "metallicFactor": 0.5 } });
    let wave = |x: u32, y: u32| {
        let chequer = if (x + y).is_multiple_of(2) {
            60.0
        } else {
            -60.0
        };
        let at = |i: u32| (20.0 * (f64::from(i) / 10.0).sin() + 128.0 + chequer).round() as u8;
        [0, at(x), at(y)]
    };
    let mut model = textured(sheet(), material, &[png(64, 64, wave)]);
    model["samplers"] = json!([{ "wrapS": 33648, "wrapT": 33071 }]);
    model["textures"][0]["sampler"] = json!(0);
    load(&model).expect("a readable file")
}

fn compare_mesh(gpu: &Gpu, scene: &Scene, kind: CameraKind, size: [u32; 2], tolerance: Tolerance) {
    let camera = Camera::for_scene(kind, scene, size);
    let (actual, twin) = (
        draw(gpu, scene, &camera, size),
        reference::gbuffer(scene, &camera, size),
    );
    let hits = |mask: &Pixels<f32>, i: usize| mask.data[i] == 1.0;
    let (a_mask, b_mask) = (actual.mask(), twin.mask());
    let all = 0..b_mask.data.len();
    // The maps change by up to 0.3 from texel to texel, and 20 pixels are a texel.
    let filtered = 0.3 * filter_error();
    // An edge through a pixel's centre may fall on either side.
    let edge = all
        .clone()
        .filter(|&i| hits(&a_mask, i) != hits(&b_mask, i))
        .count();
    assert!(
        edge <= 4,
        "{} {kind:?}: {edge} pixels differ in mask",
        scene.name
    );
    for (what, device, exact) in ATTACHMENTS {
        let mut worst = Worst::new(format!("{} {kind:?} {what}", scene.name), tolerance);
        let mut off_count = 0;
        for i in all
            .clone()
            .filter(|&i| hits(&a_mask, i) && hits(&b_mask, i))
        {
            let (a, b) = (device(&actual).data[i], exact(&twin).data[i]);
            let off = (0..4)
                .map(|c| (f64::from(a[c]) - b[c]).abs())
                .fold(0.0, f64::max);
            // Where two triangles meet, either one may be in front.
            if off > 0.1 {
                off_count += 1;
                continue;
            }
            // A vertex off by a step of the grid moves a slanted surface by more.
            let slope = if what == "position" {
                slope(exact(&twin), i)
            } else {
                0.0
            };
            let case = || {
                format!(
                    "pixel {} {}: {a:?} against {b:?}",
                    i as u32 % size[0],
                    i as u32 / size[0]
                )
            };
            let snapped = 2.0 * slope / f64::from(1 << gpu.sub_pixel_precision_bits());
            worst.add_within(off, 0.0, filtered + snapped, case);
        }
        assert!(
            off_count <= 4,
            "{} {kind:?} {what}: {off_count} pixels show something else",
            scene.name
        );
        worst.check();
    }
    let mut n_dot_v = Worst::new(format!("{} {kind:?} n_dot_v", scene.name), relative(1e-3));
    let (a, b) = (actual.n_dot_v(&camera), twin.n_dot_v(&camera));
    for i in
        all.filter(|&i| hits(&a_mask, i) && hits(&b_mask, i) && (a.data[i] - b.data[i]).abs() < 0.1)
    {
        n_dot_v.add_within(f64::from(a.data[i]), f64::from(b.data[i]), filtered, || {
            format!("pixel {i}")
        });
    }
    n_dot_v.check();
}

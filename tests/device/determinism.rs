//! The same request gives the same bits: repeated, on a fresh device, in another process, after
//! other work. Earlier contents of memory have no effect.

use crate::harness::{
    golden_environment, lobe_sphere, poison, request, scene, with_gpu, with_pipeline,
    with_submissions,
};
use crate::tables::environment_image;
use splitsum::base::glsl::constants::{FRESNEL_SCHLICK, GROUP_SIDE};
use splitsum::base::math::sequence::{FramePoints, PixelPoints};
use splitsum::instrument::brdf::MODELS;
use splitsum::instrument::environment::Placement;
use splitsum::instrument::environment::distribution::EnvironmentDistribution;
use splitsum::instrument::gbuffer::pass::{self, GbufferImages, SceneData};
use splitsum::instrument::gpu::{Format, Gpu, Groups, Part, image_groups};
use splitsum::instrument::metrics::Epsilon;
use splitsum::instrument::pipeline::{Pipeline, RenderRequest};
use splitsum::instrument::precompute::points::Points;
use splitsum::instrument::precompute::{PrecomputeSettings, PrefilterBy};
use splitsum::instrument::scene::{CameraKind, MaterialOverride};
use splitsum::instrument::shade::pass::{Passes, Tables};
use splitsum::instrument::shade::reference_pass::{
    DistributionBuffers, Lobe, ReferenceRun, Stop, Sums,
};
use splitsum::instrument::shade::{DIFFUSE, METHODS};

/// Every method and diffuse method on the grid of spheres.
fn requests() -> Vec<RenderRequest> {
    let environment = golden_environment();
    let base = RenderRequest {
        reference_samples: 64,
        background: true,
        ..request(
            &environment,
            scene("spheres", MaterialOverride::default()),
            CameraKind::Perspective,
            [40, 24],
        )
        .shaded(|s| {
            s.placement = Placement {
                orientation: 2,
                rotation_deg: 20.0,
            }
        })
    };
    let of_method = METHODS
        .iter()
        .map(|method| base.shaded(|s| s.method = method));
    let of_diffuse = DIFFUSE.iter().zip(MODELS.iter().cycle());
    let of_diffuse =
        of_diffuse.map(|(diffuse, brdf)| base.shaded(|s| (s.diffuse, s.brdf) = (diffuse, *brdf)));
    of_method.chain(of_diffuse).collect()
}

/// Every work group is in one part of a pass, and a part of several groups stays within the limit
/// of a submission.
#[test]
fn parts_cover_a_pass_once_within_the_budget() {
    with_gpu(|gpu| {
        let shapes = [
            ([1, 1], 1, 1),
            ([512, 512], 1, 1024),
            ([18, 18], 6, 4096),
            ([1024, 40], 6, 1 << 16),
            ([129, 257], 6, 1 << 20),
        ];
        for (size, faces, samples) in shapes {
            let [columns, rows, _] = image_groups(size[0], size[1]);
            let mut seen = vec![0; (columns * rows * faces) as usize];
            for Part {
                first_row,
                groups:
                    Groups {
                        first: [x, y, z],
                        count: [width, height, depth],
                    },
            } in gpu.parts(size, faces, samples)
            {
                let count = width * height * depth;
                let taken = u64::from(count * GROUP_SIDE * GROUP_SIDE) * samples;
                assert!(
                    count == 1 || taken <= gpu.submission_samples(),
                    "{size:?} {faces} {samples}: {count} groups"
                );
                let first = first_row / GROUP_SIDE + y;
                for (face, row) in (z..z + depth)
                    .flat_map(|face| (first..first + height).map(move |row| (face, row)))
                {
                    (x..x + width).for_each(|column| {
                        seen[((face * rows + row) * columns + column) as usize] += 1
                    });
                }
            }
            assert!(
                seen.iter().all(|times| *times == 1),
                "{size:?} {faces} {samples}"
            );
        }
    });
}

/// Short submissions split the usual ones: rows, columns and faces.
#[test]
fn short_submissions_make_the_same_image() {
    let precompute = PrecomputeSettings {
        prefilter: PrefilterBy::Sampled,
        prefilter_sample_count: 1200,
        prefilter_size: [24, 24],
        prefilter_level_count: 3,
        ..PrecomputeSettings::default()
    };
    let sphere = scene("sphere", MaterialOverride::default());
    let base = RenderRequest {
        background: true,
        ..request(
            &golden_environment(),
            sphere,
            CameraKind::Perspective,
            [44, 20],
        )
        .shaded(|s| {
            s.precompute = precompute;
            s.samples = 1500;
            s.diffuse = DIFFUSE
                .iter()
                .find(|diffuse| diffuse.uses_irradiance_map)
                .unwrap();
        })
    };
    let sampled = base.shaded(|s| {
        s.method = METHODS
            .iter()
            .find(|method| method.name == "sampled")
            .unwrap()
    });
    let blue = sampled.shaded(|s| (s.frame, s.frames.points) = (Some(0), FramePoints::Blue));
    let requests = [base, sampled, blue];
    let [usual, short] = [false, true].map(|is_interactive| {
        let mut hashes = Vec::new();
        with_submissions(is_interactive, |pipeline| {
            hashes.extend(requests.iter().map(|request| frame_hash(pipeline, request)));
        });
        hashes
    });
    assert_eq!(usual, short);
}

fn frame_hash(pipeline: &mut Pipeline, request: &RenderRequest) -> String {
    let frame = pipeline.render(request).unwrap();
    let mut hasher = blake3::Hasher::new();
    hasher.update(bytemuck::cast_slice(&frame.radiance.data));
    if let Some(error) = &frame.standard_error {
        hasher.update(bytemuck::cast_slice(&error.data));
    }
    hasher.finalize().to_hex().to_string()
}

/// Names the file to which the other process writes its hashes.
const HASH_FILE: &str = "SPLITSUM_TEST_HASH_FILE";

/// The other process of `frames_have_the_same_bits_everywhere`; without the variable it does
/// nothing.
#[test]
fn hashes_of_another_process() {
    let Some(path) = std::env::var_os(HASH_FILE) else {
        return;
    };
    with_pipeline(|pipeline| {
        let hashes: Vec<String> = requests()
            .iter()
            .map(|request| frame_hash(pipeline, request))
            .collect();
        std::fs::write(&path, hashes.join("\n")).unwrap();
    });
}

#[test]
fn frames_have_the_same_bits_everywhere() {
    with_pipeline(|pipeline| {
        let requests = requests();
        let first: Vec<String> = requests
            .iter()
            .map(|request| frame_hash(pipeline, request))
            .collect();
        // Again in another order, so that every frame follows a different one.
        for (request, hash) in requests.iter().zip(&first).rev() {
            let name = format!(
                "{} {}",
                request.shading.method.name, request.shading.diffuse.name
            );
            assert_eq!(
                frame_hash(pipeline, request),
                *hash,
                "{name} after other work"
            );
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hashes");
        let status = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "determinism::hashes_of_another_process"])
            .env(HASH_FILE, &path)
            .output()
            .unwrap();
        assert!(
            status.status.success(),
            "{}",
            String::from_utf8_lossy(&status.stdout)
        );
        let other = std::fs::read_to_string(&path).unwrap();
        assert_eq!(other.lines().collect::<Vec<_>>(), first, "another process");
        // Other seeds are other points: the hash depends on the radiance.
        let reference = requests
            .iter()
            .find(|request| request.shading.method.name == "reference")
            .unwrap();
        let other_seed = RenderRequest {
            seed: 2,
            ..reference.clone()
        };
        assert_ne!(
            frame_hash(pipeline, &other_seed),
            frame_hash(pipeline, reference)
        );
    });
}

/// Memory that the next buffers of this size will probably get holds NaNs.
fn poison_free_memory(gpu: &Gpu, size: u64) {
    let buffers: Vec<_> = (0..8)
        .map(|_| gpu.buffer("poison", size).unwrap())
        .collect();
    buffers.iter().for_each(|buffer| poison(gpu, buffer));
}

#[test]
fn the_reference_reads_no_memory_before_writing_it() {
    with_gpu(|gpu| {
        let environment = golden_environment();
        let size = [24, 24];
        let bytes = 16 * 24 * 24;
        let request = request(&environment, lobe_sphere(0.3), CameraKind::Ortho, size);
        let image = environment_image(gpu, &environment.image);
        let distribution =
            DistributionBuffers::new(gpu, &EnvironmentDistribution::new(&environment.image))
                .unwrap();
        let blank = gpu.image("blank", [1, 1], 1, Format::Rgba32Float).unwrap();
        let tables = Tables {
            environment: image,
            filtered: blank.clone(),
            prefiltered: blank.clone(),
            dfg: blank.clone(),
            tap_table: blank.clone(),
            irradiance_map: blank.clone(),
            sh9_texture: blank,
            sh9: gpu.buffer("blank", 256).unwrap(),
            points: Points::upload(gpu, 1, request.shading.sequence, 0, PixelPoints::Shared)
                .unwrap(),
            shifts: gpu.buffer("blank", 256).unwrap(),
        };
        let gbuffer = GbufferImages::new(gpu, size).unwrap();
        let scene = SceneData::new(gpu, &request.scene).unwrap();
        let mut recorder = gpu.record("gbuffer").unwrap();
        pass::record(&mut recorder, &scene, &request.camera, gbuffer.all()).unwrap();
        recorder.submit().unwrap();
        let mask = gbuffer.read(gpu).unwrap().mask();
        let results = [false, true].map(|is_poisoned| {
            if is_poisoned {
                poison_free_memory(gpu, bytes);
            }
            let sums = Sums::new(gpu, size).unwrap();
            // The pass adds to these two, so the pipeline clears them.
            let [radiance, squared_error] = ["radiance", "squared error"].map(|name| {
                let buffer = gpu.buffer(name, bytes).unwrap();
                let mut recorder = gpu.record(name).unwrap();
                recorder.fill(&buffer, 0);
                recorder.submit().unwrap();
                buffer
            });
            let run = ReferenceRun {
                passes: Passes {
                    shading: &request.shading,
                    camera: &request.camera,
                    tables: &tables,
                    gbuffer: &gbuffer,
                    fresnel_f0: FRESNEL_SCHLICK,
                    tangents: None,
                    radiance: &radiance,
                },
                stop: Stop {
                    sample_count: 64,
                    relative_error: None,
                },
                epsilon: Epsilon::ABSOLUTE,
                seed: 1,
                mask: &mask,
                distribution: &distribution,
                sums: &sums,
                squared_error: &squared_error,
            };
            run.run(gpu, Lobe::Specular("specular"), None).unwrap();
            [&radiance, &squared_error].map(|buffer| gpu.read_buffer::<u32>(buffer).unwrap())
        });
        assert!(
            results[0] == results[1],
            "the contents of fresh memory change the result"
        );
        assert!(results[0][0].iter().any(|&word| word != 0));
    });
}

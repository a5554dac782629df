//! Tables and references from the disk have the bits of those that are made; halves are rounded once.

use crate::harness::{golden_environment, request, scene, with_pipeline};
use half::f16;
use splitsum::environment::Environment;
use splitsum::pipeline::{BakeRequest, DiskCache, Pipeline, RenderRequest};
use splitsum::pixels::{RgbImage, exr};
use splitsum::precompute::{HALF_MAX, PrecomputeSettings, StorageFormat};
use splitsum::scene::{CameraKind, MaterialOverride};
use splitsum::shade::{diffuse_by_name, method_by_name};
use std::path::Path;
use std::sync::Arc;

const SMALL: PrecomputeSettings = PrecomputeSettings {
    prefilter_size: [32, 16],
    prefilter_level_count: 2,
    prefilter_sample_count: 16,
    dfg_size: 16,
    dfg_sample_count: 64,
    irradiance_size: [16, 8],
    irradiance_sample_count: [16, 8],
    storage: StorageFormat::F32,
};

/// Requests that need every kind of table, and a reference of both terms with a stop.
fn requests() -> Vec<RenderRequest> {
    let base = RenderRequest {
        precompute: SMALL,
        reference_samples: 256,
        samples: 256,
        ..request(&golden_environment(), scene("spheres", MaterialOverride::default()), CameraKind::Ortho, [40, 24])
    };
    let of = |method: &str, diffuse: &str| RenderRequest {
        method: method_by_name(method).unwrap(),
        diffuse: diffuse_by_name(diffuse).unwrap(),
        ..base.clone()
    };
    let stopped = RenderRequest { reference_error: Some(0.5), ..of("reference", "reference") };
    let half = PrecomputeSettings { storage: StorageFormat::F16, ..SMALL };
    let in_halves = RenderRequest { precompute: half, ..of("split-sum", "irradiance-map") };
    vec![of("split-sum", "irradiance-map"), of("sampled", "sh9"), of("reference", "reference"), stopped, in_halves]
}

fn bits(image: &RgbImage) -> Vec<u32> {
    image.data.iter().flatten().map(|x| x.to_bits()).collect()
}

#[test]
fn what_the_disk_keeps_has_the_bits_of_what_is_made() {
    let dir = tempfile::tempdir().unwrap();
    let render_all = |pipeline: &mut Pipeline| -> Vec<_> {
        let frames = requests().into_iter().map(|request| pipeline.render(&request).unwrap());
        frames
            .map(|f| (bits(&f.radiance), f.standard_error.as_ref().map(bits), f.convergences, f.mask, f.n_dot_v))
            .collect()
    };
    let mut expected = Vec::new();
    with_pipeline(|pipeline| expected = render_all(pipeline));
    for (made, read) in [(true, false), (false, true)] {
        with_pipeline(|pipeline| {
            pipeline.keep_on_disk(DiskCache::open(dir.path(), 1 << 30).unwrap());
            assert!(render_all(pipeline) == expected, "made: {made}");
            let work = pipeline.shared_work();
            assert_eq!(work.keys().collect::<Vec<_>>(), ["dfg", "irradiance", "mips", "prefilter", "reference", "sh9"]);
            assert!(work.values().all(|tally| (tally.made > 0, tally.read > 0) == (made, read)), "{work:?}");
            assert_eq!(work["reference"].made + work["reference"].read, 2);
            // The same map serves both formats.
            assert_eq!(work["prefilter"].made + work["prefilter"].read, 1);
            assert!(pipeline.take_warnings().is_empty());
        });
    }
}

/// A time of a table that came from the disk would be that of a copy.
#[test]
fn timed_tables_are_made_whatever_the_disk_holds() {
    let dir = tempfile::tempdir().unwrap();
    for _ in 0..2 {
        with_pipeline(|pipeline| {
            pipeline.keep_on_disk(DiskCache::open(dir.path(), 1 << 30).unwrap());
            let request = &requests()[0];
            pipeline.render(request).unwrap();
            let before = pipeline.shared_work().clone();
            let samples = pipeline.time_precompute(request, 0, 2).unwrap();
            let passes: Vec<&str> = samples.passes.iter().map(|(pass, _)| *pass).collect();
            let mips = request.precompute.prefilter_level_count as usize;
            let levels: Vec<String> = (0..mips).map(|level| format!("prefilter mip {level}")).collect();
            let due = ["mips", "irradiance"].into_iter().chain(levels.iter().map(String::as_str)).chain(["dfg"]);
            assert_eq!(passes, due.collect::<Vec<_>>());
            assert!(samples.passes.iter().all(|(_, ms)| ms.len() == 2 && ms.iter().all(|ms| *ms > 0.0)), "{samples:?}");
            assert_eq!(*pipeline.shared_work(), before);
        });
    }
}

#[test]
fn halves_are_the_nearest_to_what_the_passes_made() {
    // A sun brighter than any half.
    let image = RgbImage::from_fn(32, 16, |x, y| if (x, y) == (5, 4) { [1e6, 3.0, 70000.0] } else { [0.1, 1.7, 1e-6] });
    let environment = Arc::new(Environment::from_image("sun", image));
    with_pipeline(|pipeline| {
        let bake = |pipeline: &mut Pipeline, storage: StorageFormat, out: &Path| {
            let brdfs = vec![splitsum::brdf::MODELS[0]];
            let precompute = PrecomputeSettings { storage, ..SMALL };
            let request = BakeRequest {
                environment: environment.clone(),
                precompute,
                brdfs,
                masking_shadowing: Default::default(),
            };
            pipeline.bake(&request, out).unwrap();
        };
        let [whole, half] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        bake(pipeline, StorageFormat::F32, whole.path());
        bake(pipeline, StorageFormat::F16, half.path());
        let mut cut_off = 0;
        for name in ["prefiltered_ggx_0.exr", "prefiltered_ggx_1.exr", "irradiance_over_pi.exr"] {
            let [of_whole, of_half] = [&whole, &half].map(|dir| exr::read(&dir.path().join(name)).unwrap().rgb);
            for (x, h) in of_whole.data.iter().flatten().zip(of_half.data.iter().flatten()) {
                cut_off += usize::from(*x > HALF_MAX);
                assert_eq!(f16::from_f32(x.min(HALF_MAX)).to_f32(), *h, "{name}: {x}");
            }
            assert_ne!(bits(&of_whole), bits(&of_half), "{name}");
        }
        assert!(cut_off > 0, "no texel was too bright for a half");
    });
}

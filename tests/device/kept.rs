//! Tables and references from the disk have the same bits as new ones; halves are rounded once.

use crate::harness::{golden_environment, request, scene, usual_tables, with_pipeline};
use half::f16;
use splitsum::base::math::sequence::{PixelPoints, SEQUENCES};
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::brdf::{Compensation, MaskingShadowing, WidthLaw};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::pipeline::{DiskCache, Frame, Pipeline, RenderRequest};
use splitsum::instrument::precompute::dfg::DfgAxes;
use splitsum::instrument::precompute::given::{GivenMap, GivenTable};
use splitsum::instrument::precompute::prefilter::{LEVEL_MAPPINGS, WEIGHTS};
use splitsum::instrument::precompute::{HALF_MAX, PrecomputeSettings, PrefilterBy, StorageFormat};
use splitsum::instrument::scene::{Camera, CameraKind, MaterialOverride};
use splitsum::instrument::shade::{Diffuse, Method, Shading};
use std::collections::BTreeSet;
use std::sync::Arc;

fn small() -> PrecomputeSettings {
    PrecomputeSettings {
        prefilter_size: [16; 2],
        prefilter_level_count: 2,
        prefilter: PrefilterBy::Sampled,
        prefilter_sample_count: 16,
        dfg_size: 16,
        dfg_sample_count: 64,
        irradiance_size: [8; 2],
        irradiance_sample_count: [16, 8],
        storage: StorageFormat::F32,
        ..usual_tables()
    }
}

/// Requests that need every kind of table, and a reference of both terms with a stop.
fn requests() -> Vec<RenderRequest> {
    let base = RenderRequest {
        reference_samples: 256,
        ..request(
            &golden_environment(),
            scene("spheres", MaterialOverride::default()),
            CameraKind::Ortho,
            [40, 24],
        )
        .shaded(|s| (s.precompute, s.samples) = (small(), 256))
    };
    let of = |method: &str, diffuse: &str| {
        base.shaded(|s| {
            s.method = Method::listed(method);
            s.diffuse = Diffuse::listed(diffuse);
        })
    };
    let stopped = RenderRequest {
        reference_error: Some(0.5),
        ..of("reference", "reference")
    };
    let half = PrecomputeSettings {
        storage: StorageFormat::F16,
        ..small()
    };
    let in_halves = of("split-sum", "irradiance-map").shaded(|s| s.precompute = half);
    vec![
        of("split-sum", "irradiance-map"),
        of("sampled", "sh9"),
        of("reference", "reference"),
        stopped,
        in_halves,
    ]
}

fn bits(image: &RgbImage) -> Vec<u32> {
    image.data.iter().flatten().map(|x| x.to_bits()).collect()
}

#[test]
fn entries_of_the_disk_cache_have_the_bits_of_new_tables() {
    let dir = tempfile::tempdir().unwrap();
    let render_all = |pipeline: &mut Pipeline| -> Vec<_> {
        let frames = requests()
            .into_iter()
            .map(|request| pipeline.render(&request).unwrap());
        frames
            .map(|f| {
                (
                    bits(&f.radiance),
                    f.standard_error.as_ref().map(bits),
                    f.convergences,
                    f.mask,
                    f.n_dot_v,
                )
            })
            .collect()
    };
    let mut expected = Vec::new();
    with_pipeline(|pipeline| expected = render_all(pipeline));
    for (made, read) in [(true, false), (false, true)] {
        with_pipeline(|pipeline| {
            pipeline.keep_on_disk(DiskCache::open(dir.path(), 1 << 30).unwrap());
            assert!(render_all(pipeline) == expected, "made: {made}");
            let work = pipeline.shared_work();
            assert_eq!(
                work.keys().collect::<Vec<_>>(),
                ["dfg", "irradiance", "mips", "prefilter", "reference", "sh9"]
            );
            assert!(
                work.values()
                    .all(|counts| counts.map(|count| count > 0) == [made, read]),
                "{work:?}"
            );
            assert_eq!(work["reference"].iter().sum::<usize>(), 2);
            // The same map serves both formats.
            assert_eq!(work["prefilter"].iter().sum::<usize>(), 1);
            assert!(pipeline.take_warnings().is_empty());
        });
    }
}

fn neighbours(base: &RenderRequest) -> Vec<RenderRequest> {
    let PrecomputeSettings {
        layout: own,
        prefilter_level_count,
        level_mapping,
        ..
    } = base.shading.precompute;
    let side = 4 << prefilter_level_count;
    let texels = |level: u32| {
        vec![[0.5, 0.4, 0.3, 1.0]; (own.face_count * (side >> level) * (side >> level)) as usize]
    };
    let given_map = Arc::new(GivenMap {
        name: "file:x".to_owned(),
        hash: "map".to_owned(),
        layout: own,
        side,
        mapping: level_mapping,
        levels: (0..prefilter_level_count).map(texels).collect(),
    });
    let texels = vec![[0.6, 0.1, 0.0, 1.0]; 16];
    let given_table = Arc::new(GivenTable {
        name: "file:y".to_owned(),
        hash: "table".to_owned(),
        side: 4,
        texels,
    });
    let other = |change: &dyn Fn(&mut RenderRequest)| {
        let mut request = base.clone();
        change(&mut request);
        request
    };
    let shaded = |change: &dyn Fn(&mut Shading)| base.shaded(change);
    let set = |change: &dyn Fn(&mut PrecomputeSettings)| base.shaded(|s| change(&mut s.precompute));
    let rough = MaterialOverride {
        alpha: Some(0.7),
        ..MaterialOverride::default()
    };
    let far = Camera::for_scene(CameraKind::Perspective, &base.scene, base.size);
    let layouts = LAYOUTS
        .iter()
        .filter(|layout| *layout != own && layout.face_count == 1);
    let by_layout = layouts.map(|layout| set(&|s| s.layout = layout));
    let by_field = vec![
        other(&|r| {
            r.environment = Arc::new(Environment::from_image(
                "flat",
                RgbImage::filled(8, 4, [0.5; 3]),
            ))
        }),
        shaded(&|s| s.placement.orientation += 1),
        shaded(&|s| s.placement.rotation_deg += 40.0),
        shaded(&|s| s.environment_scale *= 3.0),
        other(&|r| r.scene = Arc::new(r.scene.apply(&rough))),
        other(&|r| r.camera = far),
        other(&|r| r.size[0] += 3),
        shaded(&|s| s.brdf = splitsum::instrument::brdf::MODELS[1]),
        shaded(&|s| s.masking_shadowing = MaskingShadowing::Correlated),
        shaded(&|s| s.compensation = Compensation::Turquin),
        shaded(&|s| s.samples += 8),
        shaded(&|s| s.sequence = &SEQUENCES[1]),
        shaded(&|s| s.point_set += 1),
        shaded(&|s| s.pixel_points = PixelPoints::Owen),
        other(&|r| r.reference_samples *= 2),
        other(&|r| r.reference_error = Some(0.5)),
        shaded(&|s| s.lod_bias += 1.0),
        other(&|r| r.background = !r.background),
        other(&|r| r.seed += 1),
        other(&|r| r.given.prefiltered = Some(given_map.clone())),
        other(&|r| r.given.dfg = Some(given_table.clone())),
        set(&|s| s.prefilter_size = s.prefilter_size.map(|side| 2 * side)),
        set(&|s| s.prefilter_level_count += 1),
        set(&|s| s.prefilter_sample_count *= 2),
        set(&|s| s.prefilter = PrefilterBy::Harmonic),
        set(&|s| s.prefilter_lod_bias += 1.0),
        set(&|s| s.dfg_size *= 2),
        set(&|s| s.dfg_sample_count *= 2),
        set(&|s| s.dfg_axes = DfgAxes::Centres),
        set(&|s| s.irradiance_size = s.irradiance_size.map(|side| 2 * side)),
        set(&|s| s.irradiance_sample_count = s.irradiance_sample_count.map(|count| 2 * count)),
        set(&|s| {
            s.storage = if s.storage == StorageFormat::F16 {
                StorageFormat::F32
            } else {
                StorageFormat::F16
            }
        }),
    ];
    // Two levels are the ends, which all mappings share.
    let by_mapping = LEVEL_MAPPINGS[1..]
        .iter()
        .map(|mapping| set(&|s| (s.level_mapping, s.prefilter_level_count) = (mapping, 3)));
    let by_weight = WEIGHTS[1..]
        .iter()
        .flat_map(|weight| MaskingShadowing::all().map(move |masking| (weight, *masking)));
    let by_weight = by_weight.map(|(weight, masking)| {
        shaded(&|s| (s.precompute.prefilter_weight, s.masking_shadowing) = (weight, masking))
    });
    by_field
        .into_iter()
        .chain(by_layout)
        .chain(by_mapping)
        .chain(by_weight)
        .collect()
}

/// Every output of a frame, bit for bit.
fn shown(frame: &Frame) -> (Vec<u32>, Option<Vec<u32>>, Vec<u32>) {
    let n_dot_v = frame.n_dot_v.data.iter().map(|x| x.to_bits()).collect();
    (
        bits(&frame.radiance),
        frame.standard_error.as_ref().map(bits),
        n_dot_v,
    )
}

/// A key that lacks a field returns the result of an earlier request: right after its base a
/// neighbour then shows the base's result, alone its own. Each pair has its own light, scene, size
/// and counts, so that no other request leaves the same.
#[test]
fn frames_do_not_depend_on_earlier_requests() {
    let dir = tempfile::tempdir().unwrap();
    let of = |(method, diffuse, name): (&str, &str, &str), pair: u32| {
        let light = |x: u32, y: u32| {
            [
                1.0 + (x % 5) as f32,
                0.1 * (x + y) as f32,
                1.0 + 0.1 * pair as f32,
            ]
        };
        let material = MaterialOverride {
            alpha: Some(0.2 + 0.01 * pair as f32),
            ..MaterialOverride::default()
        };
        let map = Arc::new(Environment::from_image(
            "map",
            RgbImage::from_fn(64, 32, light),
        ));
        RenderRequest {
            reference_samples: 64,
            ..request(
                &map,
                scene(name, material),
                CameraKind::Ortho,
                [13 + pair, 9],
            )
            .shaded(|s| {
                s.precompute = PrecomputeSettings {
                    prefilter_size: [32; 2],
                    dfg_sample_count: 64 + 32 * pair,
                    storage: if pair.is_multiple_of(2) {
                        StorageFormat::F16
                    } else {
                        StorageFormat::F32
                    },
                    ..small()
                };
                s.samples = 8 + pair;
                s.method = Method::listed(method);
                s.diffuse = Diffuse::listed(diffuse);
            })
        }
    };
    // The g-buffer of a design is drawn once.
    let terms = [
        ("split-sum", "irradiance-map", "sphere"),
        ("sampled", "sh9", "design"),
        ("reference", "reference", "sphere"),
        ("reference", "none", "sphere"),
    ];
    let bases = |pair: usize| terms.map(|names| of(names, pair as u32));
    let count = neighbours(&bases(0)[0]).len();
    let pairs = (0..count).flat_map(bases);
    let (bases, all): (Vec<_>, Vec<_>) = pairs
        .enumerate()
        .map(|(i, base)| (base.clone(), neighbours(&base).swap_remove(i / terms.len())))
        .unzip();
    let render = |pipeline: &mut Pipeline, request: &RenderRequest| {
        shown(&pipeline.render(request).unwrap())
    };
    let mut expected = Vec::new();
    with_pipeline(|pipeline| {
        pipeline.keep_on_disk(DiskCache::open(dir.path(), 1 << 30).unwrap());
        for (base, neighbour) in bases.iter().zip(&all) {
            render(pipeline, base);
            expected.push(render(pipeline, neighbour));
        }
    });
    for is_kept in [false, true] {
        with_pipeline(|pipeline| {
            if is_kept {
                pipeline.keep_on_disk(DiskCache::open(dir.path(), 1 << 30).unwrap());
            }
            for (index, (request, expected)) in all.iter().zip(&expected).enumerate().rev() {
                assert!(
                    render(pipeline, request) == *expected,
                    "kept {is_kept}, neighbour {index}: {request:?}"
                );
            }
            let references = pipeline.shared_work()["reference"];
            assert!(!is_kept || references[0] == 0, "{references:?}");
        });
    }
}

/// A kept reference of one law is not the reference of another.
/// A reference with more samples continues the last one. It has the bits of one drawn at once,
/// also if images or a smaller reference came between.
#[test]
fn a_continued_reference_has_the_bits_of_one_drawn_at_once() {
    let of = |method: &str, diffuse: &str, samples: u32| RenderRequest {
        reference_samples: samples,
        ..requests()[0].shaded(|s| {
            s.method = Method::listed(method);
            s.diffuse = Diffuse::listed(diffuse);
            s.samples = samples;
        })
    };
    let image = of("sampled", "sh9", 16);
    let cases = [
        ("reference", "none"),
        ("reference", "reference"),
        ("none", "reference"),
    ];
    for (method, diffuse) in cases {
        let reference = |samples| of(method, diffuse, samples);
        let mut expected = Vec::new();
        for samples in [64, 256, 1024] {
            with_pipeline(|pipeline| {
                expected.push(shown(&pipeline.render(&reference(samples)).unwrap()));
            });
        }
        with_pipeline(|pipeline| {
            for round in [0, 1, 2, 2, 0, 2] {
                let frame = pipeline.render(&reference(64 << (2 * round))).unwrap();
                let words = format!("{method}, {diffuse}, round {round}");
                assert!(shown(&frame) == expected[round], "{words}");
                pipeline.render(&image).unwrap();
            }
        });
    }
}

#[test]
fn references_are_kept_by_their_law_of_widths() {
    let dir = tempfile::tempdir().unwrap();
    let material = MaterialOverride {
        alpha: Some(0.3),
        anisotropy: Some(0.5),
        ..MaterialOverride::default()
    };
    let plain = RenderRequest {
        scene: Arc::new(scene("sphere", material)),
        ..requests().swap_remove(0)
    };
    let plain = RenderRequest {
        reference_samples: 64,
        ..plain.shaded(|s| {
            (s.method, s.diffuse) = (Method::listed("reference"), Diffuse::listed("none"))
        })
    };
    with_pipeline(|pipeline| {
        pipeline.keep_on_disk(DiskCache::open(dir.path(), 1 << 30).unwrap());
        let images: BTreeSet<Vec<u32>> = WidthLaw::all()
            .map(|law| {
                bits(
                    &pipeline
                        .render(&plain.shaded(|s| s.widths = *law))
                        .unwrap()
                        .radiance,
                )
            })
            .collect();
        assert_eq!(
            [images.len(), pipeline.shared_work()["reference"][0]],
            [WidthLaw::all().count(); 2]
        );
    });
}

/// The time of a table from the disk would be the time of a copy.
#[test]
fn timed_tables_are_computed_even_if_cached() {
    let dir = tempfile::tempdir().unwrap();
    for _ in 0..2 {
        with_pipeline(|pipeline| {
            pipeline.keep_on_disk(DiskCache::open(dir.path(), 1 << 30).unwrap());
            let request = &requests()[0];
            pipeline.render(request).unwrap();
            let before = pipeline.shared_work().clone();
            let samples = pipeline.time_precompute(request, 0, 2).unwrap();
            let passes: Vec<&str> = samples.passes.iter().map(|(pass, _)| *pass).collect();
            let mips = request.shading.precompute.prefilter_level_count as usize;
            let levels: Vec<String> = (0..mips)
                .map(|level| format!("prefilter mip {level}"))
                .collect();
            let due = ["mips", "irradiance"]
                .into_iter()
                .chain(levels.iter().map(String::as_str))
                .chain(["dfg"]);
            assert_eq!(passes, due.collect::<Vec<_>>());
            assert!(
                samples
                    .passes
                    .iter()
                    .all(|(_, ms)| ms.len() == 2 && ms.iter().all(|ms| *ms > 0.0)),
                "{samples:?}"
            );
            assert_eq!(*pipeline.shared_work(), before);
        });
    }
}

#[test]
fn halves_are_the_nearest_to_the_computed_values() {
    // A sun brighter than any half.
    let image = RgbImage::from_fn(32, 16, |x, y| {
        if (x, y) == (5, 4) {
            [1e6, 3.0, 70000.0]
        } else {
            [0.1, 1.7, 1e-6]
        }
    });
    let environment = Arc::new(Environment::from_image("sun", image));
    with_pipeline(|pipeline| {
        let mut request = RenderRequest {
            environment,
            ..requests().swap_remove(0)
        };
        let mut levels = |storage: StorageFormat| {
            request.shading.precompute = PrecomputeSettings { storage, ..small() };
            pipeline.light_tables(&request, 0, &[]).unwrap().prefiltered
        };
        let [whole, half] = [StorageFormat::F32, StorageFormat::F16].map(&mut levels);
        let mut cut_off = 0;
        for (of_whole, of_half) in whole.iter().zip(&half) {
            for (x, h) in of_whole
                .data
                .iter()
                .flatten()
                .zip(of_half.data.iter().flatten())
            {
                cut_off += usize::from(*x > HALF_MAX);
                assert_eq!(f16::from_f32(x.min(HALF_MAX)).to_f32(), *h, "{x}");
            }
            assert_ne!(bits(of_whole), bits(of_half));
        }
        assert!(cut_off > 0, "no texel was too bright for a half");
    });
}

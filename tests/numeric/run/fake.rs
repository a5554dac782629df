//! A synthetic renderer: an analytic sphere whose error is known for every method.

use splitsum::base::pixels::{GrayImage, Pixels, Rgb8Image, RgbImage};
use splitsum::instrument::ladder::{Attribution, STEPS, StepNumbers};
use splitsum::instrument::pipeline::{
    DeviceInfo, Encoding, Extent, Frame, FrameTimings, Intermediate, IntermediateImage,
    LightTables, PassTime, RenderRequest, Selection, Steadiness, TimingSamples,
};
use splitsum::instrument::precompute::dfg::DfgAxes;
use splitsum::instrument::precompute::taps::TapCount;
use splitsum::instrument::shade::reference_pass::Convergence;
use splitsum::instrument::tonemap::ToneCurve;
use splitsum::run::estimate::Ahead;
use splitsum::run::{Progress, RenderFault, Renderer, Served};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

/// Log and faults of the fake renderer.
#[derive(Debug, Default)]
pub struct Log {
    /// Method and sample count of every render.
    pub renders: Vec<(String, u32)>,
    pub tonemaps: usize,
    pub timings: usize,
    /// Frames that were not counted.
    pub warmups: u32,
    /// Timed frames by model, method and sample count.
    pub frames: BTreeMap<(&'static str, &'static str, u32), usize>,
    /// A method whose renders fail.
    pub broken_method: Option<&'static str>,
    /// Whether a render fails.
    pub broken: Option<fn(&RenderRequest) -> bool>,
    /// Relative error of `split-sum`, if it is not [`SPLIT_SUM_ERROR`].
    pub split_sum_error: Option<fn(&RenderRequest) -> f32>,
    /// Relative standard error of a reference by its samples, if it is not [`NOISE`]; its pixels
    /// then err by as much.
    pub noise: Option<fn(u32) -> f32>,
    /// Renders until the device is lost.
    pub renders_left: Option<usize>,
    /// Name of the device, if it is not `fake`.
    pub device: Option<&'static str>,
    /// The processor that its driver compiles for.
    pub target: Option<&'static str>,
    /// Whether the radiance is proportional to the F0 of the material.
    pub has_f0: bool,
    /// Whether every error, share and time is another, by a hash of the request.
    pub is_scrambled: bool,
}

pub struct Fake(pub Rc<RefCell<Log>>);

/// Relative error of `sampled` at one sample; it falls with the root of the count.
pub const ERROR_AT_ONE: f32 = 0.4;
/// Relative error of `split-sum` at any count. Break-even with `sampled` lies between 4 (0.2) and
/// 16 (0.1) samples.
pub const SPLIT_SUM_ERROR: f32 = 0.15;
/// Relative standard error of the reference.
const NOISE: f32 = 1e-4;
/// Relative error of each further point set, of alternating sign.
const SET_ERROR: f32 = 0.01;

/// The fake reference stops at a quarter of its samples with an error of 1/1000, if the request
/// allows that error.
fn convergence(request: &RenderRequest) -> Convergence {
    let is_met = request.reference_error.is_some_and(|wanted| wanted >= 1e-3);
    Convergence {
        term: "shade-specular",
        sample_count: u64::from(request.reference_samples) / if is_met { 4 } else { 1 },
        relative_error: 1e-3,
        is_met: is_met || request.reference_error.is_none(),
    }
}

fn set_error(set: u32) -> f32 {
    match set {
        0 => 0.0,
        set if set.is_multiple_of(2) => SET_ERROR,
        _ => -SET_ERROR,
    }
}

/// 1 or -1, equally often and in no order.
fn sign([x, y]: [u32; 2]) -> f32 {
    let mixed =
        (x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35);
    if mixed >> 31 == 0 { 1.0 } else { -1.0 }
}

/// A number in [0, 1) of a text and of what a request asks for.
fn dice(request: &RenderRequest, what: &str) -> f64 {
    let (shading, material) = (&request.shading, request.scene.materials.first());
    let light = (
        &request.environment.name,
        shading.environment_scale,
        shading.placement,
    );
    let case = (
        shading.brdf.name(),
        shading.masking_shadowing,
        shading.compensation,
        shading.frames,
        shading.frame,
    );
    let method = (
        shading.method.name,
        shading.diffuse.name,
        shading.samples,
        shading.sequence.name,
        shading.point_set,
    );
    let points = (shading.pixel_points, shading.lod_bias);
    let layers = (
        shading.coat_layering,
        shading.coat_renderer.name,
        shading.sheen_visibility,
        shading.sheen_lookup.name,
    );
    let lobes = (shading.widths, shading.bend.name, layers, points);
    let made = &shading.precompute;
    let maps = (
        made.layout.name,
        made.prefilter_size,
        made.prefilter_level_count,
        made.prefilter_sample_count,
    );
    let tables = (
        made.dfg_size,
        made.dfg_sample_count,
        made.irradiance_size,
        made.irradiance_sample_count,
    );
    let made = (
        maps,
        tables,
        made.level_mapping.name,
        made.prefilter_weight.name,
    );
    let text = format!(
        "{what} {:?} {light:?} {case:?} {method:?} {material:?} {lobes:?} {made:?}",
        request.size
    );
    let hash = blake3::hash(text.as_bytes());
    f64::from(u32::from_le_bytes(hash.as_bytes()[..4].try_into().unwrap())) / 2.0_f64.powi(32)
}

/// The factor of an image whose error varies by pixel and channel, `error` times 0.1 to 4.
fn scrambled([turn, size]: [f64; 2], error: f32, [x, y]: [u32; 2], channel: usize) -> f32 {
    let phase = 3.0 * f64::from(x) / 7.0 + 5.0 * f64::from(y) / 7.0 + 9.0 * turn + channel as f64;
    1.0 + error * (0.14 * 20.0_f64.powf(size) * (1.0 + 0.3 * phase.sin())) as f32
}

impl Renderer for Fake {
    fn device(&self) -> DeviceInfo {
        DeviceInfo {
            name: self.0.borrow().device.unwrap_or("fake").to_owned(),
            device_type: "cpu",
            driver: "formula".to_owned(),
            target: self.0.borrow().target.map(str::to_owned),
            api_version: "0".to_owned(),
            timestamp_period_ns: 1.0,
            memory_bytes: 0,
            has_exact_filter: true,
            has_seamless_cubes: true,
            is_radv: false,
        }
    }

    fn check(&self, _: &RenderRequest) -> Served<()> {
        Ok(())
    }

    fn render(&mut self, request: &RenderRequest) -> Served<Frame> {
        let mut log = self.0.borrow_mut();
        let fault = |message: &str, device_lost| {
            Err(RenderFault {
                message: message.to_owned(),
                device_lost,
                is_input: false,
            })
        };
        if log.broken_method == Some(request.shading.method.name)
            || log.broken.is_some_and(|is_broken| is_broken(request))
        {
            return fault("the shader is broken", false);
        }
        match &mut log.renders_left {
            Some(0) => return fault("unplugged", true),
            Some(left) => *left -= 1,
            None => {}
        }
        log.renders.push((
            request.shading.method.name.to_owned(),
            request.shading.samples,
        ));
        let factor = match request.shading.method.name {
            "reference" => 1.0,
            "split-sum" => {
                1.0 + log
                    .split_sum_error
                    .map_or(SPLIT_SUM_ERROR, |error| error(request))
            }
            _ => {
                1.0 + ERROR_AT_ONE / (request.shading.samples as f32).sqrt()
                    + set_error(request.shading.point_set)
            }
        };
        let material = request.scene.materials.first();
        let alpha = material.map_or(0.5, |material| material.alpha);
        let f0 = match material {
            Some(material) if log.has_f0 => material.f0[0],
            _ => 1.0,
        };
        let [width, height] = request.size;
        let n_z = |x: u32, y: u32| {
            let centred = |i: u32, count: u32| (i as f32 + 0.5) / count as f32 * 2.1 - 1.05;
            let r2 = centred(x, width).powi(2) + centred(y, height).powi(2);
            (r2 < 1.0).then(|| (1.0 - r2).sqrt())
        };
        let n_dot_v = GrayImage::from_fn(width, height, |x, y| n_z(x, y).unwrap_or(0.0));
        let mask = GrayImage::from_fn(
            width,
            height,
            |x, y| if n_z(x, y).is_some() { 1.0 } else { 0.0 },
        );
        let dice_of_image = ["phase", "error"].map(|what| dice(request, what));
        // Some errors are within the noise.
        let noise = match log.noise {
            Some(noise) => noise(request.reference_samples),
            None if log.is_scrambled => 0.1 * dice(request, "noise").powi(2) as f32,
            None => NOISE,
        };
        let is_noisy = log.noise.is_some() && request.shading.method.name == "reference";
        let factor = |at: [u32; 2], k: usize| match log.is_scrambled {
            true => scrambled(dice_of_image, factor - 1.0, at, k),
            false if is_noisy => 1.0 + noise * sign(at),
            false => factor,
        };
        let radiance = RgbImage::from_fn(width, height, |x, y| {
            let of = |n_z: f32| {
                [0, 1, 2].map(|k| f0 * factor([x, y], k) * [0.2, 0.5, 1.0][k] * (alpha + n_z))
            };
            n_z(x, y).map_or([0.0; 3], of)
        });
        let standard_error = (request.shading.method.name == "reference")
            .then(|| radiance.map(|texel| texel.map(|c| c * noise)));
        let mut convergences = vec![convergence(request)];
        if log.is_scrambled {
            let sample_count = 2 * convergences[0].sample_count;
            let (is_met, relative_error) =
                (dice(request, "diffuse") < 0.5, 2e-3 * dice(request, "stop"));
            convergences.push(Convergence {
                term: "shade-diffuse",
                sample_count,
                relative_error,
                is_met,
            });
        }
        let without_noise = radiance.map(|texel| texel.map(|c| 0.5 * c));
        Ok(Frame {
            radiance,
            convergences: convergences
                .into_iter()
                .filter(|_| request.shading.method.name == "reference")
                .collect(),
            standard_error,
            mask: Arc::new(mask),
            n_dot_v: Arc::new(n_dot_v),
            steadiness: (request.shading.frames.count > 1).then_some(Steadiness {
                without_noise,
                flicker: if log.is_scrambled {
                    dice(request, "flicker")
                } else {
                    0.25
                },
            }),
            // A cached frame has no passes; this one was rendered.
            timings: FrameTimings {
                frame: vec![PassTime {
                    pass: "gbuffer",
                    ms: 1.0,
                }],
                ..FrameTimings::default()
            },
        })
    }

    /// Step k adds 0.01 (k + 1): twice that alone, three times that as the last, four times that on
    /// average. Its standard error is 0.001 (k + 1), of its share 0.
    fn attributions(
        &mut self,
        request: &RenderRequest,
        _: u32,
        bands: &[[f64; 2]],
    ) -> Served<Vec<Attribution>> {
        let is_scrambled = self.0.borrow().is_scrambled;
        let of_band = |n_dot_v: [f64; 2]| {
            let dice = |what: &str, i: usize| dice(request, &format!("{what} {i} {n_dot_v:?}"));
            let varied = |what: &str, i: usize| {
                let scramble = if is_scrambled {
                    2.0 * dice(what, i) - 0.5
                } else {
                    1.0
                };
                0.01 * (i + 1) as f64 * scramble
            };
            let own = |i: usize| varied("own", i);
            let error = (0..STEPS.len()).map(own).sum();
            // A band has fewer views than all.
            let most = if n_dot_v == [0.0, 1.0] { 0.02 } else { 0.05 };
            let noise = |what: &str, i: usize| {
                if is_scrambled {
                    most * dice(what, i)
                } else {
                    1e-3 * (i + 1) as f64
                }
            };
            let step = |i: usize| StepNumbers {
                step: STEPS[i].name,
                share: own(i) / error,
                error: (0..=i).map(own).sum(),
                first_in: 2.0 * varied("first", i),
                last_out: 3.0 * varied("last", i),
                shapley: 4.0 * varied("shapley", i),
                step_error: noise("step", i),
                share_error: if is_scrambled { noise("share", i) } else { 0.0 },
            };
            let steps = (0..STEPS.len()).map(step).collect();
            Attribution {
                n_dot_v,
                pixel_count: 10,
                error,
                noise: 1e-6,
                steps,
            }
        };
        Ok([[0.0, 1.0]]
            .into_iter()
            .chain(bands.iter().copied())
            .map(of_band)
            .collect())
    }

    fn tonemap(&mut self, radiance: &RgbImage, curve: ToneCurve) -> Served<Rgb8Image> {
        self.0.borrow_mut().tonemaps += 1;
        Ok(curve.apply_image(radiance))
    }

    /// Constant light of radiance 1 in a few texels; the lobe reflects f0 whole.
    fn light_tables(
        &mut self,
        request: &RenderRequest,
        _: u32,
        counts: &[TapCount],
    ) -> Served<LightTables> {
        let chain = |levels: u32| {
            (0..levels)
                .map(|k| RgbImage::filled(8 >> k, (4 >> k).max(1), [1.0; 3]))
                .collect()
        };
        let mut sh9 = vec![[0.0; 3]; 9];
        sh9[0] = [(4.0 * std::f32::consts::PI).sqrt(); 3];
        let dfg = Pixels::filled(4, 4, [1.0, 0.0]);
        Ok(LightTables {
            level_mapping: request.shading.precompute.level_mapping,
            environment: chain(4),
            layout: &splitsum::instrument::environment::layout::LAYOUTS[2],
            sh9,
            prefiltered: chain(2),
            dfg,
            dfg_axes: DfgAxes::default(),
            // Every lobe points along r and has the width alpha.
            tap_tables: counts
                .iter()
                .map(|_| {
                    Pixels::new(
                        2,
                        4,
                        [[[1.0, 0.0, 0.0, 0.0]; 2], [[1.0, 1.0, 0.0, 0.0]; 2]]
                            .concat()
                            .repeat(2),
                    )
                })
                .collect(),
        })
    }

    /// A ramp to the right, 0 to 1, in the upper half of the image; green is a half. Levels of the
    /// prefiltered map are radiance, their blue is the mean of the environment; all else is linear,
    /// its blue is 0, but of `alpha` the material's.
    fn intermediate(
        &mut self,
        request: &RenderRequest,
        selection: Selection,
    ) -> Served<IntermediateImage> {
        let [width, height] = selection.fitted_size(request);
        let is_covered = |y: u32| selection.level.is_some() || 2 * y < height;
        let unit = Extent { min: 0.0, max: 1.0 };
        let blue = match selection.intermediate {
            Intermediate::Prefiltered => request.environment.luminance.mean as f32,
            Intermediate::Alpha => request.scene.materials[0].alpha,
            _ => 0.0,
        };
        Ok(IntermediateImage {
            values: RgbImage::from_fn(width, height, |x, y| match is_covered(y) {
                true => [(x as f32 + 0.5) / width as f32, 0.5, blue],
                false => [0.0; 3],
            }),
            mask: Arc::new(GrayImage::from_fn(width, height, |_, y| {
                f32::from(u8::from(is_covered(y)))
            })),
            encoding: match selection.level {
                Some(_) => Encoding::Radiance,
                None => Encoding::Linear([unit; 3]),
            },
        })
    }

    /// The first frame of a configuration takes 4 ms more than its sample count, the next ones 0,
    /// 1, 2, 3, 4, 0 ... more.
    fn time(
        &mut self,
        request: &RenderRequest,
        of_tables: bool,
        [warmup, rounds]: [u32; 2],
    ) -> Served<TimingSamples> {
        let mut log = self.0.borrow_mut();
        (log.timings, log.warmups) = (
            log.timings + 1,
            log.warmups + if of_tables { 0 } else { warmup },
        );
        let scramble = if log.is_scrambled {
            0.5 + dice(request, "time")
        } else {
            1.0
        };
        if of_tables {
            let [dfg, wall] = [3.0, 10.0].map(|ms| vec![ms * scramble; rounds as usize]);
            return Ok(TimingSamples {
                passes: vec![("dfg", dfg)],
                wall_ms: wall,
            });
        }
        let frame = log
            .frames
            .entry((
                request.shading.brdf.name(),
                request.shading.method.name,
                request.shading.samples,
            ))
            .or_default();
        let ms: Vec<f64> = (0..rounds as usize)
            .map(|round| {
                scramble * f64::from(request.shading.samples) + ((*frame + round + 4) % 5) as f64
            })
            .collect();
        *frame += ms.len();
        Ok(TimingSamples {
            passes: vec![
                ("gbuffer", vec![1.0; ms.len()]),
                ("shade-specular", ms.clone()),
            ],
            wall_ms: ms.iter().map(|t| t + 1.5).collect(),
        })
    }

    fn take_warnings(&mut self) -> Vec<String> {
        Vec::new()
    }
}

pub struct Silent;

impl Progress for Silent {
    fn start(&mut self, _: usize, _: usize, _: Ahead) {}
    fn step(&mut self, _: &str, _: Option<&str>, _: Ahead) {}
    fn note(&mut self, _: &str) {}
}

pub fn fakes(
    log: &Rc<RefCell<Log>>,
) -> impl FnMut() -> Result<Box<dyn Renderer>, RenderFault> + 'static {
    let log = log.clone();
    move || Ok(Box::new(Fake(log.clone())))
}

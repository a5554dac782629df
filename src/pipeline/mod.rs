//! Runs environment, precompute, gbuffer, shade and tonemap in this order.

use crate::brdf::{Brdf, MaskingShadowing};
use crate::environment::Environment;
use crate::pixels::{GrayImage, Rgb8Image, RgbImage};
use crate::precompute::PrecomputeSettings;
use crate::scene::{Camera, Light, Scene};
use crate::shade::{Diffuse, Method};
use crate::tonemap::ToneCurve;
use std::sync::Arc;

/// Everything that determines one radiance image.
#[derive(Clone, Debug)]
pub struct RenderRequest {
    pub environment: Arc<Environment>,
    /// Turns the environment about +y.
    pub environment_rotation_deg: f64,
    /// Multiplies the environment's radiance.
    pub environment_scale: f32,
    pub scene: Arc<Scene>,
    pub camera: Camera,
    pub size: [u32; 2],
    pub method: &'static Method,
    pub diffuse: &'static Diffuse,
    pub brdf: &'static dyn Brdf,
    pub masking_shadowing: MaskingShadowing,
    /// Samples a pixel of `method` (and of a `reference` diffuse term).
    pub samples: u32,
    pub lod_bias: f32,
    pub lights: Vec<Light>,
    /// Shows the environment where nothing is hit.
    pub background: bool,
    pub precompute: PrecomputeSettings,
    /// Seeds the scrambles of the reference.
    pub seed: u32,
}

/// One rendered radiance image and what belongs to it.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Linear radiance; 0 where nothing is hit, unless the background was asked for.
    pub radiance: RgbImage,
    /// Standard error of the mean per pixel and channel; only the reference has one.
    pub standard_error: Option<RgbImage>,
    /// 1 where a surface is hit.
    pub mask: GrayImage,
    /// Cosine between normal and view; 0 where nothing is hit.
    pub n_dot_v: GrayImage,
    pub timings: FrameTimings,
}

/// Time of one pass in one execution.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    /// `mips`, `sh9`, `irradiance`, `prefilter`, `dfg`, `gbuffer`, `shade-specular`, `shade-diffuse`, `shade-lights`, `tonemap`.
    pub pass: &'static str,
    pub ms: f64,
}

/// Device times of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameTimings {
    /// Precompute passes that ran for this frame (empty when all tables were cached).
    pub precompute: Vec<PassTime>,
    /// Per-frame passes.
    pub frame: Vec<PassTime>,
    /// Host wall time of the submissions that `frame` sums over, ms.
    pub wall_ms: f64,
}

/// What is known of the device.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceInfo {
    pub name: String,
    /// `cpu`, `discrete-gpu`, `integrated-gpu`, `virtual-gpu`, `other`.
    pub device_type: &'static str,
    pub driver: String,
    pub api_version: String,
    /// Nanoseconds a timestamp tick.
    pub timestamp_period_ns: f32,
    pub memory_bytes: u64,
}
#[allow(dead_code)]
type _Unused = (Rgb8Image, ToneCurve);

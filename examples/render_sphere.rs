//! Renders a sphere by the split sum on a Vulkan device and compares it with the reference.

use splitsum::base::names::Listed;
use splitsum::instrument::environment::Environment;
use splitsum::instrument::pipeline::{Options, Pipeline, RenderRequest};
use splitsum::instrument::scene::{CameraKind, Scene};
use splitsum::instrument::shade::Method;
use std::{error::Error, sync::Arc};

fn main() -> Result<(), Box<dyn Error>> {
    let light = Arc::new(Environment::open("builtin:studio")?);
    let request = RenderRequest::plain(light, Scene::sphere(), CameraKind::Ortho, [32, 32]);
    let mut pipeline = Pipeline::new(Options::default())?;
    let image = pipeline.render(&request)?;
    let method = Method::listed("reference");
    let reference = pipeline.render(&request.shaded(|shading| shading.method = method))?;
    let [split_sum, exact] = [&image, &reference].map(|frame| frame.radiance.get(16, 16)[1]);
    println!("green at the centre: {split_sum:.4} by the split sum, {exact:.4} by the reference");
    Ok(())
}

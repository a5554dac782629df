//! Renders the halves and the reference of a state, and paints them where the window takes them
//! from.

use super::{Renderer, Stop};
use crate::base::names::Listed;
use crate::base::pixels::Rgb8Image;
use crate::instrument::metrics::{Comparison, HEADLINE, Metric};
use crate::instrument::pipeline::{Frame, PipelineError, RenderRequest};
use crate::view::picture::{Picture, painted};
use crate::view::shown::{Shot, Status};
use crate::view::state::{Image, Inputs, Side, State};
use crate::view::texels::{DeviceTexels, Texels};
use std::sync::Arc;
use std::sync::atomic::Ordering;

impl Renderer<'_> {
    /// Shows both halves. If they stay on the device, nothing of them is read, so they have no
    /// values yet. Returns whether it made a table.
    pub(super) fn sketch(
        &mut self,
        whole: &State,
        inputs: &Inputs,
        count: u32,
        scale: u32,
    ) -> Result<bool, Stop> {
        if !self.is_painted_on_device() || whole.picture != Picture::Image {
            return self.shoot(whole, inputs, count, scale);
        }
        let state = &whole.scaled(scale);
        let mut has_made_table = false;
        for side in [Side::Left, Side::Right] {
            let image = state.image(side, count);
            let request = image.request(inputs);
            let curve = state.point.settings().curve;
            let Some(picture) = self.pipeline.picture_on_device(&request, curve)? else {
                return self.shoot(whole, inputs, count, scale);
            };
            has_made_table |= picture.has_made_table;
            self.shown.halves[side as usize] = Some(Shot {
                image,
                frame: None,
                picture: Texels::Device(DeviceTexels {
                    words: picture.words,
                    size: request.size,
                    gpu: self.gpu.clone(),
                }),
                kind: state.picture,
                fault: None,
                generation: self.shown.generation,
                scale,
                score: None,
            });
        }
        self.set_status(Status::Busy);
        Ok(has_made_table)
    }

    fn is_painted_on_device(&self) -> bool {
        self.post.is_painted_on_device.load(Ordering::Relaxed)
    }

    /// Shows both halves, and the reference if needed. Returns whether it made a table.
    pub(super) fn shoot(
        &mut self,
        whole: &State,
        inputs: &Inputs,
        count: u32,
        scale: u32,
    ) -> Result<bool, Stop> {
        let state = &whole.scaled(scale);
        let generation = self.shown.generation;
        let mut has_made_table = false;
        let is_first = self.shown.side(Side::Left).is_none_or(|shot| {
            shot.generation != generation || shot.scale > 1 || shot.frame.is_none()
        });
        let truth = match state.picture.scale() {
            Some(_) => Some(self.frame(&state.truth(count), inputs)?),
            None => None,
        };
        for side in [Side::Left, Side::Right] {
            let image = state.image(side, count);
            let frame = self.frame(&image, inputs)?;
            has_made_table |= !frame.timings.precompute.is_empty();
            let request = image.request(inputs);
            let picture = self.picture(state, &request, &frame, truth.as_deref())?;
            // The score of the same frame stays until the next reference is ready.
            let known = self.shown.side(side).filter(|shot| {
                shot.frame
                    .as_ref()
                    .is_some_and(|known| Arc::ptr_eq(known, &frame))
            });
            let score = known.and_then(|shot| shot.score);
            self.shown.halves[side as usize] = Some(Shot {
                image,
                frame: Some(frame),
                picture,
                kind: state.picture,
                fault: state.picture.fault(&request),
                generation,
                scale,
                score,
            });
            if scale == 1 && is_first {
                self.set_status(Status::Busy);
            }
        }
        self.set_status(Status::Busy);
        Ok(has_made_table)
    }

    /// Paints a half where the window takes it from.
    fn picture(
        &mut self,
        state: &State,
        request: &RenderRequest,
        frame: &Frame,
        truth: Option<&Frame>,
    ) -> Result<Texels, PipelineError> {
        let curve = state.point.settings().curve;
        let is_on_device = self.is_painted_on_device();
        if is_on_device && state.picture == Picture::Image {
            let radiance = &frame.radiance;
            return Ok(Texels::Device(DeviceTexels {
                words: self.pipeline.tonemap_on_device(radiance, curve)?.0,
                size: [radiance.width, radiance.height],
                gpu: self.gpu.clone(),
            }));
        }
        let pipeline = &mut self.pipeline;
        let image = painted(pipeline, state.picture, curve, request, frame, truth)?;
        Ok(if is_on_device {
            Texels::Device(DeviceTexels::copied(&self.gpu, &image)?)
        } else {
            Texels::Host(Arc::new(image))
        })
    }

    /// Renders the reference with `count` samples per pixel and scores the halves.
    pub(super) fn refine(
        &mut self,
        state: &State,
        inputs: &Inputs,
        count: u32,
    ) -> Result<(), Stop> {
        let image = state.truth(count);
        let truth = self.frame(&image, inputs)?;
        let request = image.request(inputs);
        let headline = Metric::listed(HEADLINE);
        for shot in self.shown.halves.iter_mut().flatten() {
            let Some(frame) = &shot.frame else { continue };
            let curve = state.point.settings().curve;
            let comparison = Comparison::new(
                &frame.radiance,
                &truth.radiance,
                &truth.mask,
                curve,
                request.epsilon(),
            );
            let is_other = !Arc::ptr_eq(frame, &truth);
            shot.score = comparison
                .ok()
                .filter(|_| is_other)
                .map(|comparison| comparison.evaluate(&[headline])[0].1);
        }
        self.shown.truth = Some(Shot {
            image,
            frame: Some(truth),
            // Only its values are shown.
            picture: Texels::Host(Arc::new(Rgb8Image::filled(1, 1, [0; 3]))),
            kind: Picture::Image,
            fault: None,
            generation: self.shown.generation,
            scale: 1,
            score: None,
        });
        Ok(())
    }

    /// Renders an image unless its frame is in memory.
    fn frame(&mut self, image: &Image, inputs: &Inputs) -> Result<Arc<Frame>, Stop> {
        let render = || Ok(Arc::new(self.pipeline.render(&image.request(inputs))?));
        self.kept.get_or_make(image.clone(), render)
    }
}

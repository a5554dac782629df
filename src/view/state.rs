//! The window's state as data: it becomes requests, and by [`super::file`] commands.

use super::picture::Picture;
use crate::bake::ENVIRONMENT_FORMATS;
use crate::experiment::axis::{
    ALBEDO, ALPHA, AXES, AxisId, ENVIRONMENT, F0, METALLIC, METHOD, Part, Point, REFERENCE,
    Reference, SAMPLES, SCENE, SIZE, View,
};
use crate::experiment::value::Value;
use crate::instrument::environment::{BUILTIN_PREFIX, Environment, FORMATS};
use crate::instrument::pipeline::RenderRequest;
use crate::instrument::precompute::given::Given;
use crate::instrument::scene::{Camera, Orbit, Scene, scene_extensions, scene_format};
use std::path::Path;
use std::sync::Arc;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Left,
    Right,
}

#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Values of every axis; the method is the left half's.
    pub point: Point,
    /// The method of the right half.
    pub right: Value,
    /// Its `reference_samples` end the refinement.
    pub view: View,
    pub picture: Picture,
    /// Share of the width for the left half.
    pub wipe: f32,
    /// Whether the picture has the size of its place in the window.
    pub fill: bool,
}

/// The first view: some room around the model.
pub const HOME: Orbit = Orbit {
    yaw_deg: 0.0,
    pitch_deg: 0.0,
    distance: 1.125,
};
const FIRST_SAMPLES: u32 = 32;

/// Settings shared by the images of a state.
pub struct Inputs {
    pub environment: Arc<Environment>,
    /// With the state's material.
    pub scene: Arc<Scene>,
    pub camera: Camera,
}

/// One image of a state; equal images have equal pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    pub point: Point,
    pub view: View,
}

impl State {
    /// Shows `point` on the left and the reference on the right.
    pub fn new(point: Point, view: View) -> Self {
        let right = Value::Text(REFERENCE.to_owned().into());
        Self {
            point,
            right,
            view,
            picture: Picture::Image,
            wipe: 0.5,
            fill: false,
        }
    }

    /// Makes paths absolute, so that saved files find them.
    pub fn name_files(&mut self) {
        for axis in [ENVIRONMENT, SCENE] {
            let name = self.point[axis].text();
            let is_file =
                Path::new(name).extension().is_some() && !name.starts_with(BUILTIN_PREFIX);
            if let Ok(whole) = std::path::absolute(name)
                && is_file
            {
                self.point[axis] = Value::Text(whole.display().to_string().into());
            }
        }
    }

    /// Opens an environment or a model; a model that has materials shows them. Returns its kind in
    /// words.
    pub fn open(&mut self, path: &Path) -> Result<&'static str, String> {
        let unknown = || {
            format!(
                "{}: expected an .hdr, .exr, {} file",
                path.display(),
                scene_extensions()
            )
        };
        let axis = file_axis(path).ok_or_else(unknown)?;
        self.point[axis] = Value::from(path.display().to_string());
        if axis == SCENE && has_materials(self.point[SCENE].text()) {
            for axis in [ALPHA, METALLIC, F0, ALBEDO] {
                self.point[axis] = Value::Unset;
            }
        }
        Ok(if axis == SCENE {
            "Model"
        } else {
            "Environment"
        })
    }

    /// Returns the left half's share; an error against the reference takes the whole width.
    pub fn shown_wipe(&self) -> f32 {
        let is_reference = |side| self.method(side).text() == REFERENCE;
        let is_left = is_reference(Side::Left);
        let is_right = is_reference(Side::Right);
        if self.picture.scale().is_none() || is_left == is_right {
            self.wipe
        } else if is_right {
            1.0
        } else {
            0.0
        }
    }

    pub fn size(&self) -> [u32; 2] {
        self.point[SIZE].pair()
    }

    /// The state with its resolution divided by `scale`.
    pub fn scaled(&self, scale: u32) -> Self {
        let mut state = self.clone();
        state.point[SIZE] = Value::Pair(self.size().map(|side| (side / scale).max(1)));
        state
    }

    /// Lists the reference's sample counts, each four times the one before.
    pub fn counts(&self) -> Vec<u32> {
        let last = self.view.reference_samples;
        let mut counts: Vec<u32> = std::iter::successors(Some(last), |count| Some(count / 4))
            .take_while(|&count| {
                count >= FIRST_SAMPLES && count % FIRST_SAMPLES == 0 || count == last
            })
            .collect();
        counts.reverse();
        counts
    }

    pub fn method(&self, side: Side) -> &Value {
        match side {
            Side::Left => &self.point[METHOD],
            Side::Right => &self.right,
        }
    }

    /// Returns the image of a half; unbiased terms draw `count` samples per pixel.
    pub fn image(&self, side: Side, count: u32) -> Image {
        let mut point = self.point.clone();
        point[METHOD] = self.method(side).clone();
        if point[METHOD].text() == REFERENCE {
            self.truth(count)
        } else {
            self.image_of(point, count)
        }
    }

    /// Returns the reference's image of both terms.
    pub fn truth(&self, count: u32) -> Image {
        let mut point = self.point.clone();
        point[METHOD] = Value::Text(REFERENCE.to_owned().into());
        let reference = Reference {
            samples: count,
            ..Reference::default()
        };
        self.image_of(point.reference(&reference), count)
    }

    /// The image of a point; `count` is ignored unless some term is drawn.
    fn image_of(&self, mut point: Point, count: u32) -> Image {
        if point.method().is_integrated() {
            point[SAMPLES] = Value::Count(count);
        }
        let is_drawn = point.method().is_integrated() || point.diffuse().is_integrated();
        let mut point = point.collapsed();
        for id in AXES.ids().filter(|&id| AXES[id].part == Part::Display) {
            point[id] = Value::Unset;
        }
        Image {
            point,
            view: View {
                reference_samples: if is_drawn { count } else { FIRST_SAMPLES },
                ..self.view.clone()
            },
        }
    }
}

/// Returns the axis that takes a file of this name.
pub fn file_axis(path: &Path) -> Option<AxisId> {
    let is_map = path.extension().is_some_and(|end| {
        FORMATS
            .iter()
            .chain(ENVIRONMENT_FORMATS)
            .any(|format| end.eq_ignore_ascii_case(format.extension))
    });
    if is_map {
        Some(ENVIRONMENT)
    } else {
        scene_format(path).map(|_| SCENE)
    }
}

/// Whether a scene has materials of its own.
pub fn has_materials(name: &str) -> bool {
    let path = Path::new(name);
    let is_obj = path
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("obj"));
    let names_library =
        || std::fs::read(path).is_ok_and(|text| text.windows(7).any(|word| word == b"mtllib "));
    name == "spheres" || scene_format(path).is_some() && (!is_obj || names_library())
}

impl Image {
    pub fn request(&self, inputs: &Inputs) -> RenderRequest {
        let Inputs {
            environment,
            scene,
            camera,
        } = inputs;
        self.point.settings().request_from(
            *camera,
            environment,
            scene.clone(),
            &self.view,
            Given::default(),
        )
    }
}

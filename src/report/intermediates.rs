//! `intermediates.json`: pictures of what the images of a run are made of, for the comparison of its
//! report. A run writes it while it has its device; `page::intermediates` reads it.
//!
//! Images that are made of the same share their pictures: attachments of the g-buffer belong to a
//! view of a scene, tables to an environment, a model and their settings.

use crate::base::pixels::{RgbImage, packed};
use crate::experiment::axis::Settings;
use crate::experiment::plan::Plan;
use crate::instrument::pipeline::{Encoding, IntermediateImage, RenderRequest, Selection};
use crate::instrument::scene::is_design;
use crate::instrument::shade::Shading;
use crate::run::companion::PlanFile;
use crate::run::{RenderFault, Renderer};
use indexmap::{IndexMap, IndexSet};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Name of the record in the folder of a run.
pub const INTERMEDIATES_FILE: &str = "intermediates.json";
/// Most bytes of base64: the largest page has room for a tenth of its own bytes.
const BYTES_MAX: usize = 4 << 20;
/// Most pictures that are rendered; a run would spend seconds on more.
const PICTURES_MAX: usize = 1000;

#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct IntermediateRecord {
    pub pictures: Vec<PackedIntermediate>,
    /// Indices of all pictures of what an image is made of.
    pub sets: Vec<Vec<usize>>,
    /// Index of each cell's set, by its id. Cells of designs have none.
    pub cells: BTreeMap<String, usize>,
    /// Pictures beyond [`BYTES_MAX`] or [`PICTURES_MAX`].
    pub left_out: usize,
}

/// A picture as half floats (see [`packed`]); scalars have one channel.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct PackedIntermediate {
    /// As `render --show` takes it.
    pub name: String,
    /// Whether it has a pixel for each pixel of the image.
    pub is_attachment: bool,
    pub size: [u32; 2],
    pub texels: String,
    /// Number of channels clamped to the half-float range.
    pub clamped_count: usize,
    /// Where there are values; empty if everywhere.
    pub mask: String,
    pub encoding: Encoding,
}

/// Makes `intermediates.json` during a run.
#[derive(Clone, Copy, Debug)]
pub struct IntermediatesFile;

impl PlanFile for IntermediatesFile {
    fn name(&self) -> &'static str {
        INTERMEDIATES_FILE
    }

    fn loss(&self) -> &'static str {
        "the report will not show what its images are made of"
    }

    fn text(&self, plan: &Plan, renderer: &mut dyn Renderer) -> Result<String, RenderFault> {
        let record = Maker::new(renderer).record(plan)?;
        let text = serde_json::to_string(&record).expect("keys of the record are texts");
        Ok(text + "\n")
    }
}

struct Maker<'r> {
    renderer: &'r mut dyn Renderer,
    record: IntermediateRecord,
    /// Index of each picture by [`Selection::key`]; `None` if it is left out.
    pictures: IndexMap<String, Option<usize>>,
    sets: IndexSet<Vec<usize>>,
    bytes: usize,
}

impl<'r> Maker<'r> {
    fn new(renderer: &'r mut dyn Renderer) -> Self {
        Self {
            renderer,
            record: IntermediateRecord::default(),
            pictures: IndexMap::new(),
            sets: IndexSet::new(),
            bytes: 0,
        }
    }

    /// Makes the pictures of all cells of a plan, each once.
    fn record(mut self, plan: &Plan) -> Result<IntermediateRecord, RenderFault> {
        let mut sets_by_inputs: IndexMap<String, usize> = IndexMap::new();
        for cell in &plan.cells {
            let settings = cell.point.settings();
            if is_design(&settings.scene) {
                continue;
            }
            let inputs = inputs(&settings);
            let set = match sets_by_inputs.get(&inputs) {
                Some(set) => *set,
                None => self.set(&plan.request(&cell.point))?,
            };
            sets_by_inputs.insert(inputs, set);
            self.record.cells.insert(cell.id.to_string(), set);
        }
        self.record.sets = self.sets.into_iter().collect();
        self.record.left_out = self.pictures.values().filter(|kept| kept.is_none()).count();
        Ok(self.record)
    }

    /// Returns the index of the set of a request's pictures.
    fn set(&mut self, request: &RenderRequest) -> Result<usize, RenderFault> {
        let mut set = Vec::new();
        for selection in Selection::all(request) {
            set.extend(self.picture(request, selection)?);
        }
        Ok(self.sets.insert_full(set).0)
    }

    /// Returns the index of a picture; `None` if there is no room for it.
    fn picture(
        &mut self,
        request: &RenderRequest,
        selection: Selection,
    ) -> Result<Option<usize>, RenderFault> {
        let key = selection.key(request);
        if let Some(index) = self.pictures.get(&key) {
            return Ok(*index);
        }
        let index = if self.bytes < BYTES_MAX && self.pictures.len() < PICTURES_MAX {
            let image = self.renderer.intermediate(request, selection)?;
            Some(self.keep(PackedIntermediate::new(selection, &image)))
        } else {
            None
        };
        self.pictures.insert(key, index);
        Ok(index)
    }

    /// Returns the index of a picture. Equal ones are kept once: scenes of two materials have the
    /// same positions.
    fn keep(&mut self, picture: PackedIntermediate) -> usize {
        let pictures = &mut self.record.pictures;
        let known = pictures.iter().position(|known| *known == picture);
        known.unwrap_or_else(|| {
            self.bytes += picture.texels.len() + picture.mask.len();
            pictures.push(picture);
            pictures.len() - 1
        })
    }
}

impl PackedIntermediate {
    fn new(selection: Selection, image: &IntermediateImage) -> Self {
        let is_covered = image.mask.data.iter().all(|covered| *covered > 0.0);
        let texels = packed_values(&image.values);
        Self {
            name: selection.to_string(),
            is_attachment: selection.intermediate.is_attachment(),
            size: [image.values.width, image.values.height],
            texels: texels.base64,
            clamped_count: texels.clamped_count,
            mask: if is_covered {
                String::new()
            } else {
                packed::mask(&image.mask)
            },
            encoding: image.encoding,
        }
    }
}

/// Packs values; of scalars one channel.
fn packed_values(values: &RgbImage) -> packed::Encoded {
    let is_grey = values.data.iter().all(|[r, g, b]| r == g && g == b);
    if is_grey {
        packed::texels(&values.map(|[r, ..]| [r]))
    } else {
        packed::texels(values)
    }
}

/// All settings that determine what an image is made of; the compiler rejects a forgotten one.
fn inputs(settings: &Settings) -> String {
    let Settings {
        size,
        environment,
        scene,
        material,
        shading,
        prefiltered,
        dfg,
        light_intensity: _,
        light_turn_deg: _,
        curve: _,
    } = settings;
    let Shading {
        brdf,
        masking_shadowing,
        compensation,
        fresnel,
        method,
        diffuse,
        precompute,
        // Tables are made before the light is turned or scaled, and for one pixel's sample.
        placement: _,
        environment_scale: _,
        samples: _,
        sequence: _,
        point_set: _,
        pixel_points: _,
        frames: _,
        frame: _,
        lod_bias: _,
        widths: _,
        bend: _,
        coat_layering: _,
        coat_renderer: _,
        sheen_visibility: _,
        sheen_lookup: _,
        specular_occlusion: _,
        metallic_mix: _,
    } = shading;
    let lobe = (brdf.name(), masking_shadowing, compensation, fresnel);
    let terms = (method.name, diffuse.name);
    let files = (environment, scene, prefiltered, dfg);
    format!("{size:?} {files:?} {material:?} {lobe:?} {terms:?} {precompute:?}")
}

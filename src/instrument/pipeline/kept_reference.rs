//! References on disk: their keys and bytes.

use super::RenderRequest;
use super::inputs::{DfgInputs, SharedKey, mips_key};
use crate::base::names::Listed;
use crate::base::pixels::RgbImage;
use crate::instrument::brdf::Fresnel;
use crate::instrument::gbuffer;
use crate::instrument::shade::Shading;
use crate::instrument::shade::metallic::MetallicMix;
use crate::instrument::shade::pass::{BACKGROUND_SHADER, DIFFUSE_PASS, SPECULAR_PASS};
use crate::instrument::shade::reference_pass::Convergence;

/// The expensive parts of a reference frame.
#[derive(Debug, PartialEq)]
pub(super) struct Reference {
    pub(super) radiance: RgbImage,
    pub(super) standard_error: Option<RgbImage>,
    pub(super) convergences: Vec<Convergence>,
}

/// Returns everything that determines the frame of `request`; `None` without a reference term: such
/// frames are cheap.
///
/// Of the table settings only the DFG table's matter, and only if the frame reads it.
pub(super) fn key(request: &RenderRequest) -> Option<SharedKey> {
    let Shading {
        brdf,
        method,
        diffuse,
        ..
    } = request.shading;
    let is_cheap = !request.has_reference_term() || !request.is_under_environment();
    if is_cheap || method.has_pass() || diffuse.has_pass() {
        return None;
    }
    let dfg = request
        .needs_dfg()
        .then(|| DfgInputs::from_request(request).key());
    let inputs = inputs(request, dfg.as_ref());
    let lobes = request
        .reference_lobes()
        .into_iter()
        .flat_map(|lobe| lobe.shaders(brdf));
    let background = request.background.then(|| BACKGROUND_SHADER.to_owned());
    let shaders = gbuffer::pass::shaders()
        .map(str::to_owned)
        .chain(lobes)
        // A background reads the levels of the environment.
        .chain(mips_key(&request.environment).shaders)
        .chain(dfg.into_iter().flat_map(|key| key.shaders))
        .chain(background)
        .collect();
    Some(SharedKey {
        kind: "reference",
        inputs,
        shaders,
    })
}

/// Returns everything but the sample count that determines a reference which takes all its samples;
/// `None` for other frames.
pub(super) fn rounds_key(request: &RenderRequest) -> Option<String> {
    if request.reference_error.is_some() {
        return None;
    }
    let mut uncounted = request.clone();
    uncounted.reference_samples = 0;
    if uncounted.shading.method.is_integrated() {
        uncounted.shading.samples = 0;
    }
    key(&uncounted).map(|key| key.text())
}

/// Returns the values that determine a reference, by name; `dfg` is the key of the DFG table that
/// it reads.
fn inputs(request: &RenderRequest, dfg: Option<&SharedKey>) -> String {
    let RenderRequest {
        environment,
        scene,
        camera,
        size: [width, height],
        shading,
        reference_samples,
        reference_error,
        background,
        // Applied after the kept image.
        antialias: _,
        // A given table has its own key, and no reference reads a prefiltered map.
        given: _,
        seed,
        // Images under direct lights are not kept.
        illumination: _,
    } = request;
    let ShadingInputs {
        light,
        terms,
        tables,
        widths,
    } = ShadingInputs::new(shading);
    let table = dfg.map_or("none\n".to_owned(), |key| {
        format!("{:?}\n{}", shading.precompute.storage, key.inputs)
    });
    let widths = if scene.has_anisotropy() {
        widths
    } else {
        String::new()
    };
    format!(
        "environment={}\n{light}epsilon={}\nscene={}\ncamera={camera:?}\nsize={width}x{height}\n\
         {terms}reference_samples={reference_samples}\nreference_error={reference_error:?}\n\
         background={background}\nseed={seed}\n{tables}dfg={table}{widths}",
        environment.hash,
        request.epsilon().squared_epsilon(),
        scene.hash,
    )
}

/// The fields of [`Shading`] that determine a reference, as lines.
struct ShadingInputs {
    light: String,
    terms: String,
    /// What the method's reference takes from the table settings.
    tables: String,
    /// They matter to anisotropic materials alone.
    widths: String,
}

impl ShadingInputs {
    fn new(shading: &Shading) -> Self {
        let Shading {
            placement,
            environment_scale,
            brdf,
            masking_shadowing,
            compensation,
            fresnel,
            metallic_mix,
            method,
            diffuse,
            samples,
            precompute,
            // Parameters of sampled methods.
            sequence: _,
            point_set: _,
            pixel_points: _,
            frames: _,
            frame: _,
            lod_bias: _,
            // Layers are kept each by itself.
            widths,
            bend: _,
            coat_layering: _,
            coat_renderer: _,
            // The model of their layer.
            sheen_visibility: _,
            sheen_lookup: _,
            // Its factors are applied to the kept image.
            specular_occlusion: _,
        } = shading;
        let levels = method.uses_levels.then_some((
            precompute.prefilter_level_count,
            precompute.level_mapping.name,
        ));
        // References by the defaults keep their keys.
        let fresnel = match fresnel {
            Fresnel::Schlick => "",
            Fresnel::Exact => "fresnel=exact\n",
        };
        let mix = match metallic_mix {
            MetallicMix::F0 => "",
            MetallicMix::Brdf => "metallic_mix=brdf\n",
        };
        let weight = method
            .uses_weight
            .then_some(precompute.prefilter_weight.name);
        Self {
            light: format!("placement={placement:?}\nscale={environment_scale}\n"),
            terms: format!(
                "method={}\ndiffuse={}\nbrdf={}\nmasking={masking_shadowing:?}\n\
                 compensation={compensation:?}\nsamples={samples}\n{fresnel}{mix}",
                method.name,
                diffuse.name,
                brdf.name(),
            ),
            tables: format!("levels={levels:?}\nweight={weight:?}\n"),
            widths: format!("widths={}\n", widths.name()),
        }
    }
}

/// The possible values of [`Convergence::term`].
const TERMS: [&str; 2] = [SPECULAR_PASS, DIFFUSE_PASS];
const CONVERGENCE_LENGTH: usize = 18;

impl Reference {
    /// Radiance, a flag, the standard error if there is one, then the terms.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut bytes: Vec<u8> = bytemuck::cast_slice(&self.radiance.data).to_vec();
        bytes.push(u8::from(self.standard_error.is_some()));
        if let Some(image) = &self.standard_error {
            bytes.extend_from_slice(bytemuck::cast_slice(&image.data));
        }
        for Convergence {
            term,
            sample_count,
            relative_error,
            is_met,
        } in &self.convergences
        {
            bytes.push(
                TERMS
                    .iter()
                    .position(|known| known == term)
                    .map_or(u8::MAX, |index| index as u8),
            );
            bytes.extend(sample_count.to_le_bytes());
            bytes.extend(relative_error.to_le_bytes());
            bytes.push(u8::from(*is_met));
        }
        bytes
    }

    /// Inverse of `to_bytes`; `None` if `bytes` are not a frame of this size.
    pub(super) fn from_bytes(bytes: &[u8], [width, height]: [u32; 2]) -> Option<Self> {
        let image_length = size_of::<[f32; 3]>() * width as usize * height as usize;
        let image =
            |bytes: &[u8]| RgbImage::new(width, height, bytemuck::pod_collect_to_vec(bytes));
        let (radiance, rest) = bytes.split_at_checked(image_length)?;
        let (flag, rest) = rest.split_first()?;
        let (standard_error, rest) = match flag {
            0 => (None, rest),
            _ => rest
                .split_at_checked(image_length)
                .map(|(error, rest)| (Some(image(error)), rest))?,
        };
        let term = |bytes: &[u8]| -> Option<Convergence> {
            let (index, rest) = bytes.split_first()?;
            let (sample_count, rest) = rest.split_first_chunk()?;
            let (relative_error, rest) = rest.split_first_chunk()?;
            Some(Convergence {
                term: TERMS.get(usize::from(*index))?,
                sample_count: u64::from_le_bytes(*sample_count),
                relative_error: f64::from_le_bytes(*relative_error),
                is_met: *rest.first()? == 1,
            })
        };
        let convergences = rest
            .chunks(CONVERGENCE_LENGTH)
            .map(term)
            .collect::<Option<Vec<_>>>()?;
        Some(Self {
            radiance: image(radiance),
            standard_error,
            convergences,
        })
    }
}

//! Writes precomputed tables as files for people and other programs.

use super::light_tables::{LOBES_OF, read_level, read_texels};
use super::{Pipeline, PipelineError, RenderRequest};
use crate::bakes::container::write_table;
use crate::brdf::{Brdf, MaskingShadowing};
use crate::environment::Environment;
use crate::glsl::constants::{LOBE_SHAPE_PARTS, LOBE_SHAPE_SIDE};
use crate::gpu::{Gpu, Image};
use crate::pixels::{GrayImage, Pixels, exr, write_atomically};
use crate::precompute::dfg::DfgAxes;
use crate::precompute::{PrecomputeSettings, PrefilterBy};
use crate::scene::{CameraKind, Scene};
use crate::shade::{Diffuse, Method, Shading};
use crate::spelling::Listed;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The methods whose tables of taps are baked.
const TAPS_OF: [&str; 2] = ["split-sum-two", "split-sum-four"];

/// The file that lists the files of a bake.
const MANIFEST: &str = "bake.json";

#[derive(Clone, Debug)]
pub struct BakeRequest {
    pub environment: Arc<Environment>,
    pub precompute: PrecomputeSettings,
    /// Each gets a prefiltered map, a DFG table and a lobe table.
    pub brdfs: Vec<&'static dyn Brdf>,
    pub masking_shadowing: MaskingShadowing,
}

/// `sh9.json`: the coefficients and what they mean.
#[derive(Serialize)]
struct Sh9File<'a> {
    environment: &'a str,
    environment_hash: &'a str,
    basis: &'static str,
    order: [&'static str; 9],
    meaning: &'static str,
    radiance: Vec<[f32; 3]>,
}

/// `bake.json`: what the other files hold.
#[derive(Serialize)]
struct BakeFile<'a> {
    environment: &'a str,
    environment_hash: &'a str,
    masking_shadowing: &'static str,
    layout: &'static str,
    mapping: &'static str,
    radiance: &'static str,
    dfg: &'static str,
    lobes: &'static str,
    taps: &'static str,
    irradiance: &'static str,
    prefilter_alphas: Vec<f64>,
    level_mapping: &'static str,
    prefilter_weight: &'static str,
    prefilter: &'static str,
    /// Only for sampled maps.
    #[serde(skip_serializing_if = "Option::is_none")]
    prefilter_lod_bias: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    prefilter_sample_count: Option<u32>,
    dfg_sample_count: u32,
    storage_format: &'static str,
    device: &'a str,
    files: Vec<String>,
}

impl Pipeline {
    /// Writes into the folder `out`, and returns the paths: prefiltered levels, DFG table, lobe table and taps of each
    /// model (EXR; lobes also as source text, taps as KTX 2), SH9 (JSON), the irradiance map (EXR), and `bake.json` last. Removes levels
    /// that an earlier bake left beyond these.
    pub fn bake(&mut self, request: &BakeRequest, out: &Path) -> Result<Vec<PathBuf>, PipelineError> {
        let environment = &request.environment;
        let settings = &request.precompute;
        remove_stale(request, out)?;
        // The smallest request that makes the tables; nothing of it is shaded.
        let mut view = RenderRequest::plain(environment.clone(), Scene::sphere(), CameraKind::Ortho, [8, 8]);
        view.shading = Shading {
            method: Method::listed("none"),
            masking_shadowing: request.masking_shadowing,
            // Other programs look the table up in their own way.
            precompute: PrecomputeSettings { dfg_axes: DfgAxes::Centres, ..*settings },
            ..view.shading
        };

        let mut files = ["sh9.json", "irradiance_over_pi.exr"].map(|name| out.join(name)).to_vec();
        view.shading.diffuse = Diffuse::listed("sh9");
        let prepared = self.prepare(&view)?;
        let texels: Vec<[f32; 4]> = self.gpu.read_buffer(&prepared.tables.sh9)?;
        write_json(&files[0], &sh9_file(environment, &texels))?;
        view.shading.diffuse = Diffuse::listed("irradiance-map");
        let prepared = self.prepare(&view)?;
        write_image(&self.gpu, &prepared.tables.irradiance_map, 0, &files[1])?;
        view.shading.diffuse = Diffuse::listed("none");
        view.shading.method = Method::listed(LOBES_OF);
        for brdf in &request.brdfs {
            view.shading.brdf = *brdf;
            let tables = self.prepare(&view)?.tables;
            for mip in 0..tables.prefiltered.mip_count() {
                let path = out.join(level_name(*brdf, mip));
                write_image(&self.gpu, &tables.prefiltered, mip, &path)?;
                files.push(path);
            }
            let path = out.join(format!("dfg_{}.exr", brdf.name()));
            // Viewers show nothing for channels named A and B.
            write_channels(&read_texels(&self.gpu, &tables.dfg)?, &["R", "G"], &path)?;
            files.push(path);
            let lobes = lobes(&self.gpu, &tables.lobe_table)?;
            let [image, header] = ["exr", "h"].map(|end| out.join(format!("lobes_{}.{end}", brdf.name())));
            write_channels(&lobes, &["R", "G", "B", "A"], &image)?;
            write_atomically(&header, |file| file.write_all(lobe_header(brdf.name(), &lobes).as_bytes()))?;
            files.extend([image, header]);
            for method in TAPS_OF {
                view.shading.method = Method::listed(method);
                let table = self.prepare(&view)?.tables.lobe_table;
                let taps = read_texels(&self.gpu, &table)?;
                let count = method.trim_start_matches("split-sum-");
                let [image, texture] =
                    ["exr", "ktx2"].map(|end| out.join(format!("taps_{count}_{}.{end}", brdf.name())));
                write_channels(&taps, &["R", "G", "B", "A"], &image)?;
                write_atomically(&texture, |file| file.write_all(&write_table(&taps)))?;
                files.extend([image, texture]);
            }
            view.shading.method = Method::listed(LOBES_OF);
        }
        let names = files.iter().filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
        let is_sampled = settings.prefilter == PrefilterBy::Sampled;
        let manifest = BakeFile {
            environment: &environment.name,
            environment_hash: &environment.hash,
            masking_shadowing: request.masking_shadowing.name(),
            layout: settings.layout.name,
            mapping: settings.layout.mapping,
            radiance: "linear Rec.709",
            dfg: "channel R (A of the text) scales f0, channel G (B) is added; x = n_dot_v, y = perceptual_roughness, both at texel centres (i + 0.5) / size, row 0 is the smoothest; a lookup within half a texel of an edge is clamped: at roughness 1 ggx errs by up to 0.5 / size",
            lobes: "two square parts below each other, nodes at both ends of x = sqrt(n_dot_v) and y = perceptual_roughness: first moments as shares of r and n (of the parts of weight 1 - Fc, then of Fc), and ratios of perceptual roughness for shares 0, 1/2 and 1 of the second; docs/paste.md",
            taps: "square parts below each other, nodes at both ends of x = sqrt(n_dot_v) and y = perceptual_roughness: for F0 1, then for 0.04, a part for each two taps (place between n and r, level, twice) and a part of weights; for this number and mapping of levels; docs/paste.md",
            irradiance: "irradiance / pi: what a Lambert surface of albedo 1 reflects",
            prefilter_alphas: (0..settings.prefilter_level_count)
                .map(|mip| settings.level_mapping.alpha_from_mip(f64::from(mip), settings.prefilter_level_count))
                .collect(),
            level_mapping: settings.level_mapping.name,
            prefilter_weight: settings.prefilter_weight.name,
            prefilter: settings.prefilter.name(),
            prefilter_lod_bias: is_sampled.then_some(settings.prefilter_lod_bias),
            prefilter_sample_count: is_sampled.then_some(settings.prefilter_sample_count),
            dfg_sample_count: settings.dfg_sample_count,
            storage_format: settings.storage.name(),
            device: &self.device().name,
            files: names.collect(),
        };
        let path = out.join(MANIFEST);
        write_json(&path, &manifest)?;
        files.push(path);
        Ok(files)
    }
}

/// Removes what the bake would not overwrite: the manifest, which is about to be wrong, and levels beyond the last.
fn remove_stale(request: &BakeRequest, out: &Path) -> Result<(), PipelineError> {
    let beyond = |brdf: &dyn Brdf| {
        let first = request.precompute.prefilter_level_count;
        let levels = (first..).map(|mip| out.join(level_name(brdf, mip)));
        levels.take_while(|path| path.exists()).collect::<Vec<_>>()
    };
    let stale = request.brdfs.iter().flat_map(|brdf| beyond(*brdf)).chain([out.join(MANIFEST)]);
    for path in stale {
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(PipelineError::Stale { path, error });
            }
            _ => {}
        }
    }
    Ok(())
}

fn level_name(brdf: &dyn Brdf, mip: u32) -> String {
    format!("prefiltered_{}_{mip}.exr", brdf.name())
}

fn sh9_file<'a>(environment: &'a Environment, texels: &[[f32; 4]]) -> Sh9File<'a> {
    Sh9File {
        environment: &environment.name,
        environment_hash: &environment.hash,
        basis: "real spherical harmonics of the world direction (y up), no Condon-Shortley sign",
        order: [
            "Y00",
            "Y1-1 (y)",
            "Y10 (z)",
            "Y11 (x)",
            "Y2-2 (xy)",
            "Y2-1 (yz)",
            "Y20 (3z^2-1)",
            "Y21 (xz)",
            "Y22 (x^2-y^2)",
        ],
        meaning: "radiance L_lm = integral of L Y_lm; irradiance(n) = sum of A_l L_lm Y_lm(n) with A = pi, 2pi/3, pi/4",
        radiance: texels.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
    }
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<(), PipelineError> {
    Ok(write_atomically(path, |file| {
        serde_json::to_writer_pretty(&mut *file, value)?;
        file.write_all(b"\n")
    })?)
}

fn write_image(gpu: &Gpu, image: &Image, mip: u32, path: &Path) -> Result<(), PipelineError> {
    let rgb = read_level(gpu, image, mip)?;
    Ok(exr::write_rgba(path, &rgb, &GrayImage::filled(rgb.width, rgb.height, 1.0), &[])?)
}

/// Extracts the parts of a lobe table that [`LOBES_OF`] reads: the moments, and below them the last widths.
fn lobes(gpu: &Gpu, table: &Image) -> Result<Pixels<[f32; 4]>, PipelineError> {
    let [side, part] = [LOBE_SHAPE_SIDE, LOBE_SHAPE_SIDE * LOBE_SHAPE_SIDE];
    let texels = gpu.read_image(table, 0)?;
    let (moments, widths) = (&texels[..part as usize], &texels[(part * (LOBE_SHAPE_PARTS - 1)) as usize..]);
    Ok(Pixels::new(side, 2 * side, [moments, widths].concat()))
}

fn write_channels(texels: &Pixels<[f32; 4]>, names: &[&str], path: &Path) -> Result<(), PipelineError> {
    let channel = |(index, name): (usize, &&str)| (name.to_string(), texels.map(|texel| texel[index]));
    Ok(exr::write_channels(path, names.iter().enumerate().map(channel).collect())?)
}

/// Writes the table as source text that is valid C, C++ and GLSL, row by row.
fn lobe_header(model: &str, lobes: &Pixels<[f32; 4]>) -> String {
    let (name, count) = (format!("splitsum_lobes_{model}"), lobes.width * lobes.height);
    let rows: Vec<String> = (0..lobes.height)
        .flat_map(|y| (0..lobes.width).map(move |x| (x, y)))
        .map(|(x, y)| format!("SPLITSUM_LOBE({})", lobes.get(x, y).map(|number| format!("{number:?}")).join(", ")))
        .collect();
    format!(
        "/* {} x {} texels, rows of y first; docs/paste.md says what they hold. */\n\
         #undef SPLITSUM_LOBE\n\
         #if defined(GL_core_profile) || defined(GL_ES)\n\
         #define SPLITSUM_LOBE(x, y, z, w) vec4(x, y, z, w)\n\
         const vec4 {name}[{count}] = vec4[{count}](\n\
         #else\n\
         #define SPLITSUM_LOBE(x, y, z, w) {{x, y, z, w}}\n\
         static const float {name}[{count}][4] = {{\n\
         #endif\n\
         {}\n\
         #if defined(GL_core_profile) || defined(GL_ES)\n\
         );\n\
         #else\n\
         }};\n\
         #endif\n",
        lobes.width,
        lobes.height,
        rows.join(",\n"),
    )
}

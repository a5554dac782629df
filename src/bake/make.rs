//! Bakes tables for an engine: exact levels by its preset, written, read back and compared.
//! `examples/judge_bake.rs` does it.

use super::container::{Encoding, FACE_COUNT, FORMATS, Format, TEXELS, TEXELS_MAX, Texel};
use super::convention::{Convention, Preset, TableAxes};
pub use super::judge::GOOD;
use super::judge::{Directions, Truth, errors, exact, level, table, texels};
use super::parts::{KEY, Manifest, Map};
use super::paste::{self, TAPS};
use super::product::LAST_SIDE;
use super::sh;
use super::source::{FACES, MANIFEST, Reading, read};
use crate::base::glsl::constants::ALPHA_MIN;
use crate::base::names::Listed;
use crate::base::pixels::{
    Fault, GrayImage, Pixels, PixelsError, Rgb8Image, RgbImage, exr, png, write_atomically,
};
use crate::instrument::brdf::{Brdf, Ggx, MaskingShadowing, alpha_from_perceptual_roughness, g1};
use crate::instrument::environment::Environment;
use crate::instrument::environment::layout::LAYOUTS;
use crate::instrument::precompute::dfg::chebyshev;
use crate::instrument::precompute::exact_quadrature;
use crate::instrument::precompute::prefilter::{Kernel, Weight};
use crate::instrument::precompute::sh9::reference::project_bilinear;
use crate::instrument::precompute::taps::TapCount;
use glam::{DVec2, DVec3};
use std::io::Write;
use std::path::{Path, PathBuf};

#[derive(Clone, Debug)]
pub struct Making<'a> {
    pub preset: &'static Preset,
    pub environment: &'a Environment,
    pub brdf: &'static dyn Brdf,
    pub masking: MaskingShadowing,
    pub weight: &'static Weight,
    pub texel: &'static Texel,
    /// Sides of a face, of the irradiance map and of the table, texels.
    pub side: u32,
    pub irradiance_side: u32,
    pub table_side: u32,
    /// Levels of the prefiltered map, from 2 to one per halving of `side`.
    pub level_count: u32,
}

/// Default sides, texels.
pub const IRRADIANCE_SIDE: u32 = 32;
pub const TABLE_SIDE: u32 = 64;
/// Bound on the relative error of a table's integrals. True errors are at most 7.5e-5 (GGX and
/// Beckmann, 289 texels of 128x128); [`chebyshev`] adds at most 1e-4.
const TABLE_WITHIN: f64 = 1e-2;

#[derive(Clone, Debug)]
pub struct Written {
    pub name: String,
    pub side: u32,
    pub alpha: f64,
    /// relMSE against its integral.
    pub relmse: f64,
    /// Why relMSE is above [`GOOD`].
    pub why: Option<String>,
}

#[derive(Clone, Debug)]
pub struct Baked {
    /// Every file, `bake.json` last.
    pub files: Vec<PathBuf>,
    pub levels: Vec<Written>,
    /// relMSE between the texels of the last prefiltered level, and how to lower it.
    pub last_between: (f64, Option<String>),
    /// Largest error of the table in its first file.
    pub table_error: Option<f64>,
}

struct Planned {
    name: &'static str,
    levels: Vec<Vec<RgbImage>>,
    exact: Vec<(Directions, Vec<DVec3>)>,
    alphas: Vec<f64>,
}

/// Bakes into the folder `out`, `bake.json` last, then reads everything back and compares it.
///
/// Fails if a file exists or cannot be written. [`Making::check`] reports settings that the
/// engine's format cannot hold.
pub fn make(making: &Making, out: &Path) -> Result<Baked, PixelsError> {
    let (product, convention) = (making.preset.product(), making.preset.convention());
    let (code_name, code) = paste::file(product.language);
    let names = [
        Some(product.specular),
        product.irradiance,
        product.sh,
        Some(TAPS),
        Some(&code_name),
        Some(MANIFEST),
    ];
    for name in names
        .into_iter()
        .flatten()
        .chain(product.tables.iter().copied())
    {
        if out.join(name).exists() {
            return Err(Fault::new("exists", "a new or an empty folder").at(&out.join(name)));
        }
    }
    std::fs::create_dir_all(out)
        .map_err(|error| Fault::new(format!("cannot be created ({error})"), "a folder").at(out))?;
    let alphas = convention
        .alphas(making.level_count as usize)
        .expect("an engine has as many widths as levels");
    let kernel = Kernel::new(making.brdf, making.weight, making.masking);
    let truth = Truth::new(making.environment, kernel, &alphas);
    let sides = (0..making.level_count).map(|k| (making.side >> k).max(1));
    let exact = |kernel: Kernel, alpha: f64, side: u32| {
        let directions = Directions::new(&LAYOUTS[0], convention.axes, [side; 2]);
        let exact = exact::exact(&truth, kernel, &directions, alpha);
        (directions, exact)
    };
    let specular = alphas
        .iter()
        .zip(sides)
        .map(|(alpha, side)| exact(kernel, *alpha, side));
    let mut maps = vec![planned(
        product.specular,
        specular.collect(),
        alphas.clone(),
    )];
    if let Some(name) = product.irradiance {
        let (kernel, alpha) = Truth::of_irradiance();
        maps.push(planned(
            name,
            vec![exact(kernel, alpha, making.irradiance_side)],
            vec![1.0],
        ));
    }
    let radiance = project_bilinear(&exact_quadrature(&making.environment.image));
    let radiance = sh::turned(&radiance, |file| convention.axes.to_world(file));

    let manifest = manifest(making, &convention, &alphas);
    let keys = keys(&manifest, &radiance);
    let mut files = Vec::new();
    for map in &maps {
        write_map(making, map, &keys, &out.join(map.name), &mut files)?;
    }
    let axes = convention.table_axes;
    let table = (!product.tables.is_empty())
        .then(|| dfg(making.brdf, making.masking, axes, making.table_side));
    for name in &product.tables {
        let path = out.join(name);
        write_table(
            table.as_ref().expect("made above"),
            &keys[..keys.len() - 1],
            &path,
        )?;
        files.push(path);
    }
    let level_count = convention.mapping_levels(making.level_count as usize);
    let taps = paste::taps(
        kernel,
        making.masking,
        convention.mapping,
        level_count,
        TapCount::Two,
    );
    let text = serde_json::to_string_pretty(&manifest).expect("plain values") + "\n";
    let of_sh = product
        .sh
        .map(|name| (name, sh::to_cmgen(&radiance).into_bytes()));
    let others = [
        (TAPS, super::container::write_table(&taps)),
        (&code_name, code.into()),
        (MANIFEST, text.into()),
    ];
    for (name, bytes) in of_sh.into_iter().chain(others) {
        let path = out.join(name);
        write_bytes(&path, &bytes)?;
        files.push(path);
    }

    let bake = read(
        &[out.display().to_string()],
        Reading {
            layout: None,
            brdf: making.brdf.name(),
        },
    )?;
    let mut levels = Vec::new();
    for (map, found) in maps.iter().zip([&bake.specular, &bake.irradiance]) {
        levels.extend(compared(
            making,
            &truth,
            map,
            found.as_ref().expect("it was written"),
        ));
    }
    let error = |(own, found): (&RgbImage, &RgbImage)| {
        let off = own
            .data
            .iter()
            .zip(&found.data)
            .flat_map(|(a, b)| (0..2).map(|i| f64::from((a[i] - b[i]).abs())));
        off.fold(0.0, f64::max)
    };
    let specular = bake.specular.as_ref().expect("it was written");
    let last_between = between(
        making,
        &truth,
        &convention,
        alphas[alphas.len() - 1],
        specular,
    );
    Ok(Baked {
        files,
        levels,
        last_between,
        table_error: table.as_ref().zip(bake.dfg.as_ref()).map(error),
    })
}

impl<'a> Making<'a> {
    /// Starts with an engine's defaults: GGX, faces of `side` texels, its pixel format and number
    /// of levels.
    pub fn new(preset: &'static Preset, environment: &'a Environment, side: u32) -> Self {
        let (convention, product) = (preset.convention(), preset.product());
        Self {
            preset,
            environment,
            brdf: &Ggx,
            masking: convention.masking,
            weight: convention.weight,
            texel: Texel::listed(product.texel),
            side,
            irradiance_side: IRRADIANCE_SIDE,
            table_side: TABLE_SIDE,
            level_count: product.levels(side),
        }
    }

    /// Reports settings that the engine's format cannot hold.
    pub fn check(&self) -> Result<(), String> {
        let product = self.preset.product();
        let engine = product.engine;
        let is_exr = |name: &&str| {
            name.ends_with(".exr") || container(name).is_none() && !name.ends_with(".png")
        };
        if !exr::IS_BUILT && [product.specular].iter().chain(&product.tables).any(is_exr) {
            return Err(format!(
                "--for {engine} writes OpenEXR; build with the feature exr"
            ));
        }
        let most = self.side.max(1).ilog2() + 1;
        if !self.side.is_power_of_two()
            || self.side < 8
            || 8 * u64::from(self.side).pow(2) > TEXELS_MAX
        {
            return Err(format!(
                "faces of {} texels; --for {engine} needs a power of 2 from 8 to 1024",
                self.side
            ));
        }
        match product.level_count {
            Some(count) if self.level_count != count || count > most => {
                return Err(format!(
                    "{} levels, faces of {} texels; --for {engine} needs {count} levels and faces \
                     of at least {}",
                    self.level_count,
                    self.side,
                    1 << (count - 1)
                ));
            }
            _ if !(2..=most).contains(&self.level_count) => {
                return Err(format!(
                    "{} levels; faces of {} have 2 to {most}",
                    self.level_count, self.side
                ));
            }
            _ => {}
        }
        let container = container(product.specular);
        let known: Vec<&str> = TEXELS
            .iter()
            .filter(|texel| holds(container, texel))
            .map(|texel| texel.name)
            .collect();
        if !known.contains(&self.texel.name) {
            let form = container.map_or("EXR faces", |format| format.name);
            return Err(format!(
                "{} in {form}; --for {engine} needs one of {}",
                self.texel.name,
                known.join(", ")
            ));
        }
        Ok(())
    }
}

/// Returns the container of a file name; `None` for a folder of faces.
fn container(name: &str) -> Option<&'static Format> {
    FORMATS
        .iter()
        .find(|format| name.ends_with(&format!(".{}", format.extension)))
}

fn holds(container: Option<&Format>, texel: &Texel) -> bool {
    match container {
        None => texel.name == "rgba32f",
        Some(format) => texel.channels >= 3 && (!format.needs_dxgi || texel.dxgi.is_some()),
    }
}

fn planned(name: &'static str, exact: Vec<(Directions, Vec<DVec3>)>, alphas: Vec<f64>) -> Planned {
    let faces = |(_, values): &(Directions, Vec<DVec3>)| -> Vec<RgbImage> {
        let side = (values.len() / FACE_COUNT).isqrt() as u32;
        // Rounding may take a series below 0.
        let texel = |value: &DVec3| value.max(DVec3::ZERO).as_vec3().to_array();
        let face = |values: &[DVec3]| Pixels::new(side, side, values.iter().map(texel).collect());
        values
            .chunks_exact(values.len() / FACE_COUNT)
            .map(face)
            .collect()
    };
    Planned {
        name,
        levels: exact.iter().map(faces).collect(),
        exact,
        alphas,
    }
}

fn write_map(
    making: &Making,
    map: &Planned,
    keys: &[(String, String)],
    path: &Path,
    files: &mut Vec<PathBuf>,
) -> Result<(), PixelsError> {
    if let Some(format) = container(map.name) {
        let is_packed = making.preset.product().is_packed;
        let encoding = Encoding {
            texel: making.texel,
            levels: &map.levels,
            keys,
            is_packed,
        };
        write_bytes(path, &(format.write)(&encoding))?;
        files.push(path.to_owned());
        return Ok(());
    }
    std::fs::create_dir_all(path).map_err(|error| {
        Fault::new(format!("cannot be created ({error})"), "a folder of faces").at(path)
    })?;
    for (k, faces) in map.levels.iter().enumerate() {
        for (face, name) in faces.iter().zip(FACES) {
            let path = path.join(format!("m{k}_{name}.exr"));
            exr::write_rgba(
                &path,
                face,
                &GrayImage::filled(face.width, face.height, 1.0),
                &[],
            )?;
            files.push(path);
        }
    }
    Ok(())
}

/// Computes A and B at texel centres.
pub fn dfg(
    brdf: &'static dyn Brdf,
    masking: MaskingShadowing,
    axes: &TableAxes,
    side: u32,
) -> RgbImage {
    // Walter's fit of G1 has a kink where no polynomial is close; without its error A and B are
    // smooth.
    let smooth = if masking == MaskingShadowing::Schlick {
        masking
    } else {
        MaskingShadowing::SmithExact
    };
    let kink = |at: DVec2| {
        let alpha = alpha_from_perceptual_roughness(at.y).max(ALPHA_MIN.into());
        g1(brdf, at.x, alpha, masking) / g1(brdf, at.x, alpha, smooth)
    };
    let table = chebyshev::table(side, |at| {
        table::exact(brdf, masking, at, TABLE_WITHIN) / kink(at)
    });
    let size = f64::from(side);
    RgbImage::from_fn(side, side, |x, y| {
        let at = axes.parameters((DVec2::new(x.into(), y.into()) + 0.5) / size);
        let [x, y] = (size * at).to_array().map(|x| x as u32);
        (kink(at) * table.get(x, y))
            .extend(0.0)
            .as_vec3()
            .to_array()
    })
}

fn write_table(
    table: &RgbImage,
    keys: &[(String, String)],
    path: &Path,
) -> Result<(), PixelsError> {
    let channel = |i: usize| table.map(|texel| texel[i]);
    let name = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    if let Some(format) = container(&name) {
        let (texel, levels) = (Texel::listed("rg16f"), [vec![table.clone()]]);
        return write_bytes(
            path,
            &(format.write)(&Encoding {
                texel,
                levels: &levels,
                keys,
                is_packed: false,
            }),
        );
    }
    if name.ends_with(".png") {
        let byte = |value: f32| (255.0 * value.clamp(0.0, 1.0)).round() as u8;
        return png::write_rgb8(
            path,
            &Rgb8Image::from_fn(table.width, table.height, |x, y| table.get(x, y).map(byte)),
        );
    }
    // Viewers show nothing under the names A and B.
    exr::write_channels(
        path,
        vec![("R".into(), channel(0)), ("G".into(), channel(1))],
    )
}

pub(super) fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), PixelsError> {
    write_atomically(path, |file| file.write_all(bytes))
}

fn manifest(making: &Making, convention: &Convention, alphas: &[f64]) -> Manifest {
    let product = making.preset.product();
    let owned = |name: &str| name.to_owned();
    Manifest {
        version: format!("splitsum {}", env!("CARGO_PKG_VERSION")),
        engine: owned(product.engine),
        preset: owned(making.preset.name),
        environment: making.environment.name.clone(),
        environment_hash: making.environment.hash.clone(),
        brdf: owned(making.brdf.name()),
        masking_shadowing: owned(making.masking.name()),
        prefilter_weight: owned(making.weight.name),
        prefilter_alphas: alphas.to_vec(),
        level_mapping: owned(convention.mapping.name),
        axes: convention.axes.to_string(),
        table_axes: owned(convention.table_axes.name),
        units: owned("linear Rec.709, radiance as the environment has it; irradiance over pi"),
        pixel_format: owned(making.texel.name),
        specular: owned(product.specular),
        irradiance: product.irradiance.map(owned),
        tables: product.tables.iter().map(|name| owned(name)).collect(),
        sh: product.sh.map(owned),
        taps: Some(owned(TAPS)),
    }
}

/// Builds a container's metadata. SH comes last: Filament's reader searches for that key.
fn keys(
    manifest: &Manifest,
    radiance: &crate::instrument::precompute::sh9::reference::Sh9,
) -> Vec<(String, String)> {
    let alphas: Vec<String> = manifest
        .prefilter_alphas
        .iter()
        .map(|alpha| format!("{alpha:.6}"))
        .collect();
    let own = [
        ("preset", &manifest.preset),
        ("source", &manifest.environment),
        ("source_hash", &manifest.environment_hash),
        ("brdf", &manifest.brdf),
        ("masking", &manifest.masking_shadowing),
        ("weight", &manifest.prefilter_weight),
        ("mapping", &manifest.level_mapping),
        ("alphas", &alphas.join(",")),
        ("axes", &manifest.axes),
        ("table_axes", &manifest.table_axes),
        ("units", &manifest.units),
    ]
    .map(|(key, value)| (format!("{KEY}{key}"), value.clone()));
    let lines: String = sh::scaled(radiance)
        .iter()
        .map(|[r, g, b]| format!("{r} {g} {b}\n"))
        .collect();
    let common = [("KTXorientation", "rd"), ("KTXwriter", &manifest.version)];
    let common = common.map(|(key, value)| (key.to_owned(), value.to_owned()));
    common
        .into_iter()
        .chain(own)
        .chain([("sh".to_owned(), lines)])
        .collect()
}

/// Scores the last level that the engine reads at four points per texel.
fn between(
    making: &Making,
    truth: &Truth,
    convention: &Convention,
    alpha: f64,
    map: &Map,
) -> (f64, Option<String>) {
    let count = map.levels.len();
    let faces = &map.levels[count.min(convention.mapping_levels(count) as usize) - 1];
    let relmse = level::between_texels(truth, map.layout, faces, convention, alpha);
    let why = (relmse > GOOD && faces[0].width < LAST_SIDE).then(|| {
        match making.preset.product().level_count {
            Some(count) => {
                let engine = making.preset.product().engine;
                format!(
                    "{engine} needs {count} levels; use faces of {} for {LAST_SIDE} texels",
                    LAST_SIDE << (count - 1)
                )
            }
            None => "use fewer levels or larger faces".to_owned(),
        }
    });
    (relmse, why)
}

/// Scores the levels of a map as read back.
fn compared(making: &Making, truth: &Truth, map: &Planned, found: &Map) -> Vec<Written> {
    let is_only = map.levels.len() == 1;
    let level = |k: usize| {
        let (directions, exact) = &map.exact[k];
        let relmse = errors(
            directions,
            &texels(&found.levels[k], 1.0),
            exact,
            truth.epsilon(),
            1.0,
        )
        .relmse;
        let largest = making.texel.largest;
        let own = map.levels[k].iter().flat_map(|face| &face.data);
        let cut = own
            .filter(|texel| texel.iter().any(|value| *value > largest))
            .count();
        let why = (relmse > GOOD).then(|| match cut {
            0 => format!(
                "{} rounds dark channels beside bright ones; try another --format",
                making.texel.name
            ),
            _ => format!(
                "{cut} texels are clipped at {largest}, the maximum of {}",
                making.texel.name
            ),
        });
        let name = if is_only {
            "irradiance".to_owned()
        } else {
            k.to_string()
        };
        Written {
            name,
            side: found.levels[k][0].width,
            alpha: map.alphas[k],
            relmse,
            why,
        }
    };
    (0..map.levels.len()).map(level).collect()
}

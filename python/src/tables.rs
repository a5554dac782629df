//! Tables of the split sum.

use crate::arrays::{Array, Source, from_image, shaped, value_error};
use glam::DVec3;
use numpy::{PyReadonlyArray1, PyReadonlyArray3};
use pyo3::prelude::*;
use splitsum::bake::container::TEXELS_MAX;
use splitsum::bake::convention::{Axes, Preset};
use splitsum::bake::judge::{Directions, exact, has_width};
use splitsum::bake::{make, paste};
use splitsum::base::names::Listed;
use splitsum::base::pixels::{Pixels, RgbImage};
use splitsum::instrument::brdf::{Brdf, MaskingShadowing};
use splitsum::instrument::environment::layout::MapLayout;
use splitsum::instrument::precompute::PrecomputeSettings;
use splitsum::instrument::precompute::dfg::DfgAxes;
use splitsum::instrument::precompute::dfg::reference::{self, dfg};
use splitsum::instrument::precompute::prefilter::{Kernel, LevelMapping, LevelSpacing, harmonic};
use splitsum::instrument::precompute::taps::{
    Chain, Fit, LEVEL_MIN, Lobe, Tap, TapCount, TapTable, dielectric_share, first_guess,
};

fn parse<T: Listed + ?Sized>(name: &str) -> PyResult<&'static T> {
    T::parse(name).map_err(value_error)
}

/// Parses model, weight and masking.
fn kernel([model, weight, masking]: &[String; 3]) -> PyResult<Kernel> {
    Ok(Kernel::new(
        parse::<dyn Brdf>(model)?,
        parse(weight)?,
        *parse::<MaskingShadowing>(masking)?,
    ))
}

/// Parses model and masking.
fn lobe_of([model, masking]: &[String; 2]) -> PyResult<(&'static dyn Brdf, MaskingShadowing)> {
    Ok((
        parse::<dyn Brdf>(model)?,
        *parse::<MaskingShadowing>(masking)?,
    ))
}

fn tap_count(count: i64) -> PyResult<TapCount> {
    let found = TapCount::ALL
        .into_iter()
        .find(|known| *known as i64 == count);
    found.ok_or_else(|| value_error(format!("count: {count}; expected 1, 2 or 4 taps")))
}

/// How the levels of a map are spaced: the name of a mapping, or the roughness of each level.
#[derive(FromPyObject)]
pub enum Mapping {
    Name(String),
    Roughnesses(Vec<f64>),
}

fn spacing(mapping: Mapping, levels: i64) -> PyResult<LevelSpacing> {
    match mapping {
        Mapping::Name(name) => {
            let (mapping, level_count) = mapped(&name, levels)?;
            Ok(LevelSpacing {
                mapping,
                level_count,
            })
        }
        Mapping::Roughnesses(roughnesses) => {
            LevelSpacing::listed(&roughnesses).map_err(value_error)
        }
    }
}

/// Parses a mapping and checks a number of levels by the rules of experiments.
fn mapped(mapping: &str, levels: i64) -> PyResult<(&'static LevelMapping, u32)> {
    let levels = u32::try_from(levels)
        .map_err(|_| value_error(format!("levels: {levels}; expected at least 2")))?;
    let settings = PrecomputeSettings {
        layout: parse("octahedral")?,
        prefilter_size: [1 << 16; 2],
        prefilter_level_count: levels,
        ..PrecomputeSettings::default()
    };
    settings.validate().map_err(value_error)?;
    Ok((parse(mapping)?, levels))
}

/// Returns the width of each level of a map.
#[pyfunction]
pub fn level_alphas(mapping: Mapping, levels: i64) -> PyResult<Vec<f64>> {
    let spacing = spacing(mapping, levels)?;
    Ok((0..spacing.level_count)
        .map(|level| spacing.alpha_from_level(level.into()))
        .collect())
}

/// Returns the bend of a named mapping, whose level is `r (1 + bend (1 - r)) (levels - 1)`.
#[pyfunction]
pub fn level_bend(mapping: String) -> PyResult<f64> {
    Ok(parse::<LevelMapping>(&mapping)?.bend())
}

/// Returns the factor of each degree by which a level of a width is made, to the degree that matters
/// and at most to `degree`. Empty if the level is a mirror.
#[pyfunction]
pub fn level_factors<'py>(
    py: Python<'py>,
    alpha: f64,
    degree: usize,
    names: [String; 3],
) -> PyResult<Array<'py, f64>> {
    let kernel = kernel(&names)?;
    let factors = py.detach(|| {
        if has_width(alpha) {
            harmonic::factors(kernel, alpha, harmonic::degree(alpha).min(degree))
        } else {
            Vec::new()
        }
    });
    let count = factors.len();
    shaped(py, factors, vec![count])
}

/// Prefilters a map for several widths, each level half the size of the one before; faces are below
/// each other.
#[pyfunction]
pub fn prefilter<'py>(
    py: Python<'py>,
    source: Source,
    alphas: Vec<f64>,
    size: Option<[i64; 2]>,
    layout: String,
    names: [String; 3],
) -> PyResult<Vec<Array<'py, f32>>> {
    let layout = parse::<MapLayout>(&layout)?;
    let kernel = kernel(&names)?;
    let size = size.map_or(layout.prefilter_size, |size| {
        size.map(|side| side.clamp(0, u32::MAX.into()) as u32)
    });
    let [width, height] = size;
    let texels = u64::from(width)
        .saturating_mul(height.into())
        .saturating_mul(layout.face_count.into());
    let least = 1 << (alphas.len().clamp(1, 31) - 1);
    if width.min(height) < least || texels > TEXELS_MAX || layout.is_square && width != height {
        let square = if layout.is_square {
            "square faces, "
        } else {
            ""
        };
        return Err(value_error(format!(
            "size: {width}x{height}; expected {square}{least} or more texels a side and at most \
             {TEXELS_MAX} in all"
        )));
    }
    let environment = source.environment(py)?;
    let levels = py.detach(|| {
        let widths = alphas.iter().filter(|alpha| has_width(**alpha));
        let degree = widths.map(|alpha| harmonic::degree(*alpha)).max();
        let harmonics = degree.map(|degree| harmonic::harmonics(&environment.image, degree));
        let level = |(level, alpha): (usize, &f64)| {
            let size = size.map(|side| side >> level);
            let texels: Vec<[f32; 3]> = match harmonics.as_ref().filter(|_| has_width(*alpha)) {
                Some(harmonics) => {
                    let texels = harmonic::level(harmonics, kernel, *alpha, layout, size);
                    texels.into_iter().map(|[r, g, b, _]| [r, g, b]).collect()
                }
                None => {
                    let texels =
                        exact::mirror(&environment, &Directions::new(layout, Axes::SAME, size));
                    texels
                        .into_iter()
                        .map(|texel| texel.as_vec3().to_array())
                        .collect()
                }
            };
            RgbImage::new(size[0], size[1] * layout.face_count, texels)
        };
        alphas.iter().enumerate().map(level).collect::<Vec<_>>()
    });
    levels
        .into_iter()
        .map(|level| from_image(py, level))
        .collect()
}

/// Bound on the relative error of a table with nodes at fourth roots, as `bake` has it: true errors
/// are at most 7.5e-5.
const TABLE_WITHIN: f64 = 1e-2;

/// Makes the table of (A, B) as `splitsum bake` does, or as `splitsum render` does: with nodes at
/// fourth roots.
#[pyfunction]
pub fn dfg_table<'py>(
    py: Python<'py>,
    side: u32,
    axes: &str,
    names: [String; 2],
) -> PyResult<Array<'py, f32>> {
    let (model, masking) = lobe_of(&names)?;
    let values: Vec<f32> = match axes {
        "centres" => {
            let axes = Preset::listed("splitsum").convention().table_axes;
            let table = py.detach(|| make::dfg(model, masking, axes, side));
            table.data.iter().flat_map(|[a, b, _]| [*a, *b]).collect()
        }
        "fourth-roots" => {
            let axes = DfgAxes::FourthRoots;
            let table = py.detach(|| reference::table(model, masking, axes, side, TABLE_WITHIN));
            let pairs = table.data.iter();
            pairs.flat_map(|pair| pair.as_vec2().to_array()).collect()
        }
        _ => {
            return Err(value_error(format!(
                "axes: {axes:?}; expected \"centres\" or \"fourth-roots\""
            )));
        }
    };
    shaped(py, values, vec![side as usize, side as usize, 2])
}

/// Returns A, B, and the first moment of each part as shares of r and n.
#[pyfunction]
pub fn lobes<'py>(
    py: Python<'py>,
    n_dot_v: PyReadonlyArray1<f64>,
    alpha: PyReadonlyArray1<f64>,
    names: [String; 2],
) -> PyResult<Array<'py, f64>> {
    let (model, masking) = lobe_of(&names)?;
    let views = pairs(&n_dot_v, &alpha);
    let of_view = |[n_dot_v, alpha]: &[f64; 2]| {
        let lobe = Lobe::new(model, masking, *n_dot_v, *alpha);
        let [of_f0, of_f90] = lobe.moments();
        [
            lobe.albedos.x,
            lobe.albedos.y,
            of_f0.x,
            of_f0.y,
            of_f90.x,
            of_f90.y,
        ]
    };
    let values = py.detach(|| views.iter().flat_map(of_view).collect());
    shaped(py, values, vec![views.len(), 6])
}

fn pairs(first: &PyReadonlyArray1<f64>, second: &PyReadonlyArray1<f64>) -> Vec<[f64; 2]> {
    first
        .as_array()
        .iter()
        .zip(second.as_array())
        .map(|(first, second)| [*first, *second])
        .collect()
}

/// Makes a table of taps, as `splitsum bake` writes it.
#[pyfunction]
pub fn taps<'py>(
    py: Python<'py>,
    count: i64,
    levels: i64,
    mapping: Mapping,
    names: [String; 3],
) -> PyResult<Array<'py, f32>> {
    let count = tap_count(count)?;
    let spacing = spacing(mapping, levels)?;
    let kernel = kernel(&names)?;
    let masking = *parse::<MaskingShadowing>(&names[2])?;
    let texels = py.detach(|| paste::taps(kernel, masking, spacing, count));
    let shape = vec![texels.height as usize, texels.width as usize, 4];
    shaped(py, texels.data.into_flattened(), shape)
}

/// Looks up place, level and weight of each tap for views and F0.
#[pyfunction]
pub fn lookup_taps<'py>(
    py: Python<'py>,
    table: PyReadonlyArray3<f32>,
    n_dot_v: PyReadonlyArray1<f64>,
    alpha: PyReadonlyArray1<f64>,
    f0: PyReadonlyArray1<f64>,
    names: [String; 2],
) -> PyResult<Array<'py, f64>> {
    let (model, masking) = lobe_of(&names)?;
    let (height, width, channels) = table.as_array().dim();
    let size = [width as u32, height as u32];
    let count = TapCount::ALL
        .into_iter()
        .find(|count| TapTable::size(*count) == size && channels == 4);
    let count = count.ok_or_else(|| {
        value_error(format!(
            "table: its shape is ({height}, {width}, {channels}); expected a table \
                             of splitsum.taps"
        ))
    })?;
    let texels = table.as_array().iter().copied().collect::<Vec<f32>>();
    let table = TapTable {
        texels: Pixels::new(size[0], size[1], texels.as_chunks().0.to_vec()),
    };
    let views = pairs(&n_dot_v, &alpha);
    let f0 = f0.as_array().to_vec();
    let of_view = |([n_dot_v, alpha], f0): (&[f64; 2], &f64)| {
        let pair = dfg(model, masking, *n_dot_v, *alpha);
        table.taps(
            *n_dot_v,
            *alpha,
            dielectric_share(*f0, [pair.f0_scale, pair.f90_scale]),
        )
    };
    let values = py.detach(|| views.iter().zip(&f0).flat_map(of_view).flatten().collect());
    shaped(py, values, vec![views.len(), count as usize, 3])
}

/// Fits taps to the lobe of one view: place, level, alpha and weight of each, their objective and
/// the textbook's.
#[pyfunction]
pub fn fit_taps<'py>(
    py: Python<'py>,
    lobe: Bound<'py, PyAny>,
    view: [f64; 2],
    count: i64,
    levels: i64,
    mapping: Mapping,
    names: [String; 3],
) -> PyResult<(Array<'py, f64>, [f64; 2])> {
    let count = tap_count(count)?;
    let kernel = kernel(&names)?;
    let spacing = spacing(mapping, levels)?;
    let chain = py.detach(|| Chain::spaced(kernel, spacing.clone()));
    let [n_dot_v, alpha] = view;
    let lobe_level = chain.level(alpha);
    if lobe_level < LEVEL_MIN {
        return Err(value_error(format!(
            "alpha: {alpha} is level {lobe_level:.3} of the map; expected {LEVEL_MIN} or more"
        )));
    }
    // About the mirror direction first, which finds the lobe's first moment.
    let theta = n_dot_v.acos();
    let mut fault = None;
    let mut fit_about = |angle: f64| {
        Fit::new(&chain, view, angle, count, |directions| {
            densities(&lobe, directions).unwrap_or_else(|error| {
                fault = Some(error);
                vec![1.0; directions.len()]
            })
        })
    };
    let first = fit_about(theta);
    let moment = first.first_moment(&first.densities);
    let fit = fit_about(f64::atan2(-moment.x, moment.y));
    if let Some(error) = fault {
        return Err(error);
    }
    let taps = py.detach(|| fit.taps(&fit.solve(first_guess(count), first_guess(count), 0.0)));
    let textbook = Tap {
        angle: theta,
        level: lobe_level,
        weight: 1.0,
    };
    let errors = [&taps[..], &[textbook]]
        .map(|taps| fit.objective(&fit.residuals(taps, &fit.kernels(taps))));
    let of_tap = |tap: &Tap| {
        [
            tap.mirror_share(theta),
            tap.level,
            spacing.alpha_from_level(tap.level),
            tap.weight,
        ]
    };
    let values = taps.iter().flat_map(of_tap).collect();
    Ok((shaped(py, values, vec![taps.len(), 4])?, errors))
}

/// Calls a lobe of Python with directions.
fn densities(lobe: &Bound<PyAny>, directions: &[DVec3]) -> PyResult<Vec<f64>> {
    let values = directions.iter().flat_map(|l| l.to_array()).collect();
    let found = lobe.call1((shaped(lobe.py(), values, vec![directions.len(), 3])?,))?;
    Ok(found
        .extract::<PyReadonlyArray1<f64>>()?
        .as_array()
        .to_vec())
}

//! Exact integrals and scores.

use crate::arrays::{Array, Source, file_error, image, shaped, value_error};
use numpy::{PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;
use splitsum::bake::convention::{PRESETS, Preset};
use splitsum::bake::judge::{Judging, Limits, as_json};
use splitsum::bake::source::{Reading, read};
use splitsum::base::csv::Cell;
use splitsum::base::math::quadrature::Tolerance;
use splitsum::base::names::Listed;
use splitsum::base::pixels::GrayImage;
use splitsum::instrument::brdf::Brdf;
use splitsum::instrument::environment::{Environment, LoadOptions};
use splitsum::instrument::metrics::{Comparison, Epsilon, HEADLINE, Metric};
use splitsum::instrument::shade::reference::TOLERANCE;
use splitsum::instrument::tonemap::ToneCurve;
use splitsum::oracle::{Kind, Queries};
use std::path::Path;

/// Lists the columns of a kind of query: required ones first.
#[pyfunction]
pub fn kind_columns(kind: String) -> PyResult<Vec<&'static str>> {
    let columns = Kind::parse(&kind).map_err(value_error)?.columns();
    Ok([columns.required, columns.optional].concat())
}

/// Answers a table of queries in CSV; returns the names of the answer's columns and its numbers, a
/// row each.
#[pyfunction]
pub fn integrate<'py>(
    py: Python<'py>,
    table: String,
    kind: String,
    source: Option<Source>,
    tolerance: f64,
) -> PyResult<(Vec<String>, Array<'py, f64>)> {
    let kind = *Kind::parse(&kind).map_err(value_error)?;
    let environment = source.map(|source| source.environment(py)).transpose()?;
    let answers = py.detach(|| {
        let mut queries = Queries::from_bytes(
            Path::new("queries"),
            table.as_bytes(),
            kind,
            &LoadOptions::default(),
        )
        .map_err(|faults| faults.to_string())?;
        queries.environments.clear();
        queries.environments.extend(environment);
        let answers = queries.answer(
            Tolerance {
                relative: tolerance,
                ..TOLERANCE
            },
            || (),
        );
        match answers.not_finite.first() {
            Some(row) => Err(format!(
                "the answer to row {} is not finite: a cosine or width too small for \
                             f64",
                row - 1
            )),
            None => Ok(answers),
        }
    });
    let answers = answers.map_err(value_error)?;
    let given = table
        .lines()
        .next()
        .map_or(0, |header| header.split(',').count());
    let number = |cell: &Cell| {
        if let Cell::Number(number) = cell {
            *number
        } else {
            f64::NAN
        }
    };
    let values = answers
        .rows
        .iter()
        .flat_map(|row| row[given..].iter().map(number))
        .collect();
    let names = answers.columns[given..].to_vec();
    let shape = vec![answers.rows.len(), names.len()];
    Ok((names, shaped(py, values, shape)?))
}

/// Judges a bake; returns the scores as JSON. `preset` is a name or JSON, `limits` JSON.
#[pyfunction]
pub fn check_bake(
    py: Python,
    files: Vec<String>,
    source: Option<Source>,
    preset: Option<String>,
    model: String,
    limits: String,
) -> PyResult<String> {
    let brdf = <dyn Brdf>::parse(&model).map_err(value_error)?;
    let limits: Limits = serde_json::from_str(&limits).map_err(value_error)?;
    let open = |text: &str| {
        let preset = if text.starts_with('{') {
            Preset::from_json(text.to_owned())
        } else {
            Preset::parse(text)
        };
        preset.map_err(value_error)
    };
    let named = preset.as_deref().map(open).transpose()?;
    let reading = Reading {
        layout: None,
        brdf: brdf.name(),
        byte_color: named.and_then(|preset| preset.convention().byte_color),
    };
    let bake = py
        .detach(|| read(&files, reading))
        .map_err(|error| file_error(&error.path.clone(), error))?;
    let preset = match (named, &bake.stated.preset) {
        (Some(preset), _) => preset,
        (None, Some(stated)) => open(stated)?,
        (None, None) => &PRESETS[0],
    };
    let environment = match source {
        Some(source) => source.environment(py)?,
        None if bake.specular.is_some() || bake.irradiance.is_some() || bake.sh.is_some() => {
            return Err(value_error(
                "environment: maps and SH need the map that they were baked \
                                    from",
            ));
        }
        // The light does not reach a DFG table.
        None => Environment::open("builtin:constant").map_err(value_error)?,
    };
    let judging = Judging::by(preset, &bake.stated).map_err(value_error)?;
    let judging = Judging { brdf, ..judging };
    let judged = py
        .detach(|| judging.judge(&environment, &bake, |_| ()))
        .map_err(value_error)?;
    Ok(as_json(&environment.name, preset.name, &limits, &judged).to_string())
}

/// Scores an image against a reference over a mask.
#[pyfunction]
pub fn relmse(
    py: Python,
    test: PyReadonlyArray3<f32>,
    reference: PyReadonlyArray3<f32>,
    mask: PyReadonlyArray2<bool>,
    environment_mean: f64,
) -> PyResult<f64> {
    let test = image(&test);
    let reference = image(&reference);
    let mask = mask.as_array();
    let is_in = mask.iter().map(|is_in| f32::from(*is_in)).collect();
    let mask = GrayImage::new(mask.dim().1 as u32, mask.dim().0 as u32, is_in);
    py.detach(|| {
        let epsilon = Epsilon::of_light(environment_mean);
        let comparison = Comparison::new(&test, &reference, &mask, ToneCurve::default(), epsilon)?;
        Ok(comparison.evaluate(&[Metric::listed(HEADLINE)])[0].1)
    })
    .map_err(|error: splitsum::instrument::metrics::MetricsError| value_error(error))
}

//! `splitsum integrate`: exact answers to a table of queries, without a device.

use super::shared::{InputFlags, check_out};
use super::{Failure, log, print_data, progress};
use clap::Args;
use splitsum::base::math::quadrature::Tolerance;
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{Brdf, IOR_MAX, MaskingShadowing, SheenVisibility, WidthLaw};
use splitsum::instrument::precompute::prefilter::Weight;
use splitsum::instrument::shade::coat::CoatLayering;
use splitsum::instrument::shade::reference::TOLERANCE;
use splitsum::oracle::{ALPHA_MIN, Kind, Queries};
use std::path::PathBuf;

/// Answer a table of queries exactly, in f64 on the CPU (no Vulkan).
#[derive(Args, Debug)]
#[command(after_help = after_help())]
pub struct Arguments {
    /// Read queries from this CSV file; see below for its columns.
    queries: PathBuf,
    /// Choose shading, ladder, dfg, prefilter, irradiance or sh9.
    #[arg(
        long,
        value_name = "NAME",
        default_value = "shading",
        value_parser = |name: &str| Kind::parse(name).copied(),
    )]
    kind: Kind,
    /// Write the table to FILE.csv [default: standard output].
    #[arg(long, value_name = "FILE.csv")]
    out: Option<PathBuf>,
    /// Stop an integration at this relative error (dfg: 5e-7; sh9: 1e-9).
    #[arg(long, value_name = "R", default_value_t = TOLERANCE.relative, value_parser = tolerance)]
    tolerance: f64,
    #[command(flatten)]
    inputs: InputFlags,
}

/// Lists the columns of each kind and the names in their cells.
fn after_help() -> String {
    let [models, maskings, weights] = [
        <dyn Brdf>::names(),
        MaskingShadowing::names(),
        Weight::names(),
    ]
    .map(either);
    let [layerings, visibilities, laws] = [
        CoatLayering::names(),
        SheenVisibility::names(),
        WidthLaw::names(),
    ]
    .map(either);
    format!(
        "\
QUERIES.csv has a header and one query per line. The answer adds columns: each number and a bound
of its absolute error. Faults are reported as file:line:column before anything is computed.

Kinds, their columns (any order; [optional]) and what is added (_r _g _b, then _error_r ... _b):
  shading     environment,brdf,alpha,f0,nx,ny,nz,vx,vy,vz [masking,id] ->
              specular        outgoing radiance of the specular term, Schlick's F from f0
              specular_white  the same with F = 1
              diffuse         of albedo 1, with 1 - F(v.h) inside the integral
              lambert         of albedo 1, without: irradiance over pi
              [anisotropy,anisotropy_rotation_deg,anisotropy_widths]: two widths along a tangent,
              at 0 degrees east (y x n), turned counter-clockwise about n
              [coat,coat_alpha,coat_layering] -> coat: radiance of the coat; base_share: factor of
              all below it, so of the results above and of the sheen
              [sheen_color,sheen_alpha,sheen_visibility] -> sheen, sheen_base_share: the same, under
              a coat
  ladder      as shading without layers, and [levels] -> reference, ladder_fresnel,
              ladder_masking, ladder_view, ladder_levels: from the integral to the split sum
  dfg         brdf,alpha,n_dot_v [masking,id] -> f0_scale,f90_scale,albedo,error
              (the albedo is the sum: a white furnace)
  prefilter   environment,brdf,alpha,rx,ry,rz [weight,masking,id] -> prefiltered
              (the split sum's first factor)
  irradiance  environment,nx,ny,nz [id] -> irradiance (not divided by pi)
  sh9         environment [id] -> l00,l1m1,l10,l11,l2m2,l2m1,l20,l21,l22
              (y up, no Condon-Shortley sign)

Cells: environment is builtin:NAME or a file (`splitsum list`), relative to QUERIES.csv;
FILE.exr#NAME is a layer. alpha in [{ALPHA_MIN}, 1]; f0 and sheen_color one number or R:G:B in [0, 1]; ior, in place
of f0, the index of refraction in [1, {IOR_MAX}]: f0 = ((1 - ior)/(1 + ior))^2; n, v and r unit vectors within 1e-5, y
up, v above the horizon of n; id any text, copied; brdf {models}.
The first is the default: masking {maskings};
weight {weights}; anisotropy_widths {laws};
coat_layering {layerings}; sheen_visibility {visibilities}.
Radiance is in the units of the map, looked up bilinearly.

Examples:
  printf 'environment,brdf,alpha,f0,nx,ny,nz,vx,vy,vz\\nbuiltin:sky,ggx,0.25,0.04,0,0.6,0.8,0,0,1\\n' \
  > queries.csv
  splitsum integrate queries.csv
  printf 'brdf,masking,alpha,n_dot_v\\nphong,separable,1,0.1\\nphong,smith-exact,1,0.1\\n' > \
  albedo.csv
  splitsum integrate albedo.csv --kind dfg --out answers.csv"
    )
}

fn either(names: Vec<&str>) -> String {
    match &names[..] {
        [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => names.concat(),
    }
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(out) = &arguments.out {
        check_out("--out", out, &["csv"], [arguments.queries.clone()])?;
    }
    let queries = Queries::read(
        &arguments.queries,
        arguments.kind,
        &arguments.inputs.options(),
    )
    .map_err(Failure::input)?;
    queries
        .warnings()
        .for_each(|(name, warning)| super::warn(name, &super::with_guide(warning)));
    if queries.is_empty() {
        return Err(Failure::nothing_to_do(format!(
            "{}: no query below the header",
            arguments.queries.display()
        )));
    }
    progress::counting("integrating", queries.len());
    let tolerance = Tolerance {
        relative: arguments.tolerance,
        ..TOLERANCE
    };
    let answers = queries.answer(tolerance, progress::one_more);
    progress::end();
    if let Some(row) = answers.not_finite.first() {
        return Err(Failure::failed(format!(
            "{}: the answer to query {row} is not finite ({} in all): a cosine or width too small \
             for f64",
            arguments.queries.display(),
            answers.not_finite.len()
        )));
    }
    match &arguments.out {
        Some(out) => answers.write(out).map_err(Failure::failed)?,
        None => print_data(&String::from_utf8_lossy(&answers.to_csv()))?,
    }
    if answers.unmet > 0 {
        log(&format!(
            "warning: {} of {} answers did not reach the tolerance; see their error columns",
            answers.unmet,
            queries.len()
        ));
    }
    Ok(())
}

fn tolerance(text: &str) -> Result<f64, String> {
    let number: f64 = text
        .parse()
        .map_err(|_| format!("{text:?} is not a number"))?;
    // Below 1e-9 rounding dominates; above 0.1 a bound is useless.
    if (1e-9..=0.1).contains(&number) {
        Ok(number)
    } else {
        Err(format!("{text} is outside [1e-9, 0.1]"))
    }
}

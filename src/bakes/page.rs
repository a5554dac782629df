//! The scores of a bake as one HTML file.

use crate::pixels::{PixelsError, write_atomically};
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, context};
use std::io::{Error, Write};
use std::path::Path;

pub const START: &str = "<!doctype html>";

/// A row of the page's table.
#[derive(serde::Serialize)]
pub struct Row {
    pub name: String,
    pub size: [u32; 2],
    pub alpha: String,
    /// Error in percent, as are errors between texels and the bias.
    pub rms: String,
    /// log10 of relmse, for the length of a bar.
    pub log: f64,
    pub between: String,
    pub bias: String,
    pub worst: String,
    pub verdict: String,
}

/// Writes a page of the JSON scores `bake` of these files.
pub fn write(path: &Path, files: &[String], bake: &serde_json::Value, rows: &[Row]) -> Result<(), PixelsError> {
    let mut templates = Environment::new();
    templates.set_auto_escape_callback(|_| AutoEscape::Html);
    let (files, bake, rows) = (Serde(files), Serde(bake), Serde(rows));
    let page = templates.render_str(include_str!("../../assets/bakes/page.html"), context! { files, bake, rows });
    write_atomically(path, |file| file.write_all(page.map_err(Error::other)?.as_bytes()))
}

//! Images, environments and errors between Python and the library.

use numpy::ndarray::Axis;
use numpy::{Element, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArray3};
use pyo3::exceptions::{PyFileNotFoundError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use splitsum::base::pixels::{Decoded, GrayImage, RgbImage, exr};
use splitsum::instrument::environment::{BUILTIN_PREFIX, Environment, LoadOptions, checked};
use std::ffi::CString;
use std::path::{Path, PathBuf};

pub type Array<'py, T> = Bound<'py, PyArrayDyn<T>>;

pub fn value_error(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Makes the error of a file: `FileNotFoundError` if it is missing.
pub fn file_error(path: &Path, error: impl ToString) -> PyErr {
    if path.exists() {
        value_error(error)
    } else {
        PyFileNotFoundError::new_err(error.to_string())
    }
}

/// An environment: a name, a path or an image.
#[derive(FromPyObject)]
pub enum Source<'py> {
    Named(String),
    Image(PyReadonlyArray3<'py, f32>),
}

impl Source<'_> {
    /// Loads the environment and checks its texels. Its warnings become warnings of Python.
    pub fn environment(&self, py: Python) -> PyResult<Environment> {
        let environment = match self {
            Self::Named(name) => py.detach(|| Environment::open(name)).map_err(|error| {
                let is_formula = name.starts_with(BUILTIN_PREFIX);
                // FILE.exr#LAYER names a file, too.
                let file = name
                    .rsplit_once('#')
                    .map_or(name.as_str(), |(file, _)| file);
                if is_formula {
                    value_error(error)
                } else {
                    file_error(Path::new(file), error)
                }
            })?,
            Self::Image(array) => {
                let decoded = Decoded::new(image(array), Vec::new());
                py.detach(|| checked("array", decoded, &LoadOptions::default()))
                    .map_err(value_error)?
            }
        };
        for warning in &environment.warnings {
            let text =
                CString::new(format!("{}: {warning}", environment.name)).map_err(value_error)?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 2)?;
        }
        Ok(environment)
    }
}

/// Copies an image of shape (h, w, 3).
pub fn image(array: &PyReadonlyArray3<f32>) -> RgbImage {
    let view = array.as_array();
    let texels = match view.as_slice() {
        Some(values) => values.as_chunks().0.to_vec(),
        None => view
            .lanes(Axis(2))
            .into_iter()
            .map(|texel| [texel[0], texel[1], texel[2]])
            .collect(),
    };
    RgbImage::new(view.dim().1 as u32, view.dim().0 as u32, texels)
}

/// Moves values into an array.
pub fn shaped<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    shape: Vec<usize>,
) -> PyResult<Array<'_, T>> {
    PyArray1::from_vec(py, values).reshape(shape)
}

pub fn from_image(py: Python<'_>, image: RgbImage) -> PyResult<Array<'_, f32>> {
    let shape = vec![image.height as usize, image.width as usize, 3];
    shaped(py, image.data.into_flattened(), shape)
}

/// Writes an image, with A = 1.
#[pyfunction]
pub fn write_exr(py: Python, path: PathBuf, array: PyReadonlyArray3<f32>) -> PyResult<()> {
    let rgb = image(&array);
    let alpha = GrayImage::filled(rgb.width, rgb.height, 1.0);
    py.detach(|| exr::write_rgba(&path, &rgb, &alpha, &[]))
        .map_err(value_error)
}

/// Reads colour and, if present, channel A.
#[pyfunction]
pub fn read_exr<'py>(
    py: Python<'py>,
    path: PathBuf,
    layer: Option<String>,
) -> PyResult<(Array<'py, f32>, Option<Array<'py, f32>>)> {
    let decoded = py
        .detach(|| exr::read_layer(&path, layer.as_deref()))
        .map_err(|error| file_error(&path, error))?;
    let shape = vec![decoded.rgb.height as usize, decoded.rgb.width as usize];
    let alpha = decoded
        .alpha
        .map(|alpha| shaped(py, alpha.data, shape))
        .transpose()?;
    Ok((from_image(py, decoded.rgb)?, alpha))
}

//! Wavefront OBJ files.
use super::{Scene, SceneError};
use std::path::Path;

pub(super) fn load(_spec: &str, path: &Path) -> Result<Scene, SceneError> {
    Err(SceneError::File { path: path.to_owned(), message: "OBJ files cannot be read yet".to_owned() })
}

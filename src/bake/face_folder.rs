//! A cube as one image a face and level in a folder: cmgen's `m0_px.exr`, or `px.exr` of one level.

use super::container::{FACE_COUNT, read_texture};
use super::parts::Map;
use crate::base::pixels::{Fault, PixelsError, RgbImage};
use crate::instrument::environment::layout::LAYOUTS;
use std::path::Path;

/// Names of faces in files.
pub const FACES: [&str; FACE_COUNT] = ["px", "nx", "py", "ny", "pz", "nz"];

/// Parses level and face of cmgen's `mL_px.exr`, or of `px.exr`.
pub fn face_of(name: &str) -> Option<(usize, usize)> {
    let (stem, _) = name.rsplit_once('.')?;
    let (level, face) = match stem.rsplit_once('_') {
        Some((level, face)) => (level.strip_prefix('m')?.parse().ok()?, face),
        None => (0, stem),
    };
    Some((level, FACES.iter().position(|known| *known == face)?))
}

/// The files of faces in a folder.
struct FaceFolder<'p> {
    path: &'p Path,
    /// Faces of each level; `None` for those not read.
    levels: Vec<[Option<RgbImage>; FACE_COUNT]>,
}

/// Reads every level of the faces among the files of a folder.
pub fn read(path: &Path, names: &[String]) -> Result<Map, PixelsError> {
    let mut folder = FaceFolder {
        path,
        levels: Vec::new(),
    };
    let mut faces: Vec<((usize, usize), &String)> = names
        .iter()
        .filter_map(|name| Some((face_of(name)?, name)))
        .collect();
    faces.sort();
    for ((level, face), name) in faces {
        folder.add(level, face, name)?;
    }
    folder.into_map()
}

impl FaceFolder<'_> {
    fn refuse(&self, what: String) -> PixelsError {
        Fault::new(
            what,
            "one file a face, m0_px.exr, m0_nx.exr, ... of each level from 0, or the folder of \
             splitsum bake",
        )
        .in_file(self.path)
    }

    /// Reads a face; faces come in order.
    fn add(&mut self, level: usize, face: usize, name: &str) -> Result<(), PixelsError> {
        let level_count = self.levels.len();
        if level > level_count || (level == level_count && face > 0) {
            return Err(self.refuse(format!("it has {name}, but not every face before it")));
        }
        if level == level_count {
            self.levels.push([const { None }; FACE_COUNT]);
        }
        let first = self.levels[level].iter().flatten().next();
        let image = read_face(&self.path.join(name), first.map(|first| first.width))?;
        if self.levels[level][face].is_some() {
            return Err(self.refuse(format!("{name} is the second file of its face")));
        }
        self.levels[level][face] = Some(image);
        Ok(())
    }

    fn into_map(mut self) -> Result<Map, PixelsError> {
        if self.levels.is_empty() {
            return Err(self.refuse("it has neither faces nor a bake.json".to_owned()));
        }
        let mut levels = Vec::new();
        for (level, faces) in std::mem::take(&mut self.levels).into_iter().enumerate() {
            let missing: Vec<&str> = FACES
                .iter()
                .zip(&faces)
                .filter(|(_, face)| face.is_none())
                .map(|(name, _)| *name)
                .collect();
            if !missing.is_empty() {
                let missing = missing.join(", ");
                return Err(self.refuse(format!("level {level} lacks the faces {missing}")));
            }
            levels.push(faces.into_iter().flatten().collect());
        }
        Ok(Map {
            layout: &LAYOUTS[0],
            levels,
        })
    }
}

/// Reads an image of one square face; `side` is the side of its level, if it is known.
fn read_face(file: &Path, side: Option<u32>) -> Result<RgbImage, PixelsError> {
    let mut texture = read_texture(file)?;
    let RgbImage { width, height, .. } = texture.levels[0][0];
    let side = side.unwrap_or(width);
    let level_count = texture.levels.len();
    if texture.is_cube() || level_count > 1 || [width, height] != [side; 2] {
        let levels = if level_count == 1 {
            "one level".to_owned()
        } else {
            format!("{level_count} levels")
        };
        let what = format!("it is {levels} of {width}x{height}");
        return Err(Fault::new(what, format!("one square face of {side}x{side}")).in_file(file));
    }
    Ok(texture.levels.swap_remove(0).swap_remove(0))
}

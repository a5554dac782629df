//! Maps of materials, as files beside the scene.

use super::mtl::MapUse;
use crate::base::pixels::lookup::Wrap;
use crate::instrument::scene::maps::{Maps, Meaning};
use crate::instrument::scene::source::SceneFiles;
use std::path::PathBuf;

/// Reads the files of maps, each once for each meaning.
pub struct MapFiles<'f> {
    files: &'f dyn SceneFiles,
    pub maps: Maps,
    known: Vec<KnownMap>,
    /// One warning each.
    pub unreadable: Vec<String>,
}

struct KnownMap {
    path: PathBuf,
    meaning: Meaning,
    /// Index of the texture; `None` for an unreadable one.
    index: Option<usize>,
}

impl<'f> MapFiles<'f> {
    pub fn new(files: &'f dyn SceneFiles) -> Self {
        Self {
            files,
            maps: Maps::default(),
            known: Vec::new(),
            unreadable: Vec::new(),
        }
    }

    pub fn index(&mut self, map: &MapUse) -> Option<usize> {
        let MapUse {
            path,
            kind,
            meaning,
        } = map;
        let is_known = |known: &&KnownMap| known.path == *path && known.meaning == *meaning;
        if let Some(known) = self.known.iter().find(is_known) {
            return known.index;
        }
        let bytes = self.files.read(path).map_err(|error| error.to_string());
        let index = bytes.and_then(|bytes| self.maps.add(&bytes, *meaning, Wrap::REPEAT));
        let index = index
            .map_err(|error| {
                self.unreadable.push(format!(
                    "{}: cannot read the {kind}: {error}; skipped",
                    path.display()
                ));
            })
            .ok();
        self.known.push(KnownMap {
            path: path.clone(),
            meaning: *meaning,
            index,
        });
        index
    }
}

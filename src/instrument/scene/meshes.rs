//! The meshes of a scene, shared by all scenes that differ in materials alone: a sweep makes one
//! scene an image.

use super::hasher::SceneHasher;
use super::mesh::Mesh;
use glam::DVec3;
use std::collections::HashMap;
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError};

/// Most directions whose supports are kept: a camera needs ten.
const SUPPORTS_MAX: usize = 256;

/// A list of meshes that clones share, with what was computed from it.
#[derive(Clone, Debug, Default)]
pub struct Meshes(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    list: Vec<Mesh>,
    /// By the bits of a direction.
    supports: Mutex<HashMap<[u64; 3], f64>>,
    hashed: Mutex<Option<Hashed>>,
}

/// The state of a hash after the meshes.
#[derive(Debug)]
struct Hashed {
    /// Hash of what came before them.
    head: blake3::Hash,
    hasher: blake3::Hasher,
}

impl From<Vec<Mesh>> for Meshes {
    fn from(list: Vec<Mesh>) -> Self {
        Self(Arc::new(Shared {
            list,
            ..Shared::default()
        }))
    }
}

impl Deref for Meshes {
    type Target = [Mesh];

    fn deref(&self) -> &[Mesh] {
        &self.0.list
    }
}

impl<'a> IntoIterator for &'a Meshes {
    type Item = &'a Mesh;
    type IntoIter = std::slice::Iter<'a, Mesh>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl Meshes {
    /// Returns the largest `dot(p, direction)` over all corners p; -infinity without meshes.
    pub(super) fn support(&self, direction: DVec3) -> f64 {
        if self.is_empty() {
            return f64::NEG_INFINITY;
        }
        let key = direction.to_array().map(f64::to_bits);
        let supports = &self.0.supports;
        let mut supports = supports.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = supports.get(&key) {
            return *known;
        }
        if supports.len() >= SUPPORTS_MAX {
            supports.clear();
        }
        let corners = self.iter().flat_map(Mesh::corners);
        let found = corners
            .map(|p| p.dot(direction))
            .fold(f64::NEG_INFINITY, f64::max);
        supports.insert(key, found);
        found
    }

    /// Hashes the meshes after `head`.
    pub(super) fn hashed_after(&self, head: SceneHasher) -> SceneHasher {
        let key = head.0.finalize();
        let hashed = &self.0.hashed;
        let mut hashed = hashed.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = hashed.as_ref().filter(|known| known.head == key) {
            return SceneHasher(known.hasher.clone());
        }
        let mut hasher = head;
        for mesh in self {
            hasher.list(&mesh.positions);
            hasher.list(&mesh.normals);
            hasher.list(&mesh.uvs);
            hasher.list(&mesh.tangents);
            hasher.list(&mesh.indices);
            hasher.list(&[mesh.material as u64]);
        }
        *hashed = Some(Hashed {
            head: key,
            hasher: hasher.0.clone(),
        });
        hasher
    }
}

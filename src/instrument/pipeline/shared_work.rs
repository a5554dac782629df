//! Shared results: made once, then taken from memory or disk.

use super::PipelineError;
use super::cache::Recent;
use super::disk_cache::DiskCache;
use super::inputs::SharedKey;
use crate::instrument::gpu::{Buffer, Gpu, GpuError, Image, Report};
use std::collections::BTreeMap;

/// How often each kind of table (`mips`, `sh9`, `irradiance`, `prefilter`, `dfg`, `taps`,
/// `reference`) was made, and read from disk.
pub type SharedWork = BTreeMap<String, [usize; 2]>;

/// The disk cache, if there is one, and the tally so far.
#[derive(Debug, Default)]
pub(super) struct Kept {
    pub(super) disk: Option<DiskCache>,
    pub(super) work: SharedWork,
}

impl Kept {
    pub(super) fn load(&mut self, key: &SharedKey) -> Option<Vec<u8>> {
        let payload = self.disk.as_mut()?.load(&key.shaders, &key.text())?;
        self.work.entry(key.kind.to_owned()).or_default()[1] += 1;
        Some(payload)
    }

    /// Counts a result and keeps it on disk if there is a cache.
    pub(super) fn store(
        &mut self,
        key: &SharedKey,
        payload: impl FnOnce() -> Result<Vec<u8>, GpuError>,
    ) -> Result<(), GpuError> {
        self.work.entry(key.kind.to_owned()).or_default()[0] += 1;
        if let Some(disk) = &mut self.disk {
            disk.store(&key.shaders, &key.text(), &payload()?);
        }
        Ok(())
    }
}

pub(super) trait Table: Clone {
    /// Reads the f32 that passes write, as bytes.
    fn download(&self, gpu: &Gpu) -> Result<Vec<u8>, GpuError>;
    /// Inverse of `download`; false if `bytes` have another length.
    fn upload(&self, gpu: &Gpu, bytes: &[u8]) -> Result<bool, GpuError>;
}

/// The levels of an image from `first` on; those above have another source.
#[derive(Clone)]
pub(super) struct Levels {
    pub(super) image: Image,
    pub(super) first: u32,
}

impl Levels {
    pub(super) fn all(image: Image) -> Self {
        Self { image, first: 0 }
    }

    pub(super) fn bytes(&self) -> u64 {
        self.image.bytes()
    }

    fn mips(&self) -> std::ops::Range<u32> {
        self.first..self.image.mip_count()
    }
}

impl Table for Levels {
    fn download(&self, gpu: &Gpu) -> Result<Vec<u8>, GpuError> {
        let levels: Result<Vec<_>, _> = self
            .mips()
            .map(|mip| gpu.read_image(&self.image, mip))
            .collect();
        Ok(bytemuck::cast_slice(&levels?.concat()).to_vec())
    }

    fn upload(&self, gpu: &Gpu, bytes: &[u8]) -> Result<bool, GpuError> {
        let texel_count = |mip| {
            self.image.face_count() as usize
                * self
                    .image
                    .mip_size(mip)
                    .iter()
                    .map(|&side| side as usize)
                    .product::<usize>()
        };
        if bytes.len() != size_of::<[f32; 4]>() * self.mips().map(texel_count).sum::<usize>() {
            return Ok(false);
        }
        let mut texels: &[[f32; 4]] = &bytemuck::pod_collect_to_vec(bytes);
        for mip in self.mips() {
            let (level, rest) = texels.split_at(texel_count(mip));
            gpu.write_image(&self.image, mip, level)?;
            texels = rest;
        }
        Ok(true)
    }
}

impl Table for Buffer {
    fn download(&self, gpu: &Gpu) -> Result<Vec<u8>, GpuError> {
        gpu.read_buffer(self)
    }

    fn upload(&self, gpu: &Gpu, bytes: &[u8]) -> Result<bool, GpuError> {
        if bytes.len() as u64 != self.size() {
            return Ok(false);
        }
        gpu.write_buffer(self, bytes)?;
        Ok(true)
    }
}

/// Makes missing tables and sums the times of their passes.
pub(super) struct Maker<'a> {
    pub(super) gpu: &'a Gpu,
    pub(super) kept: &'a mut Kept,
    pub(super) total: Report,
}

impl Maker<'_> {
    /// Returns the table of this key: from the shelf, from the disk, or filled by its passes.
    pub(super) fn table<T: Table>(
        &mut self,
        shelf: &mut Recent<String, T>,
        key: &SharedKey,
        empty: impl FnOnce() -> Result<T, GpuError>,
        fill: impl FnOnce(&T) -> Result<Report, GpuError>,
    ) -> Result<T, PipelineError> {
        shelf.get_or_make(key.inputs.clone(), || {
            let table = empty()?;
            if let Some(bytes) = self.kept.load(key)
                && table.upload(self.gpu, &bytes)?
            {
                return Ok(table);
            }
            let report = fill(&table)?;
            key.assert_names(&report.shaders);
            self.total.add(report);
            self.kept.store(key, || table.download(self.gpu))?;
            Ok(table)
        })
    }
}

//! Buffers and accessors. Files state every length, so each is checked before allocation.

use crate::base::files::inside;
use crate::instrument::scene::source::{SceneFiles, existing};
use ::gltf::Document;
use ::gltf::accessor::{Accessor, DataType, Dimensions, sparse::IndexType};
use ::gltf::buffer::{Source, View};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use std::borrow::Cow;
use std::path::Path;

const MAX_BYTES: usize = 1 << 30;

pub struct Buffers<'a>(Vec<Cow<'a, [u8]>>);

/// Reads a URI: `data:` with base64, or the percent-encoded path of a file beside `from`.
pub fn resource(uri: &str, from: &Path, files: &dyn SceneFiles) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = data.split_once(";base64,").ok_or("data: without base64")?;
        return BASE64_STANDARD
            .decode(text)
            .map_err(|error| format!("data: {error}"));
    }
    let name = percent_encoding::percent_decode_str(uri).decode_utf8_lossy();
    inside(Path::new(""), &name)?;
    files
        .read(&existing(files, from, &name))
        .map_err(|error| format!("cannot read {name:?}: {error}"))
}

impl<'a> Buffers<'a> {
    pub fn read(
        document: &Document,
        blob: Option<&'a [u8]>,
        path: &Path,
        files: &dyn SceneFiles,
    ) -> Result<Self, String> {
        let mut all = Vec::new();
        let mut bytes_left = MAX_BYTES;
        for buffer in document.buffers() {
            let fault = |what: String| format!("buffer {}: {what}", buffer.index());
            let bytes = match buffer.source() {
                Source::Bin => Cow::Borrowed(blob.ok_or_else(|| {
                    fault("has no URI, and the file has no binary part".to_owned())
                })?),
                Source::Uri(uri) => Cow::Owned(resource(uri, path, files).map_err(fault)?),
            };
            if bytes.len() < buffer.length() {
                return Err(fault(format!(
                    "has {} bytes; expected {}",
                    bytes.len(),
                    buffer.length()
                )));
            }
            bytes_left = bytes_left.checked_sub(bytes.len()).ok_or_else(|| {
                fault(format!(
                    "with it the buffers have more than {} MiB",
                    MAX_BYTES >> 20
                ))
            })?;
            all.push(bytes);
        }
        Ok(Self(all))
    }

    pub fn view(&self, view: &View) -> Result<&[u8], String> {
        let buffer = &self.0[view.buffer().index()];
        let end = view.offset().checked_add(view.length());
        end.and_then(|end| buffer.get(view.offset()..end))
            .ok_or_else(|| {
                format!(
                    "view {}: {} bytes from byte {} of {}",
                    view.index(),
                    view.length(),
                    view.offset(),
                    buffer.len()
                )
            })
    }

    /// Returns `count` elements of `size` bytes.
    fn elements<'s>(
        &'s self,
        view: &View,
        offset: usize,
        count: usize,
        size: usize,
    ) -> Result<impl Iterator<Item = &'s [u8]> + use<'s, 'a>, String> {
        let bytes = self.view(view)?;
        let stride = view.stride().unwrap_or(size);
        let end = (count - 1)
            .checked_mul(stride)
            .and_then(|last| last.checked_add(offset)?.checked_add(size));
        let Some(bytes) = end
            .filter(|_| stride >= size)
            .and_then(|end| bytes.get(offset..end))
        else {
            let all = bytes.len();
            let elements = format!("{count} elements of {size} bytes, {stride} apart");
            return Err(format!(
                "view {}: {elements}, from byte {offset} of {all}",
                view.index()
            ));
        };
        Ok((0..count).map(move |i| &bytes[i * stride..][..size]))
    }

    /// Concatenates the elements of an accessor: zeros if it has no view, with sparse ones
    /// replaced.
    fn packed(&self, accessor: &Accessor, most: usize) -> Result<Vec<u8>, String> {
        let count = accessor.count();
        let size = accessor.size();
        if count == 0 || count > most {
            return Err(format!("has {count} elements; expected 1 to {most}"));
        }
        let mut packed = match accessor.view() {
            Some(view) => self
                .elements(&view, accessor.offset(), count, size)?
                .collect::<Vec<_>>()
                .concat(),
            None => vec![0; count * size],
        };
        let Some(sparse) = accessor.sparse().filter(|sparse| sparse.count() > 0) else {
            return Ok(packed);
        };
        let indices = sparse.indices();
        let values = sparse.values();
        let replaced = sparse.count();
        let index_size = match indices.index_type() {
            IndexType::U8 => 1,
            IndexType::U16 => 2,
            IndexType::U32 => 4,
        };
        let replaced_indices =
            self.elements(&indices.view(), indices.offset(), replaced, index_size)?;
        for (index, value) in
            replaced_indices.zip(self.elements(&values.view(), values.offset(), replaced, size)?)
        {
            let index = index
                .iter()
                .rev()
                .fold(0, |number, &byte| number << 8 | usize::from(byte));
            let slot = packed.chunks_exact_mut(size).nth(index);
            slot.ok_or_else(|| format!("sparse index {index}; expected below {count}"))?
                .copy_from_slice(value);
        }
        Ok(packed)
    }

    /// Reads at most `most` vectors of floats or, normalized if stated, integers
    /// (`KHR_mesh_quantization`).
    pub fn vectors<const N: usize>(
        &self,
        accessor: &Accessor,
        most: usize,
    ) -> Result<Vec<[f32; N]>, String> {
        let fault = |what: String| format!("accessor {}: {what}", accessor.index());
        let floats = [
            Dimensions::Scalar,
            Dimensions::Vec2,
            Dimensions::Vec3,
            Dimensions::Vec4,
        ][N - 1];
        if accessor.dimensions() != floats {
            return Err(fault(format!(
                "is {:?}; expected {floats:?}",
                accessor.dimensions()
            )));
        }
        let packed = self.packed(accessor, most).map_err(fault)?;
        // The most negative integer is -1 as well.
        let part = |x: f32, largest: f32| {
            if accessor.normalized() {
                (x / largest).max(-1.0)
            } else {
                x
            }
        };
        let pairs = || packed.as_chunks().0.iter();
        let numbers: Vec<f32> = match accessor.data_type() {
            DataType::F32 => packed
                .as_chunks()
                .0
                .iter()
                .map(|bytes| f32::from_le_bytes(*bytes))
                .collect(),
            DataType::U16 => pairs()
                .map(|pair| part(u16::from_le_bytes(*pair).into(), 65535.0))
                .collect(),
            DataType::I16 => pairs()
                .map(|pair| part(i16::from_le_bytes(*pair).into(), 32767.0))
                .collect(),
            DataType::U8 => packed
                .iter()
                .map(|byte| part(f32::from(*byte), 255.0))
                .collect(),
            DataType::I8 => packed
                .iter()
                .map(|byte| part(byte.cast_signed().into(), 127.0))
                .collect(),
            other => {
                return Err(fault(format!(
                    "holds {other:?}; expected floats or integers of 8 or 16 bits"
                )));
            }
        };
        Ok(numbers.as_chunks::<N>().0.to_vec())
    }

    /// Reads at most `most` unsigned integers.
    pub fn indices(&self, accessor: &Accessor, most: usize) -> Result<Vec<u32>, String> {
        let fault = |what: String| format!("accessor {}: {what}", accessor.index());
        let packed = self.packed(accessor, most).map_err(fault)?;
        match (accessor.dimensions(), accessor.data_type()) {
            (Dimensions::Scalar, DataType::U32) => Ok(packed
                .as_chunks()
                .0
                .iter()
                .map(|b| u32::from_le_bytes(*b))
                .collect()),
            (Dimensions::Scalar, DataType::U16) => Ok(packed
                .as_chunks()
                .0
                .iter()
                .map(|b| u16::from_le_bytes(*b).into())
                .collect()),
            (Dimensions::Scalar, DataType::U8) => {
                Ok(packed.iter().map(|byte| (*byte).into()).collect())
            }
            (dimensions, data) => Err(fault(format!(
                "is {dimensions:?} of {data:?}; expected indices"
            ))),
        }
    }
}

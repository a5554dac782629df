//! Arrays of numbers in VTK's XML files, in the forms that F3D 4 writes and reads.
//!
//! A file states the type and the number of components of its array in attributes. The numbers are
//! text in the array itself, or appended behind `_`: raw bytes, or base64 of blocks packed by zlib
//! [VTK 9.7, `vtkXMLWriterBase`, `vtkXMLDataParser`].

use crate::base::pixels::Fault;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::read::ZlibDecoder;
use std::io::Read;

/// Most bytes that an array may unpack to: a cube of 1024 texels a side in 32-bit floats.
const BYTES_MAX: usize = 6 * 1024 * 1024 * 3 * 4;
const EXPECTED: &str = "32-bit floats as text, as raw appended bytes, or packed by zlib in base64";

/// The first array of a file.
#[derive(Debug)]
pub struct DataArray {
    pub component_count: usize,
    pub values: Vec<f32>,
}

/// Returns the value of an attribute of the first element of this name.
pub fn attribute<'t>(text: &'t str, element: &str, name: &str) -> Option<&'t str> {
    let start = text.find(&format!("<{element} "))?;
    let tag = text[start..].split('>').next()?;
    let (_, value) = tag.split_once(&format!(" {name}=\""))?;
    value.split('"').next()
}

/// Splits a file into its markup and the bytes appended behind `_`, if there are some.
pub fn split(bytes: &[u8]) -> Result<(&str, Option<&[u8]>), Fault> {
    const APPENDED: &[u8] = b"<AppendedData";
    let not_text = || Fault::new("its markup is not text", "an XML file of VTK");
    let Some(start) = bytes
        .windows(APPENDED.len())
        .position(|window| window == APPENDED)
    else {
        return Ok((std::str::from_utf8(bytes).map_err(|_| not_text())?, None));
    };
    let data = bytes[start..].iter().position(|byte| *byte == b'_');
    let data = data.ok_or_else(|| Fault::new("nothing is appended", EXPECTED))? + start;
    let markup = std::str::from_utf8(&bytes[..data]).map_err(|_| not_text())?;
    Ok((markup, Some(&bytes[data + 1..])))
}

/// Reads the first array of a file.
pub fn read(bytes: &[u8]) -> Result<DataArray, Fault> {
    let (markup, appended) = split(bytes)?;
    let stated = |element: &str, name: &str| attribute(markup, element, name);
    let refuse = |what: String| Fault::new(what, EXPECTED);
    let kind = stated("DataArray", "type").unwrap_or_default();
    if kind != "Float32" || stated("VTKFile", "byte_order") == Some("BigEndian") {
        return Err(refuse(format!("its array is of type {kind:?}")));
    }
    let component_count = stated("DataArray", "NumberOfComponents")
        .map_or(Some(1), |count| count.parse().ok())
        .filter(|count| (1..=16).contains(count))
        .ok_or_else(|| refuse("its number of components is unknown".to_owned()))?;
    let format = stated("DataArray", "format").unwrap_or_default();
    let values = match (format, appended) {
        ("ascii", _) => numbers(markup)?,
        ("appended", Some(data)) => {
            let header = stated("VTKFile", "header_type").unwrap_or("UInt32");
            let word_bytes = if header == "UInt64" { 8 } else { 4 };
            let packing = stated("VTKFile", "compressor");
            let bytes = match (stated("AppendedData", "encoding"), packing) {
                (Some("raw"), None) => raw(data, word_bytes)?,
                (Some("base64"), Some("vtkZLibDataCompressor")) => unpacked(data, word_bytes)?,
                _ => return Err(refuse("its appended bytes have another form".to_owned())),
            };
            let (words, _) = bytes.as_chunks::<4>();
            words.iter().map(|word| f32::from_le_bytes(*word)).collect()
        }
        _ => return Err(refuse(format!("the format of its array is {format:?}"))),
    };
    Ok(DataArray {
        component_count,
        values,
    })
}

/// Parses the text of the array.
fn numbers(markup: &str) -> Result<Vec<f32>, Fault> {
    let text = markup
        .split_once("<DataArray")
        .and_then(|(_, rest)| rest.split_once('>'))
        .and_then(|(_, rest)| rest.split('<').next())
        .unwrap_or_default();
    text.split_whitespace()
        .map(|word| {
            word.parse()
                .map_err(|_| Fault::new(format!("{word:?} is not a number"), EXPECTED))
        })
        .collect()
}

fn truncated() -> Fault {
    Fault::new(
        "its array ends behind the file",
        "a complete file; it is probably truncated",
    )
}

/// Reads a little-endian word of 4 or 8 bytes.
fn word(bytes: &[u8], word_bytes: usize) -> Result<usize, Fault> {
    let bytes = bytes.get(..word_bytes).ok_or_else(truncated)?;
    let value = bytes.iter().rev().try_fold(0usize, |value, byte| {
        value.checked_mul(256).map(|high| high + usize::from(*byte))
    });
    value.ok_or_else(truncated)
}

/// Returns bytes behind their length.
fn raw(data: &[u8], word_bytes: usize) -> Result<Vec<u8>, Fault> {
    let length = word(data, word_bytes)?;
    let bytes = data.get(word_bytes..).and_then(|rest| rest.get(..length));
    bytes.map(<[u8]>::to_vec).ok_or_else(truncated)
}

/// Unpacks blocks in base64: a header with the number of blocks, their size unpacked, the size of a
/// partial last block and the packed size of each, encoded by itself; then the blocks.
fn unpacked(data: &[u8], word_bytes: usize) -> Result<Vec<u8>, Fault> {
    let is_digit = |byte: &u8| byte.is_ascii_alphanumeric() || b"+/=".contains(byte);
    let text: Vec<u8> = data.iter().copied().take_while(is_digit).collect();
    let decoded = |text: &[u8]| {
        BASE64_STANDARD
            .decode(text)
            .map_err(|error| Fault::new(format!("its base64 cannot be read ({error})"), EXPECTED))
    };
    let digits = |bytes: usize| 4 * bytes.div_ceil(3);
    let first = decoded(text.get(..digits(3 * word_bytes)).ok_or_else(truncated)?)?;
    let block_count = word(&first, word_bytes)?;
    let block_bytes = word(&first[word_bytes..], word_bytes)?;
    if block_count > BYTES_MAX || block_count.saturating_mul(block_bytes) > 2 * BYTES_MAX {
        return Err(Fault::new(
            format!("it claims {block_count} blocks of {block_bytes} bytes"),
            format!("at most {BYTES_MAX} bytes"),
        ));
    }
    let header = digits((3 + block_count) * word_bytes);
    let sizes = decoded(text.get(..header).ok_or_else(truncated)?)?;
    let blocks = decoded(text.get(header..).ok_or_else(truncated)?)?;
    let mut bytes = Vec::new();
    let mut position = 0usize;
    for block in 0..block_count {
        let size = sizes.get((3 + block) * word_bytes..).unwrap_or_default();
        let length = word(size, word_bytes)?;
        let end = position.checked_add(length).ok_or_else(truncated)?;
        let packed = blocks.get(position..end).ok_or_else(truncated)?;
        ZlibDecoder::new(packed)
            .take(block_bytes as u64)
            .read_to_end(&mut bytes)
            .map_err(|error| Fault::new(format!("cannot be unpacked ({error})"), EXPECTED))?;
        position = end;
    }
    Ok(bytes)
}

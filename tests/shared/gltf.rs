//! Small glTF files, made by the tests that use them.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use glam::Vec3;
use serde_json::{Value, json};
use splitsum::instrument::scene::{Scene, SceneFiles};
use std::io::{Error, ErrorKind};
use std::path::Path;

struct One<'a>(&'a [u8]);

impl SceneFiles for One<'_> {
    fn read(&self, path: &Path) -> std::io::Result<Vec<u8>> {
        if self.has(path) {
            Ok(self.0.to_vec())
        } else {
            Err(Error::from(ErrorKind::NotFound))
        }
    }

    fn has(&self, path: &Path) -> bool {
        path == Path::new("x.gltf")
    }
}

pub fn load(model: &Value) -> Result<Scene, String> {
    Scene::from_file(Path::new("x.gltf"), &One(model.to_string().as_bytes()))
        .map_err(|error| error.to_string())
}

fn data(bytes: &[u8]) -> String {
    format!(
        "data:application/octet-stream;base64,{}",
        BASE64_STANDARD.encode(bytes)
    )
}

/// An image of 8-bit texels, as a `data:` URI.
pub fn png(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 3]) -> Value {
    uri(image::RgbImage::from_fn(width, height, |x, y| {
        image::Rgb(texel(x, y))
    }))
}

pub fn uri(image: impl Into<image::DynamicImage>) -> Value {
    let mut file = std::io::Cursor::new(Vec::new());
    image
        .into()
        .write_to(&mut file, image::ImageFormat::Png)
        .expect("a picture in memory");
    json!({ "uri": format!("data:image/png;base64,{}", BASE64_STANDARD.encode(file.into_inner())) })
}

/// One mesh with attributes of floats (name, floats an element, values) in one node, each in its
/// own buffer; indices of 16 bits.
pub fn mesh(attributes: &[(&str, usize, &[f32])], indices: &[u16]) -> Value {
    let mut buffers: Vec<Vec<u8>> = attributes
        .iter()
        .map(|(.., values)| values.iter().flat_map(|x| x.to_le_bytes()).collect())
        .collect();
    buffers.push(indices.iter().flat_map(|x| x.to_le_bytes()).collect());
    let mut accessors: Vec<Value> = (0..)
        .zip(attributes)
        .map(|(view, (_, floats, values))| {
            let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][floats - 1];
            json!({ "bufferView": view, "componentType": 5126, "count": values.len() / floats, "type": kind,
                    "min": [0, 0, 0], "max": [0, 0, 0] })
        })
        .collect();
    accessors.push(
        json!({ "bufferView": attributes.len(), "componentType": 5123, "count": indices.len(), "type": "SCALAR" }),
    );
    let names: serde_json::Map<String, Value> = (0..)
        .zip(attributes)
        .map(|(accessor, (name, ..))| ((*name).to_owned(), json!(accessor)))
        .collect();
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": names, "indices": attributes.len(), "material": 0 }] }],
        "materials": [{ "doubleSided": true }],
        "accessors": accessors,
        "bufferViews": (0..).zip(&buffers).map(|(i, b)| json!({ "buffer": i, "byteLength": b.len() })).collect::<Vec<_>>(),
        "buffers": buffers.iter().map(|b| json!({ "uri": data(b), "byteLength": b.len() })).collect::<Vec<_>>(),
    })
}

/// A bent sheet of two triangles with unequal normals, which shows a wrong transform of either
/// triangle.
pub fn sheet() -> Value {
    let positions = [-1., -1., 0., 1., -1., 0.3, 1., 1., -0.2, -1., 1., 0.1];
    let normals = [
        [-0.3, -0.1, 1.0],
        [0.4, -0.2, 1.0],
        [0.1, 0.5, 1.0],
        [-0.2, 0.3, 1.0],
    ];
    let normals = normals
        .map(|n| Vec3::from_array(n).normalize().to_array())
        .concat();
    let uvs = [0., 0., 1., 0., 1., 1., 0., 1.];
    mesh(
        &[
            ("POSITION", 3, &positions),
            ("NORMAL", 3, &normals),
            ("TEXCOORD_0", 2, &uvs),
        ],
        &[0, 1, 2, 0, 2, 3],
    )
}

/// Gives the material of `model` maps: (place, image), each with its own texture.
pub fn textured(mut model: Value, material: Value, images: &[Value]) -> Value {
    model["materials"] = json!([material]);
    model["images"] = json!(images);
    model["textures"] = (0..images.len())
        .map(|source| json!({ "source": source }))
        .collect();
    model
}

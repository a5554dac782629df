//! Small right files of every kind of input, made here: what fuzzing and mutation start from.

use crate::bakes::files;
use crate::gltf_files::{png, textured};
use crate::scene::gltf::{glb, quad};
use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes, LineOrder,
    WritableImage, f16,
};
use serde_json::{Value, json};
use splitsum::bakes::container::TEXELS;
use std::io::Cursor;

/// The seeds of one target, with their names.
pub fn seeds(target: &str) -> Vec<(String, Vec<u8>)> {
    let texts = |seeds: &[(&str, &str)]| seeds.iter().map(|(n, t)| (n.to_string(), t.as_bytes().to_vec())).collect();
    match target {
        "hdr" => hdr(),
        "exr" => exr(),
        "obj" => obj(),
        "gltf" => gltf(),
        "experiment" => texts(EXPERIMENTS),
        "queries" => texts(QUERIES),
        "report" => texts(REPORTS),
        "ktx2" | "ktx" | "dds" => textures(target),
        "png" => pngs(),
        "sh" => coefficients(),
        "bake" => bakes(),
        other => panic!("there is no target {other}"),
    }
}

/// A cube of 4 with its levels in each pixel format, all texels of the same bytes.
fn textures(target: &str) -> Vec<(String, Vec<u8>)> {
    let mut seeds = Vec::new();
    for texel in TEXELS.iter().filter(|texel| target != "dds" || texel.dxgi.is_some()) {
        let level = |side: usize| vec![vec![0x3b; side * side * texel.bytes]; 6];
        let levels = [level(4), level(2), level(1)];
        let mut seed = |name: &str, bytes: Vec<u8>| seeds.push((format!("{}{name}", texel.name), bytes));
        match target {
            "ktx2" => {
                seed("", files::ktx2(texel, 4, &levels, false));
                seed("-zstd", files::ktx2(texel, 4, &levels, true));
            }
            "ktx" => seed("", files::ktx1(texel, 4, &levels)),
            _ => seed("", files::dds(texel, 4, &levels)),
        }
    }
    seeds
}

/// A table of 3 in 8 and 16 bits, grey and in colours.
fn pngs() -> Vec<(String, Vec<u8>)> {
    let eight = image::RgbImage::from_fn(3, 3, |x, y| image::Rgb([40 * x as u8, 80 * y as u8, 7]));
    let image = image::DynamicImage::from(eight);
    let forms = [("rgb8", image.clone()), ("rgba16", image.to_rgba16().into()), ("grey8", image.to_luma8().into())];
    let seed = |(name, image): (&str, image::DynamicImage)| {
        let mut file = Cursor::new(Vec::new());
        image.write_to(&mut file, image::ImageFormat::Png).expect("a picture in memory");
        (name.to_owned(), file.into_inner())
    };
    forms.into_iter().map(seed).collect()
}

fn coefficients() -> Vec<(String, Vec<u8>)> {
    let radiance = std::array::from_fn(|k| glam::DVec3::new(0.5, -0.25, 1e-3) * k as f64);
    let json = json!({ "radiance": radiance.map(|triple: glam::DVec3| triple.to_array()) });
    let texts = [("cmgen", splitsum::bakes::sh::to_cmgen(&radiance)), ("ours", json.to_string())];
    texts.map(|(name, text)| (name.to_owned(), text.into_bytes())).into()
}

/// Faces of one texel in two levels, by their names and by a `bake.json`.
fn bakes() -> Vec<(String, Vec<u8>)> {
    let face = [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n".as_slice(), &[9, 99, 199, 129], b"\n"].concat();
    let faces = |folder: &str| -> Vec<u8> {
        let names = (0..2).flat_map(|level| splitsum::bakes::source::FACES.map(|face| format!("m{level}_{face}.hdr")));
        names.flat_map(|name| [format!("@@{folder}{name}\n").as_bytes(), &face].concat()).collect()
    };
    let texts: Vec<String> = coefficients().into_iter().map(|(_, text)| String::from_utf8(text).unwrap()).collect();
    let engines = json!({
        "version": "splitsum", "engine": "raw", "preset": "splitsum", "environment": "e", "environment_hash": "0",
        "brdf": "ggx", "masking_shadowing": "separable", "prefilter_weight": "cosine", "prefilter_alphas": [0, 1],
        "level_mapping": "linear", "axes": "+x+y+z", "table_axes": "n+r+", "units": "", "pixel_format": "rgba32f",
        "specular": "specular", "irradiance": null, "tables": ["dfg.hdr"], "sh": "sh.txt",
    });
    let engines = format!("@@bake.json\n{engines}\n@@sh.txt\n{}@@dfg.hdr\n", texts[0]);
    let ours = json!({ "layout": "equirect", "prefilter_alphas": [0], "prefilter_weight": "cosine",
                       "masking_shadowing": "separable" });
    let ours = format!("@@bake.json\n{ours}\n@@sh9.json\n{}\n@@prefiltered_ggx_0.exr\n", texts[1]);
    let mut level = Cursor::new(Vec::new());
    let pixels = Image::from_channels((2, 1), exr::prelude::SpecificChannels::rgb(|_| (0.5f32, 1.0f32, 2.0f32)));
    pixels.write().to_buffered(&mut level).expect("an image in memory");
    vec![
        ("faces".to_owned(), faces("")),
        ("engine".to_owned(), [engines.as_bytes(), &face, &faces("specular/")].concat()),
        ("ours".to_owned(), [ours.as_bytes(), level.get_ref()].concat()),
    ]
}

fn hdr() -> Vec<(String, Vec<u8>)> {
    let texel = |i: u8| [i.wrapping_mul(37) | 128, i, 255 - i, 125 + i % 9];
    let flat: Vec<u8> = (0..18).flat_map(texel).collect();
    let file = |header: &str, resolution: &str, pixels: &[u8]| {
        [format!("#?{header}\n\n{resolution}\n").as_bytes(), pixels].concat()
    };
    let rgbe = "RADIANCE\nFORMAT=32-bit_rle_rgbe";
    let mut new_rle = Vec::new();
    for row in 0..2u8 {
        new_rle.extend([2, 2, 0, 9]);
        for channel in 0..4 {
            // The last channel is the exponent; 131 gives values of some units.
            let value = if channel == 3 { 131 } else { row * 40 + channel * 9 + 120 };
            new_rle.extend([128 + 5, value, 3, 1, 2, 3, 1, 130]);
        }
    }
    let old_rle = [texel(5), [1, 1, 1, 8], texel(7), texel(8), [1, 1, 1, 7]].concat();
    let resolutions = ["-Y 2 +X 9", "+Y 2 +X 9", "-Y 2 -X 9", "+X 9 -Y 2", "-X 9 +Y 2"];
    let mut seeds: Vec<(String, Vec<u8>)> =
        resolutions.iter().enumerate().map(|(i, r)| (format!("flat-{i}"), file(rgbe, r, &flat))).collect();
    seeds.extend([
        ("new-rle".to_owned(), file(rgbe, "-Y 2 +X 9", &new_rle)),
        ("old-rle".to_owned(), file("RGBE", "-Y 2 +X 9", &old_rle)),
        (
            "header".to_owned(),
            file(
                "RADIANCE\n# a\nFORMAT=32-bit_rle_xyze\nEXPOSURE=4\nEXPOSURE= .5\nCOLORCORR=1 2 .5\nPIXASPECT=1\nVIEW= -vtv",
                "-Y 2 +X 9",
                &flat,
            ),
        ),
        (
            "primaries".to_owned(),
            file(&format!("{rgbe}\nPRIMARIES=.708 .292 .170 .797 .131 .046 .3127 .3290"), "-Y 2 +X 9", &flat),
        ),
    ]);
    seeds
}

fn exr() -> Vec<(String, Vec<u8>)> {
    let (width, height) = (13usize, 9usize);
    let half =
        |c: usize| FlatSamples::F16((0..width * height).map(|i| f16::from_f32((i * 7 % 83 + c) as f32)).collect());
    let float = |c: usize| FlatSamples::F32((0..width * height).map(|i| (i * 5 % 71 + c) as f32 / 8.0).collect());
    let uint = |c: usize| FlatSamples::U32((0..width * height).map(|i| (i * 3 % 59 + c) as u32).collect());
    let bytes = |image: &dyn Fn(&mut Cursor<Vec<u8>>)| {
        let mut file = Cursor::new(Vec::new());
        image(&mut file);
        file.into_inner()
    };
    let plain = |compression, blocks, names: &[&str], samples: &dyn Fn(usize) -> FlatSamples| {
        let list = names.iter().enumerate().map(|(c, name)| AnyChannel::new(*name, samples(c)));
        let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
        let image = Image::from_encoded_channels((width, height), encoding, AnyChannels::sort(list.collect()));
        bytes(&|file| image.write().non_parallel().to_buffered(file).expect("an image in memory"))
    };
    let lines = exr::image::Blocks::ScanLines;
    let tiles = exr::image::Blocks::Tiles(exr::math::Vec2(8, 4));
    let rgb = ["R", "G", "B"];
    let mut seeds = vec![
        ("float".to_owned(), plain(Compression::Uncompressed, lines, &["R", "G", "B", "A"], &float)),
        ("uint".to_owned(), plain(Compression::ZIP1, lines, &rgb, &uint)),
        ("layer".to_owned(), plain(Compression::RLE, lines, &["a.R", "a.G", "a.B", "Z"], &float)),
    ];
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::B44A,
        Compression::DWAA(None),
        Compression::DWAB(None),
    ];
    for compression in compressions {
        seeds.push((format!("half-{compression}").to_lowercase(), plain(compression, lines, &rgb, &half)));
        // The encoder of the crate `exr` writes no tiles under DWA.
        if !matches!(compression, Compression::DWAA(_) | Compression::DWAB(_)) {
            seeds.push((format!("tiles-{compression}").to_lowercase(), plain(compression, tiles, &rgb, &float)));
        }
    }
    let part = |name: &str, names: &[&str]| {
        let list = names.iter().enumerate().map(|(c, name)| AnyChannel::new(*name, half(c)));
        let encoding = Encoding::SMALL_FAST_LOSSLESS;
        Layer::new((width, height), LayerAttributes::named(name), encoding, AnyChannels::sort(list.collect()))
    };
    let parts = Image::from_layers(
        exr::meta::header::ImageAttributes::with_size((width, height)),
        vec![part("depth", &["Z"]), part("beauty", &rgb)],
    );
    seeds.push((
        "parts".to_owned(),
        bytes(&|file| {
            parts.write().non_parallel().to_buffered(file).expect("an image in memory");
        }),
    ));
    let levels = |base: f32| exr::image::Levels::Mip {
        rounding_mode: exr::math::RoundingMode::Down,
        level_data: [8usize, 4, 2, 1].iter().map(|size| FlatSamples::F32(vec![base; size * size])).collect(),
    };
    let list = rgb.iter().zip([1.0, 2.0, 3.0]).map(|(name, base)| AnyChannel::new(*name, levels(base)));
    let encoding = Encoding { compression: Compression::ZIP16, blocks: tiles, line_order: LineOrder::Increasing };
    let mips = Image::from_encoded_channels((8, 8), encoding, AnyChannels::sort(list.collect()));
    seeds.push((
        "mips".to_owned(),
        bytes(&|file| {
            mips.write().non_parallel().to_buffered(file).expect("an image in memory");
        }),
    ));
    seeds
}

fn obj() -> Vec<(String, Vec<u8>)> {
    let texts = [
        (
            "forms",
            "@@x.obj\nv 0 0 0\nv 1 0 0\r\nv 1 1 0 1\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nf 1 2 3\nf 1/1 2/2 3/3\nf 1//1 3//1 4//1\nf -4/1/-1 -3/2/-1 -2/3/-1 \\\n-1/1/1",
        ),
        (
            "materials",
            "@@x.obj\nmtllib m.mtl other.mtl\no a\ng b\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nusemtl two words\ns 1\nf 1 3 4\nl 1 2\np 1\n@@m.mtl\nnewmtl red\nKd 1 .5 0\nNs 10\nNi 1.5\nnewmtl two words\nPr .5\nPm 1\nmap_Kd -s 1 1 1 a.png\n",
        ),
        ("concave", "@@x.obj\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nv 2 1 1e-9\nf 1 2 3 4 5\nf 1 2 3 6 5 4\n"),
        ("text", "@@x.obj\n\u{feff}# c\\\nv 1 2 3 #x\ncurv 0 1\nvp 1\nv 1e3 -2.5E-2 .3\nv +1 0 0\nfo 1 2 3"),
    ];
    let mut seeds: Vec<(String, Vec<u8>)> = texts.iter().map(|(n, t)| (n.to_string(), t.as_bytes().to_vec())).collect();
    let mut picture = Cursor::new(Vec::new());
    image::RgbImage::from_fn(3, 2, |x, y| image::Rgb([90 * x as u8, 100 * y as u8, 7]))
        .write_to(&mut picture, image::ImageFormat::Png)
        .expect("a picture in memory");
    let scene =
        "@@x.obj\nmtllib m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n@@m\nnewmtl a\nmap_Kd p\n@@p\n";
    seeds.push(("map".to_owned(), [scene.as_bytes(), &picture.into_inner()].concat()));
    seeds
}

/// A square with every map, text and binary, whole and with sparse elements.
fn gltf() -> Vec<(String, Vec<u8>)> {
    let material = json!({
        "normalTexture": { "index": 1 },
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 } },
    });
    let turned = json!({ "offset": [0, 1], "rotation": 1, "scale": [2, 2], "texCoord": 0 });
    let turned = json!({ "normalTexture": { "index": 0, "extensions": { "KHR_texture_transform": turned } } });
    let images = [0, 90].map(|base| png(2, 2, move |x, y| [base + 90 * x as u8, 100 * y as u8, 7]));
    let mut sparse = quad();
    let accessors = sparse["accessors"].as_array_mut().expect("accessors");
    accessors[0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": 3, "componentType": 5123 },
        "values": { "bufferView": 0 },
    });
    let mut nodes = quad();
    nodes["nodes"] = json!([{ "children": [1], "scale": [1, -1, 1] }, { "mesh": 0, "rotation": [0, 1, 0, 0] }]);
    nodes["meshes"][0]["primitives"][0]["mode"] = json!(5);
    let mut turned = textured(quad(), turned, &images);
    turned["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33071, "wrapT": 33648 }]);
    turned["textures"][0]["sampler"] = json!(0);
    let models =
        [("maps", textured(quad(), material, &images)), ("sparse", sparse), ("nodes", nodes), ("turned", turned)];
    let text = |(name, model): &(&str, Value)| (name.to_string(), format!("@@x.gltf\n{model}").into_bytes());
    let mut seeds: Vec<_> = models.iter().map(text).collect();
    seeds.push(("binary".to_owned(), glb(&models[1].1)));
    seeds
}

const EXPERIMENTS: &[(&str, &str)] = &[
    (
        "sweep",
        r#"@@x.toml
name = "x"
question = "Which \"one\"?"
seed = 7
size = [16, 16]
scene = "sphere"
camera = "ortho"
background = false
reference = { method = "reference", samples = 64, relative_error = 0.01 }
[axes]
environment = ["builtin:constant"]
brdf = ["ggx", "beckmann", "phong"]
method = ["sampled", "split-sum"]
samples = [1, 4]
alpha = { logspace = [0.1, 1.0, 3] }
exposure = [1, 10]
[[exclude]]
method = "split-sum"
samples = [4]
why = "it takes none"
[timing]
warmup = "stable"
rounds = 3
"#,
    ),
    (
        "zip",
        r#"@@x.toml
name = "zip"
zip = [["f0", "albedo"]]
[axes]
environment = ["builtin:cap:half_angle_deg=10", "builtin:gradient"]
f0 = [0.04, [1, 0.5, 0.25]]
albedo = [0, 1]
contrast = [1, 2.2]
method = ["none"]
diffuse = ["none"]
[bias_variance]
repeats = 2
[precompute]
prefilter_size = [32, 32]
prefilter_level_count = 3
dfg_sample_count = 64
[[lights]]
kind = "directional"
direction = [0, 1, 0]
color = [1, 1, 1]
[[lights]]
kind = "point"
position = [0.0, 2, -1e1]
color = [5, 5, 5]
@@set
alpha=0.1,0.2
samples=8
"#,
    ),
    (
        "faults",
        "@@x.toml\nname = 'a/b'\nsize = [0]\nsedd = 1\n[axes]\nalpha = [1.4, \"x\", 0x10, 1979-05-27, inf]\nmethode = ['split sum']\n[axes.environment]\n\"\\u00e9\" = '''\n'''\n@@set\nalpha\nbrdf=\n=1\n",
    ),
];

const QUERIES: &[(&str, &str)] = &[
    (
        "shading",
        "id,environment,brdf,masking,alpha,f0,nx,ny,nz,vx,vy,vz\na,builtin:constant,ggx,,0.2,0.04,0,1,0,0,1,0\n\"b,\"\"\",builtin:cap:half_angle_deg=10,phong,height-correlated,1,1:0.5:0,0,0,1,0.6,0,0.8\n",
    ),
    ("dfg", "\u{feff}brdf,alpha,n_dot_v\r\nggx,0.5,0.25\r\n\r\nbeckmann,1e-2,1\r\n"),
    ("prefilter", "environment,brdf,alpha,rx,ry,rz\nbuiltin:gradient,ggx,.5,1,0,0\n"),
    ("irradiance", "environment,nx,ny,nz\nbuiltin:constant,0,0,1\nnone.hdr,0,0,2\n"),
    ("sh9", "environment\nbuiltin:constant\n"),
];

const REPORTS: &[(&str, &str)] = &[
    (
        "run",
        r#"@@provenance.json
{"schema_version": 1, "name": "a <b>", "question": "?", "plan_hash": "1", "shader_hash": "2", "cell_count": 4, "sessions": [{"date_utc": "2020", "device": {"name": "d", "driver": "v"}, "commit": {"hash": "0"}, "host": {"cpu": "c"}}], "metrics": [{"name": "relmse"}], "excluded": [], "inputs": []}
@@errors.csv
cell,environment,alpha,method,samples,exposure,relmse,rmse,relmse_noise_floor,verdict
0,builtin:sky,0.1,sampled,1,1,0.4,1,1e-6,resolved
1,builtin:sky,0.1,sampled,4,1,0.1,1,1e-6,resolved
2,builtin:sky,0.1,split-sum,,1,0.2,1,1e-6,resolved
3,"=a,""</script>",0.5,sampled,16,1,inf,,,failed
@@errors_by_n_dot_v.csv
cell,environment,alpha,method,samples,exposure,n_dot_v_lo,n_dot_v_hi,pixel_count,relmse
0,builtin:sky,0.1,sampled,1,1,0,0.5,9,0.5
1,builtin:sky,0.1,sampled,4,1,0,0.5,9,0.2
2,builtin:sky,0.1,split-sum,,1,0,0.5,9,0.3
@@images.csv
cell,radiance,reference
0,a.exr,r.exr
1,b.exr,r.exr
@@experiment.toml
name = "a"
@@timings/0.json
{"cell": "0", "phase": "frame", "block": "", "environment_size": [8, 4], "size": [8, 8], "axes": {"method": "sampled", "samples": "1"}, "warmup": 1, "rounds": [{"order": 0, "start_s": 0.5}], "passes": [{"pass": "shade", "ms": [1.5, 2, 1e1]}], "wall_ms": [2, 3, 4], "device": "d", "device_type": "cpu", "driver": "v"}
@@failed/3.json
{"cell": "3", "label": "alpha=0.5", "reason": "<script>"}
"#,
    ),
    ("least", "@@provenance.json\n{}\n@@errors.csv\ncell\n"),
];

//! The disk cache returns entries bit for bit or not at all; the memory cache is bounded.

use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::brdf::{Beckmann, Brdf, Ggx};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::gpu::{DeviceInfo, code_hash, processor, shader_code, shader_names};
use splitsum::instrument::pipeline::{
    CACHE_BYTES, DiskCache, Recent, RenderRequest, shaders_of_kept,
};
use splitsum::instrument::scene::{CameraKind, Scene};
use splitsum::instrument::shade::{Diffuse, Method};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const LIMIT: u64 = 1 << 20;

fn open(dir: &Path) -> DiskCache {
    DiskCache::open(dir, LIMIT).unwrap()
}

fn files(dir: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect()
}

#[test]
fn a_payload_comes_back_under_its_key_only() {
    let dir = tempfile::tempdir().unwrap();
    let bits: Vec<u8> = [f32::NAN, -0.0, f32::MIN_POSITIVE / 2.0, f32::INFINITY]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    open(dir.path()).store(&[], "a", &bits);
    open(dir.path()).store(&[], "empty", &[]);
    let mut cache = open(dir.path());
    assert_eq!(cache.load(&[], "a"), Some(bits));
    assert_eq!(cache.load(&[], "empty"), Some(Vec::new()));
    assert_eq!(cache.load(&[], "b"), None);
    assert!(cache.take_warnings().is_empty());
}

#[test]
fn any_damage_is_noticed_and_removed() {
    let dir = tempfile::tempdir().unwrap();
    let payload: Vec<u8> = (0..=255).collect();
    open(dir.path()).store(&[], "key", &payload);
    let file = files(dir.path()).pop().unwrap();
    let whole = std::fs::read(&file).unwrap();
    let flipped = (0..whole.len()).step_by(7).map(|place| {
        let mut bytes = whole.clone();
        bytes[place] ^= 0x10;
        bytes
    });
    let cut = (0..whole.len())
        .step_by(13)
        .map(|length| whole[..length].to_vec());
    let longer = std::iter::once([whole.as_slice(), &[0]].concat());
    for bytes in flipped.chain(cut).chain(longer) {
        std::fs::write(&file, &bytes).unwrap();
        let mut cache = open(dir.path());
        assert_eq!(cache.load(&[], "key"), None);
        let warnings = cache.take_warnings();
        assert!(
            warnings.len() == 1 && warnings[0].contains("is damaged"),
            "{warnings:?}"
        );
        assert!(!file.exists());
    }
    // An entry of another key under this name: the name proves nothing.
    let mut cache = open(dir.path());
    cache.store(&[], "other", &payload);
    let other = files(dir.path()).pop().unwrap();
    std::fs::rename(other, &file).unwrap();
    assert_eq!(cache.load(&[], "key"), None);
}

#[test]
fn above_its_limit_the_entries_used_longest_ago_go() {
    let dir = tempfile::tempdir().unwrap();
    let payload = vec![7; (LIMIT / 5) as usize];
    let mut cache = open(dir.path());
    let old = std::time::SystemTime::now() - std::time::Duration::from_secs(1000);
    for (age, key) in ["a", "b", "c", "d"].iter().enumerate() {
        let before = files(dir.path());
        cache.store(&[], key, &payload);
        let new = files(dir.path())
            .into_iter()
            .find(|file| !before.contains(file))
            .unwrap();
        let time = old + std::time::Duration::from_secs(age as u64);
        std::fs::File::options()
            .append(true)
            .open(new)
            .unwrap()
            .set_modified(time)
            .unwrap();
    }
    // The oldest entry is used, so the second oldest is removed when a fifth one (with its header)
    // exceeds the limit.
    assert!(cache.load(&[], "a").is_some());
    cache.store(&[], "e", &payload);
    assert!(cache.load(&[], "a").is_some() && cache.load(&[], "e").is_some());
    assert_eq!(cache.load(&[], "b"), None);
    let total: u64 = files(dir.path())
        .iter()
        .map(|file| file.metadata().unwrap().len())
        .sum();
    assert!(total <= LIMIT, "{total}");
    // An entry larger than the limit is not tried, and other files are never removed.
    std::fs::write(dir.path().join("note.txt"), "mine").unwrap();
    cache.store(&[], "huge", &vec![0; LIMIT as usize]);
    assert_eq!(cache.load(&[], "huge"), None);
    DiskCache::open(dir.path(), 1).unwrap();
    assert_eq!(files(dir.path()), [dir.path().join("note.txt")]);
}

#[test]
fn a_folder_that_cannot_be_written_is_one_warning() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("cache");
    let mut cache = open(&folder);
    std::fs::remove_dir(&folder).unwrap();
    cache.store(&[], "a", &[1]);
    cache.store(&[], "b", &[2]);
    let warnings = cache.take_warnings();
    assert!(
        warnings.len() == 1 && warnings[0].contains("keeps nothing more"),
        "{warnings:?}"
    );
    std::fs::write(&folder, "").unwrap();
    assert!(
        DiskCache::open(&folder, LIMIT)
            .unwrap_err()
            .to_string()
            .contains("choose a folder")
    );
}

fn request(brdf: &'static dyn Brdf, method: &str, diffuse: &str) -> RenderRequest {
    let white = Arc::new(Environment::from_image(
        "white",
        RgbImage::filled(4, 2, [1.0; 3]),
    ));
    RenderRequest::plain(white, Scene::sphere(), CameraKind::Ortho, [8, 8]).shaded(|s| {
        s.method = Method::listed(method);
        s.diffuse = Diffuse::listed(diffuse);
        s.brdf = brdf;
    })
}

#[test]
fn a_reference_outlives_a_change_of_every_shader_but_its_own() {
    const VIEW: [&str; 5] = [
        "gbuffer/sphere.vert",
        "gbuffer/sphere.frag",
        "gbuffer/mesh.vert",
        "gbuffer/mesh.frag",
        "precompute/mips.comp",
    ];
    let own = |brdf: &str| {
        [
            format!("shade/reference.comp:specular:{brdf}"),
            format!("shade/reference_resolve.comp:specular:{brdf}"),
        ]
    };
    let diffuse = [
        "shade/reference.comp:lambert",
        "shade/reference_resolve.comp:lambert",
        "precompute/dfg.comp:beckmann",
    ];
    let cases = [
        (request(&Ggx, "reference", "none"), own("ggx").to_vec()),
        (
            request(&Beckmann, "reference", "none"),
            own("beckmann").to_vec(),
        ),
        (
            request(&Beckmann, "reference", "reference"),
            [
                own("beckmann").to_vec(),
                diffuse.map(str::to_owned).to_vec(),
            ]
            .concat(),
        ),
    ];
    for (request, own) in cases {
        let shaders = shaders_of_kept(&request).unwrap();
        let hash = |changed: &str| {
            code_hash(&shaders, |name| {
                if name == changed {
                    b"changed".as_slice()
                } else {
                    shader_code(name)
                }
            })
        };
        for name in shader_names() {
            let is_own = VIEW.contains(&name) || own.iter().any(|shader| shader == name);
            assert_eq!(hash(name) != hash(""), is_own, "{name}");
        }
    }
    assert!(shaders_of_kept(&request(&Ggx, "sampled", "none")).is_none());
}

#[test]
fn memory_holds_the_most_recent_up_to_its_bytes_and_its_count() {
    // The cache keeps at most CACHE_BYTES beside the newest value. The oldest are removed first,
    // and a value that was read again is not the oldest.
    let mut recent = Recent::weighed(4, |bytes: &u64| *bytes);
    let third = CACHE_BYTES / 3;
    let mut keep =
        |key: &'static str, bytes: u64| recent.get_or_make(key, || Ok::<_, ()>(bytes)).unwrap();
    keep("a", third);
    keep("b", third);
    keep("a", 0);
    keep("c", 4 * third);
    keep("d", third);
    let held: Vec<&str> = ["a", "b", "c", "d"]
        .into_iter()
        .filter(|key| recent.get(key).is_some())
        .collect();
    assert_eq!(held, ["d"]);
    let mut recent = Recent::weighed(2, |bytes: &u64| *bytes);
    let mut keep = |key: &'static str| recent.get_or_make(key, || Ok::<_, ()>(third)).unwrap();
    assert_eq!(["a", "b", "a", "c"].map(&mut keep), [third; 4]);
    let held: Vec<&str> = ["a", "b", "c"]
        .into_iter()
        .filter(|key| recent.get(key).is_some())
        .collect();
    assert_eq!(held, ["a", "c"]);
}

/// A processor of other features has other keys, whatever order the system lists them in; one with
/// another clock has the same.
#[test]
fn a_software_device_is_keyed_by_the_processor_it_compiles_for() {
    let cpuinfo = |model: u32, flags: &str, clock: &str| {
        format!(
            "processor\t: 0\nvendor_id\t: GenuineIntel\ncpu family\t: 6\nmodel\t\t: {model}\n\
             model name\t: Xeon\ncpu MHz\t\t: {clock}\nflags\t\t: {flags}\n\nprocessor\t: 1\n"
        )
    };
    let right = processor::described(&cpuinfo(85, "fpu fma avx512f", "2000"));
    assert_eq!(
        right,
        processor::described(&cpuinfo(85, "avx512f fpu fma", "3500"))
    );
    assert_ne!(right, processor::described(&cpuinfo(85, "fpu fma", "2000")));
    assert_ne!(
        right,
        processor::described(&cpuinfo(106, "fpu fma avx512f", "2000"))
    );
    let device = |target: Option<&str>| DeviceInfo {
        name: "llvmpipe (LLVM 15.0.6, 256 bits)".to_owned(),
        device_type: "cpu",
        driver: "llvmpipe Mesa 22.3.6".to_owned(),
        target: target.map(str::to_owned),
        api_version: "1.3.230".to_owned(),
        timestamp_period_ns: 1.0,
        memory_bytes: 0,
        has_exact_filter: true,
        has_seamless_cubes: true,
        is_radv: false,
    };
    let dir = tempfile::tempdir().unwrap();
    let of = |target: Option<&str>| {
        let mut cache = open(dir.path());
        cache.set_device(&device(target));
        cache
    };
    of(Some(&right)).store(&[], "key", &[1]);
    assert_eq!(of(Some(&right)).load(&[], "key"), Some(vec![1]));
    assert_eq!(of(Some("another")).load(&[], "key"), None);
    assert_eq!(of(None).load(&[], "key"), None);
}

#!/bin/sh
# image 0.25.10 (crates.io), the usual image library of Rust: imageops on Rgb32F pictures.
# Guess: Rgb32F exists for HDR (the .hdr and EXR decoders return it), so resize and fast_blur keep
#   the mean of a picture with lamps, as they keep it for any other.
# Seen: resize clips each value to 1 with every filter, nearest included, and fast_blur does too:
#   a sky of .5 with a lamp of 1000 has a mean of 8.31 before and .50 to .54 after. blur (Gaussian)
#   keeps it; thumbnail keeps the lamp but adds .5 to each value (8.81): it rounds as for integers
#   (issue 2273). None reports anything.
# Hurt: tools in Rust that shrink environment maps or build mips: suns and lamps vanish, the sky
#   stays, and the preview, which is clipped anyway, looks the same.
# Avoid: fast_image_resize's F32 types, or sum blocks oneself; test with one texel of 1000.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
cd "$t"
command -v cargo >/dev/null || exit 77
mkdir src
cat >Cargo.toml <<'C'
[package]
name = "probe"
version = "0.0.0"
edition = "2021"
[dependencies]
image = { version = "=0.25.10", default-features = false }
[profile.dev]
debug = false
C
cat >src/main.rs <<'R'
use image::imageops::{blur, fast_blur, resize, thumbnail, FilterType};
use image::{Rgb, Rgb32FImage};

fn mean(picture: &Rgb32FImage) -> f32 {
    picture.pixels().map(|p| p.0[0]).sum::<f32>() / picture.pixels().len() as f32
}

fn main() {
    let mut map = Rgb32FImage::from_pixel(64, 32, Rgb([0.5; 3]));
    for at in 0..16 {
        map.put_pixel(20 + at % 4, 12 + at / 4, Rgb([1000.0; 3]));
    }
    let rows = [
        ("nearest", mean(&resize(&map, 16, 8, FilterType::Nearest))),
        ("triangle", mean(&resize(&map, 16, 8, FilterType::Triangle))),
        ("lanczos3", mean(&resize(&map, 16, 8, FilterType::Lanczos3))),
        ("fast_blur", mean(&fast_blur(&map, 2.0))),
        ("thumbnail", mean(&thumbnail(&map, 16, 8))),
        ("blur", mean(&blur(&map, 2.0))),
    ];
    let true_mean = mean(&map);
    println!("image 0.25.10: mean of the picture {true_mean:.3}");
    for (name, got) in rows {
        println!("{name}: {got:.3} (expected {true_mean:.3})");
    }
    let clipped = rows[..4].iter().all(|(_, got)| *got < 1.0);
    let shifted = (rows[4].1 - true_mean - 0.5).abs() < 0.01;
    if !clipped || !shifted {
        println!("CHANGED: resize no longer clips at 1, or thumbnail no longer adds .5");
        std::process::exit(1);
    }
    println!("still so: floats are clipped at 1 by resize and fast_blur, raised .5 by thumbnail");
}
R
cargo fetch -q || exit 77
cargo run -q -j 1

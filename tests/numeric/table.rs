//! preview
use splitsum::metrics::*;
use splitsum::pixels::*;
use splitsum::table::colormap::*;
use splitsum::table::contact_sheet::*;
use splitsum::table::markdown::significant;
use splitsum::tonemap::ToneCurve;

fn save(image: &Rgb8Image, path: &str) {
    image::save_buffer(path, image.data.as_flattened(), image.width, image.height, image::ColorType::Rgb8).unwrap();
}

#[test]
fn preview() {
    let side = 128;
    let sphere = |x: u32, y: u32| {
        let (x, y) = ((x as f32 + 0.5) / side as f32 * 2.1 - 1.05, 1.05 - (y as f32 + 0.5) / side as f32 * 2.1);
        let r2 = x * x + y * y;
        (r2 < 1.0).then(|| [x, y, (1.0 - r2).max(0.0).sqrt()])
    };
    let mask = GrayImage::from_fn(side, side, |x, y| if sphere(x, y).is_some() { 1.0 } else { 0.0 });
    let alphas = [0.05f32, 0.1, 0.25, 0.5, 1.0];
    let columns = [
        "reference",
        "sampled-unfiltered N = 4",
        "sampled N = 16",
        "sampled N = 40",
        "split-sum",
        "seed0-literal (documented slips)",
    ];
    let mut rows = Vec::new();
    let mut labels = Vec::new();
    for (k, alpha) in alphas.iter().enumerate() {
        let shade = |noise: f32, seed: u32| {
            RgbImage::from_fn(side, side, |x, y| {
                let Some(n) = sphere(x, y) else { return [0.0; 3] };
                let d = (n[0] * 0.4 + n[1] * 0.7 + n[2] * 0.6).max(0.0);
                let spec = d.powf(4.0 / (alpha * alpha)) / (alpha * alpha) * 0.5;
                let h = (x.wrapping_mul(73856093) ^ y.wrapping_mul(19349663) ^ seed.wrapping_mul(83492791))
                    .wrapping_mul(2654435761);
                let u = (h >> 8) as f32 / (1 << 24) as f32;
                let sky = 0.3 + 0.5 * (n[1] * 0.5 + 0.5);
                let f = (1.0 + noise * (u - 0.5)).max(0.0);
                [(sky * 0.7 + spec) * f, (sky * 0.85 + spec) * f, (sky * 1.2 + spec) * f]
            })
        };
        let reference = shade(0.0, 0);
        let mut images = vec![Tile::Image { image: ToneCurve::default().apply_image(&reference), note: String::new() }];
        let mut errors = vec![Tile::Missing(String::new())];
        for (i, noise) in [1.2, 0.4, 0.2, 0.05, 0.9].into_iter().enumerate() {
            let test = shade(noise, i as u32 + 1).map(|p| if i >= 3 { p.map(|v| v * 1.1) } else { p });
            let c = Comparison::new(&test, &reference, &mask, ToneCurve::default()).unwrap();
            if k == 3 && i == 1 {
                images.push(Tile::Missing("failed: device lost after 3 attempts".into()));
                errors.push(Tile::Missing("no image".into()));
                continue;
            }
            let v = c.evaluate(&[metric("relmse_eps1e-2").unwrap()])[0].1;
            images.push(Tile::Image { image: ToneCurve::default().apply_image(&test), note: String::new() });
            let picture = if k == 4 {
                SIGNED_ERROR.image(&c.signed_error_map(), &mask)
            } else {
                RELATIVE_ERROR.image(&c.relative_error_map(), &mask)
            };
            errors.push(Tile::Image { image: picture, note: format!("relMSE {}", significant(v, 3)) });
        }
        errors[0] = Tile::Missing("noise floor 2.1e-6".into());
        rows.push(images);
        labels.push(format!("α = {alpha}\nimage"));
        rows.push(errors);
        labels.push("relative error".to_string());
    }
    let sheet = ContactSheet {
        title: "samples-vs-split-sum: ggx, builtin:sky, 128×128".into(),
        caption: "Error maps show sqrt(mean of d²/(r² + 0.01)) over RGB, the same range in every tile. The reference took 16384 samples a pixel; its own noise floor is relMSE 2.1e-6. Tone curve: exposure 1, contrast 1.".into(),
        column_labels: columns.iter().map(|s| s.to_string()).collect(),
        row_labels: labels,
        rows,
        column_group_starts: vec![1],
        row_group_starts: vec![2, 4, 6, 8],
        scale: 1,
        legends: vec![
            Legend { label: "relative error".into(), scale: RELATIVE_ERROR },
            Legend { label: "signed relative error".into(), scale: SIGNED_ERROR },
        ],
    };
    save(&sheet.render().unwrap(), "/tmp/sheet.png");
    let small = ContactSheet {
        title: "One long title that does not fit over a single narrow column of tiles".into(),
        column_labels: vec!["sampled-unfiltered-with-a-very-long-name".into()],
        row_labels: vec!["r".into()],
        rows: vec![vec![Tile::Image { image: Rgb8Image::filled(32, 32, [90, 20, 60]), note: "0.0123".into() }]],
        scale: 2,
        ..sheet.clone()
    };
    save(&small.render().unwrap(), "/tmp/small.png");
}

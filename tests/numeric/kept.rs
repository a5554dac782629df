//! Files in a few numbers each, so that one snapshot holds a whole folder.

use crate::run::runs::snapshot;
use splitsum::base::csv::Table;
use splitsum::report::page::PAGE_FILE;
use std::path::Path;

/// The text's numbers and words: the count of numbers, a sum over them that moves by the relative
/// change of each, and a hash of the words. Numbers up to 1e-12 are rounding and count as 0. Names
/// of cells, which are hexadecimal, do not count.
fn digest(text: &str) -> String {
    let (mut count, mut sum, mut words) = (0, 0.0, blake3::Hasher::new());
    let tokens = text.split(|c: char| !(c.is_ascii_alphanumeric() || "+-._".contains(c)));
    for token in tokens.filter(|token| !token.is_empty()) {
        if token.len() >= 16 && token.bytes().all(|c| c.is_ascii_hexdigit()) {
            continue;
        }
        if let Ok(x) = token.parse::<f64>() {
            count += 1;
            let size = if x.abs() > 1e-12 {
                x.signum() * (x.abs() / 1e-12).ln()
            } else {
                0.0
            };
            // The golden ratio gives each place another weight.
            sum += size * (1.0 + (0.618_034 * f64::from(count)).fract());
        } else {
            words.update(token.as_bytes()).update(b" ");
        }
    }
    format!("{count} {sum:.2} {}", &words.finalize().to_hex()[..6])
}

/// The digest of each column of the folder's CSV files, of its figures, and of its sentences; the
/// mean of its pictures.
pub fn folder(dir: &Path) -> String {
    let (mut kept, mut pictures, mut light) = (String::new(), 0, 0.0);
    for (name, (bytes, _)) in snapshot(dir) {
        if name.ends_with(".csv") {
            let table = Table::read(&dir.join(&name)).unwrap();
            kept += &format!("{name}\n");
            for (place, column) in table.columns.iter().enumerate() {
                let values: Vec<&str> = table.rows.iter().map(|row| row[place].as_str()).collect();
                kept += &format!("  {column}: {}\n", digest(&values.join(" ")));
            }
        } else if name.ends_with(".svg") || name == "summary.md" || name == PAGE_FILE {
            // Without pictures, the report's menu and data, and its line of device and date.
            let text = String::from_utf8(bytes).unwrap();
            let page = text
                .split_once("<main")
                .map(|(_, page)| page.split("id=\"view-images\"").next().unwrap());
            let lines = page
                .unwrap_or(&text)
                .lines()
                .filter(|line| !line.contains("class=\"fine\""));
            let text = lines.collect::<Vec<_>>().join("\n");
            let parts = text.split("base64,").enumerate();
            let text: String = parts
                .map(|(i, part)| {
                    if i == 0 {
                        part
                    } else {
                        part.split_once('"').unwrap().1
                    }
                })
                .collect();
            kept += &format!("{name} {}\n", digest(&text));
        } else if name.ends_with(".png") {
            let bytes = image::load_from_memory(&bytes)
                .unwrap()
                .into_rgb8()
                .into_raw();
            light += bytes.iter().map(|byte| f64::from(*byte)).sum::<f64>() / bytes.len() as f64;
            pictures += 1;
        }
    }
    kept + &format!("{pictures} pictures, means of {light:.0} in all\n")
}

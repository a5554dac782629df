//! Records of one device must agree; those of several are chosen from.

use super::{Bench, CELLS};
use crate::run::runs::{read, rewrite};

#[test]
fn records_of_one_device_must_agree() {
    let bench = Bench::new(100.0);
    let id = &bench.plan.cells[5].id;
    // Two processes that began at once know nothing of each other; the first is set aside until the second is done.
    let twice = |device| {
        bench.chunk_on("fake", 0);
        let (chunk, aside) = (bench.path("store/chunks/00000"), bench.path("aside"));
        let first = bench.attempts(0)[0].clone();
        std::fs::rename(&first, &aside).unwrap();
        bench.chunk_on(device, 0);
        std::fs::rename(&aside, chunk.join(first.file_name().unwrap())).unwrap();
    };
    twice("fake");
    assert!(bench.merge().unwrap().holes.is_empty());
    let attempts = bench.attempts(0);
    assert_eq!(attempts.len(), 2);
    let path = attempts[1].join(format!("cells/{id}.json"));
    // A time is no score.
    let figure = |name: &str, text: &str| rewrite(&path, |record| record[name] = serde_json::from_str(text).unwrap());
    figure("spent", r#"{ "tables_ms": {}, "display_ms": 1e6, "score_ms": 1e6 }"#);
    bench.merge().unwrap();
    // The same scores of other bytes: the device is not what it was.
    let image = bench
        .names(&attempts[1].join("images"))
        .into_iter()
        .find(|name| name.contains(&bench.plan.cells[5].radiance))
        .unwrap();
    let hash = |hash: &str| rewrite(&path, |record| record["files"][&image] = hash.into());
    let own = splitsum::files::content_hash(&attempts[1].join("images").join(&image)).unwrap();
    hash(&"0".repeat(64));
    let text = bench.merge().unwrap_err().to_string();
    assert!(text.contains(&format!("{id} ")) && text.contains(&format!("differ in files.{image}")), "{text}");
    hash(&own);
    let before = (read(bench.path("merged/errors.csv")), read(&path));
    let facts =
        ["/scores/mae", "/noise_floors/mae", "/bins/9/scores/mae", "/bins/9/pixel_count", "/axes/alpha", "/verdict"];
    for fact in facts {
        let is_count = fact.ends_with("count");
        rewrite(&path, |record| {
            *record.pointer_mut(fact).unwrap() = if is_count { 7.into() } else { "1.25e-1".into() };
        });
        let error = bench.merge().unwrap_err();
        assert!(!error.is_misuse());
        let text = error.to_string();
        assert!(text.contains(&format!("{id} ")) && text.contains(&path.display().to_string()), "{text}");
        let differs = format!("differ in {} (", fact[1..].replace('/', "."));
        assert!(text.contains("merged/cells") && text.contains(&differs), "{text}");
        assert!(text.contains(if is_count { "7)" } else { "1.25e-1" }), "{text}");
        assert!(!text.contains("rmse") && !text.contains("wall_ms"), "{text}");
        assert!(read(bench.path("merged/errors.csv")) == before.0);
        if fact != facts[facts.len() - 1] {
            std::fs::write(&path, &before.1).unwrap();
        }
    }
    // On another device the same difference is none.
    figure("device", r#""other""#);
    bench.merge().unwrap();
}

#[test]
fn the_device_with_most_cells_is_taken_and_a_mix_is_told() {
    let bench = Bench::new(0.3);
    let last = bench.file.chunks.len() - 1;
    let cells = |chunk: usize| bench.file.chunks[chunk].cells.len();
    assert!(last >= 4 && cells(0) > 0 && cells(last) == 0, "the last chunk holds timings only");
    for chunk in 0..=last {
        bench.chunk_on(if chunk == 0 { "rare" } else { "usual" }, chunk);
    }
    let merged = bench.merge().unwrap();
    let usual = CELLS - cells(0);
    let note = format!("the cells come from 2 devices: {} from rare (formula), {usual} from usual (formula)", cells(0));
    assert_eq!(merged.notes, [note]);
    // The usual device does the rare one's cells, too: now it has all of them.
    std::fs::rename(bench.path("store/chunks/00000"), bench.path("aside")).unwrap();
    bench.chunk_on("usual", 0);
    let attempt = std::fs::read_dir(bench.path("aside")).unwrap().next().unwrap().unwrap();
    std::fs::rename(attempt.path(), bench.path("store/chunks/00000").join(attempt.file_name())).unwrap();
    assert!(bench.merge().unwrap().notes.is_empty());
    let record = read(bench.path(&format!("merged/cells/{}.json", bench.file.chunks[0].cells[0])));
    assert!(String::from_utf8(record).unwrap().contains("\"device\": \"usual\""));
}

//! Records and images that were damaged after they were written.

use super::Bench;
use crate::run::runs::{contents, read};
use splitsum::run::chunk::ChunkError;
use std::path::{Path, PathBuf};

/// Each fault is named with its path, and a merge that meets one writes nothing: neither a new folder nor into one that is there.
#[test]
fn what_is_damaged_or_missing_ends_the_merge_before_anything_is_written() {
    let bench = Bench::new(100.0);
    bench.chunk_on("fake", 0);
    let attempt = bench.attempts(0)[0].clone();
    let names = |folder: &str, end: &str| -> Vec<PathBuf> {
        let names = bench.names(&attempt.join(folder));
        names.iter().filter(|name| name.ends_with(end)).map(|name| attempt.join(folder).join(name)).collect()
    };
    let record = attempt.join(format!("cells/{}.json", bench.plan.cells[3].id));
    let refused = |path: &Path, what: &str, damage: &dyn Fn()| {
        let whole = read(path);
        damage();
        let before = contents(&bench.path("merged"));
        let Err(error) = bench.merge() else { panic!("{what}: {} was merged", path.display()) };
        let text = error.to_string();
        assert!(matches!(error, ChunkError::Damaged(_)) && !error.is_misuse(), "{text}");
        assert!(text.contains(&path.display().to_string()) && text.contains(what), "{what}: {text}");
        assert!(contents(&bench.path("merged")) == before, "{what}: something was written");
        std::fs::write(path, whole).unwrap();
    };
    let cut = |path: &Path| std::fs::write(path, &read(path)[..40]).unwrap();
    let changed = |path: &Path| {
        let mut bytes = read(path);
        let last = bytes.len() - 7;
        bytes[last] ^= 1;
        std::fs::write(path, bytes).unwrap();
    };
    for round in ["into nothing", "into what an earlier merge left"] {
        // What an earlier merge left holds whole copies of the images, and of where references stopped.
        let ends: &[&str] = if round == "into nothing" { &[".exr", ".error.png"] } else { &[] };
        for image in ends.iter().map(|end| names("images", end)[0].clone()) {
            let image = &image;
            refused(image, "is missing; it belongs to", &|| std::fs::remove_file(image).unwrap());
            refused(image, "is not the file that its record was made from", &|| changed(image));
            refused(image, "is not the file that its record was made from", &|| cut(image));
        }
        let (timing, reference) = (names("timings", ".json")[0].clone(), names("references", ".json")[0].clone());
        let records = if round == "into nothing" { vec![&record, &timing, &reference] } else { vec![&record, &timing] };
        for path in records {
            refused(path, "its checksum does not hold", &|| {
                // A figure that somebody corrected.
                let text = String::from_utf8(read(path.clone())).unwrap();
                let place = text.find(|c: char| c.is_ascii_digit()).unwrap();
                let digit = if &text[place..=place] == "1" { "2" } else { "1" };
                std::fs::write(path, format!("{}{digit}{}", &text[..place], &text[place + 1..])).unwrap();
            });
            refused(path, "expected a file that this program wrote", &|| cut(path));
        }
        if round == "into nothing" {
            assert!(!bench.path("merged").exists());
        }
        assert!(bench.merge().unwrap().holes.is_empty(), "{round}");
        assert!(read(bench.path("merged/errors.csv")) == read(bench.whole().join("errors.csv")), "{round}");
    }
    // The chunk makes anew what is damaged, and the merge then wants only that the damaged record be gone.
    cut(&record);
    bench.chunk_on("fake", 0);
    let again = bench.attempts(0)[1].join("cells");
    assert_eq!(bench.names(&again).len(), 1);
    std::fs::remove_file(&record).unwrap();
    assert!(bench.merge().unwrap().holes.is_empty());
}

/// An image that a merge left and that was damaged since comes back from the chunks.
#[test]
fn a_damaged_image_of_a_merged_run_is_brought_again() {
    let bench = Bench::new(100.0);
    bench.chunk_on("fake", 0);
    bench.merge().unwrap();
    let name = bench.names(&bench.path("merged/images")).into_iter().find(|name| name.ends_with(".exr")).unwrap();
    let image = bench.path("merged/images").join(name);
    let whole = read(image.clone());
    // Removed first: the file is a link to that of the attempt.
    std::fs::remove_file(&image).unwrap();
    std::fs::write(&image, b"damaged").unwrap();
    assert!(bench.merge().unwrap().holes.is_empty());
    assert!(read(image) == whole);
}

/// A record of a cell that the plan does not have is left out and told; one under another cell's name is damage.
#[test]
fn records_of_other_cells_are_no_part_of_a_merge() {
    let bench = Bench::new(100.0);
    bench.chunk_on("fake", 0);
    let cells = bench.attempts(0)[0].join("cells");
    let path = |id: &str| cells.join(format!("{id}.json"));
    let [first, second] = [0, 1].map(|cell| path(&bench.plan.cells[cell].id));
    std::fs::copy(&first, path("0123456789abcdef")).unwrap();
    let merged = bench.merge().unwrap();
    assert!(merged.holes.is_empty());
    assert!(merged.notes.len() == 1 && merged.notes[0].contains("does not have, left out: 1, the first "));
    assert!(read(bench.path("merged/errors.csv")) == read(bench.whole().join("errors.csv")));

    std::fs::copy(&first, &second).unwrap();
    let Err(ChunkError::Damaged(damage)) = bench.merge() else { panic!("it was merged") };
    assert!(damage.len() == 1 && damage[0].contains("under another name"), "{damage:?}");
}

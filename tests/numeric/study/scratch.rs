use splitsum::study::figure::svg::svg;
use splitsum::study::finished::Finished;
use splitsum::study::questions::answers;
use std::path::Path;

#[test]
fn scratch_print() {
    for name in [
        "tables",
        "diffuse",
        "level-bias",
        "exposure-and-contrast",
        "dynamic-range",
        "energy",
        "timing",
        "quick",
        "printed-slips",
        "break-even",
        "source-document-0",
    ] {
        let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("results").join(name);
        let run = Finished::read(&dir).unwrap();
        println!("\n########## {name} config {}", run.config.is_some());
        let t = std::time::Instant::now();
        for answer in answers(&run, &[], None) {
            println!("\n=== {}", answer.question.name);
            for sentence in answer.finding.sentence.split(". ") {
                println!("  ({}) {sentence}", sentence.split_whitespace().count());
            }
            println!("{}", answer.finding.digest.as_ref().unwrap_or(&answer.finding.table).markdown());
            println!("rows {} {:?}", answer.finding.table.rows.len(), t.elapsed());
            println!("{}", answer.finding.table.csv().lines().take(3).collect::<Vec<_>>().join("\n"));
            if let Some(figure) = &answer.finding.figure {
                std::fs::create_dir_all("/tmp/figs_f").unwrap();
                std::fs::write(format!("/tmp/figs_f/{name}-{}.svg", answer.question.name), svg(figure, 760)).unwrap();
            }
        }
    }
}

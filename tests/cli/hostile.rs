//! Hostile names, files and folders. No test needs a device.

use super::{ok, published, splitsum, stderr, stdout};
use std::path::Path;

fn change_provenance(dir: &Path, change: impl FnOnce(&mut serde_json::Value)) {
    let path = dir.join("provenance.json");
    let mut value: serde_json::Value =
        serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    change(&mut value);
    std::fs::write(path, value.to_string()).unwrap();
}

#[test]
fn hostile_names_reach_neither_markdown_nor_terminal() {
    let root = tempfile::tempdir().unwrap();
    let dir = published(root.path(), "a\u{1b}[31m\u{202e}b");
    change_provenance(&dir, |value| {
        value["question"] = "# head\n<script>alert(1)</script> [x](javascript:y)".into();
        value["sessions"][0]["device"]["name"] = "gpu\u{1b}[31m<img onerror=x>".into();
    });
    let name = dir.file_name().unwrap().to_str().unwrap();
    let output = ok(root.path(), &["answers", name]);
    let summary = std::fs::read_to_string(dir.join("summary.md")).unwrap();
    assert!(
        summary.contains("\n\\# head \\<script>alert(1)\\</script> [x\\](javascript:y)\n"),
        "{summary}"
    );
    assert!(
        summary.contains("\\<img onerror") && !summary.contains(" <img"),
        "{summary}"
    );
    let shown = output + &summary;
    assert!(
        !shown.contains(['\u{1b}', '\u{202e}']) && shown.contains("\\u{1b}[31m\\u{202e}"),
        "{shown}"
    );
}

#[test]
fn a_folder_where_a_file_belongs_is_bad_input() {
    let root = tempfile::tempdir().unwrap();
    std::fs::write(
        root.path().join("x.toml"),
        "name = \"x\"\n[axes]\nalpha = [0.5]\n",
    )
    .unwrap();
    let plan = |flags: &[&str]| {
        splitsum(
            root.path(),
            &[&["plan", "x.toml", "--no-cache"], flags].concat(),
        )
    };
    let cells: serde_json::Value = serde_json::from_str(&stdout(&plan(&["--json"]))).unwrap();
    let id = cells["cells"][0]["id"].as_str().unwrap().to_owned();
    std::fs::create_dir_all(root.path().join(format!("runs/x/cells/{id}.json"))).unwrap();
    let output = plan(&[]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(
        stderr(&output).contains(&format!("cells/{id}.json")),
        "{}",
        stderr(&output)
    );
}

#[cfg(target_os = "linux")]
#[test]
fn nothing_is_published_if_the_folder_cannot_be_created() {
    let root = tempfile::tempdir().unwrap();
    published(root.path(), "run");
    let output = splitsum(
        root.path(),
        &["answers", "run", "--publish", "/proc/splitsum"],
    );
    assert!(
        output.status.code() == Some(2) && stderr(&output).contains("/proc/splitsum"),
        "{}",
        stderr(&output)
    );
}

#[cfg(unix)]
#[test]
fn an_output_is_written_through_a_link_and_never_over_a_device() {
    let root = tempfile::tempdir().unwrap();
    published(root.path(), "run");
    ok(root.path(), &["report", "run", "--out", "real.html"]);
    let old = std::fs::read_to_string(root.path().join("real.html")).unwrap();
    std::fs::write(root.path().join("real.html"), old.replace("<html", "<HTML")).unwrap();
    std::os::unix::fs::symlink("real.html", root.path().join("link.html")).unwrap();
    ok(root.path(), &["report", "run", "--out", "link.html"]);
    assert!(root.path().join("link.html").is_symlink());
    assert!(
        std::fs::read_to_string(root.path().join("real.html"))
            .unwrap()
            .contains("<html")
    );

    let sockets = ["socket.html", "socket.csv"].map(|name| root.path().join(name));
    let _listeners = sockets
        .each_ref()
        .map(|socket| std::os::unix::net::UnixListener::bind(socket).unwrap());
    std::fs::write(
        root.path().join("q.csv"),
        "brdf,alpha,n_dot_v\nggx,0.5,0.5\n",
    )
    .unwrap();
    let report: &[&str] = &["report", "run", "--out", "socket.html"];
    let integrate: &[&str] = &["integrate", "q.csv", "--kind", "dfg", "--out", "socket.csv"];
    for (arguments, socket) in [report, integrate].into_iter().zip(&sockets) {
        let refused = splitsum(root.path(), arguments);
        assert!(
            stderr(&refused).contains("is a device or a pipe; expected a regular file"),
            "{}",
            stderr(&refused)
        );
        assert!(refused.status.code() == Some(2) && !std::fs::metadata(socket).unwrap().is_file());
    }
}

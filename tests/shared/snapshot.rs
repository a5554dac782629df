//! Texts compared with files in `tests/snapshots`.

/// Compares `text` with `tests/snapshots/NAME.snap`. `INSTA_UPDATE=always` writes the file.
pub fn assert_snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::new();
    settings.set_snapshot_path(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/snapshots"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

/// A message without the names of a long list, which grows: `expected a, b, c, d` is `expected
/// ...`.
pub fn without_lists(message: &str) -> String {
    for word in ["expected ", "known: "] {
        if let Some((start, list)) = message.rsplit_once(word)
            && list.matches(", ").count() >= 3
        {
            return format!("{start}{word}...");
        }
    }
    message.to_owned()
}

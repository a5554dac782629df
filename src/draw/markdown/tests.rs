use super::{Align, MarkdownTable, inline, link, paragraph};

#[test]
fn hostile_names_stay_text_in_markdown() {
    for (text, expected) in [
        (
            "sky < 4 and [0, 1] (of `ggx`)",
            "sky < 4 and [0, 1] (of `ggx`)",
        ),
        ("<script>x</script>", "\\<script>x\\</script>"),
        ("\\<img onerror=x>", "\\\\\\<img onerror=x>"),
        // Markdown written by the program itself.
        ("reference 64 \\*", "reference 64 \\*"),
        ("[a](javascript:x)", "[a\\](javascript:x)"),
        ("a\n# b\u{1b}[31m\u{202e}c", "a # b\\u{1b}[31m\\u{202e}c"),
    ] {
        assert_eq!(inline(text), expected);
    }
    for (text, expected) in [
        ("# head", "\\# head"),
        ("  - item", "\\- item"),
        ("12. item", "12\\. item"),
        ("`a` b", "`a` b"),
        ("**a** b", "**a** b"),
        ("```a", "\\```a"),
    ] {
        assert_eq!(paragraph(text), expected);
    }
    assert_eq!(
        link("a]<b>[\n", "tables/a (b)\n[c.png"),
        "[a\\]\\<b>\\[\\\\n](tables/a%20%28b%29%0A%5Bc.png)"
    );
    let mut table = MarkdownTable::new(&[("name", Align::Left)]);
    table.row(&["<b>[x](y)|z"]);
    assert!(
        table.to_string().contains("| \\<b>[x\\](y)\\|z |"),
        "{table}"
    );
}

use super::short_names;

#[test]
fn names_of_environments_are_short_and_distinct() {
    let names = |files: &[&str]| -> Vec<String> {
        let short = short_names(files.iter().copied());
        files.iter().map(|file| short[*file].clone()).collect()
    };
    assert_eq!(
        names(&["maps/a.hdr", "/x/b.c.exr", "builtin:sky"]),
        ["a", "b.c", "builtin:sky"]
    );
    assert_eq!(
        names(&["one/a.hdr", "two/a.hdr", "b.hdr"]),
        ["one/a.hdr", "two/a.hdr", "b"]
    );
    assert_eq!(
        names(&["a.hdr", "a.exr", "a.exr#sun"]),
        ["a.hdr", "a.exr", "a#sun"]
    );
    assert_eq!(
        names(&["/maps/x/a.hdr", "a", "b"]),
        ["/maps/x/a.hdr", "a", "b"]
    );
}

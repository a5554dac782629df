use super::Variant;

fn sampled(count: u32) -> Variant {
    Variant {
        samples: Some(count),
        ..Variant::new("sampled")
    }
}

#[test]
fn a_variant_has_a_name_for_files_and_a_title_for_readers() {
    assert_eq!(sampled(16).to_string(), "sampled 16");
    assert_eq!(sampled(16).title(), "Sampling, 16 samples");
    assert_eq!(sampled(1).label(), "Sampling, 1 sample");
    let split_sum = Variant::new("split-sum");
    assert_eq!(split_sum.to_string(), "split-sum");
    assert_eq!(split_sum.label(), "Split sum (textbook)");
}

#[test]
fn labels_keep_names_that_are_words() {
    let reference = Variant {
        samples: Some(64),
        ..Variant::new("reference")
    };
    assert_eq!(reference.label(), "reference 64");
    assert_eq!(Variant::new("none").label(), "none");
    assert_eq!(Variant::new("sampled").label(), "sampled");
    assert_eq!(Variant::new("sampled").title(), "Sampling");
    // A diffuse method has no title.
    assert_eq!(Variant::new("lambert-sh9").title(), "lambert-sh9");
}

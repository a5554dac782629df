use super::{
    Coverage, Extent, Interval, Number, Phrase, Quantity, Statement, Unit, Variant, markdown,
    plain_markdown, spans,
};

#[test]
fn numbers_are_written_in_their_forms() {
    for (number, text) in [
        (Number::rounded(0.01234), "0.012"),
        (Number::share(0.25), "25 %"),
        (Number::share(0.00123), "0.12 %"),
        (Number::Count(1234), "1234"),
        (Number::AtMost(4), "at most 4"),
        (Number::MoreThan(256), "more than 256"),
    ] {
        assert_eq!(number.to_string(), text);
    }
}

#[test]
fn an_extent_is_one_number_if_both_ends_read_alike() {
    assert_eq!(
        Extent::from_values([17.0, 8.1, 12.0]).to_string(),
        "8.1 to 17"
    );
    assert_eq!(Extent::from_values([8.11, 8.12]).to_string(), "8.1");
    let interval = |coverage, ends: [f64; 2]| {
        let extent = Extent::from_values(ends);
        Interval { extent, coverage }.to_string()
    };
    assert_eq!(
        interval(Coverage::Confidence, [8.1, 17.0]),
        " (95 % 8.1 to 17)"
    );
    assert_eq!(
        interval(Coverage::All("environments"), [1.0, 2.0]),
        " (environments 1.0 to 2.0)"
    );
    assert_eq!(interval(Coverage::Confidence, [8.11, 8.12]), "");
}

#[test]
fn a_quantity_has_its_unit_before_its_interval() {
    let interval = Interval {
        extent: Extent::from_values([8.1, 17.0]),
        coverage: Coverage::Confidence,
    };
    let quantity = Quantity::rounded(12.0).unit(" ms").interval(Some(interval));
    assert_eq!(quantity.to_string(), "12 ms (95 % 8.1 to 17)");
    // Only the number and its unit are emphasised.
    let sentence = statement!["It takes ", quantity.strong(), "."];
    assert_eq!(
        markdown([&sentence]),
        "It takes **12 ms** (95 % 8.1 to 17)."
    );
    assert_eq!(
        plain_markdown([&sentence]),
        "It takes 12 ms (95 % 8.1 to 17)."
    );
}

#[test]
fn a_unit_is_singular_after_one() {
    let samples = |number| Quantity::new(number).unit(Unit::SAMPLES).to_string();
    for (number, text) in [
        (Number::Count(1), "1 sample"),
        (Number::Count(2), "2 samples"),
        (Number::Count(0), "0 samples"),
        (Number::AtMost(1), "at most 1 sample"),
        (Number::MoreThan(1), "more than 1 sample"),
        (Number::rounded(1.0), "1.0 samples"),
    ] {
        assert_eq!(samples(number), text);
    }
    let from_one = Extent {
        least: Number::Count(1),
        most: Number::Count(4),
    };
    let quantity = Quantity::new(from_one).unit(Unit::SAMPLES_PER_PIXEL);
    assert_eq!(quantity.to_string(), "1 to 4 samples per pixel");
    // Other units are the same after every number.
    let quantity = Quantity::new(Number::Count(1)).unit(" ms");
    assert_eq!(quantity.to_string(), "1 ms");
}

#[test]
fn lists_of_more_than_four_end_with_others() {
    let listed = |count: usize| {
        let items = ["a", "b", "c", "d", "e"][..count].iter();
        markdown([&Statement::listed(
            items.map(|item| (*item).into()).collect(),
        )])
    };
    assert_eq!(
        [0, 1, 2, 3, 4, 5].map(listed),
        [
            "",
            "a",
            "a and b",
            "a, b and c",
            "a, b, c and d",
            "a, b, c and others"
        ]
    );
    let joined = Statement::joined(["a".into(), "b".into()], "; ");
    assert_eq!(markdown([&joined]), "a; b");
}

#[test]
fn methods_are_code_in_markdown_and_titles_on_the_page() {
    let method = Phrase::Method(Variant {
        samples: Some(16),
        ..Variant::new("sampled")
    });
    let sentence = statement![method.clone(), " beats ", Phrase::Metric("relmse"), "."];
    assert_eq!(markdown([&sentence]), "`sampled 16` beats `relmse`.");
    let text =
        |spans: Vec<super::Span>| spans.into_iter().map(|span| span.text).collect::<String>();
    assert_eq!(
        text(spans([&sentence])),
        "Sampling, 16 samples beats relmse."
    );
    // Within a sentence a title is a common noun.
    assert_eq!(
        text(spans([&statement!["First ", method]])),
        "First sampling, 16 samples"
    );
    assert_eq!(
        markdown([&Statement::from("One.").strong(), &"Two.".into()]),
        "**One.** Two."
    );
}

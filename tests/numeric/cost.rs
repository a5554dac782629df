//! The counter of instructions on made texts, and the bounds on made counts.

use splitsum::cost::family::{FAMILIES, STREAMED_BYTES, Texel};
use splitsum::cost::isa::{Counts, ShaderCounts, count};
use splitsum::cost::model::Pass;
use splitsum::glsl::constants::POINTS_PER_DISPATCH;

/// Instructions of every class, before, within and after a loop with a branch inside; the loop's exit lies in its middle.
const MADE: &str = "\
BB0:
\ts_mov_b32 s0, s3                                            ; be800303
\tv_mul_f32_e32 v1, v2, v3 ; 100e150a
\t(then repeated 2 times)
\timage_load v[4:7], v[2:3], s[24:31] dmask:0xf unorm
\tv_rcp_f32_e32 v1, v1
BB1:
\ts_cmp_ge_u32 s1, s0
\ts_cbranch_scc1 BB5
BB2:
\tv_fma_f32 v1, v2, v3, v4
\tv_dual_mul_f32 v0, v1, v2 :: v_dual_add_f32 v3, v4, v5
\ts_and_saveexec_b64 s[4:5], vcc
\ts_cbranch_execz BB4
BB3:
\tv_sqrt_f32_e32 v1, v1
\timage_sample_lz v[1:3], v[4:5], s[0:7], s[8:11] dmask:0x7
\timage_sample_l v[1:3], v[4:5], s[0:7], s[8:11] dmask:0x7
BB4:
\ts_waitcnt vmcnt(0)
\tv_mul_lo_u32 v0, v3, s12
\ts_branch BB1
BB5:
\tbuffer_load_dwordx4 v[4:7], v0, s[0:3], 0 offen
\tbuffer_store_b64 v[4:5], v0, s[0:3], 0 offen
\ts_endpgm
";

fn made() -> ShaderCounts {
    ShaderCounts {
        outside: Counts {
            alu: 3.0,
            quarter: 1.0,
            scalar: 1.0,
            unfiltered: 1.0,
            memory_bytes: 24.0,
            ..Counts::default()
        },
        inside: Counts { alu: 2.0, quarter: 2.0, scalar: 5.0, bilinear: 1.0, trilinear: 1.0, ..Counts::default() },
        other_loops: 0,
    }
}

#[test]
fn instructions_are_counted_by_class_inside_and_outside_the_loop() {
    assert_eq!(count(MADE), Ok(made()));
}

#[test]
fn the_loop_over_samples_is_the_outermost_that_looks_up() {
    let nested = "BB0:\n v_mov_b32 v0, 0\nBB1:\n v_mov_b32 v0, 0\nBB2:\n image_sample v0, v1\n s_cbranch_scc0 BB2\nBB3:\n \
                  s_cbranch_scc0 BB1\nBB4:\n s_add_u32 s0, s0, 1\n s_cbranch_scc0 BB4\nBB5:\n s_endpgm\n";
    let counts = count(nested).unwrap();
    assert_eq!((counts.outside.alu, counts.inside.alu, counts.inside.trilinear), (1.0, 1.0, 1.0));
    // The inner loop and the one after it.
    assert_eq!((counts.other_loops, counts.outside.scalar), (2, 2.0));
    // Texels without a filter, as of maps that a shader filters itself, make it the loop over samples, too.
    let loads =
        count("BB0:\n s_mov_b32 s0, 0\nBB1:\n image_load v0, v1\n s_cbranch_scc0 BB1\nBB2:\n s_endpgm\n").unwrap();
    assert_eq!((loads.inside.unfiltered, loads.outside.unfiltered, loads.other_loops), (1.0, 0.0, 0));
    // Without a loop all is outside; an if is none.
    let straight = count("BB0:\n s_cbranch_execz BB2\nBB1:\n image_sample v0, v1\nBB2:\n s_endpgm\n").unwrap();
    assert_eq!((straight.outside.trilinear, straight.inside), (1.0, Counts::default()));
}

#[test]
fn what_is_no_instruction_is_a_fault_with_its_line() {
    for (text, line) in
        [("BB0:\n hello world\n", 2), ("BB0:\n\n s_branch BB9\n", 3), ("BB0:\n (then repeated 2 times)\n", 2)]
    {
        assert_eq!(count(text).unwrap_err().line, line, "{text}");
    }
}

#[test]
fn the_bound_is_the_busiest_unit_and_their_sum() {
    let pass = Pass { counts: made(), wave: 64, vector_registers: 24, waves: 16 };
    let family = |name: &str| FAMILIES.iter().find(|family| family.name == name).unwrap();
    // By hand, N = 10. GCN: ALU 3 + 20 of 64 lanes and 1 + 20 of 16; texture (1 + 10 (1 + 2) 2)/4; cache 24/64; scalar 51/64.
    let (alu, scalar, texture, cache) = (23.0 / 64.0 + 21.0 / 16.0, 51.0 / 64.0, 61.0 / 4.0, 24.0 / 64.0);
    let bound = pass.cycles(family("vega10"), Texel::Rgba16f, 10);
    assert_eq!(bound.least, texture);
    assert!((bound.most - (alu + scalar + texture + cache)).abs() < 1e-12);
    assert_eq!(pass.busiest(family("vega10"), Texel::Rgba16f, 10), "texture");
    // Wider texels cost twice the filter, and on RDNA between two and four times.
    let bound = pass.cycles(family("navi21"), Texel::Rgba32f, 10);
    assert_eq!(bound.least, 61.0 / 4.0);
    assert!((bound.most - (23.0 / 64.0 + 21.0 / 16.0 + 51.0 / 128.0 + 121.0 / 4.0 + 24.0 / 128.0)).abs() < 1e-12);
    // Quarter-rate work keeps GCN's ALU busy, runs beside RDNA's, and RDNA 3 may pair the rest.
    let counts = Counts { alu: 64.0, quarter: 8.0, ..Counts::default() };
    for (name, least) in [("vega10", 1.5), ("navi21", 1.0), ("gfx1100", 0.5)] {
        let bound = pass.cycles_of(&counts, family(name), Texel::Rgba16f);
        assert_eq!((bound.least, bound.most), (least, 1.5), "{name}");
    }
    // One sample on 8 compute units at 1600 MHz: the texture unit's (1 + 3) / 4 clocks a pixel.
    let deck = family("vangogh");
    let time = pass.cycles(deck, Texel::Rgba16f, 1).milliseconds(&deck.card);
    assert!((time.least - 2_073_600.0 / (8.0 * 1.6e6)).abs() < 1e-12, "{time:?}");
}

/// By hand: 1920x1080 pixels of 80 bytes are 165.888 MB.
#[test]
fn memory_takes_its_bytes_over_its_bandwidth() {
    let outside = Counts { dram_bytes: STREAMED_BYTES, ..Counts::default() };
    let counts = ShaderCounts { outside, ..ShaderCounts::default() };
    let pass = Pass { counts, wave: 64, vector_registers: 24, waves: 16 };
    // MB that a cache of 128 or 96 MiB cannot hold, all of them, and GB/s.
    let hand = [
        ("vega10", 165.888, 483.8),
        ("vangogh", 165.888, 88.0),
        ("navi21", 165.888 - 134.217_728, 512.0),
        ("gfx1100", 165.888 - 100.663_296, 960.0),
    ];
    for (name, least, bandwidth) in hand {
        let family = FAMILIES.iter().find(|family| family.name == name).unwrap();
        let bound = pass.cycles(family, Texel::Rgba16f, 1);
        assert_eq!(pass.busiest(family, Texel::Rgba16f, 1), "memory");
        let time = bound.milliseconds(&family.card);
        let off = [time.least - least / bandwidth, time.most - 165.888 / bandwidth].map(f64::abs);
        assert!(off[0] < 1e-12 && off[1] < 1e-12, "{name}: {time:?}");
        // A second dispatch streams the pixels again; a sample more does not, and a pass without a loop has one dispatch.
        let inside = Counts { alu: 1e-12, ..Counts::default() };
        let looped = Pass { counts: ShaderCounts { inside, ..pass.counts }, ..pass.clone() };
        let at = |pass: &Pass, n: u32| pass.cycles(family, Texel::Rgba16f, n).milliseconds(&family.card).most;
        let [one, same, two] = [1, POINTS_PER_DISPATCH, POINTS_PER_DISPATCH + 1].map(|n| at(&looped, n));
        assert!((same / one - 1.0).abs() < 1e-9 && (two / one - 2.0).abs() < 1e-9, "{name}");
        assert_eq!(at(&pass, 1), at(&pass, POINTS_PER_DISPATCH + 1), "{name}");
        // At one clock, memory alone costs the same at both ends, but for what the cache holds.
        let one_clock = pass.cycles(&family.at_boost(), Texel::Rgba16f, 1);
        assert!((one_clock.least / one_clock.most - least / 165.888).abs() < 1e-12, "{name}");
    }
}

#[test]
fn twice_the_samples_are_twice_the_loop() {
    let pass = Pass { counts: made(), wave: 64, vector_registers: 24, waves: 16 };
    for family in FAMILIES {
        for n in (1..=POINTS_PER_DISPATCH / 2).filter(|n| n.is_power_of_two()) {
            for end in [0, 1] {
                let clocks = |counts: &Counts| family.clocks(counts, Texel::Rgba16f, 64, end);
                let fixed = clocks(&pass.counts.outside);
                let [once, twice] = [n, 2 * n].map(|n| clocks(&pass.executed(n)));
                for ((fixed, once), twice) in fixed.iter().zip(once).zip(twice) {
                    assert!(((twice - fixed) - 2.0 * (once - fixed)).abs() <= 1e-12 * twice, "{} {n}", family.name);
                }
            }
        }
        // A second dispatch sets every pixel up again.
        let [one, two] = [1, 2].map(|dispatches| pass.executed(dispatches * POINTS_PER_DISPATCH));
        assert_eq!(two, one.times(2.0));
        let bound = pass.cycles(family, Texel::Rgba32f, 64);
        assert!(bound.least < bound.most && bound.least > 0.0);
    }
}

#[test]
fn samples_at_equal_cost_are_where_the_ends_meet() {
    let pass = Pass { counts: made(), wave: 64, vector_registers: 24, waves: 16 };
    let family = FAMILIES.iter().find(|family| family.name == "vega10").unwrap();
    let of = |n| pass.cycles(family, Texel::Rgba16f, n);
    for n in [1, 7, 300] {
        let [least, most] = pass.afforded(family, Texel::Rgba16f, of(n));
        assert!(of(least).most <= of(n).least && of(n).least < of(least + 1).most, "{n}: {least}");
        assert!(of(most).least <= of(n).most && of(n).most < of(most + 1).least, "{n}: {most}");
        assert!(least < n && n <= most);
    }
}

//! The counter of instructions on synthetic assembly.

use splitsum::cost::isa::{Counts, ShaderCounts, count};

/// Instructions of every class, before, within and after a loop with a branch inside; the loop's
/// exit lies in its middle.
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

#[test]
fn instructions_are_counted_by_class_inside_and_outside_the_loop() {
    let counts = ShaderCounts {
        outside: Counts {
            alu: 3.0,
            quarter: 1.0,
            scalar: 1.0,
            unfiltered: 1.0,
            memory_bytes: 24.0,
            ..Counts::default()
        },
        inside: Counts {
            alu: 2.0,
            quarter: 2.0,
            scalar: 5.0,
            bilinear: 1.0,
            trilinear: 1.0,
            ..Counts::default()
        },
        other_loops: 0,
    };
    assert_eq!(count(MADE), Ok(counts));
}

#[test]
fn the_loop_over_samples_is_the_outermost_that_looks_up() {
    let nested = "BB0:\n v_mov_b32 v0, 0\nBB1:\n v_mov_b32 v0, 0\nBB2:\n image_sample v0, v1\n \
                  s_cbranch_scc0 BB2\nBB3:\n \
                  s_cbranch_scc0 BB1\nBB4:\n s_add_u32 s0, s0, 1\n s_cbranch_scc0 BB4\nBB5:\n \
                  s_endpgm\n";
    let counts = count(nested).unwrap();
    assert_eq!(
        (
            counts.outside.alu,
            counts.inside.alu,
            counts.inside.trilinear
        ),
        (1.0, 1.0, 1.0)
    );
    // The inner loop and the one after it.
    assert_eq!((counts.other_loops, counts.outside.scalar), (2, 2.0));
    // Unfiltered texels also make it the loop over samples, as for maps that a shader filters
    // itself.
    let loads = count(
        "BB0:\n s_mov_b32 s0, 0\nBB1:\n image_load v0, v1\n s_cbranch_scc0 BB1\nBB2:\n s_endpgm\n",
    )
    .unwrap();
    assert_eq!(
        (
            loads.inside.unfiltered,
            loads.outside.unfiltered,
            loads.other_loops
        ),
        (1.0, 0.0, 0)
    );
    // Without a loop everything is outside; an `if` is not a loop.
    let straight =
        count("BB0:\n s_cbranch_execz BB2\nBB1:\n image_sample v0, v1\nBB2:\n s_endpgm\n").unwrap();
    assert_eq!(
        (straight.outside.trilinear, straight.inside),
        (1.0, Counts::default())
    );
}

#[test]
fn an_unknown_instruction_is_a_fault_with_its_line() {
    for (text, line) in [
        ("BB0:\n hello world\n", 2),
        ("BB0:\n\n s_branch BB9\n", 3),
        ("BB0:\n (then repeated 2 times)\n", 2),
    ] {
        assert_eq!(count(text).unwrap_err().line, line, "{text}");
    }
}

//! Half floats against the crate `half`, which shares no code with them.

use crate::chi_square::Random;
use half::f16;
use splitsum::pixels::half::{from_bits, to_bits};

#[test]
fn every_half_is_its_value() {
    for bits in 0..=u16::MAX {
        let (found, expected) = (from_bits(bits), f16::from_bits(bits).to_f32());
        assert!(found == expected || found.is_nan() && expected.is_nan(), "{bits:#06x}: {found} is not {expected}");
        if !expected.is_nan() {
            assert_eq!(to_bits(found), bits);
        }
    }
}

#[test]
fn numbers_round_to_the_nearest_half() {
    // Halfway between neighbours and one step beside it, and any f32.
    let halfway = (0..0x7c00).map(|bits| 0.5 * (from_bits(bits) + f16::from_bits(bits + 1).to_f32().min(65536.0)));
    let beside = halfway.flat_map(|x| [x.next_down(), x, x.next_up()]);
    let mut random = Random(7);
    let any = (0..1_000_000).map(|_| f32::from_bits(random.word() as u32));
    for value in beside.chain(any).chain([f32::INFINITY, f32::MIN_POSITIVE, 0.0]).flat_map(|x| [x, -x]) {
        let expected = f16::from_f32(value);
        let found = to_bits(value);
        assert!(
            found == expected.to_bits() || expected.is_nan() && from_bits(found).is_nan(),
            "{value:e}: {found:#06x}"
        );
    }
}

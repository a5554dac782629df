//! The scanlines of a Radiance picture: flat texels, or one of two run-length forms.

use super::super::file::Fault;
use super::{Input, Layout};

/// Scanline lengths with the newer run-length form.
const NEW_RLE_LENGTHS: std::ops::RangeInclusive<usize> = 8..=0x7fff;

/// Why a scanline cannot be read.
pub(super) enum ScanlineFault {
    /// The file ends in it.
    Ends,
    Damaged(String),
}

impl Input<'_> {
    /// Takes the next bytes of a scanline.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], ScanlineFault> {
        let (&head, rest) = self.rest.split_first_chunk().ok_or(ScanlineFault::Ends)?;
        self.rest = rest;
        Ok(head)
    }
}

/// Reports the fault of the scanline with that number, from 0.
pub(super) fn scanline_fault(fault: ScanlineFault, number: usize, layout: &Layout) -> Fault {
    let count = layout.scanline_count();
    let what = match fault {
        ScanlineFault::Ends => format!("the file ends within scanline {number} of {count}"),
        ScanlineFault::Damaged(what) => format!("scanline {number} of {count}: {what}"),
    };
    let length = layout.scanline_length();
    Fault::new(
        what,
        format!("{count} scanlines of {length} texels, flat or run-length coded"),
    )
}

pub(super) fn read_scanline(
    input: &mut Input,
    scanline: &mut [[u8; 4]],
) -> Result<(), ScanlineFault> {
    match input.rest {
        // In the old form (2, 2) has a blue mantissa of at least 128: one of three mantissas is.
        [2, 2, high, low, ..] if *high < 128 && NEW_RLE_LENGTHS.contains(&scanline.len()) => {
            let length = usize::from(u16::from_be_bytes([*high, *low]));
            if length != scanline.len() {
                return Err(ScanlineFault::Damaged(format!(
                    "it claims {length} texels, not {}",
                    scanline.len()
                )));
            }
            input.rest = &input.rest[4..];
            (0..4).try_for_each(|channel| read_channel(input, scanline, channel))
        }
        _ => read_flat(input, scanline),
    }
}

/// Reads one channel of the newer form: counts above 128 repeat a byte `count - 128` times, others
/// copy bytes.
fn read_channel(
    input: &mut Input,
    scanline: &mut [[u8; 4]],
    channel: usize,
) -> Result<(), ScanlineFault> {
    let mut x = 0;
    while x < scanline.len() {
        let [count] = input.take()?;
        let is_run = count > 128;
        let length = usize::from(if is_run { count - 128 } else { count });
        if length == 0 {
            return Err(ScanlineFault::Damaged(format!(
                "a run of length 0 at texel {x}"
            )));
        }
        if length > scanline.len() - x {
            return Err(ScanlineFault::Damaged(format!(
                "a run of length {length} at texel {x} passes the end"
            )));
        }
        let texels = &mut scanline[x..x + length];
        if is_run {
            let [repeated] = input.take()?;
            texels
                .iter_mut()
                .for_each(|texel| texel[channel] = repeated);
        } else {
            for texel in texels {
                let [value] = input.take()?;
                texel[channel] = value;
            }
        }
        x += length;
    }
    Ok(())
}

/// Reads flat texels. In the old run-length form (1, 1, 1, n) repeats the texel before n times;
/// consecutive runs are digits of base 256.
fn read_flat(input: &mut Input, scanline: &mut [[u8; 4]]) -> Result<(), ScanlineFault> {
    let mut x = 0;
    let mut shift = 0;
    while x < scanline.len() {
        let texel: [u8; 4] = input.take()?;
        if texel[..3] != [1, 1, 1] {
            scanline[x] = texel;
            x += 1;
            shift = 0;
            continue;
        }
        // 0 is a digit of a longer run.
        let length = usize::from(texel[3]) << shift;
        if x == 0 || length > scanline.len() - x {
            return Err(ScanlineFault::Damaged(format!(
                "a run of length {length} at texel {x} repeats nothing or passes the end"
            )));
        }
        let previous = scanline[x - 1];
        scanline[x..x + length].fill(previous);
        x += length;
        // A length over 2^24 exceeds every plausible scanline.
        shift = (shift + 8).min(24);
    }
    Ok(())
}

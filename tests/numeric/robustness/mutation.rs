//! Mutation of files, as `cargo fuzz` does it, without its feedback, on any toolchain.

use fastrand::Rng;

/// Makes mutated files from a fixed seed.
pub struct Mutator(Rng);

/// Extreme integers, as bytes of a file.
const EDGES: [i64; 10] = [
    0,
    1,
    -1,
    127,
    128,
    255,
    i16::MAX as i64,
    i32::MAX as i64,
    i32::MIN as i64,
    i64::MAX,
];

/// Words that text formats treat as special.
const WORDS: [&str; 14] = [
    "nan",
    "inf",
    "-1",
    "1e400",
    "0",
    "99999999999",
    "\n",
    "\r",
    "\"",
    "\\",
    ",",
    "\u{feff}",
    "-",
    "/",
];

impl Mutator {
    pub fn new(seed: u64) -> Self {
        Self(Rng::with_seed(seed))
    }

    fn below(&mut self, end: usize) -> usize {
        self.0.usize(..end.max(1))
    }

    pub fn mutate(&mut self, seeds: &[&[u8]]) -> Vec<u8> {
        let mut bytes = seeds[self.below(seeds.len())].to_vec();
        for _ in 0..=self.below(8) {
            self.change(&mut bytes, seeds);
        }
        bytes
    }

    fn change(&mut self, bytes: &mut Vec<u8>, seeds: &[&[u8]]) {
        let at = self.below(bytes.len());
        let length = 1 + self.below(16).min(bytes.len() / 2);
        let end = (at + length).min(bytes.len());
        match self.below(9) {
            0 if !bytes.is_empty() => bytes[at] ^= 1 << self.below(8),
            1 if !bytes.is_empty() => bytes[at] = self.below(256) as u8,
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let copy = bytes[at..end].to_vec();
                let to = self.below(bytes.len());
                bytes.splice(to..to, copy);
            }
            5 => {
                // An extreme integer of 1, 2, 4 or 8 bytes.
                let value = EDGES[self.below(EDGES.len())].to_le_bytes();
                let size = (1usize << self.below(4)).min(bytes.len() - at);
                bytes[at..at + size].copy_from_slice(&value[..size]);
            }
            6 => {
                let word = WORDS[self.below(WORDS.len())];
                bytes.splice(at..at, word.bytes());
            }
            7 => {
                // Replaces a number in a text.
                let Some(digit) = (at..bytes.len()).find(|&i| bytes[i].is_ascii_digit()) else {
                    return;
                };
                let end = (digit..bytes.len())
                    .find(|&i| !bytes[i].is_ascii_digit())
                    .unwrap_or(bytes.len());
                let word = WORDS[self.below(6)];
                bytes.splice(digit..end, word.bytes());
            }
            _ => {
                // Appends the rest of another file.
                let other = seeds[self.below(seeds.len())];
                let from = self.below(other.len());
                bytes.truncate(at);
                bytes.extend(&other[from..]);
            }
        }
    }
}

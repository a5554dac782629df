//! The JPEG streams of a file, which follow each other, and their metadata segments.

/// One picture.
pub(super) struct Stream<'a> {
    /// From its first marker to its last.
    pub bytes: &'a [u8],
    /// Payloads of APP1 and APP2 segments.
    pub segments: Vec<&'a [u8]>,
}

impl<'a> Stream<'a> {
    /// Returns the rest of each segment that starts with a signature.
    pub fn after(&self, signature: &[u8]) -> impl Iterator<Item = &'a [u8]> {
        self.segments
            .iter()
            .filter_map(move |segment| segment.strip_prefix(signature))
    }
}

const START_OF_IMAGE: [u8; 2] = [0xff, 0xd8];
const END_OF_IMAGE: u8 = 0xd9;
const START_OF_SCAN: u8 = 0xda;
const APP1: u8 = 0xe1;
const APP2: u8 = 0xe2;

/// Splits a file into its streams, and skips bytes between them. Stops at damage.
pub(super) fn streams(mut bytes: &[u8]) -> Vec<Stream<'_>> {
    let mut found = Vec::new();
    while let Some(start) = bytes
        .windows(START_OF_IMAGE.len())
        .position(|pair| pair == START_OF_IMAGE)
    {
        bytes = &bytes[start..];
        let Some(stream) = first_stream(bytes) else {
            break;
        };
        bytes = &bytes[stream.bytes.len()..];
        found.push(stream);
    }
    found
}

/// Reads segments up to the end of the image; `None` if the file ends before.
fn first_stream(bytes: &[u8]) -> Option<Stream<'_>> {
    let mut segments = Vec::new();
    let mut position = START_OF_IMAGE.len();
    loop {
        let marker = *bytes.get(position + 1)?;
        if bytes[position] != 0xff {
            return None;
        }
        position += 2;
        if marker == END_OF_IMAGE {
            return Some(Stream {
                bytes: &bytes[..position],
                segments,
            });
        }
        // Fill bytes.
        if marker == 0xff {
            position -= 1;
            continue;
        }
        let length = u16::from_be_bytes(*bytes.get(position..)?.first_chunk()?);
        let payload = bytes.get(position + 2..position + usize::from(length))?;
        position += usize::from(length);
        match marker {
            APP1 | APP2 => segments.push(payload),
            START_OF_SCAN => position += coded_length(bytes.get(position..)?)?,
            _ => {}
        }
    }
}

/// Returns the length of the coded samples at the front: up to the next marker that is neither a
/// stuffed byte nor a restart.
fn coded_length(bytes: &[u8]) -> Option<usize> {
    bytes.windows(2).position(|pair| {
        pair[0] == 0xff && pair[1] != 0 && pair[1] != 0xff && !(0xd0..=0xd7).contains(&pair[1])
    })
}

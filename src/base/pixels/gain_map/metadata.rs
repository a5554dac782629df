//! The numbers of a gain map: XMP attributes or elements, or the binary block of ISO 21496-1.

use super::streams::Stream;
use crate::base::pixels::file::Fault;
use glam::DVec3;

const XMP: &[u8] = b"http://ns.adobe.com/xap/1.0/\0";
const ISO: &[u8] = b"urn:iso:std:iso:ts:21496:-1\0";
const PREFIX: &str = "hdrgm:";

/// How gains are stored, by channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GainMap {
    /// Gains of the codes 0 and 1, stops.
    min: DVec3,
    max: DVec3,
    gamma: DVec3,
    offset_sdr: DVec3,
    offset_hdr: DVec3,
}

impl GainMap {
    /// Reads the metadata of a stream; `None` if it is not a gain map.
    pub fn of(stream: &Stream) -> Option<Result<Self, Fault>> {
        let by_xmp = stream
            .after(XMP)
            .find_map(|packet| Self::of_xmp(&String::from_utf8_lossy(packet)));
        by_xmp.or_else(|| stream.after(ISO).find_map(Self::of_iso))
    }

    /// Returns the radiance of a linear colour of the picture and a gain of the map.
    pub fn radiance(&self, sdr: DVec3, gain: DVec3) -> DVec3 {
        let shaped = DVec3::from_array(std::array::from_fn(|i| gain[i].powf(1.0 / self.gamma[i])));
        let stops = self.min + (self.max - self.min) * shaped;
        (sdr + self.offset_sdr) * DVec3::from_array(stops.to_array().map(f64::exp2))
            - self.offset_hdr
    }

    fn of_xmp(packet: &str) -> Option<Result<Self, Fault>> {
        let max = value(packet, "GainMapMax")?;
        let read = || {
            let is_hdr = text(packet, "BaseRenditionIsHDR").is_some_and(|text| text == "True");
            if is_hdr {
                return Err(Fault::new(
                    "has a gain map whose picture is the HDR one",
                    "a gain map that brightens an SDR picture",
                ));
            }
            let or =
                |name: &str, default: f64| value(packet, name).unwrap_or(Ok(DVec3::splat(default)));
            Self {
                min: or("GainMapMin", 0.0)?,
                max: max?,
                gamma: or("Gamma", 1.0)?,
                offset_sdr: or("OffsetSDR", 1.0 / 64.0)?,
                offset_hdr: or("OffsetHDR", 1.0 / 64.0)?,
            }
            .checked()
        };
        Some(read())
    }

    /// Reads the block of ISO 21496-1: two versions, flags, two headrooms, then five numbers for one
    /// channel or for three, as fractions or over one denominator. The picture has its versions
    /// alone.
    fn of_iso(block: &[u8]) -> Option<Result<Self, Fault>> {
        const THREE_CHANNELS: u8 = 1 << 7;
        const COMMON_DENOMINATOR: u8 = 1 << 3;
        let (&flags, mut rest) = block.get(4..)?.split_first()?;
        let mut word = || {
            let (&word, after) = rest.split_first_chunk()?;
            rest = after;
            Some(i32::from_be_bytes(word))
        };
        let common = if flags & COMMON_DENOMINATOR != 0 {
            Some(word()?)
        } else {
            None
        };
        let mut number = |is_signed: bool| {
            let numerator = word()?;
            let denominator = f64::from(match common {
                Some(denominator) => denominator as u32,
                None => word()? as u32,
            });
            let numerator = if is_signed {
                f64::from(numerator)
            } else {
                f64::from(numerator as u32)
            };
            Some(numerator / denominator)
        };
        // The headrooms say for which screens the gains are.
        number(false)?;
        number(false)?;
        let channel_count = if flags & THREE_CHANNELS != 0 { 3 } else { 1 };
        let mut channels = Vec::new();
        for _ in 0..channel_count {
            channels.push(Channel {
                min: number(true)?,
                max: number(true)?,
                gamma: number(false)?,
                offset_sdr: number(true)?,
                offset_hdr: number(true)?,
            });
        }
        let each = |field: fn(&Channel) -> f64| {
            DVec3::from_array(std::array::from_fn(|i| field(&channels[i % channel_count])))
        };
        let gain_map = Self {
            min: each(|channel| channel.min),
            max: each(|channel| channel.max),
            gamma: each(|channel| channel.gamma),
            offset_sdr: each(|channel| channel.offset_sdr),
            offset_hdr: each(|channel| channel.offset_hdr),
        };
        Some(gain_map.checked())
    }

    fn checked(self) -> Result<Self, Fault> {
        let all = [
            self.min,
            self.max,
            self.gamma,
            self.offset_sdr,
            self.offset_hdr,
        ];
        let is_usable = all.iter().all(|value| value.is_finite())
            && self.gamma.min_element() > 0.0
            && self.max.max_element() < f64::from(f32::MAX_EXP);
        if is_usable {
            Ok(self)
        } else {
            Err(Fault::new(
                format!(
                    "has a gain map from {} to {} stops with gamma {}",
                    self.min, self.max, self.gamma
                ),
                "finite gains and a gamma above 0",
            ))
        }
    }
}

struct Channel {
    min: f64,
    max: f64,
    gamma: f64,
    offset_sdr: f64,
    offset_hdr: f64,
}

/// Returns the text of `hdrgm:NAME="text"` or `<hdrgm:NAME>text</hdrgm:NAME>`.
fn text<'p>(packet: &'p str, name: &str) -> Option<&'p str> {
    let tag = format!("{PREFIX}{name}");
    packet.match_indices(&tag).find_map(|(start, _)| {
        let after = packet[start + tag.len()..].trim_start();
        if let Some(element) = after.strip_prefix('>') {
            return element
                .split_once(&format!("</{tag}"))
                .map(|(text, _)| text);
        }
        let quoted = after.strip_prefix('=')?.trim_start();
        let quote = quoted
            .chars()
            .next()
            .filter(|quote| "\"'".contains(*quote))?;
        quoted[1..].split_once(quote).map(|(text, _)| text)
    })
}

/// Returns a number, or three of a list: `<rdf:Seq><rdf:li>1</rdf:li>...`.
fn value(packet: &str, name: &str) -> Option<Result<DVec3, Fault>> {
    let text = text(packet, name)?;
    let numbers: Option<Vec<f64>> = text
        .split(['<', '>'])
        // Text is between tags: every second part.
        .step_by(2)
        .map(str::trim)
        .filter(|part| !part.is_empty())
        .map(|part| part.parse().ok())
        .collect();
    Some(match numbers.as_deref() {
        Some([all]) => Ok(DVec3::splat(*all)),
        Some([r, g, b]) => Ok(DVec3::new(*r, *g, *b)),
        _ => Err(Fault::new(
            format!("has a gain map whose {name} is {text:?}"),
            "one number, or three",
        )),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_xmp(packet: &str) -> GainMap {
        GainMap::of_xmp(packet).unwrap().unwrap()
    }

    #[test]
    fn attributes_elements_and_lists_say_the_same() {
        let attributes = by_xmp(
            r#"<rdf:Description hdrgm:Version="1.0" hdrgm:GainMapMin="-1" hdrgm:GainMapMax="3"
                hdrgm:Gamma="2" hdrgm:OffsetSDR="0.25" hdrgm:OffsetHDR="0.5"/>"#,
        );
        let elements = by_xmp(
            "<hdrgm:GainMapMin>-1</hdrgm:GainMapMin> <hdrgm:GainMapMax>\n<rdf:Seq> <rdf:li>3</rdf:li>
             <rdf:li>3</rdf:li> <rdf:li>3.0</rdf:li></rdf:Seq></hdrgm:GainMapMax>
             <hdrgm:Gamma>2</hdrgm:Gamma><hdrgm:OffsetSDR>.25</hdrgm:OffsetSDR>
             <hdrgm:OffsetHDR>0.5</hdrgm:OffsetHDR>",
        );
        assert_eq!(attributes, elements);
        // A quarter is a half after the gamma: from -1 to 3, that is 1 stop.
        let radiance = attributes.radiance(DVec3::splat(0.75), DVec3::new(0.0, 0.25, 1.0));
        assert_eq!(radiance, DVec3::new(0.0, 1.5, 7.5));
        let defaults = by_xmp(r#"hdrgm:GainMapMax='2'"#);
        assert_eq!(defaults.offset_hdr, DVec3::splat(1.0 / 64.0));
        assert_eq!((defaults.min, defaults.gamma), (DVec3::ZERO, DVec3::ONE));
    }

    #[test]
    fn the_block_of_iso_says_the_same() {
        let xmp = by_xmp(
            r#"hdrgm:GainMapMin="-1" hdrgm:GainMapMax="3" hdrgm:Gamma="2" hdrgm:OffsetSDR="0.25"
               hdrgm:OffsetHDR="0.5""#,
        );
        let numbers = [[0, 1], [3, 1], [-4, 4], [12, 4], [8, 4], [1, 4], [2, 4]];
        let fractions: Vec<u8> = numbers
            .as_flattened()
            .iter()
            .flat_map(|number: &i32| number.to_be_bytes())
            .collect();
        let block = [&[0, 0, 0, 0, 0x40][..], &fractions].concat();
        assert_eq!(GainMap::of_iso(&block).unwrap().unwrap(), xmp);
        // Over one denominator, for three channels.
        let numerators = [-4, 12, 8, 1, 2].repeat(3);
        let words = [&[4, 0, 12][..], &numerators].concat();
        let words: Vec<u8> = words
            .iter()
            .flat_map(|word: &i32| word.to_be_bytes())
            .collect();
        let block = [&[0, 0, 0, 0, 0x88][..], &words].concat();
        assert_eq!(GainMap::of_iso(&block).unwrap().unwrap(), xmp);
        // The picture has its versions alone.
        assert!(GainMap::of_iso(&[0, 0, 0, 0]).is_none());
        assert!(GainMap::of_iso(&block[..block.len() - 1]).is_none());
    }

    #[test]
    fn unusable_numbers_are_refused() {
        for packet in [
            r#"hdrgm:GainMapMax="bright""#,
            r#"hdrgm:GainMapMax="1" hdrgm:Gamma="0""#,
            r#"hdrgm:GainMapMax="1e9""#,
            r#"hdrgm:GainMapMax="1" hdrgm:BaseRenditionIsHDR="True""#,
        ] {
            assert!(GainMap::of_xmp(packet).unwrap().is_err(), "{packet}");
        }
        assert!(GainMap::of_xmp(r#"hdrgm:Version="1.0""#).is_none());
    }
}

//! Colour: luminance and the transfer functions. Linear RGB has Rec.709 primaries throughout.

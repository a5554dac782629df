//! The g-buffer: what the camera sees, one texel a pixel.

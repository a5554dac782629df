//! f64 mathematics without rendering: frames, the equirectangular mapping, point sets, quadrature,
//! spherical harmonics, order statistics.

pub mod blue_noise;
pub mod brent;
pub mod design;
pub mod equirect;
pub mod equirect_quadrature;
pub mod erf;
pub mod frame;
pub mod harmonics;
pub mod incomplete_beta;
pub mod order_statistics;
pub mod quadrature;
pub mod sampling;
pub mod sequence;
pub mod spherical_harmonics;

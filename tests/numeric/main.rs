//! numeric tests
mod brdf;
mod color;
mod environment;
mod experiment;
mod layering;
mod math;
mod metrics;
mod oracle;
mod pixels;
mod precompute;
mod published;
mod reference;
mod report;
mod scene;
mod slips;
mod table;
mod tonemap;

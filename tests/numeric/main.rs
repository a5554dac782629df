//! numeric tests
mod brdf;
mod disk_cache;
mod environment;
mod experiment;
mod layering;
mod math;
mod metrics;
mod oracle;
mod pixels;
mod precompute;
mod reference;
mod report;
mod scene;
mod sequence;
mod slips;
mod table;
mod tonemap;

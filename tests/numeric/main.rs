//! numeric tests
mod brdf;
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
mod report_live;
mod scene;
mod slips;
mod table;
mod tonemap;

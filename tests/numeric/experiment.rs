//! Experiment files and plans.

mod asks;
mod config;
mod limits;
mod names;
mod plan;
mod zips;

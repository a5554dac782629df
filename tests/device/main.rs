//! device tests

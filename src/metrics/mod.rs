//! Scores of an image against its reference. Metrics see images and a mask, never a method.

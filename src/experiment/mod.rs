//! Experiments: a file, its plan, its run.

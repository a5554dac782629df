//! Rows and image tables.

//! The same by adaptive cubature over directions.

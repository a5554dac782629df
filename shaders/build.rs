//! The build script. The feature `gpu` needs compiled shaders ([`compile`]); without it there is
//! nothing to do.

#[cfg(feature = "gpu")]
mod compile;

fn main() {
    println!("cargo::rerun-if-changed=shaders/build.rs");
    #[cfg(feature = "gpu")]
    compile::main();
}

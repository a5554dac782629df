//! The validation layer itself.

use splitsum::gpu::{Gpu, GpuError, Options};
use std::process::Command;

/// Set if this test runs itself again, with a loader that finds no layer: a process reads its environment once.
const CHILD: &str = "SPLITSUM_TEST_WITHOUT_LAYERS";

/// A requested layer that is missing is an error, never a run without validation. Without the request a device opens.
#[test]
fn a_missing_validation_layer_is_its_own_error() {
    if std::env::var_os(CHILD).is_none() {
        let layers = tempfile::tempdir().unwrap();
        let mut again = Command::new(std::env::current_exe().unwrap());
        again.args(["--exact", "layer::a_missing_validation_layer_is_its_own_error"]);
        // Explicit layers are searched here only, and the variable that adds layers by name is empty.
        again.env(CHILD, "1").env("VK_LAYER_PATH", layers.path()).env_remove("VK_INSTANCE_LAYERS");
        let output = again.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
        assert!(String::from_utf8_lossy(&output.stdout).contains("1 passed"), "the test runs under another name");
        return;
    }
    let open = |validation| Gpu::new(Options { validation, ..Options::default() });
    match open(true) {
        Err(GpuError::NoValidationLayer) => {}
        Err(error @ GpuError::NoLoader(_)) => return eprintln!("skipped: {error}"),
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("opened without the layer that was asked for"),
    }
    let opened = open(false).map(|_| ());
    assert!(matches!(opened, Ok(()) | Err(GpuError::NoDevice)), "{opened:?}");
}

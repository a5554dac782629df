//! The validation layer itself.

use splitsum::gpu::{Gpu, GpuError, Options};
use std::process::Command;

/// Set where this test runs itself again, with a loader that sees no layer: a process reads its environment once.
const CHILD: &str = "SPLITSUM_TEST_WITHOUT_LAYERS";

/// A layer that is asked for and missing is an error of its own and never a run without validation; without it a device opens.
#[test]
fn a_missing_validation_layer_is_an_error_of_its_own() {
    if std::env::var_os(CHILD).is_none() {
        let layers = tempfile::tempdir().unwrap();
        let mut again = Command::new(std::env::current_exe().unwrap());
        again.args(["--exact", "layer::a_missing_validation_layer_is_an_error_of_its_own"]);
        // Explicit layers are looked for here and nowhere else, and the variable that adds layers by name is emptied.
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

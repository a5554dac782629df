//! Shaders of a folder in place of the program's own, for people who edit shaders: without a build, the
//! next command draws with them.

use super::{Failure, log};
use splitsum::instrument::gpu::use_edited_shaders;
use std::path::Path;

/// Names the folder, such as `shaders` in a checkout.
const VARIABLE: &str = "SPLITSUM_SHADERS";

/// Uses the folder that the environment variable names, if it names one, and says how many shaders
/// are not the program's.
pub fn load() -> Result<(), Failure> {
    let Some(folder) = std::env::var_os(VARIABLE).filter(|folder| !folder.is_empty()) else {
        return Ok(());
    };
    let counts = use_edited_shaders(Path::new(&folder))
        .map_err(|fault| Failure::input(format!("{VARIABLE}: {fault}")))?;
    log(&format!(
        "{VARIABLE}: {} of {} shaders are not the program's",
        counts.compiled_count, counts.all_count
    ));
    Ok(())
}

//! Shaders of a folder in place of the program's own, for people who edit shaders: without a build,
//! the next command draws with them.

use super::{Failure, log};
use splitsum::instrument::gpu::EditedShaders;
use std::path::Path;

/// Names the folder, such as `shaders` in a checkout.
const VARIABLE: &str = "SPLITSUM_SHADERS";

/// Uses the folder that the environment variable names, if it names one, and says how many shaders
/// are not the program's.
pub fn load() -> Result<(), Failure> {
    let Some(folder) = std::env::var_os(VARIABLE).filter(|folder| !folder.is_empty()) else {
        return Ok(());
    };
    let folder = Path::new(&folder);
    // The compiler calls every folder `shaders/`.
    let fault = |what| Failure::input(format!("{VARIABLE}={}: {what}", folder.display()));
    let shaders = EditedShaders::read(folder).map_err(fault)?;
    // Before the compilation, which takes seconds after an edit of a common file.
    log(&format!(
        "{VARIABLE}: {} of {} shaders are not the program's",
        shaders.edited_count(),
        shaders.all_count()
    ));
    shaders.put_to_use().map_err(fault)
}

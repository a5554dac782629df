//! Saves a shown state in a folder: the picture, the linear halves, and commands that make them
//! again.

use super::canvas::composed;
use super::file::quoted;
use super::shown::Shown;
use super::state::{Side, State};
use crate::base::pixels::png;
use crate::run::write_radiance;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Saves what is shown in a new folder in `out`, and returns the folder.
pub fn save(out: &Path, state: &State, shown: &Shown) -> Result<PathBuf, String> {
    let folder = free_folder(out);
    std::fs::create_dir_all(&folder).map_err(|error| fault(&folder, &error))?;
    let search = search_path();
    let mut commands = format!("#!/bin/sh\n# Renders the halves of this state again.\n{search}\n");
    for (name, side) in [("left", Side::Left), ("right", Side::Right)] {
        let shot = shown.side(side).ok_or("there is no picture yet")?;
        let frame = shot.frame.as_ref().ok_or("there is no image yet")?;
        let path = folder.join(format!("{name}.exr"));
        write_radiance(&path, frame).map_err(|error| error.to_string())?;
        commands += &state.render_command(&shot.image, &format!("{name}-again.exr"));
        commands += "\n";
    }
    let picture = composed(shown, state.shown_wipe()).map_err(|error| error.to_string())?;
    let picture = picture.ok_or("there is no picture yet")?;
    png::write_rgb8(&folder.join("picture.png"), &picture).map_err(|error| error.to_string())?;
    write_text(&folder.join("render.sh"), &commands)?;
    let command = state.view_command();
    write_text(
        &folder.join("view.sh"),
        &format!("#!/bin/sh\n# Opens this state again.\n{search}\n{command}\n"),
    )?;
    Ok(folder)
}

/// The first of `view-1`, `view-2`, ... that does not exist.
fn free_folder(out: &Path) -> PathBuf {
    (1_u32..)
        .map(|number| out.join(format!("view-{number}")))
        .find(|folder| !folder.exists())
        .expect("a free number")
}

/// Adds the folder of this program to the search path of a shell.
fn search_path() -> String {
    let program = std::env::current_exe()
        .ok()
        .and_then(|file| Some(file.parent()?.display().to_string()));
    format!("PATH=$PATH:{}", quoted(&program.unwrap_or_default()))
}

fn write_text(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|error| fault(path, &error))
}

fn fault(path: &Path, error: &dyn Display) -> String {
    format!("{}: {error}", path.display())
}

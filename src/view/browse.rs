//! A list of the files that can be opened. It needs no library of the desktop.

use super::state::file_axis;
use super::theme;
use crate::experiment::axis::ENVIRONMENT;
use egui::{Key, Rect, RichText, ScrollArea, TextEdit, Ui};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const SIZE: [f32; 2] = [460.0, 320.0];

pub struct Browse {
    axis: usize,
    folder: PathBuf,
    typed: String,
    /// Folders, then files, each with its name.
    entries: Vec<(PathBuf, String)>,
}

impl Browse {
    /// Lists the files in the folder of `near` that an axis takes.
    pub fn new(axis: usize, near: &Path) -> Self {
        let beside = near.parent().filter(|folder| folder.is_dir()).map(Path::to_owned);
        let folder = beside.or_else(|| std::env::current_dir().ok()).unwrap_or_default();
        let mut browse = Self { axis, folder: PathBuf::new(), typed: String::new(), entries: Vec::new() };
        browse.enter(folder);
        browse
    }

    fn enter(&mut self, folder: PathBuf) {
        let Ok(listed) = std::fs::read_dir(&folder) else { return };
        let paths = listed.flatten().map(|entry| (entry.path(), entry.file_name().to_string_lossy().into_owned()));
        let is_listed = |path: &Path| path.is_dir() || file_axis(path) == Some(self.axis);
        self.entries = paths.filter(|(path, name)| !name.starts_with('.') && is_listed(path)).collect();
        self.entries.sort_by_cached_key(|(path, name)| (!path.is_dir(), name.to_lowercase()));
        (self.folder, self.typed) = (folder, String::new());
    }

    /// Shows the list. Returns `None` while it is open, then the chosen file, if any.
    pub fn ui(&mut self, ui: &Ui, places: &mut BTreeMap<String, Rect>) -> Option<Option<PathBuf>> {
        let mut chosen = None;
        let modal = egui::Modal::new("browse".into()).show(ui.ctx(), |ui| {
            ui.set_width(SIZE[0]);
            ui.heading(if self.axis == ENVIRONMENT { "Open an environment" } else { "Open a model" });
            ui.label(RichText::new(self.folder.display().to_string()).small().color(theme::MUTED));
            let field = TextEdit::singleline(&mut self.typed).hint_text("Path of a file or folder, then Enter");
            let field = ui.add(field.desired_width(f32::INFINITY));
            places.insert("path".to_owned(), field.rect);
            if field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
                chosen = Some(self.folder.join(self.typed.trim()));
            } else if ui.memory(|memory| memory.focused().is_none()) {
                field.request_focus();
            }
            let rows = |ui: &mut Ui| {
                if let Some(above) = self.folder.parent()
                    && ui.selectable_label(false, "..").clicked()
                {
                    chosen = Some(above.to_owned());
                }
                for (path, name) in &self.entries {
                    let shown = if path.is_dir() { format!("{name}/") } else { name.clone() };
                    let response = ui.selectable_label(false, shown);
                    places.insert(format!("file {name}"), response.rect);
                    if response.clicked() {
                        chosen = Some(path.clone());
                    }
                }
            };
            let across = egui::Layout::top_down_justified(egui::Align::LEFT);
            let area = ScrollArea::vertical().max_height(SIZE[1]).auto_shrink([false, true]);
            area.show(ui, |ui| ui.with_layout(across, rows));
            ui.button("Cancel").clicked()
        });
        match chosen {
            Some(path) if path.is_dir() => self.enter(path),
            None if !modal.inner && !modal.should_close() => {}
            chosen => return Some(chosen),
        }
        None
    }
}

//! A field for the path of a file. It needs no library of the desktop.

use crate::experiment::axis::AxisId;
use crate::experiment::axis::ENVIRONMENT;
use egui::{Key, Rect, TextEdit, Ui};
use std::collections::BTreeMap;
use std::path::PathBuf;

pub struct Browse {
    pub axis: AxisId,
    pub typed: String,
}

impl Browse {
    /// Shows the field. Returns `None` while it is open, then the path, if any.
    pub fn ui(&mut self, ui: &Ui, rects: &mut BTreeMap<String, Rect>) -> Option<Option<PathBuf>> {
        let modal = egui::Modal::new("browse".into()).show(ui.ctx(), |ui| {
            ui.set_width(460.0);
            ui.heading(if self.axis == ENVIRONMENT {
                "Open an environment"
            } else {
                "Open a model"
            });
            let field =
                TextEdit::singleline(&mut self.typed).hint_text("Path of a file, then Enter");
            let field = ui.add(field.desired_width(f32::INFINITY));
            rects.insert("path".to_owned(), field.rect);
            let is_typed = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            if !is_typed && ui.memory(|memory| memory.focused().is_none()) {
                field.request_focus();
            }
            (is_typed, ui.button("Cancel").clicked())
        });
        let (is_typed, is_cancelled) = modal.inner;
        let path = is_typed.then(|| PathBuf::from(self.typed.trim()));
        (is_typed || is_cancelled || modal.should_close()).then_some(path)
    }
}

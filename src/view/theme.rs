//! Colours and typefaces: the dark tokens of the report.

use crate::instrument::shade::Role;
use egui::epaint::Shadow;
use egui::{
    Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Stroke, TextStyle,
    Visuals, style::WidgetVisuals,
};
use std::sync::Arc;

pub const PAPER: Color32 = Color32::from_rgb(0x10, 0x12, 0x14);
pub const RAISED: Color32 = Color32::from_rgb(0x19, 0x1c, 0x1f);
pub const SUNKEN: Color32 = Color32::from_rgb(0x20, 0x24, 0x28);
pub const LINE: Color32 = Color32::from_rgb(0x31, 0x36, 0x3b);
pub const EDGE: Color32 = Color32::from_rgb(0x7d, 0x84, 0x8b);
pub const INK: Color32 = Color32::from_rgb(0xed, 0xee, 0xee);
pub const MUTED: Color32 = Color32::from_rgb(0xa6, 0xac, 0xb3);
pub const ACCENT: Color32 = Color32::from_rgb(0x7a, 0xb8, 0xf5);
pub const ON_ACCENT: Color32 = Color32::from_rgb(0x0c, 0x11, 0x16);
pub const WARN: Color32 = Color32::from_rgb(0xff, 0xc7, 0x77);
/// Ground of text on a picture.
pub const VEIL: Color32 = Color32::from_rgba_premultiplied(0x0d, 0x0f, 0x10, 0xd0);
const TEXTBOOK: Color32 = Color32::from_rgb(0xff, 0x9a, 0x62);
const CORRECTED: Color32 = Color32::from_rgb(0x45, 0xcd, 0xb7);
const SAMPLING: Color32 = Color32::from_rgb(0xbb, 0xa8, 0xff);

pub fn color(role: Option<Role>) -> Color32 {
    match role {
        None => INK,
        Some(Role::Textbook) => TEXTBOOK,
        Some(Role::Corrected) => CORRECTED,
        Some(Role::Sampling) => SAMPLING,
        Some(Role::Other) => ACCENT,
    }
}

pub fn medium(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name("medium".into()))
}

pub fn apply(context: &egui::Context) {
    context.set_fonts(fonts());
    context.set_theme(egui::Theme::Dark);
    context.all_styles_mut(|style| {
        let text = |size| FontId::proportional(size);
        let styles = [
            (TextStyle::Small, text(12.0)),
            (TextStyle::Body, text(13.5)),
            (TextStyle::Button, text(13.5)),
            (TextStyle::Heading, medium(15.0)),
            (TextStyle::Monospace, FontId::monospace(12.5)),
        ];
        style.text_styles = styles.into();
        style.spacing.item_spacing = egui::vec2(8.0, 7.0);
        style.spacing.button_padding = egui::vec2(9.0, 4.0);
        style.spacing.interact_size.y = 26.0;
        style.spacing.icon_width = 16.0;
        style.interaction.tooltip_delay = 0.3;
        style.visuals = visuals();
    });
}

fn visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.panel_fill = RAISED;
    visuals.window_fill = RAISED;
    visuals.window_stroke = Stroke::new(1.0, LINE);
    visuals.extreme_bg_color = PAPER;
    visuals.weak_text_color = Some(MUTED);
    visuals.warn_fg_color = WARN;
    visuals.selection.bg_fill = ACCENT;
    visuals.selection.stroke = Stroke::new(1.0, ON_ACCENT);
    visuals.slider_trailing_fill = true;
    // Blurred shadows are slow on a CPU.
    visuals.window_shadow = Shadow::NONE;
    visuals.popup_shadow = Shadow::NONE;
    let widgets = &mut visuals.widgets;
    set_colors(&mut widgets.noninteractive, RAISED, LINE, INK);
    set_colors(&mut widgets.inactive, SUNKEN, EDGE, INK);
    set_colors(&mut widgets.hovered, LINE, INK, INK);
    set_colors(&mut widgets.active, LINE, ACCENT, INK);
    set_colors(&mut widgets.open, LINE, EDGE, INK);
    visuals
}

/// Colours a widget in one of its states.
fn set_colors(look: &mut WidgetVisuals, ground: Color32, edge: Color32, ink: Color32) {
    look.bg_fill = ground;
    look.weak_bg_fill = ground;
    look.corner_radius = CornerRadius::same(6);
    look.bg_stroke = Stroke::new(1.0, edge);
    look.fg_stroke = Stroke::new(1.0, ink);
}

struct Typeface {
    name: &'static str,
    ttf: &'static [u8],
    family: FontFamily,
}

/// Each family falls back on the others' letters.
fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    let files = [
        Typeface {
            name: "text",
            ttf: include_bytes!("../../assets/fonts/text-regular.ttf"),
            family: FontFamily::Proportional,
        },
        Typeface {
            name: "medium",
            ttf: include_bytes!("../../assets/fonts/text-medium.ttf"),
            family: FontFamily::Name("medium".into()),
        },
        Typeface {
            name: "code",
            ttf: include_bytes!("../../assets/fonts/code-regular.ttf"),
            family: FontFamily::Monospace,
        },
    ];
    for Typeface { name, ttf, family } in files {
        fonts
            .font_data
            .insert(name.to_owned(), Arc::new(FontData::from_static(ttf)));
        fonts.families.insert(
            family,
            vec![name.to_owned(), "text".to_owned(), "code".to_owned()],
        );
    }
    fonts
}

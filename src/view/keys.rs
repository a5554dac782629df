//! Keys, and the turns of camera and light.

use super::picture::Picture;
use super::state::{HOME, State};
use crate::experiment::axis::{ENVIRONMENT_ROTATION, EXPOSURE, METHOD};
use crate::experiment::value::{Value, decimal};
use crate::instrument::scene::Orbit;
use egui::{Key, Ui};

/// Turn by an arrow key, degrees, and distance factor of + and -.
const KEY_DEG: f64 = 5.0;
const KEY_ZOOM: f64 = 1.15;

#[derive(Default)]
pub struct Pressed {
    pub is_flipped: bool,
    pub save: bool,
    pub fullscreen: bool,
}

/// Applies the keys of this pass, unless a control has the focus.
pub fn press(ui: &Ui, state: &mut State, has_probe: &mut bool) -> Pressed {
    let context = ui.ctx().clone();
    let mut pressed = Pressed::default();
    if context.memory(|memory| memory.focused()).is_some() {
        return pressed;
    }
    context.input(|input| {
        pressed.is_flipped = input.key_down(Key::Space);
        let mut stops = 0.0;
        for event in &input.events {
            let egui::Event::Key {
                key,
                pressed: true,
                modifiers,
                ..
            } = event
            else {
                continue;
            };
            // A slow pass sees several keys, each with its own modifiers.
            let (picture, orbit, shift) = (state.picture, state.view.orbit, modifiers.shift);
            let toggled = |wanted: Picture| {
                if picture == wanted {
                    Picture::Image
                } else {
                    wanted
                }
            };
            let turn = |yaw: f64, pitch: f64| turned(orbit, yaw, pitch);
            match key {
                key if modifiers.command => pressed.save |= *key == Key::S,
                Key::E => state.picture = toggled(Picture::Error),
                Key::S => state.picture = toggled(Picture::Signed),
                Key::P => *has_probe ^= true,
                Key::F | Key::F11 => pressed.fullscreen = true,
                Key::D => state.wipe = if state.wipe == 1.0 { 0.5 } else { 1.0 },
                Key::OpenBracket => stops -= 0.5,
                Key::CloseBracket => stops += 0.5,
                Key::Plus | Key::Equals => state.view.orbit = nearer(orbit, 1.0 / KEY_ZOOM),
                Key::Minus => state.view.orbit = nearer(orbit, KEY_ZOOM),
                Key::Num0 => state.view.orbit = HOME,
                Key::ArrowLeft if shift => turn_light(state, -KEY_DEG),
                Key::ArrowRight if shift => turn_light(state, KEY_DEG),
                Key::ArrowLeft => state.view.orbit = turn(-KEY_DEG, 0.0),
                Key::ArrowRight => state.view.orbit = turn(KEY_DEG, 0.0),
                Key::ArrowUp => state.view.orbit = turn(0.0, KEY_DEG),
                Key::ArrowDown => state.view.orbit = turn(0.0, -KEY_DEG),
                key => {
                    // Keys 1 to 9 choose a method in list order.
                    let digit = key
                        .symbol_or_name()
                        .parse::<usize>()
                        .ok()
                        .filter(|digit| *digit > 0);
                    if let Some(method) =
                        digit.and_then(|digit| crate::instrument::shade::METHODS.get(digit - 1))
                    {
                        state.point[METHOD] = Value::Text(method.name.to_owned().into());
                    }
                }
            }
        }
        if stops != 0.0 {
            let exposure = (state.point[EXPOSURE].number() * 2f64.powf(stops)).clamp(1e-6, 1e9);
            state.point[EXPOSURE] = Value::Number(decimal(exposure));
        }
    });
    pressed
}

/// Turns the orbit, in hundredths of a degree.
pub fn turned(orbit: Orbit, yaw: f64, pitch: f64) -> Orbit {
    let yaw_deg = (orbit.yaw_deg + yaw + 180.0).rem_euclid(360.0) - 180.0;
    rounded(Orbit {
        yaw_deg,
        pitch_deg: (orbit.pitch_deg + pitch).clamp(-180.0, 180.0),
        ..orbit
    })
}

pub fn nearer(orbit: Orbit, factor: f64) -> Orbit {
    let [nearest, farthest] = Orbit::DISTANCE;
    rounded(Orbit {
        distance: (orbit.distance * factor).clamp(nearest, farthest),
        ..orbit
    })
}

/// Rounds as files and flags write it.
fn rounded(orbit: Orbit) -> Orbit {
    let [yaw, pitch, distance] = orbit.numbers();
    let to = |x: f32, digits: f32| (x * digits).round() / digits;
    Orbit::new([to(yaw, 100.0), to(pitch, 100.0), to(distance, 1000.0)]).unwrap_or(orbit)
}

pub fn turn_light(state: &mut State, by: f64) {
    let old = state.point[ENVIRONMENT_ROTATION].number();
    let turned = (old + by + 180.0).rem_euclid(360.0) - 180.0;
    state.point[ENVIRONMENT_ROTATION] = Value::Number(decimal((turned * 100.0).round() / 100.0));
}

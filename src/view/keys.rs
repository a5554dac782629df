//! Keys, and the turns of camera and light.

use super::picture::Picture;
use super::state::{HOME, State};
use crate::experiment::axis::{ENVIRONMENT_ROTATION, EXPOSURE, METHOD};
use crate::experiment::value::{Value, decimal};
use crate::instrument::scene::Orbit;
use crate::instrument::shade::METHODS;
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
            match key {
                key if modifiers.command => pressed.save |= *key == Key::S,
                Key::P => *has_probe ^= true,
                Key::F | Key::F11 => pressed.fullscreen = true,
                Key::OpenBracket => stops -= 0.5,
                Key::CloseBracket => stops += 0.5,
                Key::ArrowLeft if modifiers.shift => turn_light(state, -KEY_DEG),
                Key::ArrowRight if modifiers.shift => turn_light(state, KEY_DEG),
                key => change_state(*key, state),
            }
        }
        if stops != 0.0 {
            let exposure = (state.point[EXPOSURE].number() * 2f64.powf(stops)).clamp(1e-6, 1e9);
            state.point[EXPOSURE] = Value::Number(decimal(exposure));
        }
    });
    pressed
}

/// Applies a key to picture, wipe, camera or method.
fn change_state(key: Key, state: &mut State) {
    let orbit = state.view.orbit;
    match key {
        Key::E => toggle(&mut state.picture, Picture::Error),
        Key::S => toggle(&mut state.picture, Picture::Signed),
        Key::D => state.wipe = if state.wipe == 1.0 { 0.5 } else { 1.0 },
        Key::Plus | Key::Equals => state.view.orbit = nearer(orbit, 1.0 / KEY_ZOOM),
        Key::Minus => state.view.orbit = nearer(orbit, KEY_ZOOM),
        Key::Num0 => state.view.orbit = HOME,
        Key::ArrowLeft => state.view.orbit = turned(orbit, -KEY_DEG, 0.0),
        Key::ArrowRight => state.view.orbit = turned(orbit, KEY_DEG, 0.0),
        Key::ArrowUp => state.view.orbit = turned(orbit, 0.0, KEY_DEG),
        Key::ArrowDown => state.view.orbit = turned(orbit, 0.0, -KEY_DEG),
        // Keys 1 to 9 choose a method in list order.
        key => {
            let number = key.symbol_or_name().parse::<usize>().ok();
            let index = number.and_then(|number| number.checked_sub(1));
            if let Some(method) = index.and_then(|index| METHODS.get(index)) {
                state.point[METHOD] = Value::Text(method.name.to_owned().into());
            }
        }
    }
}

/// Shows a picture, or the image again.
fn toggle(picture: &mut Picture, wanted: Picture) {
    *picture = if *picture == wanted {
        Picture::Image
    } else {
        wanted
    };
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

/// Multiplies the distance, in its limits.
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
    let round = |x: f32, parts: f32| (x * parts).round() / parts;
    Orbit::new([
        round(yaw, 100.0),
        round(pitch, 100.0),
        round(distance, 1000.0),
    ])
    .unwrap_or(orbit)
}

/// Turns the environment by degrees.
pub fn turn_light(state: &mut State, by: f64) {
    let old = state.point[ENVIRONMENT_ROTATION].number();
    let turned = (old + by + 180.0).rem_euclid(360.0) - 180.0;
    state.point[ENVIRONMENT_ROTATION] = Value::Number(decimal((turned * 100.0).round() / 100.0));
}

//! Detects a missing library of the display, and the end of the X server. Xlib exits with code 1, winit panics, or the window's surface is lost.

use std::ffi::c_int;
use std::sync::OnceLock;
use x11_dl::xlib::{Display, Xlib};

/// Set if a server answered at the start.
static LAST_WORDS: OnceLock<fn() -> u8> = OnceLock::new();

unsafe extern "C" {
    // Skips destructors of libraries whose threads are still running.
    safe fn _exit(code: c_int) -> !;
}

/// Ends the program if Xlib or a panic shows that the X server has ended, with the exit code of `last_words`.
pub fn when_server_ends(last_words: fn() -> u8) {
    if !answers() || LAST_WORDS.set(last_words).is_err() {
        return;
    }
    let Ok(xlib) = Xlib::open() else { return };
    // SAFETY: the handler does not return, as Xlib demands, and needs nothing that Xlib owns.
    unsafe { (xlib.XSetIOErrorHandler)(Some(on_io_error)) };
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if has_server_ended() {
            end();
        }
        report(panic);
    }));
}

/// Returns whether the server that answered in [`when_server_ends`] has ended.
pub fn has_server_ended() -> bool {
    LAST_WORDS.get().is_some() && !answers()
}

/// Returns whether a connection to the server in DISPLAY can be opened.
fn answers() -> bool {
    let Ok(xlib) = Xlib::open() else { return false };
    // SAFETY: called before this process opens a connection, and harmless afterwards.
    unsafe { (xlib.XInitThreads)() };
    // SAFETY: a null name means DISPLAY.
    let connection = unsafe { (xlib.XOpenDisplay)(std::ptr::null()) };
    if connection.is_null() {
        return false;
    }
    // SAFETY: the connection was opened above, and nothing else uses it.
    unsafe { (xlib.XCloseDisplay)(connection) };
    true
}

extern "C" fn on_io_error(_: *mut Display) -> c_int {
    end()
}

fn end() -> ! {
    _exit(LAST_WORDS.get().map_or(1, |last_words| last_words()).into())
}

/// Names a library that winit loads and panics without.
pub fn missing_library() -> Option<String> {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let is_x11 = is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY") && !is_set("WAYLAND_SOCKET");
    let (library, package) = if xkbcommon_dl::xkbcommon_option().is_none() {
        ("libxkbcommon", "libxkbcommon0")
    } else if is_x11 && xkbcommon_dl::x11::xkbcommon_x11_option().is_none() {
        ("libxkbcommon-x11", "libxkbcommon-x11-0")
    } else {
        return None;
    };
    Some(format!(
        "the window needs the library {library}: install the package {package} (its name on Debian and Ubuntu)"
    ))
}

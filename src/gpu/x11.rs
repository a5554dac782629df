//! The end of the X server: Xlib ends the program itself, with code 1, and can only be asked to do so otherwise.

use std::ffi::c_int;
use std::sync::OnceLock;
use x11_dl::xlib::{Display, Xlib};

static LAST_WORDS: OnceLock<fn() -> u8> = OnceLock::new();

unsafe extern "C" {
    // Without the destructors of libraries whose threads are at work.
    safe fn _exit(code: c_int) -> !;
}

/// Where the connection to the X server breaks, calls `last_words` and ends the program with the code that it gives.
pub fn when_server_ends(last_words: fn() -> u8) {
    // Where there is no Xlib, there is no connection.
    let Ok(xlib) = Xlib::open() else { return };
    if LAST_WORDS.set(last_words).is_ok() {
        // SAFETY: the handler does not return, as Xlib demands, and needs nothing that Xlib owns.
        unsafe { (xlib.XSetIOErrorHandler)(Some(end)) };
    }
}

extern "C" fn end(_: *mut Display) -> c_int {
    _exit(LAST_WORDS.get().map_or(1, |last_words| last_words()).into())
}

// SPDX-License-Identifier: MIT
//! Messages of the library.
use crate::error::{check, wrong};
use crate::{sys, Result};
use std::{ffi::CStr, ffi::CString, os::raw::c_char, os::raw::c_void, ptr};

/// How grave a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LogLevel {
    /// For those who look for a fault.
    Debug = 0,
    /// Nothing is wrong.
    Info = 1,
    /// Something may be wrong.
    Warning = 2,
    /// Something is wrong.
    Error = 3,
}

/// A function that takes messages, on any thread.
pub type Logger = fn(LogLevel, &str);

unsafe extern "C" fn forward(user: *mut c_void, level: u32, message: *const c_char) {
    let logger: Logger = std::mem::transmute(user);
    let level = [LogLevel::Debug, LogLevel::Info, LogLevel::Warning, LogLevel::Error][level.min(3) as usize];
    let message = CStr::from_ptr(message).to_string_lossy();
    // The library cannot be unwound: what a logger panics with has been printed.
    let _ = std::panic::catch_unwind(|| logger(level, &message));
}

/// Sends the library's messages to a function; `None`: warnings and errors to stderr, as at the start.
///
/// # Safety
/// No other thread calls the library at the same time.
pub unsafe fn set_logger(logger: Option<Logger>) {
    match logger {
        Some(logger) => sys::crofton_set_log_hook(Some(forward), logger as *mut c_void),
        None => sys::crofton_set_log_hook(None, ptr::null_mut()),
    };
}

/// Sends a message to where the library's go.
pub fn log(level: LogLevel, message: &str) -> Result<()> {
    let message = CString::new(message).map_err(|_| wrong("a message has a 0 within"))?;
    check(unsafe { sys::crofton_log(level as u32, message.as_ptr()) })
}

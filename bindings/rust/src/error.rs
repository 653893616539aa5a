// SPDX-License-Identifier: MIT
use crate::sys;
use std::{ffi::CStr, fmt};

/// An error: its kind, a message, and the item of the input that caused it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// The kind of failure.
    pub status: Status,
    /// Says what is wrong and what to do.
    pub message: String,
    /// The index of the first invalid item of the input, if one item caused the error.
    pub item: Option<u64>,
}

/// The result of the functions of this crate.
pub type Result<T> = std::result::Result<T, Error>;

macro_rules! statuses {
    ($($name:ident = $number:literal, $text:literal;)*) => {
        /// The kinds of failure; their numbers are those of the C API.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Status {
            $(#[doc = $text] $name = $number,)*
        }
        fn to_status(number: i32) -> Status {
            match number {
                $($number => Status::$name,)*
                _ => Status::Internal,
            }
        }
    };
}
statuses! {
    InvalidArgument = 1, "A parameter outside its documented range.";
    NonFinite = 2, "NaN or infinity where a finite number is needed.";
    OutOfRange = 3, "An index or a size beyond its limit.";
    Degenerate = 4, "Geometry without the extent or rank that the operation needs.";
    Empty = 5, "Nothing to work on.";
    Unsupported = 6, "Well-formed, but not something the library handles.";
    Io = 7, "A file could not be read or written.";
    Parse = 8, "A file's contents are damaged or not of its format.";
    Cancelled = 9, "A callback asked to stop.";
    BudgetExceeded = 10, "A budget of time or memory ran out before any usable result.";
    Unavailable = 11, "A device or driver is missing.";
    StaleHandle = 12, "A handle of something that has been removed.";
    Internal = 13, "A mistake of the library: please report it.";
    BadHandle = 14, "A handle that is none; not from safe code.";
    WrongSize = 15, "This crate and the library do not fit together.";
    Busy = 16, "Another thread is using the handle; not from safe code.";
    OutOfMemory = 17, "There was no memory; the call changed nothing.";
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        match self.item {
            Some(item) => write!(f, " (item {item})"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for Error {}

/// Turns a status of the C API into a result, with the library's message.
pub(crate) fn check(status: sys::Status) -> Result<()> {
    if status == 0 {
        return Ok(());
    }
    // The text stays valid until this thread's next failed call.
    let text = unsafe { CStr::from_ptr(sys::crofton_last_error()) };
    let item = unsafe { sys::crofton_last_error_item() };
    Err(Error {
        status: to_status(status),
        message: text.to_string_lossy().into_owned(),
        item: (item != u64::MAX).then_some(item),
    })
}

pub(crate) fn wrong(message: &str) -> Error {
    Error { status: Status::InvalidArgument, message: message.to_owned(), item: None }
}

/// Makes a slice of an answer; the library returns NULL for an empty one.
///
/// # Safety
/// `first` is NULL or points to `count` values that live as long as `'a`.
pub(crate) unsafe fn slice<'a, T>(first: *const T, count: usize) -> &'a [T] {
    if first.is_null() || count == 0 {
        return &[];
    }
    std::slice::from_raw_parts(first, count)
}

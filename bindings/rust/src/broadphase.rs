// SPDX-License-Identifier: MIT
//! All pairs of many boxes that move, without a World.
use crate::error::{check, slice, wrong};
use crate::jobs::with_jobs;
use crate::{sys, Executor, Obb, Result};
use std::ptr;

/// Finds all pairs of boxes that overlap, exactly, and those that are new or gone.
///
/// ```
/// use crofton::{Broadphase, Obb, Pair, Pairs};
/// # fn main() -> Result<(), crofton::Error> {
/// let boxes: Vec<_> = (0..3).map(|i| Obb::aligned([1.5 * i as f64, 0.0, 0.0], [1.0; 3])).collect();
/// let mut broadphase = Broadphase::new()?;
/// broadphase.update(None, &boxes, None)?;
/// assert_eq!(broadphase.pairs(Pairs::All)?, [Pair { first: 0, second: 1 }, Pair { first: 1, second: 2 }]);
/// # Ok(()) }
/// ```
pub struct Broadphase {
    raw: *mut sys::Broadphase,
}

unsafe impl Send for Broadphase {}
unsafe impl Sync for Broadphase {}

impl Drop for Broadphase {
    fn drop(&mut self) {
        unsafe { sys::crofton_broadphase_destroy(self.raw) };
    }
}

/// Two items form a pair only if each shares a layer with the other's `collides_with`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Filter {
    /// The layers that the item is in.
    pub layers: u32,
    /// The layers that it collides with.
    pub collides_with: u32,
}

/// Two items; `first < second`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Pair {
    /// The place of one.
    pub first: u32,
    /// The place of the other.
    pub second: u32,
}

/// Which pairs to list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pairs {
    /// Those that overlap.
    All = 0,
    /// Those that did not in the update before.
    Began = 1,
    /// Those that did.
    Stayed = 2,
    /// Those that did and no longer do.
    Ended = 3,
}

impl Broadphase {
    /// Returns one without boxes.
    pub fn new() -> Result<Broadphase> {
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_broadphase_create(&mut raw) })?;
        Ok(Broadphase { raw })
    }
    /// Finds all pairs. `boxes[i]` is the same item as in the update before; `filters`: one for each, or none.
    pub fn update(&mut self, executor: Option<&dyn Executor>, boxes: &[Obb], filters: Option<&[Filter]>) -> Result<()> {
        if filters.map_or(false, |f| f.len() != boxes.len()) {
            return Err(wrong("the two slices are to be of one length"));
        }
        let filters = filters.map_or(ptr::null(), |f| f.as_ptr());
        check(with_jobs(executor, |jobs| unsafe {
            sys::crofton_broadphase_update(self.raw, boxes.as_ptr(), filters, boxes.len(), jobs)
        }))
    }
    /// Returns pairs of the last update, in order.
    pub fn pairs(&self, which: Pairs) -> Result<&[Pair]> {
        let (mut pairs, mut count) = (ptr::null(), 0);
        check(unsafe { sys::crofton_broadphase_pairs(self.raw, which as u32, &mut pairs, &mut count) })?;
        Ok(unsafe { slice(pairs, count) })
    }
}

// SPDX-License-Identifier: MIT
use crate::sys;
use std::{mem::size_of, os::raw::c_void, sync::atomic::AtomicUsize, sync::atomic::Ordering};

/// Your job system. Results do not depend on it: any executor gives the same bits.
///
/// # Safety
/// `parallel_for` calls `task(begin, end, worker)` once for each of the ranges `[0, grain)`, `[grain, 2 * grain)`, … of
/// `[0, count)`, the last one cut short, and returns when all calls are done. `worker < concurrency()`, and no two
/// calls
/// run at once with one `worker`. It must not panic: the library cannot be unwound, so a panic ends the program.
pub unsafe trait Executor {
    /// At least 1.
    fn concurrency(&self) -> u32;
    /// Calls `task` for all ranges; see the trait's safety section.
    fn parallel_for(&self, count: usize, grain: usize, task: &(dyn Fn(usize, usize, u32) + Sync));
}

/// A number of threads, started in each call; fewer if the system starts no more. A game should use its own job system.
pub struct Threads(
    /// 0 counts as 1, more than 1024 as 1024.
    pub u32,
);

unsafe impl Executor for Threads {
    fn concurrency(&self) -> u32 {
        self.0.clamp(1, 1024)
    }

    fn parallel_for(&self, count: usize, grain: usize, task: &(dyn Fn(usize, usize, u32) + Sync)) {
        let ranges = if count == 0 { 0 } else { (count - 1) / grain + 1 };
        let next = AtomicUsize::new(0); // range: places would pass the largest number where the grain is large
        let work = |worker: u32| loop {
            let range = next.fetch_add(1, Ordering::Relaxed);
            if range >= ranges {
                break;
            }
            let begin = range * grain;
            task(begin, begin + grain.min(count - begin), worker);
        };
        std::thread::scope(|scope| {
            for worker in 1..self.concurrency() {
                let work = &work;
                if std::thread::Builder::new().spawn_scoped(scope, move || work(worker)).is_err() {
                    break;
                }
            }
            work(0);
        });
    }
}

/// Calls `function` with the executor as a C struct, or with NULL.
pub(crate) fn with_jobs<T>(executor: Option<&dyn Executor>, function: impl FnOnce(*const sys::Jobs) -> T) -> T {
    match executor {
        None => function(std::ptr::null()),
        Some(executor) => {
            let user = &executor as *const &dyn Executor as *mut c_void;
            let concurrency = executor.concurrency();
            function(&sys::Jobs { size: size_of::<sys::Jobs>(), user, concurrency, parallel_for })
        }
    }
}

/// Lets other threads use the library's task and its data.
struct Task(sys::RangeTask, *mut c_void);
unsafe impl Sync for Task {}

unsafe extern "C" fn parallel_for(
    user: *mut c_void, count: usize, grain: usize, task: sys::RangeTask, data: *mut c_void,
) {
    let task = Task(task, data);
    let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        let executor = &**(user as *const &dyn Executor);
        let task = &task;
        executor.parallel_for(count, grain, &move |begin, end, worker| (task.0)(task.1, begin, end, worker));
    }));
    if result.is_err() {
        eprintln!("crofton: an executor panicked, and the work that it was given cannot be taken back");
        std::process::abort();
    }
}

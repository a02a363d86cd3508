//! The clock of the benches: the CPU time of the process, all threads together.
//!
//! On a machine that others use as well, wall time tells as much about them as about us. Where
//! the system has no such clock it is wall time all the same.

use std::time::Duration;

/// Lets everything run on one thread, so that times are those of one core.
#[allow(dead_code, reason = "not every bench stays on one core")]
pub(crate) fn one_thread() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    pool.build_global().expect("nothing has run side by side yet");
}

/// A moment on the clock.
#[derive(Clone, Copy)]
pub(crate) struct Moment(Duration);

impl Moment {
    /// This moment.
    pub(crate) fn now() -> Self {
        Self(now())
    }

    /// How much later it is by now.
    pub(crate) fn elapsed(self) -> Duration {
        now().saturating_sub(self.0)
    }
}

#[cfg(unix)]
fn now() -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec as u32)
}

#[cfg(not(unix))]
fn now() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

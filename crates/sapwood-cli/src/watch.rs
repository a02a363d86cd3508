//! Whoever watches a run: shows on a terminal how far it is, and passes on the wish to stop.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use sapwood::geom::UnionStep;
use sapwood::scene::CancelToken;

use crate::failure::Failure;

/// Runs shorter than this show nothing.
const PATIENCE: Duration = Duration::from_millis(200);
/// The interrupt that is not waited for any more; people press twice without meaning it.
const LAST: u32 = 3;
/// Time between two pictures of the progress.
const TICK: Duration = Duration::from_millis(100);

/// A share of something: how it is shown.
const BAR: &str = "{msg} [{bar:40}] {percent:>3} %, {eta} to go";

/// Follows a run; clones follow the same one. By default nothing is shown and nobody stops it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Watch {
    progress: Option<Progress>,
    wish: Wish,
}

impl Watch {
    /// Follows the run of this process: an interrupt, or a request to terminate, ends it at its next
    /// check, so that it takes its temporary files along; a third one ends it at once, and they
    /// stay. Progress is shown on standard error if that is wanted.
    pub(crate) fn of_process(shows_progress: bool) -> Self {
        let wish = Wish::default();
        let told = wish.clone();
        let handler = move || {
            if told.is_pressed() {
                std::process::exit(i32::from(Failure::INTERRUPTED));
            }
        };
        // Where signals cannot be caught they end the process, as they always did.
        if let Err(error) = ctrlc::set_handler(handler.clone()) {
            tracing::debug!(%error, "interrupts are not caught");
        }
        #[cfg(unix)]
        if let Err(error) = catch_termination(handler) {
            tracing::debug!(%error, "requests to terminate are not caught");
        }
        Self { progress: shows_progress.then(Progress::new), wish }
    }

    /// From now on the wish to stop is passed to this token.
    pub(crate) fn follow(&self, token: CancelToken) {
        self.wish.follow(token);
    }

    /// Fails once somebody wants the run to stop.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        if self.wish.is_uttered() { Err(Failure::interrupted()) } else { Ok(()) }
    }

    /// Tells that so many components have been compiled.
    pub(crate) fn compiled(&self, n_components: u64) {
        if let Some(progress) = &self.progress {
            progress.show(format!("growing: {n_components} components"));
        }
    }

    /// Tells how much of a file is written, and whether to go on.
    pub(crate) fn written(&self, path: &Path, bytes: u64) -> ControlFlow<()> {
        if let Some(progress) = &self.progress {
            progress.show(format!("writing {}: {} MB", path.display(), bytes / 1_000_000));
        }
        if self.wish.is_uttered() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Tells how many pixels are drawn, and whether to go on.
    pub(crate) fn drawn(&self, n_done: u64, n_pixels: u64) -> ControlFlow<()> {
        if let Some(progress) = &self.progress {
            progress.show_share(n_done, n_pixels, "drawing");
        }
        if self.wish.is_uttered() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Tells how far welding has come, and whether to go on.
    pub(crate) fn welded(&self, step: UnionStep, n_solids: usize) -> ControlFlow<()> {
        if let Some(progress) = &self.progress {
            let n = n_solids as u64;
            match step {
                UnionStep::Checked { parts } => progress.show_share(parts as u64, n, "checking"),
                UnionStep::Joined { parts } => {
                    progress.show(format!("welding: {parts} of {n_solids} stems"));
                }
            }
        }
        if self.wish.is_uttered() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Takes away what is shown.
    pub(crate) fn done(&self) {
        if let Some(progress) = &self.progress {
            progress.bar.finish_and_clear();
        }
    }
}

/// Calls `handler` at each request to terminate, as service managers and time limits send it. The
/// crate that catches interrupts could do this too, but would then also catch hangups, which a run
/// may have been started to outlive (`nohup`).
#[cfg(unix)]
fn catch_termination(handler: impl Fn() + Send + 'static) -> std::io::Result<()> {
    let mut signals = signal_hook::iterator::Signals::new([signal_hook::consts::SIGTERM])?;
    let wait = move || signals.forever().for_each(|_| handler());
    std::thread::Builder::new().name("termination".to_owned()).spawn(wait).map(drop)
}

/// One line on standard error that changes.
#[derive(Clone, Debug)]
struct Progress {
    bar: ProgressBar,
    start: Instant,
}

impl Progress {
    fn new() -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        bar.set_style(ProgressStyle::default_spinner());
        Self { bar, start: Instant::now() }
    }

    /// Shows something of which nobody knows how long it takes.
    fn show(&self, message: String) {
        if !self.is_shown() {
            return;
        }
        if self.bar.length().is_some() {
            self.bar.unset_length();
            self.bar.set_style(ProgressStyle::default_spinner());
        }
        self.bar.set_message(message);
    }

    /// Shows how much of something is done.
    fn show_share(&self, n_done: u64, n: u64, message: &'static str) {
        if !self.is_shown() {
            return;
        }
        if self.bar.length() != Some(n) {
            let style = ProgressStyle::with_template(BAR).expect("the template is sound");
            self.bar.set_style(style.progress_chars("##-"));
            self.bar.set_length(n);
        }
        self.bar.set_message(message);
        self.bar.set_position(n_done);
    }

    /// Whether the run has taken long enough for progress to be shown, which it then is.
    fn is_shown(&self) -> bool {
        if self.start.elapsed() < PATIENCE {
            return false;
        }
        if self.bar.is_hidden() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            self.bar.enable_steady_tick(TICK);
        }
        true
    }
}

/// The wish to stop, and whom to tell of it.
#[derive(Clone, Debug, Default)]
struct Wish {
    uttered: CancelToken,
    followed: Arc<Mutex<CancelToken>>,
    n_interrupts: Arc<AtomicU32>,
}

impl Wish {
    /// Takes an interrupt; tells whether it is the one that ends the process at once.
    fn is_pressed(&self) -> bool {
        self.utter();
        self.n_interrupts.fetch_add(1, Ordering::Relaxed) + 1 >= LAST
    }

    fn utter(&self) {
        self.uttered.cancel();
        self.followed.lock().unwrap_or_else(|broken| broken.into_inner()).cancel();
    }

    fn is_uttered(&self) -> bool {
        self.uttered.is_cancelled()
    }

    fn follow(&self, token: CancelToken) {
        let mut followed = self.followed.lock().unwrap_or_else(|broken| broken.into_inner());
        *followed = token;
        // The wish may have been uttered while nobody was told.
        if self.is_uttered() {
            followed.cancel();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wish_reaches_whoever_is_followed_before_or_after() {
        let watch = Watch::default();
        let (first, second) = (CancelToken::default(), CancelToken::default());
        watch.follow(first.clone());
        assert!(watch.check().is_ok() && watch.written(Path::new("a"), 0).is_continue());
        watch.wish.utter();
        watch.follow(second.clone());
        assert!(first.is_cancelled() && second.is_cancelled());
        assert!(watch.check().is_err() && watch.clone().written(Path::new("a"), 0).is_break());
    }

    #[test]
    fn a_second_interrupt_waits_like_the_first() {
        let watch = Watch::default();
        let pressed = [1, 2, 3].map(|_| (watch.wish.is_pressed(), watch.check().is_err()));
        assert_eq!(pressed, [(false, true), (false, true), (true, true)]);
    }
}

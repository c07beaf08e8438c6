//! How far a render is: a bar on a terminal, a line for each tenth elsewhere.

use crate::say::say;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::{
    io::{IsTerminal, stderr},
    sync::{
        OnceLock,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

/// A picture that is done sooner needs no bar.
const BAR_AFTER: Duration = Duration::from_millis(250);
/// A picture that is done sooner needs no lines.
const LINES_AFTER: Duration = Duration::from_secs(1);

/// Shows the progress of one render on standard error.
pub(crate) struct Progress {
    start: Instant,
    style: Style,
    /// Whether pixels are finished one after the other, so that their rate means something.
    by_pixels: bool,
}

enum Style {
    Silent,
    Bar(OnceLock<ProgressBar>),
    /// The last tenth that was said.
    Lines(AtomicU64),
}

impl Progress {
    pub(crate) fn new(quiet: bool, by_pixels: bool) -> Self {
        let style = match (quiet, stderr().is_terminal()) {
            (true, _) => Style::Silent,
            (false, true) => Style::Bar(OnceLock::new()),
            (false, false) => Style::Lines(AtomicU64::new(0)),
        };
        Self {
            start: Instant::now(),
            style,
            by_pixels,
        }
    }

    /// To be called from any thread with the pixels that are done.
    pub(crate) fn update(&self, done: u64, total: u64) {
        let elapsed = self.start.elapsed();
        match &self.style {
            Style::Silent => {}
            Style::Bar(bar) if elapsed >= BAR_AFTER => {
                bar.get_or_init(|| self.new_bar(total)).set_position(done);
            }
            Style::Lines(said) if elapsed >= LINES_AFTER => self.say_tenth(said, done, total),
            Style::Bar(_) | Style::Lines(_) => {}
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        if let Style::Bar(bar) = &self.style
            && let Some(bar) = bar.get()
        {
            bar.finish_and_clear();
        }
    }

    fn new_bar(&self, total: u64) -> ProgressBar {
        let style = ProgressStyle::with_template(if self.by_pixels {
            "{percent:>3}% [{bar:40}] {human_pos} px, {per_sec}, {eta} left"
        } else {
            "{percent:>3}% [{bar:40}] {eta} left"
        });
        ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr())
            .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
            .with_elapsed(self.start.elapsed())
    }

    fn say_tenth(&self, said: &AtomicU64, done: u64, total: u64) {
        let tenth = 10 * done / total.max(1);
        // Only the thread that raises the number says it.
        if tenth < 10 && said.fetch_max(tenth, Ordering::Relaxed) < tenth {
            let elapsed = self.start.elapsed().as_secs_f64();
            let rate = done as f64 / elapsed;
            let left = (total - done) as f64 / rate;
            let speed = if self.by_pixels {
                format!(" {:.2} Mpixels/s", rate / 1e6)
            } else {
                String::new()
            };
            say(&format!("{}%{speed}, {left:.0} s left", 10 * tenth));
        }
    }
}

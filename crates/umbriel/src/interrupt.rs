//! Ctrl-C: the first saves what is done, the second ends at once.

use crate::{errors::Exit, say::say};
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

/// Set by the first Ctrl-C during a render, or by SIGTERM.
pub(crate) static STOP: AtomicBool = AtomicBool::new(false);

/// What an interrupt finds.
#[derive(Clone, Copy)]
#[repr(u8)]
pub(crate) enum Phase {
    /// Nothing to save: ends at once.
    Waiting,
    /// Part of a picture: stops the render, which saves it; a second interrupt ends at once.
    Rendering,
    /// A picture being written: lets that finish.
    Writing,
}

static PHASE: AtomicU8 = AtomicU8::new(Phase::Waiting as u8);

/// Says what an interrupt should find from now on.
pub(crate) fn enter(phase: Phase) {
    PHASE.store(phase as u8, Ordering::SeqCst);
}

/// Whether an interrupt has been seen.
pub(crate) fn stopped() -> bool {
    STOP.load(Ordering::SeqCst)
}

/// Catches interrupts from now on. Where that is not possible they end the program as ever.
pub(crate) fn install() {
    let _ = ctrlc::set_handler(|| {
        let phase = PHASE.load(Ordering::SeqCst);
        let first = !STOP.swap(true, Ordering::SeqCst);
        let saving = phase == Phase::Writing as u8 || (first && phase == Phase::Rendering as u8);
        if !saving {
            say("error: interrupted; nothing was written");
            std::process::exit(Exit::Interrupted as i32);
        }
    });
}

//! `tempco workbench`: a page on this computer over the functions that the commands call.
//!
//! ```text
//! browser ─▶ guard ─▶ server ─▶ verb/… ─▶ job: the command's own function, on a thread
//!    ▲                             └────────▶ session ◀────┘  what there is: campaign, models, answers
//!    └──────── events ◀── shared ◀─────────────┘
//! ```
//!
//! The page draws and asks; it computes no figure. Every action is a command that can be typed instead, and shows it.
//! `docs/workbench.md` has the tour, and what keeps other pages and users out.

mod assets;
mod commands;
mod entry;
mod events;
mod guard;
mod job;
mod json;
mod launch;
mod measured;
mod places;
mod refusal;
mod samples;
mod server;
mod session;
mod shared;
mod shelved;
mod start;
mod uploads;
mod verb;
mod view;

pub use server::serve;
pub use start::Workbench;

use crate::data::Data;
use std::path::PathBuf;

/// What a workbench is started with.
pub struct Settings {
    /// For everything that is made.
    pub folder: PathBuf,
    /// On 127.0.0.1; 0 takes any.
    pub port: u16,
    /// Whether to open a browser.
    pub open: bool,
    /// What is there when the page opens.
    pub first: First,
}

/// What is there when the page opens.
pub enum First {
    /// The user's campaign.
    Data(Data),
    /// A blind one, simulated.
    Demo {
        /// Of every random number, and of what is hidden.
        seed: u64,
    },
}

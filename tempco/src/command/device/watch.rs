//! What `monitor` and `raw` share: a stream that is watched until somebody has enough.

use super::target::Target;
use crate::failure::{Answer, Failure};
use crate::link::AnyLink;
use crate::terminal::{remark, say};
use clap::Args;
use firmware_sim::link::Unasked;
use protocol::Streamed;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How fast, and how long.
#[derive(Args)]
pub struct Pace {
    /// Time from one to the next, ms; the counter's gate is a second long
    #[arg(long, value_name = "MS", default_value_t = 1000)]
    every_ms: u32,

    /// Ends after so many; without it Ctrl-C ends
    #[arg(long, value_name = "N")]
    count: Option<u64>,
}

/// A line may be silent for so many periods, and this long at least, before the instrument counts as gone.
const SILENT_PERIODS: u32 = 3;
const SILENT_FOR: Duration = Duration::from_secs(3);

/// Streams, prints each message with `print`, says what was lost, and stops the stream at the end.
pub fn watch(
    target: &Target,
    pace: &Pace,
    what: Streamed,
    mut print: impl FnMut(&Unasked) -> String,
) -> Result<Answer, Failure> {
    let enough = interrupted()?;
    let mut link = target.port.connect()?;
    link.stream(what, pace.every_ms)?;
    let patience = SILENT_FOR.max(Duration::from_millis(u64::from(pace.every_ms)) * SILENT_PERIODS);
    let (mut seen, mut expected) = (0, 0);
    while !enough.load(Ordering::Relaxed) && pace.count.is_none_or(|count| seen < count) {
        let Some(message) = next(&mut link, &enough, patience)? else {
            if enough.load(Ordering::Relaxed) {
                break;
            }
            remark!("nothing came for {} s; beginning again", patience.as_secs());
            link.begin();
            link.stream(what, pace.every_ms)?;
            expected = 0;
            continue;
        };
        if message.number > expected {
            remark!("{} lost on the way", message.number - expected);
        }
        expected = message.number.wrapping_add(1);
        seen += 1;
        let text = print(&message);
        if let Err(failure) = say!("{text}") {
            link.stop()?;
            // A reader that went away has had enough.
            return if failure.is_nobody_reads() { Ok(Answer::Yes) } else { Err(failure) };
        }
    }
    link.stop()?;
    Ok(Answer::Yes)
}

#[expect(clippy::disallowed_methods, reason = "waiting for a person's instrument takes a clock")]
fn next(link: &mut AnyLink, enough: &AtomicBool, patience: Duration) -> Result<Option<Unasked>, Failure> {
    let begun = Instant::now();
    while begun.elapsed() < patience && !enough.load(Ordering::Relaxed) {
        if let Some(message) = link.next_unasked()? {
            return Ok(Some(message));
        }
    }
    Ok(None)
}

/// Becomes true with Ctrl-C.
pub fn interrupted() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&flag);
    ctrlc::set_handler(move || raised.store(true, Ordering::Relaxed)).map_err(Failure::new)?;
    Ok(flag)
}

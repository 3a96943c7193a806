//! `tempco device status PORT`

use super::target::Target;
use crate::digits::digits;
use crate::failure::{Answer, Failure};
use crate::render::status::{names, words};
use crate::terminal::say;
use clap::Args;
use protocol::{InstrumentState, Source, StorageState};

/// Asks an instrument how it is: its calibration, its storage, and every flag since power-on.
///
/// Exit code 1 if it is uncalibrated.
#[derive(Args)]
#[command(after_help = "Example:  tempco device status tcp:127.0.0.1:7000 --json")]
pub struct Status {
    #[command(flatten)]
    target: Target,
}

impl Status {
    pub fn run(&self) -> Result<Answer, Failure> {
        let mut link = self.target.port.connect()?;
        let (state, storage) = (link.state()?, link.storage()?);
        if self.target.json {
            say!("{:#}", json(&state, &storage))?;
        } else {
            say!("{}", text(&state, &storage).trim_end())?;
        }
        Ok(if storage.source == Source::Nothing { Answer::No } else { Answer::Yes })
    }
}

fn text(state: &InstrumentState, storage: &StorageState) -> String {
    let name = state.provenance.map(|provenance| digits(&provenance)).unwrap_or_default();
    let calibration = match storage.source {
        Source::Nothing => "none: every reading is without a number".to_owned(),
        Source::Factory => format!("{name}, put into flash by a programmer"),
        Source::Committed => format!("{name}, number {} of those sent over the wire", storage.sequence),
        Source::UntilPowerOff => format!("{name}, in RAM until power-off: storing it failed"),
    };
    let back = if storage.can_roll_back { "there is one to go back to" } else { "there is none to go back to" };
    let key = match storage.key {
        None => "not asked for".to_owned(),
        Some(key) => format!("asked for, by the key {}…", digits(&key)),
    };
    let [first, second] = storage.erases;
    format!(
        "calibration  {calibration}\nbefore it    {back}\nsignature    {key}\nerases       {first} and {second} of each \
         slot\nreadings     {} since power-on; raised: {}\n",
        state.readings,
        words(state.raised)
    )
}

fn json(state: &InstrumentState, storage: &StorageState) -> serde_json::Value {
    let source = match storage.source {
        Source::Nothing => "nothing",
        Source::Factory => "factory",
        Source::Committed => "committed",
        Source::UntilPowerOff => "until-power-off",
    };
    serde_json::json!({
        "calibration": state.provenance.map(|provenance| digits(&provenance)),
        "source": source, "sequence": storage.sequence, "can_roll_back": storage.can_roll_back,
        "erases": storage.erases, "key": storage.key.map(|key| digits(&key)),
        "readings": state.readings, "raised": names(state.raised),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::Status as Flags;

    const STATE: InstrumentState = InstrumentState { provenance: Some([0xAB; 8]), readings: 12, raised: Flags::STALE };
    const STORAGE: StorageState =
        StorageState { source: Source::Committed, sequence: 3, can_roll_back: true, erases: [4, 5], key: None };

    #[test]
    fn an_instruments_state_is_told_in_five_lines() {
        assert_eq!(
            text(&STATE, &STORAGE),
            "calibration  abababababababab, number 3 of those sent over the wire\nbefore it    there is one to go back \
             to\nsignature    not asked for\nerases       4 and 5 of each slot\nreadings     12 since power-on; raised: \
             stale\n"
        );
        let locked = StorageState { can_roll_back: false, key: Some([0x10; 8]), ..STORAGE };
        let text = text(&STATE, &locked);
        assert!(text.contains("there is none to go back to"), "{text}");
        assert!(text.contains("asked for, by the key 1010101010101010…"), "{text}");
    }

    #[test]
    fn where_a_calibration_comes_from_is_told_to_people_and_to_programs() {
        for (source, words, word) in [
            (Source::Nothing, "none: every reading is without a number", "nothing"),
            (Source::Factory, "abababababababab, put into flash by a programmer", "factory"),
            (Source::UntilPowerOff, "abababababababab, in RAM until power-off: storing it failed", "until-power-off"),
        ] {
            let storage = StorageState { source, ..STORAGE };
            assert!(text(&STATE, &storage).starts_with(&format!("calibration  {words}\n")));
            assert_eq!(json(&STATE, &storage)["source"], word);
        }
        let value = json(&STATE, &STORAGE);
        let expected = serde_json::json!({
            "calibration": "abababababababab", "source": "committed", "sequence": 3, "can_roll_back": true,
            "erases": [4, 5], "key": null, "readings": 12, "raised": ["stale"],
        });
        assert_eq!(value, expected);
    }
}

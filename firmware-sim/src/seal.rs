//! The sealed envelope of a blind test: what a campaign hides, not readable by eye, bound to the campaign.
//!
//! This keeps an honest person from seeing the answer by accident. It is no secret from a dishonest one: the key is
//! in the envelope.

use std::fmt;

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use crate::scenario::Scenario;
use crate::twin::random::Random;

/// What a blind campaign hides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SealedTruth {
    /// The seed that chose what to hide.
    pub blind_seed: u64,
    /// The noise behind a perfect static compensation of this campaign, µg.
    pub noise_floor_ug: f64,
    /// The effects that were added, strongest first. None is an answer too.
    #[serde(default)]
    pub hidden: Vec<HiddenEffect>,
    /// The scenario as it was measured, with the hidden effects.
    pub scenario: Scenario,
}

/// An effect that a blind campaign hides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HiddenEffect {
    /// Its name; its parameters are in the scenario.
    pub name: String,
    /// Scatter that it alone leaves behind a perfect static compensation, µg.
    pub influence_ug: f64,
    /// The same in units of the noise.
    pub times_noise: f64,
}

/// The fingerprint of a campaign: SHA-256 over its files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CampaignDigest([u8; 32]);

impl CampaignDigest {
    /// The fingerprint of the contents of the campaign's files, in the order of their names.
    pub fn of(files: impl IntoIterator<Item = impl AsRef<[u8]>>) -> Self {
        let mut hash = Sha256::new();
        for file in files {
            // The length keeps a line from wandering between files unnoticed.
            hash.update((file.as_ref().len() as u64).to_le_bytes());
            hash.update(file.as_ref());
        }
        Self(hash.finalize().into())
    }
}

impl fmt::Display for CampaignDigest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&to_hex(&self.0))
    }
}

/// The first line of every envelope.
pub const TITLE: &str = "tempco sealed truth 1";
const HINT: &str = "What the campaign of this name hides. `tempco reveal` opens it; do not edit it.";
const HEX_PER_LINE: usize = 96;

/// Puts the truth into an envelope for one campaign.
#[must_use]
pub fn seal(truth: &SealedTruth, campaign: &CampaignDigest) -> String {
    // Numbers, strings and tables only: serialising cannot fail.
    let plain = toml::to_string(truth).unwrap_or_default().into_bytes();
    let key = truth.blind_seed ^ u64::from_le_bytes(first_eight(&campaign.0));
    envelope(&plain, key, campaign)
}

fn envelope(plain: &[u8], key: u64, campaign: &CampaignDigest) -> String {
    let check = to_hex(&Sha256::digest(plain));
    let hex = to_hex(&masked(plain, key));
    let body: Vec<&str> = hex.as_bytes().chunks(HEX_PER_LINE).filter_map(|line| str::from_utf8(line).ok()).collect();
    format!("{TITLE}\n{HINT}\ncampaign {campaign}\nkey {key:016x}\ncheck {check}\n\n{}\n", body.join("\n"))
}

/// Opens an envelope and makes sure that it belongs to this campaign.
///
/// # Errors
/// If the text is no envelope, was changed, or belongs to another campaign.
pub fn open(text: &str, campaign: &CampaignDigest) -> Result<SealedTruth, SealError> {
    let mut lines = text.lines();
    if lines.next() != Some(TITLE) {
        return Err(SealError::NotSealed { expected: TITLE });
    }
    let mut field = |name: &'static str| {
        lines.find_map(|line| line.strip_prefix(name)?.strip_prefix(' ')).ok_or(SealError::Incomplete { missing: name })
    };
    let (sealed_for, key, check) = (field("campaign")?, field("key")?, field("check")?);
    let key =
        from_hex(key).and_then(|bytes| bytes.try_into().ok()).map(u64::from_be_bytes).ok_or(SealError::Damaged)?;
    let body: String = lines.collect();
    let plain = masked(&from_hex(&body).ok_or(SealError::Damaged)?, key);
    if to_hex(&Sha256::digest(&plain)) != check {
        return Err(SealError::Damaged);
    }
    if sealed_for != campaign.to_string() {
        return Err(SealError::OtherCampaign { sealed_for: sealed_for.into(), found: campaign.to_string() });
    }
    let plain = String::from_utf8(plain).map_err(|_| SealError::Damaged)?;
    toml::from_str(&plain).map_err(|error| SealError::OtherVersion { problem: error.message().into() })
}

/// Why an envelope does not open.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SealError {
    /// Some other file.
    #[error("this is not a sealed truth: its first line is not `{expected}`")]
    NotSealed {
        /// The line that was expected.
        expected: &'static str,
    },
    /// Cut off.
    #[error("the sealed truth has no line `{missing} …`; take the file as `tempco simulate` wrote it")]
    Incomplete {
        /// The line that is missing.
        missing: &'static str,
    },
    /// Changed after it was sealed.
    #[error("the sealed truth was changed after it was sealed; take the file as `tempco simulate` wrote it")]
    Damaged,
    /// Belongs to other data.
    #[error("the truth was sealed for the campaign {sealed_for}, but this campaign is {found}")]
    OtherCampaign {
        /// Fingerprint of the campaign it belongs to.
        sealed_for: String,
        /// Fingerprint of the campaign at hand.
        found: String,
    },
    /// Sealed by a program that knows other scenarios.
    #[error("another version of tempco sealed this truth: {problem}")]
    OtherVersion {
        /// What this version does not know.
        problem: String,
    },
}

/// XOR with a key stream; applying it twice gives the text back.
fn masked(bytes: &[u8], key: u64) -> Vec<u8> {
    let mut stream = Random::stream(key, "seal", 0);
    bytes
        .chunks(8)
        .flat_map(|chunk| {
            chunk.iter().zip(stream.bits().to_le_bytes()).map(|(byte, mask)| byte ^ mask).collect::<Vec<_>>()
        })
        .collect()
}

fn first_eight(bytes: &[u8; 32]) -> [u8; 8] {
    std::array::from_fn(|i| bytes[i])
}

fn to_hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn from_hex(text: &str) -> Option<Vec<u8>> {
    // As `to_hex` writes it and no other way: `from_str_radix` alone takes "+f" and "0F" for "0f".
    let is_digit = |byte: u8| matches!(byte, b'0'..=b'9' | b'a'..=b'f');
    if !text.bytes().all(is_digit) || !text.len().is_multiple_of(2) {
        return None;
    }
    (0..text.len()).step_by(2).map(|i| u8::from_str_radix(&text[i..i + 2], 16).ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sealed() -> (SealedTruth, CampaignDigest, String) {
        let mut scenario = Scenario::preset("clean").unwrap();
        scenario.effects.switch_on("lock-in", 1.0);
        let hidden = vec![HiddenEffect { name: "lock-in".into(), influence_ug: 300.0, times_noise: 50.0 }];
        let truth = SealedTruth { blind_seed: 9, noise_floor_ug: 6.0, hidden, scenario };
        let campaign = CampaignDigest::of([b"run,kind\n"]);
        let text = seal(&truth, &campaign);
        (truth, campaign, text)
    }

    #[test]
    fn what_is_sealed_comes_out_again_and_cannot_be_read_by_eye() {
        let (truth, campaign, text) = sealed();
        assert_eq!(open(&text, &campaign), Ok(truth));
        assert!(!text.contains("lock-in") && text.contains("tempco reveal"));
    }

    #[test]
    fn another_campaign_is_noticed() {
        let (_, _, text) = sealed();
        let other = CampaignDigest::of([b"run,kind,\n"]);
        assert!(matches!(open(&text, &other), Err(SealError::OtherCampaign { .. })));
        assert_ne!(CampaignDigest::of([b"a", b"b"].map(|file| &file[..])), CampaignDigest::of([&b"ab"[..]]));
    }

    #[test]
    fn every_changed_character_is_noticed() {
        let (_, campaign, text) = sealed();
        let begin = text.find("\ncampaign ").unwrap() + "\ncampaign ".len();
        for index in (begin..text.len()).step_by(7).filter(|i| text.as_bytes()[*i].is_ascii_hexdigit()) {
            let mut bytes = text.clone().into_bytes();
            for other in [b'0', b'1', b'+', b'F'] {
                let before = std::mem::replace(&mut bytes[index], other);
                let opened = open(str::from_utf8(&bytes).unwrap(), &campaign);
                assert!(before == other || opened.is_err(), "character {index}, {}", char::from(other));
                bytes[index] = before;
            }
        }
    }

    #[test]
    fn surplus_behind_what_was_sealed_is_noticed() {
        let (truth, campaign, text) = sealed();
        for surplus in ["00", "0", "0\n0", "\n\nff\n", "\nkey 0", " "] {
            assert_eq!(open(&format!("{text}{surplus}"), &campaign), Err(SealError::Damaged), "{surplus:?}");
        }
        // Also where whoever added it computed the checksum anew.
        let plain = toml::to_string(&truth).unwrap();
        assert_eq!(open(&envelope(plain.as_bytes(), 7, &campaign), &campaign), Ok(truth));
        for surplus in ["\0", "x", "[x]\n", "blind_seed = 1\n"] {
            let opened = open(&envelope(format!("{plain}{surplus}").as_bytes(), 7, &campaign), &campaign);
            assert!(matches!(opened, Err(SealError::OtherVersion { .. })), "{surplus:?}: {opened:?}");
        }
    }

    #[test]
    fn a_file_that_is_no_envelope_says_so() {
        let campaign = CampaignDigest::of([b""]);
        assert!(matches!(open("run,kind\n", &campaign), Err(SealError::NotSealed { .. })));
        assert_eq!(open(TITLE, &campaign), Err(SealError::Incomplete { missing: "campaign" }));
    }
}

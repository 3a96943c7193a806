//! What tempco writes, and how it knows its own files again: by their contents, since names and endings are the user's.
//!
//! A table or a scenario looks like any other of its kind, and people go on writing in them. The first line of those that
//! tempco wrote says so and holds the SHA-256 of the rest: a file that was changed since is its user's.

use crate::digits::digits;
use crate::hex::pieces;
use crate::region;
use firmware_sim::seal::TITLE;
use firmware_sim::virtual_flash::SLOT_BYTES;
use protocol::Blob;
use protocol::limits::MAX_STORED;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Everything but tables is smaller.
const HEAD_BYTES: u64 = 1 << 20;

/// What a file of tempco's is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Campaign,
    Scenario,
    Seal,
    Model,
    Calibration,
    CalibrationHex,
    Identity,
    IdentityHex,
    Report,
    Picture,
    Flash,
}

impl Kind {
    /// What it is called in a sentence.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Campaign => "a simulated campaign",
            Self::Scenario => "a scenario",
            Self::Seal => "a sealed truth",
            Self::Model => "a model",
            Self::Calibration => "a calibration",
            Self::CalibrationHex => "a calibration as Intel HEX",
            Self::Identity => "the identity of an instrument",
            Self::IdentityHex => "the identity of an instrument as Intel HEX",
            Self::Report => "a report",
            Self::Picture => "a picture",
            Self::Flash => "the flash of a virtual instrument",
        }
    }

    /// How its file's name usually ends.
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Campaign => "csv",
            Self::Scenario | Self::Model => "toml",
            Self::Seal => "sealed",
            Self::Calibration | Self::Identity => "bin",
            Self::CalibrationHex | Self::IdentityHex => "hex",
            Self::Report => "html",
            Self::Picture => "svg",
            Self::Flash => "flash",
        }
    }

    /// What this file of tempco's is; nothing if it is none.
    pub fn of(path: &Path) -> io::Result<Option<Self>> {
        let mut file = File::open(path)?;
        let mut head = Vec::new();
        file.by_ref().take(HEAD_BYTES).read_to_end(&mut head)?;
        if let Some((kind, promised, rest)) = marked(&head) {
            let mut digest = Sha256::new();
            digest.update(rest);
            let mut part = vec![0; HEAD_BYTES as usize];
            loop {
                match file.read(&mut part)? {
                    0 => break,
                    count => digest.update(part.get(..count).unwrap_or_default()),
                }
            }
            return Ok((digits(&digest.finalize()) == promised).then_some(kind));
        }
        Ok(binary(&head).or_else(|| str::from_utf8(&head).ok().and_then(text)))
    }
}

const MARK: &str = "# Written by tempco: ";
const MARKED: [Kind; 2] = [Kind::Campaign, Kind::Scenario];
const PROMISE: &str = "; SHA-256 of what follows: ";

/// A text with a first line that says what it is, and whether it still is.
pub fn with_mark(kind: Kind, text: &[u8]) -> Vec<u8> {
    let first = format!("{MARK}{}{PROMISE}{}\n", kind.title(), digits(&Sha256::digest(text)));
    [first.as_bytes(), text].concat()
}

/// What the first line says, the digest that it promises, and what follows it.
fn marked(head: &[u8]) -> Option<(Kind, &str, &[u8])> {
    let end = head.iter().position(|byte| *byte == b'\n')?;
    let (first, rest) = head.split_at_checked(end + 1)?;
    let (title, promise) = str::from_utf8(first).ok()?.trim_end().strip_prefix(MARK)?.split_once(PROMISE)?;
    let kind = MARKED.into_iter().find(|kind| kind.title() == title)?;
    Some((kind, promise, rest))
}

fn binary(bytes: &[u8]) -> Option<Kind> {
    let slots = || bytes.chunks(SLOT_BYTES as usize);
    let is_blank = |slot: &[u8]| slot.iter().all(|byte| *byte == 0xFF);
    if bytes.len() == 2 * SLOT_BYTES as usize
        && slots().any(|slot| is_blank(slot) || Blob::stored_length(slot).is_some())
    {
        return Some(Kind::Flash);
    }
    if Blob::stored_length(bytes).is_some() && bytes.len() <= MAX_STORED {
        return Some(Kind::Calibration);
    }
    is_identity(bytes).then_some(Kind::Identity)
}

/// Whether the bytes are a record as `IdentityRecord` writes it, to the last one.
fn is_identity(bytes: &[u8]) -> bool {
    use firmware_core::{FactoryKey, IdentityRecord};
    bytes.try_into().is_ok_and(|bytes| {
        let record = IdentityRecord::from_bytes(bytes);
        record.key != FactoryKey::Spoilt && record.to_bytes() == *bytes
    })
}

fn text(text: &str) -> Option<Kind> {
    if text.lines().next() == Some(TITLE) {
        return Some(Kind::Seal);
    }
    if text.starts_with(':') {
        return hex(text);
    }
    let generator = format!("<meta name=\"generator\" content=\"{GENERATOR}\">");
    if text.starts_with("<!DOCTYPE html>") && text.contains(&generator) {
        return Some(Kind::Report);
    }
    if text.starts_with("<svg") && text.contains(&format!("<metadata>{GENERATOR}</metadata>")) {
        return Some(Kind::Picture);
    }
    is_model(text).then_some(Kind::Model)
}

/// What pages and pictures name as the program that made them.
pub const GENERATOR: &str = "tempco";

/// Of whatever format: those of older versions are tempco's too.
fn is_model(text: &str) -> bool {
    let Ok(table) = text.parse::<toml::Table>() else { return false };
    let has = |key: &str, part: &str| table.get(key).and_then(|value| value.get(part)).is_some();
    table.get("format").is_some_and(toml::Value::is_integer)
        && has("provenance", "made_by")
        && has("scaling", "output_g")
        && has("network", "output_bias")
}

/// Nothing but one of the two regions that tempco fills.
fn hex(text: &str) -> Option<Kind> {
    let pieces = pieces(text).ok()?;
    let first = pieces.first()?;
    let within = |(origin, length): (u32, u32)| {
        let inside = |(at, bytes): &(u32, Vec<u8>)| {
            at.checked_sub(origin).is_some_and(|offset| offset as usize + bytes.len() <= length as usize)
        };
        first.0 == origin && pieces.iter().all(inside)
    };
    if within(region::calibration().ok()?) && Blob::stored_length(&first.1).is_some() {
        return Some(Kind::CalibrationHex);
    }
    (within(region::identity().ok()?) && is_identity(&first.1)).then_some(Kind::IdentityHex)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    fn kind(bytes: &[u8]) -> Option<Kind> {
        let folder = TempDir::new().expect("a folder");
        let file = folder.path().join("file");
        crate::output::write_whole(&file, bytes).expect("written");
        Kind::of(&file).expect("readable")
    }

    #[test]
    fn a_marked_text_is_tempcos_until_somebody_changes_it() {
        let long = "1,2,3\n".repeat(HEAD_BYTES as usize / 4);
        let written = with_mark(Kind::Campaign, long.as_bytes());
        assert_eq!(kind(&written), Some(Kind::Campaign));
        assert_eq!(kind(&[written.as_slice(), b"4,5,6\n"].concat()), None);
        let mut changed = written;
        *changed.last_mut().expect("not empty") = b' ';
        assert_eq!(kind(&changed), None);
        assert_eq!(kind(&with_mark(Kind::Scenario, b"")), Some(Kind::Scenario));
    }

    #[test]
    fn what_only_looks_alike_is_not_tempcos() {
        let foreign: [&[u8]; 11] = [
            b"format = 1\n",
            b"run,kind,time_s,temperature_c,delta_f_hz,reference_g\nfull-1,full,1,20.000000,76.000000,0.000000000\n",
            b"format = 1\n[provenance]\nmade_by = 'hand'\n",
            b"TPC",
            b"TPCOmore",
            b"<!DOCTYPE html>\n<html></html>",
            b"<svg></svg>",
            b"",
            b"tempco",
            &[0xFF; 4096],
            b":020000040800F2\n:0400000001020304F2\n:00000001FF\n",
        ];
        for bytes in foreign {
            assert_eq!(kind(bytes), None, "{}", String::from_utf8_lossy(bytes));
        }
        assert_eq!(kind(&[0xFF; 8192]), Some(Kind::Flash));
    }

    #[test]
    fn a_model_has_all_of_a_models_parts() {
        let parts = [
            "format = 1\n",
            "[provenance]\nmade_by = 'hand'\n",
            "[scaling]\noutput_g = 1\n",
            "[network]\noutput_bias = 1\n",
        ];
        assert_eq!(kind(parts.concat().as_bytes()), Some(Kind::Model));
        for missing in 0..parts.len() {
            let mut others = parts.to_vec();
            others.remove(missing);
            assert_eq!(kind(others.concat().as_bytes()), None, "without {}", parts[missing]);
        }
        assert_eq!(kind(parts.concat().replace("format = 1", "format = 'x'").as_bytes()), None);
    }

    #[test]
    fn an_identity_is_one_to_the_last_byte_as_it_is_or_where_the_image_looks_for_it() {
        let record = firmware_core::IdentityRecord::new("SN-1").to_bytes();
        assert_eq!(kind(&record), Some(Kind::Identity));
        assert_eq!(kind(&vec![0; record.len()]), None);
        assert_eq!(kind(&record[1..]), None);
        let ((identity, _), (calibration, length)) =
            (region::identity().expect("a region"), region::calibration().expect("a region"));
        let hex = |pieces: &[(u32, &[u8])]| kind(crate::hex::text(pieces).expect("HEX").as_bytes());
        assert_eq!(hex(&[(identity, &record)]), Some(Kind::IdentityHex));
        for foreign in [
            &[(identity, &[0; 64][..])][..],
            &[(identity + 16, &record)],
            &[(calibration, &record)],
            &[(identity, &record), (calibration, b"else")],
            &[(calibration, b"else"), (calibration + length, b"behind")],
        ] {
            assert_eq!(hex(foreign), None, "{foreign:?}");
        }
    }
}

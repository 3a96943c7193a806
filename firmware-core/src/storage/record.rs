//! The bytes behind a calibration in a slot: a mark that says writing began, a record that says it ended.
//!
//! ```text
//! mark     0   "TPMK"                 record  0   "TPRC"
//!          4   u32  erases of slot 0          4   u32  sequence number
//!          8   u32  erases of slot 1          8   u32  length of the calibration
//!         12   u32  CRC-32 of the above      12   u32  its CRC-32
//!                                            16   u32  erases of slot 0
//!                                            20   u32  erases of slot 1
//!                                            24   u32  0
//!                                            28   u32  CRC-32 of the above
//! ```
//! All numbers lowest byte first.

use crate::storage::slot::Slot;
use protocol::crc32;
use protocol::limits::MAX_STORED;

/// Bytes of mark and record.
pub const HEADING: usize = 48;

const MARK: u32 = u32::from_le_bytes(*b"TPMK");
const RECORD: u32 = u32::from_le_bytes(*b"TPRC");

/// Writing has begun.
pub struct Mark {
    /// How often each slot was erased.
    pub erases: [u32; 2],
}

/// Writing has ended.
#[derive(Clone, Copy)]
pub struct Record {
    /// Number in the order of commits, from 1 on.
    pub sequence: u32,
    /// Bytes of the calibration.
    pub length: usize,
    /// Their checksum.
    pub checksum: u32,
}

/// How far a slot was written.
pub enum State {
    /// Erased, or a programmer's.
    Unwritten,
    /// Not to its end.
    Begun,
    /// To its end.
    Committed(Record),
}

/// What stands behind a calibration.
pub struct Heading {
    /// How far it was written.
    pub state: State,
    /// How often each slot was erased, as far as this slot knows.
    pub erases: [u32; 2],
}

impl Mark {
    /// As it is stored.
    pub fn to_bytes(&self) -> [u8; 16] {
        let [first, second] = self.erases;
        let [low] = sealed([[MARK, first, second, 0]]);
        low
    }
}

impl Record {
    /// As it is stored, in two pieces.
    pub fn to_bytes(self, [first, second]: [u32; 2]) -> [[u8; 16]; 2] {
        sealed([[RECORD, self.sequence, self.length as u32, self.checksum], [first, second, 0, 0]])
    }
}

impl Heading {
    /// Of a slot that can't be read.
    pub const UNREADABLE: Self = Self { state: State::Begun, erases: [0, 0] };

    /// Reads mark and record. What fails its checksum was not written to its end.
    pub fn from_bytes(bytes: &[u8; HEADING]) -> Self {
        if bytes.iter().all(|byte| *byte == 0xFF) {
            return Self { state: State::Unwritten, erases: [0, 0] };
        }
        let (pieces, _) = bytes.as_chunks::<16>();
        let [mark, low, high] = pieces else { return Self::UNREADABLE };
        if let Some([[_, sequence, length, checksum], [first, second, ..]]) = opened(RECORD, [*low, *high]) {
            let length = length as usize;
            if length <= MAX_STORED && sequence > 0 {
                return Self {
                    state: State::Committed(Record { sequence, length, checksum }),
                    erases: [first, second],
                };
            }
        }
        match opened(MARK, [*mark]) {
            Some([[_, first, second, _]]) => Self { state: State::Begun, erases: [first, second] },
            None => Self::UNREADABLE,
        }
    }

    /// Its place in the order of commits: the newest is greatest, what holds nothing is least.
    pub const fn sequence(&self, slot: Slot) -> Option<u32> {
        match (&self.state, slot) {
            (State::Committed(record), _) => Some(record.sequence),
            (State::Unwritten, Slot::First) => Some(0),
            (State::Unwritten | State::Begun, _) => None,
        }
    }
}

/// Words as bytes, the checksum of all others in place of the last.
fn sealed<const N: usize>(words: [[u32; 4]; N]) -> [[u8; 16]; N] {
    let mut pieces = words.map(bytes_of);
    let checksum = checksum(&pieces);
    if let (Some(piece), Some([a, b, c, _])) = (pieces.last_mut(), words.last()) {
        *piece = bytes_of([*a, *b, *c, checksum]);
    }
    pieces
}

/// The words of what [`sealed`] made, if it is of this kind and nothing changed.
fn opened<const N: usize>(kind: u32, pieces: [[u8; 16]; N]) -> Option<[[u32; 4]; N]> {
    let words = pieces.map(words_of);
    let [first, ..] = words.first()?;
    let [.., last] = words.last()?;
    (*first == kind && *last == checksum(&pieces)).then_some(words)
}

fn checksum(pieces: &[[u8; 16]]) -> u32 {
    let bytes = pieces.as_flattened();
    crc32(bytes.split_last_chunk::<4>().map_or(bytes, |(sealed, _)| sealed))
}

fn bytes_of([a, b, c, d]: [u32; 4]) -> [u8; 16] {
    (u128::from(a) | u128::from(b) << 32 | u128::from(c) << 64 | u128::from(d) << 96).to_le_bytes()
}

fn words_of(bytes: [u8; 16]) -> [u32; 4] {
    let all = u128::from_le_bytes(bytes);
    [all as u32, (all >> 32) as u32, (all >> 64) as u32, (all >> 96) as u32]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mark of three and four erases, and this record with five and six.
    fn bytes(sequence: u32, length: usize) -> [u8; HEADING] {
        let [low, high] = Record { sequence, length, checksum: 9 }.to_bytes([5, 6]);
        let mut bytes = [0; HEADING];
        let pieces = [Mark { erases: [3, 4] }.to_bytes(), low, high];
        bytes.iter_mut().zip(pieces.as_flattened()).for_each(|(slot, byte)| *slot = *byte);
        bytes
    }

    fn heading(sequence: u32, length: usize) -> Heading {
        Heading::from_bytes(&bytes(sequence, length))
    }

    #[test]
    fn a_bit_that_flips_anywhere_is_found() {
        for bit in 0..8 * HEADING {
            let mut spoilt = bytes(1, 10);
            spoilt[bit / 8] ^= 1 << (bit % 8);
            let of_record = Heading::from_bytes(&spoilt);
            // Without a record, the mark is what counts.
            spoilt[16..].fill(0xFF);
            let of_mark = Heading::from_bytes(&spoilt);
            let (record_holds, mark_holds) = (of_record.erases == [5, 6], of_mark.erases == [3, 4]);
            assert_eq!((record_holds, mark_holds), (bit < 8 * 16, bit >= 8 * 16), "bit {bit}");
            assert!(matches!(of_mark.state, State::Begun));
        }
    }

    #[test]
    fn a_record_counts_if_its_calibration_can_be_stored_and_its_number_can_be_given() {
        let committed = heading(1, MAX_STORED);
        let State::Committed(record) = &committed.state else { panic!("it counts") };
        assert_eq!((record.sequence, record.length, record.checksum), (1, MAX_STORED, 9));
        assert_eq!((committed.erases, committed.sequence(Slot::Second)), ([5, 6], Some(1)));
        for (sequence, length) in [(1, MAX_STORED + 1), (0, 10), (0, MAX_STORED + 1)] {
            let heading = heading(sequence, length);
            assert!(matches!(heading.state, State::Begun), "{sequence}, {length}");
            assert_eq!((heading.erases, heading.sequence(Slot::First)), ([3, 4], None), "the mark still holds");
        }
    }
}

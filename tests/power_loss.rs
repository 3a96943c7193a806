//! Claim: whenever the power fails, the old or the new calibration is there, never none and never a mix.
//!
//! Power is cut within every byte of every write and at every part of every erase, for every state that the storage
//! can be in, and for erases that leave their sector in four ways half done.

use firmware_core::Storage;
use firmware_core::storage::{self, Slot};
use firmware_sim::link::{Kept, Link, LinkError};
use firmware_sim::virtual_flash::{EraseOrder, SLOT_BYTES, VirtualFlash};
use firmware_sim::virtual_line::VirtualLine;
use protocol::{Refusal, Source};
use tests::example;

const ORDERS: [EraseOrder; 5] = [
    EraseOrder::FrontToBack,
    EraseOrder::BackToFront,
    EraseOrder::ZerosFirst,
    EraseOrder::Scattered(1),
    EraseOrder::Scattered(2),
];

/// A calibration that is sound as far as the storage can tell, and no other one.
fn calibration(number: u8) -> Vec<u8> {
    let mut blob = example::blob();
    blob.provenance = [number; 8];
    // Of different lengths, one of them no multiple of a word.
    blob.terms.truncate(usize::from(number % 4));
    example::stored(&blob)
}

/// What the next power-on finds, as the instrument looks for it.
fn found(flash: &VirtualFlash) -> Option<Vec<u8>> {
    let mut storage = Storage::new(flash.clone(), SLOT_BYTES);
    let mut bytes = storage::Bytes::new();
    let slots = storage.newest_first();
    slots.into_iter().find_map(|slot| storage.read(slot, &mut bytes).map(|_| bytes.to_vec()))
}

fn slot_in_use(flash: &VirtualFlash) -> Option<Slot> {
    let mut storage = Storage::new(flash.clone(), SLOT_BYTES);
    let mut bytes = storage::Bytes::new();
    storage.newest_first().into_iter().find(|slot| storage.read(*slot, &mut bytes).is_some())
}

/// What can be done to the storage.
#[derive(Clone, Debug)]
enum Action {
    Commit(Vec<u8>),
    RollBack,
}

/// Does it as the instrument does; the flash afterwards, whether or not power held.
fn done(flash: &VirtualFlash, action: &Action) -> VirtualFlash {
    let in_use = slot_in_use(flash);
    let mut storage = Storage::new(flash.clone(), SLOT_BYTES);
    let _ = match action {
        Action::Commit(bytes) => storage.commit(bytes, in_use).map(drop),
        Action::RollBack => storage.clear(in_use.expect("something is in use")),
    };
    storage.flash_mut().clone()
}

fn after(commits: &[u8]) -> VirtualFlash {
    commits.iter().fold(VirtualFlash::new(), |flash, number| done(&flash, &Action::Commit(calibration(*number))))
}

fn by_programmer() -> VirtualFlash {
    VirtualFlash::holding(&calibration(9))
}

/// Every state, and what may be done in it.
fn cases() -> Vec<(&'static str, VirtualFlash, Action)> {
    let commit = || Action::Commit(calibration(7));
    let over_factory = done(&by_programmer(), &Action::Commit(calibration(1)));
    let rolled_back = done(&after(&[1, 2]), &Action::RollBack);
    vec![
        ("commit into a fresh flash", VirtualFlash::new(), commit()),
        ("commit over a programmer's", by_programmer(), commit()),
        ("commit with one slot in use", after(&[1]), commit()),
        ("commit over the programmer's with two in use", over_factory.clone(), commit()),
        ("commit with two slots in use", after(&[1, 2]), commit()),
        ("commit with two slots in use, the other way round", after(&[1, 2, 3]), commit()),
        ("commit after a step back", rolled_back, commit()),
        ("step back to the programmer's", over_factory, Action::RollBack),
        ("step back", after(&[1, 2]), Action::RollBack),
        ("step back, the other way round", after(&[1, 2, 3]), Action::RollBack),
    ]
}

/// The flash after `action` was cut short within each of its steps, every `stride`-th of them.
fn cuts(flash: &VirtualFlash, action: &Action, stride: usize) -> impl Iterator<Item = VirtualFlash> {
    let steps = flash.steps()..done(flash, action).steps();
    assert!(steps.end > steps.start, "{action:?} does something");
    steps.step_by(stride).map(move |step| {
        let mut cut = flash.clone();
        cut.fail_power_at(step);
        let mut cut = done(&cut, action);
        cut.restore_power();
        cut
    })
}

#[test]
fn power_may_fail_within_any_byte_and_any_part_of_an_erase() {
    let mut points = 0;
    for (what, flash, action) in cases() {
        let (old, new) = (found(&flash), found(&done(&flash, &action)));
        assert!(old != new && new.is_some(), "{what}");
        for order in ORDERS {
            let flash = flash.clone().erasing(order);
            for (step, cut) in cuts(&flash, &action, 1).enumerate() {
                let now = found(&cut);
                assert!(now == old || now == new, "{what}, {order:?}, step {step}: {now:02x?}");
                let again = Action::Commit(calibration(8));
                assert_eq!(found(&done(&cut, &again)), Some(calibration(8)), "{what}, {order:?}, step {step}");
                points += 1;
            }
        }
    }
    assert!(points > 10_000, "{points} cuts");
}

#[test]
fn power_may_fail_again_while_the_damage_is_repaired() {
    for (what, flash, action) in cases() {
        for order in ORDERS {
            let flash = flash.clone().erasing(order);
            for (first, cut) in cuts(&flash, &action, 5).enumerate() {
                let (old, again) = (found(&cut), Action::Commit(calibration(8)));
                for (second, cut) in cuts(&cut, &again, 7).enumerate() {
                    let now = found(&cut);
                    assert!(
                        now == old || now == Some(calibration(8)),
                        "{what}, {order:?}, cuts {first} and {second}: {now:02x?}"
                    );
                }
            }
        }
    }
}

#[test]
fn every_erase_is_counted_also_those_whose_commit_was_cut_short() {
    let mut flash = after(&[1, 2, 3]);
    let erases = |flash: &VirtualFlash| Storage::new(flash.clone(), SLOT_BYTES).erases();
    assert_eq!(erases(&flash), [1, 2]);
    let begun = flash.steps();
    flash.fail_power_at(begun + 200);
    let mut cut = done(&flash, &Action::Commit(calibration(4)));
    cut.restore_power();
    assert_eq!(found(&cut), Some(calibration(3)));
    assert_eq!(erases(&cut), [2, 2]);
    assert_eq!(erases(&done(&cut, &Action::RollBack)), [2, 3]);
}

#[test]
fn a_programmers_image_takes_the_place_of_everything_committed() {
    // As `tempco export` writes it: the blob into slot 0, the mark of an empty slot into slot 1. A programmer erases both.
    let (at, mark) = storage::empty_slot();
    let mut flash = VirtualFlash::holding(&[calibration(9), vec![0xFF; 100]].concat());
    flash.program((SLOT_BYTES + at) as usize, &mark);
    assert_eq!(found(&flash), Some(calibration(9)));
    let committed = done(&flash, &Action::Commit(calibration(4)));
    assert_eq!(found(&committed), Some(calibration(4)));
    assert_eq!(found(&done(&committed, &Action::RollBack)), Some(calibration(9)));
}

#[test]
fn the_mark_of_an_empty_slot_stands_where_the_storage_puts_its_own() {
    let (at, mark) = storage::empty_slot();
    let mut storage = Storage::new(VirtualFlash::new(), SLOT_BYTES);
    storage.clear(Slot::Second).expect("a flash that takes everything");
    let second = &storage.flash_mut().bytes()[SLOT_BYTES as usize..];
    let written: Vec<usize> = (0..second.len()).filter(|&byte| second[byte] != 0xFF).collect();
    let place = at as usize..at as usize + mark.len();
    assert!(!written.is_empty() && written.iter().all(|byte| place.contains(byte)), "{written:?} and {place:?}");
}

#[test]
fn a_slot_is_written_to_the_end_that_is_stated() {
    let flash = after(&[1]);
    let [first, second] = [0, SLOT_BYTES as usize].map(|from| &flash.bytes()[from..from + SLOT_BYTES as usize]);
    let written = |slot: &[u8]| slot.iter().rposition(|&byte| byte != 0xFF).map_or(0, |last| last + 1);
    assert_eq!(written(first).max(written(second)), storage::SLOT_USED as usize);
}

#[test]
fn the_instrument_itself_wakes_up_with_the_old_or_the_new_one_and_its_bits() {
    let (old, new) = (example::blob(), example::with_expression());
    let samples = example::samples(20);
    let provenances = [old.provenance, *b"exampl-2"];
    let new = protocol::Blob { provenance: provenances[1], ..new };
    let mut seen = [0; 2];
    for step in (0..550).step_by(3) {
        let mut link = Link::new(VirtualLine::new(example::SERIAL));
        link.upload_blob(&old).expect("a perfect line");
        let flash = link.transport_mut().flash_mut();
        flash.order = ORDERS[step as usize % ORDERS.len()];
        flash.fail_power_at(flash.steps() + step);
        let kept = link.upload_blob(&new).expect("a perfect line");
        link.transport_mut().power_cycle();
        link.begin();
        let provenance = link.state().expect("a perfect line").provenance.expect("never none");
        let which = provenances.iter().position(|known| *known == provenance).expect("never a mix");
        assert!(which == 1 || kept == Kept::UntilPowerOff, "it said that it was stored");
        let mut host = firmware_core::Compensator::load([&old, &new][which]).expect("the example is sound");
        for sample in &samples {
            assert!(link.replay(sample).expect("a perfect line").same_bits(&host.compensate(sample)));
        }
        seen[which] += 1;
    }
    assert!(seen[0] > 10 && seen[1] > 1, "{seen:?}");
}

#[test]
fn a_step_back_lasts_and_there_is_one_step_only() {
    let mut link = Link::new(VirtualLine::new(example::SERIAL));
    for number in [1, 2] {
        assert_eq!(link.upload(&calibration(number)), Ok(Kept::ForGood));
    }
    let state = link.storage().expect("a perfect line");
    assert_eq!((state.source, state.sequence, state.can_roll_back), (Source::Committed, 2, true));
    link.roll_back().expect("there is one before");
    link.transport_mut().power_cycle();
    link.begin();
    assert_eq!(link.read_calibration(), Ok(calibration(1)));
    assert_eq!(link.roll_back(), Err(LinkError::Refused(Refusal::NothingBefore)));
    assert_eq!(link.upload(&calibration(3)), Ok(Kept::ForGood));
    assert!(link.storage().expect("a perfect line").can_roll_back);
}

#[test]
fn a_flash_that_takes_nothing_is_told_and_the_calibration_runs_until_power_off() {
    let mut link = Link::new(VirtualLine::new(example::SERIAL));
    link.upload(&calibration(1)).expect("a perfect line");
    link.transport_mut().flash_mut().read_only = true;
    assert_eq!(link.upload(&calibration(2)), Ok(Kept::UntilPowerOff));
    assert_eq!(link.read_calibration(), Ok(calibration(2)));
    assert_eq!(link.storage().expect("a perfect line").source, Source::UntilPowerOff);
    link.transport_mut().power_cycle();
    link.begin();
    assert_eq!(link.read_calibration(), Ok(calibration(1)));
}

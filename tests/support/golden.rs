//! Bytes that were recorded once and may change only by decision.

use crate::workspace::root;

/// Compares `bytes` with the recorded file `name`, or records them if `TEMPCO_RECORD_GOLDEN` is set.
///
/// # Panics
/// If they differ, with the first difference; or if there is no record.
pub fn check(name: &str, bytes: &[u8]) {
    let path = root().join("tests/golden").join(name);
    if std::env::var_os("TEMPCO_RECORD_GOLDEN").is_some() {
        std::fs::write(&path, bytes).expect("the golden folder is writable");
    }
    let recorded = std::fs::read(&path)
        .unwrap_or_else(|error| panic!("{}: {error}; set TEMPCO_RECORD_GOLDEN=1 to record it", path.display()));
    if let Some(at) = (0..bytes.len().max(recorded.len())).find(|at| bytes.get(*at) != recorded.get(*at)) {
        panic!(
            "{name} differs from byte {at} on: recorded {:02x?}, now {:02x?}. Devices in the field hold the recorded \
             bytes: raise the version instead. What was only added, or changed before the first release: TEMPCO_RECORD_GOLDEN=1",
            recorded.get(at),
            bytes.get(at)
        );
    }
}

//! Bytes one by one of a reader that gives them in pieces.

use std::io;

/// The next byte of a reader that gives up waiting by itself.
pub(super) fn next_byte(
    received: &mut Vec<u8>,
    read: impl FnOnce(&mut [u8]) -> io::Result<usize>,
) -> io::Result<Option<u8>> {
    if received.is_empty() {
        let mut buffer = [0; 512];
        match read(&mut buffer) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(count) => received.extend(buffer[..count].iter().rev()),
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(received.pop())
}

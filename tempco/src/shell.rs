//! Words of a command line that somebody copies: a POSIX shell gives back their bytes, and runs none of them.
//!
//! What a terminal would act on, or a screen would hide or turn around, is written as the octal numbers of its bytes: what
//! one sees is what one copies.

use std::ffi::OsStr;
use std::path::Path;

/// Characters besides letters and digits that no shell looks at.
const PLAIN: &str = "-_./,+:=";

/// Any text as one word.
pub fn word(text: impl AsRef<OsStr>) -> String {
    let mut words = String::new();
    let mut seen = String::new();
    for chunk in text.as_ref().as_encoded_bytes().utf8_chunks() {
        for letter in chunk.valid().chars() {
            if is_treacherous(letter) {
                words += &quoted(&std::mem::take(&mut seen));
                words += &octal(letter.encode_utf8(&mut [0; 4]).as_bytes());
            } else {
                seen.push(letter);
            }
        }
        if !chunk.invalid().is_empty() {
            words += &quoted(&std::mem::take(&mut seen));
            words += &octal(chunk.invalid());
        }
    }
    words += &quoted(&seen);
    if words.is_empty() { "''".to_owned() } else { words }
}

/// A file or folder, which is none of the options whatever it begins with.
pub fn path(path: &Path) -> String {
    if path.as_os_str().as_encoded_bytes().starts_with(b"-") { word(Path::new(".").join(path)) } else { word(path) }
}

/// An option and its value, which may begin with a minus.
pub fn option(name: &str, value: &str) -> String {
    let separator = if value.starts_with('-') { '=' } else { ' ' };
    format!("{name}{separator}{}", word(value))
}

fn quoted(text: &str) -> String {
    // A shell may look up what begins with an equals sign.
    let plain = |letter: char| letter.is_ascii_alphanumeric() || PLAIN.contains(letter);
    if text.chars().all(plain) && !text.starts_with('=') {
        return text.to_owned();
    }
    // The one thing that no word can hold is NUL, which went another way.
    shlex::try_quote(text).map_or_else(|_| String::new(), Into::into)
}

/// Bytes by their numbers.
fn octal(bytes: &[u8]) -> String {
    let numbers: String = bytes.iter().map(|byte| format!("\\{byte:03o}")).collect();
    format!("\"$(printf '{numbers}')\"")
}

/// What acts on a terminal, or can't be seen as it is. A line's end stays: a shell would cut it off, and quotes hold it.
fn is_treacherous(letter: char) -> bool {
    letter != '\n'
        && (letter.is_control()
            || matches!(letter,
                '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_words_stay_as_they_are_and_others_are_quoted() {
        for (text, typed) in [
            ("campaign.csv", "campaign.csv"),
            ("time_s=t_ms*0.001", "'time_s=t_ms*0.001'"),
            ("full-2,zero-1", "full-2,zero-1"),
            ("", "''"),
            ("=ls", "'=ls'"),
            ("a\u{1b}b c", "a\"$(printf '\\033')\"'b c'"),
            ("\u{202e}", "\"$(printf '\\342\\200\\256')\""),
        ] {
            assert_eq!(word(text), typed);
        }
        assert_eq!(path(Path::new("-x.csv")), "./-x.csv");
        assert_eq!((option("--map", "a=b"), option("--map", "-a")), ("--map a=b".to_owned(), "--map=-a".to_owned()));
    }
}

#[cfg(test)]
#[cfg(unix)]
mod in_a_shell {
    use super::*;
    use std::os::unix::ffi::{OsStrExt, OsStringExt};
    use std::process::Command;

    /// What a shell hands to a program for this word.
    fn handed(typed: &str) -> Vec<u8> {
        let script = format!("for word in {typed}; do printf '%s\\0' \"$word\"; done");
        let output = Command::new("sh").arg("-c").arg(script).output().expect("a shell");
        assert!(output.status.success() && output.stderr.is_empty(), "{typed}: {output:?}");
        output.stdout
    }

    #[test]
    fn every_byte_arrives_alone_and_among_others() {
        for byte in 1..=u8::MAX {
            for text in [vec![byte], vec![b'a', byte, b'$', byte], vec![b'\'', byte, b'"', b'\\', byte, byte, b'!']] {
                let typed = word(OsStr::from_bytes(&text));
                assert_eq!(handed(&typed), [text.as_slice(), b"\0"].concat(), "{typed}");
                let acted_on = typed.bytes().find(|byte| *byte != b'\n' && byte.is_ascii_control());
                assert_eq!(acted_on, None, "{typed:?} for {text:?}");
            }
        }
        let all: Vec<u8> = (1..=u8::MAX).collect();
        let typed = word(std::ffi::OsString::from_vec(all.clone()));
        assert_eq!(handed(&typed), [all.as_slice(), b"\0"].concat());
    }
}

//! Foreign text as a terminal may show it: what one would obey is an escape.

use std::borrow::Cow;
use std::fmt::Write as _;

/// The text with everything that a terminal would obey made visible; lines and tabs stay.
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, |letter| !matches!(letter, '\n' | '\t'))
}

/// The same for what stands within a line.
pub fn visible_word(text: &str) -> Cow<'_, str> {
    escaped(text, |_| true)
}

fn escaped(text: &str, also: impl Fn(char) -> bool) -> Cow<'_, str> {
    let obeyed = |letter: char| is_obeyed(letter) && also(letter);
    if !text.contains(obeyed) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for letter in text.chars() {
        if obeyed(letter) {
            let _ = write!(shown, "\\u{:04x}", u32::from(letter));
        } else {
            shown.push(letter);
        }
    }
    Cow::Owned(shown)
}

/// Control characters, marks and overrides of direction, ends of lines that are none; all have four digits.
pub fn is_obeyed(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_shown_and_the_rest_stays() {
        assert_eq!(visible("µg °C – “ü”\n\t│ 測定\u{1f600}"), "µg °C – “ü”\n\t│ 測定\u{1f600}");
        assert_eq!(visible("a\u{1b}[31m\r\u{7}\u{9b}b\u{202e}c"), "a\\u001b[31m\\u000d\\u0007\\u009bb\\u202ec");
        assert_eq!(visible_word("a\nb\tc"), "a\\u000ab\\u0009c");
    }

    #[test]
    fn json_says_the_same_before_and_after() {
        let nasty = "a\u{1b}\u{7f}\u{85}\u{202e}\u{2066}\u{feff}\n\"\\";
        let text = serde_json::to_string_pretty(&serde_json::json!({ nasty: [nasty] })).expect("JSON");
        let shown = visible(&text).into_owned();
        assert!(!shown.contains(|c: char| c.is_control() && c != '\n') && !shown.contains('\u{202e}'));
        let read: serde_json::Value = serde_json::from_str(&shown).expect("still JSON");
        assert_eq!(read[nasty][0], nasty);
    }
}

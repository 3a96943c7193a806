//! What every page that tempco writes is made of. `page/charts.js` says how a chart is drawn.

use crate::visible::is_obeyed;
use std::fmt::Write;

/// Light, dark and print.
pub const STYLE: &str = include_str!("page/style.css");

/// Draws charts: sets `globalThis.charts`. The files in the order in which they build on each other.
pub const SCRIPT: &str = concat!(
    include_str!("page/scale.js"),
    include_str!("page/marks.js"),
    include_str!("page/charts.js"),
    include_str!("page/readout.js"),
);

/// Text as HTML shows it, in elements and in quoted attributes. What would hide or turn letters around is spelt as the
/// charts spell it.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' | '\t' => escaped.push(letter),
            letter if is_obeyed(letter) => {
                // A string takes everything.
                let _ = write!(escaped, "\\u{{{:x}}}", u32::from(letter));
            }
            letter => escaped.push(letter),
        }
    }
    escaped
}

/// JSON that stands in a `<script>` element, which no string within may end.
pub fn embedded_json(value: &impl serde::Serialize) -> serde_json::Result<String> {
    Ok(serde_json::to_string(value)?.replace('<', "\\u003c"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_names_end_no_element_and_turn_nothing_around() {
        assert_eq!(escaped("<b a=\"1\">&"), "&lt;b a=&quot;1&quot;&gt;&amp;");
        assert_eq!(escaped("a\u{1b}[31m\u{202e}b\u{feff}\rµ\n\t"), "a\\u{1b}[31m\\u{202e}b\\u{feff}\\u{d}µ\n\t");
        let json = embedded_json(&"</script><!--").expect("a string");
        assert!(!json.contains('<'));
        assert_eq!(serde_json::from_str::<String>(&json).expect("JSON"), "</script><!--");
    }
}

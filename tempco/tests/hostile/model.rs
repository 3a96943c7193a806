//! Model files, spoilt.

use super::random::Random;

/// One number, one line or one byte of the text is another.
pub fn spoilt(text: &str, random: &mut Random) -> Vec<u8> {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let line = random.below(lines.len());
    match random.below(5) {
        0 => drop(lines.remove(line)),
        1 => lines.insert(line, random.of(&["x = 1", "[[effect]]", "[network]", "bias = [1.0]", "\u{0}"]).to_owned()),
        2 => lines[line].push_str(random.of(&[" , 7", "]", "0", "e300", " = 3", "\""])),
        3 => {
            let value =
                random.of(&["nan", "-1e39", "1e-45", "0.0", "9223372036854775807", "-5", "\"x\"", "[]", "true"]);
            let key = lines[line].split('=').next().unwrap_or_default().to_owned();
            lines[line] = format!("{key}= {value}");
        }
        _ => {
            let mut bytes = lines.join("\n").into_bytes();
            let at = random.below(bytes.len());
            bytes[at] = random.next() as u8;
            return bytes;
        }
    }
    (lines.join("\n") + "\n").into_bytes()
}

//! The name that a person probably meant.

/// Letters that two names must share at their beginning to be taken for one another (`Temp_F`, `temperature_c`).
const SHARED_BEGINNING: usize = 3;

/// The candidate that is most like `name`, if any is at all.
pub(crate) fn nearest(name: &str, candidates: &[String]) -> Option<String> {
    let wanted = letters(name);
    let likeness = |candidate: &&String| {
        let found = letters(candidate);
        let shared = wanted.iter().zip(&found).take_while(|(a, b)| a == b).count();
        let distance = edit_distance(&wanted, &found);
        let alike = distance * 3 <= wanted.len().max(found.len()) || shared >= SHARED_BEGINNING;
        alike.then_some((distance.saturating_sub(shared), distance))
    };
    let scored = candidates.iter().filter_map(|candidate| Some((likeness(&candidate)?, candidate)));
    scored.min_by_key(|(score, _)| *score).map(|(_, candidate)| candidate.clone())
}

/// Case, blanks and punctuation do not make a name different.
fn letters(name: &str) -> Vec<char> {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Insertions, deletions and substitutions from `a` to `b` (Levenshtein).
fn edit_distance(a: &[char], b: &[char]) -> usize {
    let mut previous: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.iter().enumerate() {
        let mut current = vec![i + 1];
        for (j, to) in b.iter().enumerate() {
            let substituted = previous[j] + usize::from(from != to);
            current.push(substituted.min(previous[j + 1] + 1).min(current[j] + 1));
        }
        previous = current;
    }
    previous[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_found_despite_case_units_and_slips() {
        let headers = ["Temp_F", "Time [s]", "deltaf_Hz", "run-10", "run-11"].map(str::to_owned);
        for (wanted, found) in [
            ("temperature_c", Some("Temp_F")),
            ("time_s", Some("Time [s]")),
            ("delta_f_hz", Some("deltaf_Hz")),
            ("run10", Some("run-10")),
            ("reference_g", None),
            ("", None),
        ] {
            assert_eq!(nearest(wanted, &headers).as_deref(), found, "{wanted}");
        }
    }
}

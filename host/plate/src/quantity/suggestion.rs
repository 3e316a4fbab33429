//! What a mistyped word was probably meant to be.

/// The candidate that differs from `word` in the fewest letters, if that is few: a third of the word's, or the word is
/// the beginning of a candidate. Case does not count. For field names, presets and materials, which are short.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Longer words than any candidate are not compared: a hostile file may hold one of a megabyte.
    const LONGEST: usize = 80;
    let word: Vec<char> = word.to_lowercase().chars().take(LONGEST + 1).collect();
    if word.is_empty() || word.len() > LONGEST {
        return None;
    }
    candidates
        .into_iter()
        .filter_map(|candidate| {
            let letters: Vec<char> = candidate.to_lowercase().chars().collect();
            let far = distance(&word, &letters);
            let is_beginning = word.len() >= 3 && letters.starts_with(&word);
            (is_beginning || far <= word.len().div_ceil(3)).then_some((far, candidate))
        })
        .min_by_key(|(far, _)| *far)
        .map(|(_, candidate)| candidate)
}

/// `; did you mean "steel"?`, or nothing.
pub(crate) fn hint<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    nearest(word, candidates).map_or_else(String::new, |found| format!("; did you mean \"{found}\"?"))
}

/// Letters to insert, delete or change to make one word the other (Levenshtein), row by row.
fn distance(from: &[char], to: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (i, a) in from.iter().enumerate() {
        let mut diagonal = i;
        row[0] = i + 1;
        for (j, b) in to.iter().enumerate() {
            let change = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = change.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_finger_is_understood_and_another_word_is_not() {
        let names = ["length_m", "loss_factor", "taper", "aluminium", "steel"];
        for (word, wanted) in [
            ("lenght_m", Some("length_m")),
            ("LENGTH_M", Some("length_m")),
            ("length", Some("length_m")),
            ("tapper", Some("taper")),
            ("aluminum", Some("aluminium")),
            ("colour", None),
            ("x", None),
            ("", None),
            (&"a".repeat(1 << 20), None),
        ] {
            assert_eq!(nearest(word, names), wanted, "{word:.20}");
        }
    }
}

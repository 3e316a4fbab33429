//! The most likely intended word for a mistyped one.

/// The candidate with the fewest differing letters, if these are at most a third of the letters of `word`, or if
/// `word` is the beginning of a candidate. Case does not count. For field names, presets and materials, which are
/// short.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Words longer than any candidate are not compared: a hostile file may hold one of a megabyte.
    const LONGEST: usize = 80;
    let word: String = word.chars().take(LONGEST + 1).collect::<String>().to_lowercase();
    let letters = word.chars().count();
    if letters == 0 || letters > LONGEST {
        return None;
    }
    candidates
        .into_iter()
        .filter_map(|candidate| {
            let lower = candidate.to_lowercase();
            let distance = strsim::levenshtein(&word, &lower);
            let is_beginning = letters >= 3 && lower.starts_with(&word);
            (is_beginning || distance <= letters.div_ceil(3)).then_some((distance, candidate))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// `; did you mean "steel"?`, or nothing.
pub(crate) fn hint<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    nearest(word, candidates).map_or_else(String::new, |found| format!("; did you mean \"{found}\"?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistyped_name_is_found_and_another_word_is_not() {
        let names = ["length_m", "loss_factor", "taper", "aluminium", "steel"];
        for (word, wanted) in [
            ("lenght_m", Some("length_m")),
            ("LENGTH_M", Some("length_m")),
            ("length", Some("length_m")),
            ("tapper", Some("taper")),
            ("aluminum", Some("aluminium")),
            ("tpaer", Some("taper")),
            ("stel", Some("steel")),
            ("stl", None),
            ("LOSS", Some("loss_factor")),
            ("colour", None),
            ("x", None),
            ("", None),
            (&"a".repeat(1 << 20), None),
        ] {
            assert_eq!(nearest(word, names), wanted, "{word:.20}");
        }
    }
}

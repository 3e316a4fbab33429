//! What the name of a column says: a quantity by words of the one table, and a unit.

use super::quantities::Quantity;
use super::units::{Unit, unit};
use super::words::{Word, word_of};

/// What the name of a column says.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Name {
    pub(super) quantity: Option<Quantity>,
    /// Whether each of its words is known.
    pub(super) is_clear: bool,
    /// Whether a word makes it another column.
    pub(super) is_other: bool,
    /// Whether a word, or a sign before it, turns its numbers into others.
    pub(super) is_changed: bool,
    /// The text of its unit, and the unit if it is known.
    pub(super) unit: Option<(String, Option<Unit>)>,
}

impl Name {
    /// Reads *name (unit)*, *name [unit]*, *name unit*, *name in unit* or a unit alone.
    pub(super) fn of(text: &str) -> Self {
        let text: String = text.chars().map(narrow).collect();
        if word_of(&text.to_lowercase()).is_none()
            && let Some(found) = unit(&text)
        {
            return Self {
                quantity: None,
                is_clear: true,
                is_other: false,
                is_changed: false,
                unit: Some((text, Some(found))),
            };
        }
        let mut found = None;
        let mut text = text.trim();
        let mut is_changed = ["1/", "1 /", "-", "−"].iter().any(|sign| text.starts_with(sign));
        if let Some((name, of, known)) = IN.iter().find_map(|word| {
            let (name, of) = text.rsplit_once(word)?;
            Some((name, of, unit(of)?))
        }) {
            (text, found) = (name, Some((of.to_owned(), Some(known))));
        } else if let Some((name, last)) = text.rsplit_once(char::is_whitespace)
            && word_of(&last.to_lowercase()).is_none()
            && is_whole(last)
            && let Some(of) = unit(last)
        {
            let is_bracketed = last.starts_with(['(', '[']) && last.ends_with([')', ']']);
            let last = if is_bracketed { &last[1..last.len() - 1] } else { last };
            (text, found) = (name, Some((last.to_owned(), Some(of))));
        }
        let (mut words, bracketed) = without_brackets(text);
        is_changed |= has_factor(&words);
        for content in bracketed {
            match unit(&content) {
                _ if content.is_empty() => {}
                Some(of) if found.is_none() => found = Some((content, Some(of))),
                // Such as "Re(H1)", "Level (measured)".
                None if words_of(&content.to_lowercase()).all(|word| word_of(word).is_some()) => {
                    words.push(' ');
                    words.push_str(&content);
                }
                _ => found = Some((content, None)),
            }
        }
        // Such as (m/s)/lbf.
        if found.is_some() && words.contains(" /") && !words.trim_end().ends_with('/') {
            found = Some((text.to_owned(), None));
        }
        let words = words.to_lowercase().replace("frequency response", " ");
        let words: Vec<&str> = words_of(&words).flat_map(unglued).collect();
        let mut named = words.len();
        if found.is_none() {
            let ending = (0..words.len()).map(|at| (at, words[at..].join(" ")));
            let ending = ending.filter(|(_, it)| word_of(it).is_none());
            if let Some((at, of)) =
                ending.filter_map(|(at, it)| Some((at, (it.clone(), Some(unit(&it)?))))).next()
            {
                (named, found) = (at, Some(of));
            }
        }
        let mut kinds: Vec<Quantity> = Vec::new();
        let (mut is_clear, mut is_other) = (true, false);
        for word in &words[..named] {
            match word_of(word) {
                Some(Word::Is(quantity)) => kinds.push(quantity),
                Some(Word::InUnit(quantity)) => {
                    kinds.push(quantity);
                    is_clear &= found.is_some();
                }
                Some(Word::Plain) => {}
                Some(Word::Other) => is_other = true,
                Some(Word::Changed) => is_changed = true,
                None => is_clear = false,
            }
        }
        kinds.sort_unstable();
        kinds.dedup();
        // "Phase of displacement" is a phase, "velocity magnitude" a velocity.
        if kinds.iter().any(|it| matches!(it, Quantity::Phase | Quantity::Real | Quantity::Imaginary)) {
            kinds.retain(|it| !it.is_level());
        } else if kinds.iter().any(|it| it.is_level() && !matches!(it, Quantity::Level | Quantity::Magnitude))
        {
            kinds.retain(|it| !matches!(it, Quantity::Level | Quantity::Magnitude));
        } else if kinds.contains(&Quantity::Level) {
            kinds.retain(|it| *it != Quantity::Magnitude);
        }
        Self {
            quantity: kinds.first().copied(),
            is_clear: is_clear && !is_changed && kinds.len() <= 1,
            is_other,
            is_changed,
            unit: found,
        }
    }
}

/// Whether each bracket of a word is opened and closed in it.
fn is_whole(word: &str) -> bool {
    let count = |signs: [char; 2]| word.matches(signs).count();
    count(['(', '[']) == count([')', ']'])
}

/// Whether a number multiplies or divides, as in "Level*10", "Frequency/100", "2 x Frequency".
fn has_factor(text: &str) -> bool {
    let signs: Vec<char> = text.chars().filter(|it| !it.is_whitespace()).collect();
    let is_digit = |at: Option<usize>| at.and_then(|at| signs.get(at)).is_some_and(char::is_ascii_digit);
    let by_sign = (0..signs.len()).any(|at| match signs[at] {
        '*' | '×' | '·' | '⋅' | '^' => is_digit(at.checked_sub(1)) || is_digit(Some(at + 1)),
        '/' => is_digit(Some(at + 1)),
        _ => false,
    });
    let is_number = |word: &str| word.starts_with(|letter: char| letter.is_ascii_digit());
    let words: Vec<&str> = text.split_whitespace().collect();
    let by_x = words.windows(2).any(|pair| {
        matches!(*pair, ["x" | "X", factor] if is_number(factor))
            || matches!(*pair, [factor, "x" | "X"] if is_number(factor))
    });
    by_sign || by_x || words.iter().any(|word| word.strip_prefix(['x', 'X']).is_some_and(is_number))
}

/// Words before a unit, as in "Frequenz in Hz".
const IN: [&str; 7] = [" in ", " en ", " em ", " i ", " w ", " v ", " в "];

/// The letter of ASCII for a wide one, as Chinese and Japanese programs write brackets.
fn narrow(letter: char) -> char {
    let of_ascii = ('\u{ff01}'..='\u{ff5e}').contains(&letter).then(|| u32::from(letter) - 0xfee0);
    of_ascii.and_then(char::from_u32).unwrap_or(letter)
}

/// "freqhz" is "freq", "hz".
fn unglued(word: &str) -> impl Iterator<Item = &str> {
    let is_name = |stem: &&str| matches!(word_of(stem), Some(Word::Is(_)));
    let stem = ["khz", "hz", "db", "deg", "rad"]
        .into_iter()
        .find_map(|unit| word.strip_suffix(unit).filter(is_name));
    let stem = stem.filter(|_| word_of(word).is_none());
    let (first, second) = word.split_at(stem.map_or(word.len(), str::len));
    [first, second].into_iter().filter(|part| !part.is_empty())
}

fn words_of(text: &str) -> impl Iterator<Item = &str> {
    let parts = |letter: char| {
        !letter.is_alphanumeric() && !matches!(letter, '°' | '%' | '²' | '\u{300}'..='\u{36f}')
    };
    text.split(parts).filter(|word| !word.is_empty())
}

/// A name without its brackets, and their contents.
pub(super) fn without_brackets(text: &str) -> (String, Vec<String>) {
    let (mut outside, mut contents, mut depth) = (String::new(), Vec::<String>::new(), 0_usize);
    for letter in text.chars() {
        match letter {
            '(' | '[' | '{' if depth == 0 => {
                contents.push(String::new());
                outside.push(' ');
                depth = 1;
                continue;
            }
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' if depth > 0 => depth -= 1,
            _ => {}
        }
        match contents.last_mut() {
            Some(content) if depth > 0 => content.push(letter),
            _ if !matches!(letter, ')' | ']' | '}') => outside.push(letter),
            _ => {}
        }
    }
    (outside, contents.into_iter().map(|content| content.trim().to_owned()).collect())
}

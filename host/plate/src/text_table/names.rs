//! The one table of what columns are called: quantities in the languages and programs that write them, and words that
//! change nothing, or that make a column another one.

use super::units::{Unit, unit};

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Frequency, hertz.
    Frequency,
    /// A level in decibels.
    Level,
    /// A magnitude.
    Magnitude,
    /// A magnitude of the deflection, metres.
    Displacement,
    /// A magnitude of the velocity, m/s.
    Velocity,
    /// A magnitude of the acceleration, m/s^2.
    Acceleration,
    /// A magnitude of the strain.
    Strain,
    /// A phase.
    Phase,
    /// The real part of a response.
    Real,
    /// The imaginary part of a response.
    Imaginary,
    /// A place, metres.
    Place,
    /// A time, seconds.
    Time,
    /// The number of a tone.
    Tone,
}

impl Quantity {
    /// Its name in a report and in an option.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Frequency => "frequency",
            Self::Level => "level",
            Self::Magnitude => "magnitude",
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Strain => "strain",
            Self::Phase => "phase",
            Self::Real => "real",
            Self::Imaginary => "imaginary",
            Self::Place => "place",
            Self::Time => "time",
            Self::Tone => "tone",
        }
    }

    /// Whether it is the size of a response.
    pub(crate) const fn is_level(self) -> bool {
        matches!(
            self,
            Self::Level
                | Self::Magnitude
                | Self::Displacement
                | Self::Velocity
                | Self::Acceleration
                | Self::Strain
        )
    }
}

/// What a word of a name is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Word {
    Is(Quantity),
    /// Changes nothing.
    Plain,
    /// Makes the column another one, which is left out.
    Other,
}

/// Synonyms in English, German, French, Spanish, Italian, Portuguese, Dutch, the Nordic languages, Polish, Czech, Russian,
/// Chinese, Japanese and Korean, and the abbreviations of programs.
const WORDS: &[(Word, &str)] = &[
    (
        Word::Is(Quantity::Frequency),
        "frequency frequencies freq freqs frq f fréquence frequence frequenz frequenzen frecuencia frequenza frequência \
         frequencia frequentie frekvens taajuus częstotliwość frekvence частота 频率 頻率 周波数 주파수",
    ),
    (
        Word::Is(Quantity::Level),
        "level levels spl dbspl pegel schalldruckpegel niveau nivel nível livello nivå niveauet taso poziom úroveň уровень レベル",
    ),
    (
        Word::Is(Quantity::Magnitude),
        "magnitude magnitudes mag magn abs amplitude amplitudes ampl amp betrag amplitudengang module modulo módulo modul \
         magnitud amplitud ampiezza amplituda амплитуда 幅值 振幅 진폭",
    ),
    (
        Word::Is(Quantity::Displacement),
        "displacement disp deflection deplacement déplacement auslenkung verschiebung weg wegamplitude desplazamiento \
         spostamento deslocamento verplaatsing",
    ),
    (
        Word::Is(Quantity::Velocity),
        "velocity vel vitesse geschwindigkeit schnelle velocidad velocità velocidade snelheid",
    ),
    (
        Word::Is(Quantity::Acceleration),
        "acceleration accel acc accélération beschleunigung aceleración accelerazione aceleração versnelling",
    ),
    (Word::Is(Quantity::Strain), "strain dehnung déformation deformación deformazione rek"),
    (
        Word::Is(Quantity::Phase),
        "phase phases phasenwinkel phasengang phasenlage phi φ ϕ angle winkel fase fasen fáze faza vaihe arg argument ang angolo \
         ángulo hoek фаза 相位 位相 위상",
    ),
    (Word::Is(Quantity::Real), "real re réel réelle reell realteil reale reel"),
    (
        Word::Is(Quantity::Imaginary),
        "imaginary imag im img imaginär imaginärteil imaginaerteil imaginaire imaginario imaginaria immaginaria \
         immaginario",
    ),
    (Word::Is(Quantity::Place), "place position pos x distance ort abstand lieu"),
    (Word::Is(Quantity::Time), "time t zeit temps tiempo tempo"),
    (Word::Is(Quantity::Tone), "tone ton"),
    (
        Word::Plain,
        "of the and part teil partie parte response antwort réponse respuesta risposta function funktion fonction frf tf \
         transfer h h1 h2 hv gain verstärkung trace spur channel ch kanal canal voie sensor mic mikrofon microphone \
         measured signal value wert vib vibration sound pressure schalldruck unwrapped wrapped data frequenzgang",
    ),
    (
        Word::Other,
        "coherence coh kohärenz kohaerenz cohérence coherencia coerenza γ2 γ² noise rauschen bruit snr thd std stdev sd \
         sigma error err uncertainty tolerance deviation variance delay temperature date index idx \
         weight headroom step resolution bandwidth sampling sample samples delta difference diff offset change \
         quality group samplerate",
    ),
];

fn word_of(word: &str) -> Option<Word> {
    let is_digits = word.bytes().all(|byte| byte.is_ascii_digit());
    let found = || WORDS.iter().find(|(_, words)| words.split(' ').any(|it| it == word)).map(|it| it.0);
    if is_digits { Some(Word::Plain) } else { found() }
}

/// What the name of a column says.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Name {
    pub(super) quantity: Option<Quantity>,
    /// Whether each of its words is known.
    pub(super) is_clear: bool,
    /// Whether a word makes it another column.
    pub(super) is_other: bool,
    /// The text of its unit, and the unit if it is known.
    pub(super) unit: Option<(String, Option<Unit>)>,
}

impl Name {
    /// Reads *name (unit)*, *name [unit]*, *name unit* or a unit alone.
    pub(super) fn of(text: &str) -> Self {
        if word_of(&text.to_lowercase()).is_none()
            && let Some(found) = unit(text)
        {
            return Self {
                quantity: None,
                is_clear: true,
                is_other: false,
                unit: Some((text.to_owned(), Some(found))),
            };
        }
        let mut found = None;
        let mut text = text.trim();
        if let Some((name, last)) = text.rsplit_once(char::is_whitespace)
            && word_of(&last.to_lowercase()).is_none()
            && let Some(of) = unit(last)
        {
            let is_bracketed = last.starts_with(['(', '[']) && last.ends_with([')', ']']);
            let last = if is_bracketed { &last[1..last.len() - 1] } else { last };
            (text, found) = (name, Some((last.to_owned(), Some(of))));
        }
        let (mut words, bracketed) = without_brackets(text);
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
                Some(Word::Plain) => {}
                Some(Word::Other) => is_other = true,
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
            is_clear: is_clear && kinds.len() <= 1,
            is_other,
            unit: found,
        }
    }
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
    let parts = |letter: char| !letter.is_alphanumeric() && !matches!(letter, '°' | '%' | '²');
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

//! The one table of what columns are called: quantities in the languages and programs that write them, and words that
//! change nothing, that make a column another one, or that turn its meaning round.

use super::quantities::Quantity;

/// What a word of a name is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Word {
    Is(Quantity),
    /// A quantity with several usual units: the column must state one.
    InUnit(Quantity),
    /// Changes nothing.
    Plain,
    /// Makes the column another one, which is left out.
    Other,
    /// Changes the numbers, so that the other words do not state their meaning.
    Changed,
}

/// Synonyms, in lower case. Accents may be missing in a file.
const WORDS: &[(Word, &str)] = &[
    (
        Word::Is(Quantity::Frequency),
        "frequency frequencies freq freqs frq f fréquence frequenz frequenzen frecuencia frequenza frequência frequentie \
         frekvens taajuus częstotliwość frekvence frekvencia frekvenca frekvencija frekans frecvență freqüència συχνότητα \
         частота честота 频率 頻率 周波数 주파수",
    ),
    (Word::InUnit(Quantity::Frequency), "angular omega ω kreisfrequenz pulsation"),
    (
        Word::Is(Quantity::Level),
        "level levels spl dbspl pegel schalldruckpegel niveau nivel nível livello nivå niveauet taso poziom úroveň szint \
         seviye nivell nivo razina στάθμη уровень рівень ниво レベル 电平 級",
    ),
    (
        Word::Is(Quantity::Magnitude),
        "magnitude magnitudes mag magn abs amplitude amplitudes ampl amp betrag amplitudengang module modulo modul magnitud \
         amplitud ampiezza amplituda amplitúdó genlik πλάτος амплитуда ачх 幅值 幅度 振幅 진폭 크기",
    ),
    (
        Word::Is(Quantity::Displacement),
        "displacement disp deflection déplacement auslenkung verschiebung weg wegamplitude desplazamiento spostamento \
         deslocamento verplaatsing receptance compliance",
    ),
    (
        Word::Is(Quantity::Velocity),
        "velocity vel vitesse geschwindigkeit schnelle velocidad velocità velocidade snelheid mobility",
    ),
    (
        Word::Is(Quantity::Acceleration),
        "acceleration accel acc accélération beschleunigung aceleración accelerazione aceleração versnelling accelerance \
         inertance",
    ),
    (Word::Is(Quantity::Strain), "strain dehnung déformation deformación deformazione rek"),
    (
        Word::Is(Quantity::Phase),
        "phase phases phasenwinkel phasengang phasenlage ph phi φ ϕ angle winkel fase fasen fas fáze fáza faza faz fázis fază \
         vaihe arg argument ang angolo ángulo hoek φάση фаза фчх 相位 位相 위상",
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
    (
        Word::Changed,
        "log log10 log2 ln lg lag inverse inverted reciprocal negative minus squared square power leistung puissance density \
         dichte normalized normalised normiert relative attenuation dämpfung loss reduction half double",
    ),
];

pub(super) fn word_of(word: &str) -> Option<Word> {
    if word.bytes().all(|byte| byte.is_ascii_digit()) {
        return Some(Word::Plain);
    }
    let plain: Vec<char> = without_accents(word).collect();
    let is_same = |it: &str| without_accents(it).eq(plain.iter().copied());
    WORDS.iter().find(|(_, words)| words.split(' ').any(is_same)).map(|it| it.0)
}

/// Latin letters with accents, each after the plain one.
const ACCENTS: [&str; 15] = [
    "aáàâäãåąă",
    "cçćč",
    "dď",
    "eéèêëęě",
    "gğ",
    "iíìîï",
    "lł",
    "nñńň",
    "oóòôöõøő",
    "rř",
    "sśšşș",
    "tťțţ",
    "uúùûüůű",
    "yý",
    "zźżž",
];

/// The letters of a word without accents, which may be marks of their own.
fn without_accents(word: &str) -> impl Iterator<Item = char> {
    let plain = |letter: char| {
        let group = ACCENTS.iter().find(|group| group.contains(letter));
        group.and_then(|group| group.chars().next()).unwrap_or(letter)
    };
    word.chars().filter(|letter| !('\u{300}'..='\u{36f}').contains(letter)).map(plain)
}

//! Plates between two workers of a browser. A plate is sent once, as the text of its file, under a number; after that
//! its number stands for it on both sides, and what comes back has the very plate that was sent.
//!
//! ```text
//! Arc<Plate> --by_number--> 7, text  ==>  7 --by_number--> Arc<Plate>
//!            <--by_number-- 7        <==  7 <--by_number--
//! ```
//! Each side has an [`Exchange`] for the other one; both must read all messages in the order in which they were written.

use crate::Plate;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::sync::Arc;

/// Plates that are kept; older ones are sent again.
const KEPT: usize = 64;

/// The plates that one side has sent to the other.
#[derive(Debug, Default)]
pub struct Exchange {
    plates: VecDeque<(u64, Arc<Plate>)>,
    /// The latest number that this side has given.
    latest: u64,
}

thread_local! {
    static ACTIVE: RefCell<Option<Exchange>> = const { RefCell::new(None) };
}

impl Exchange {
    /// Runs `use_it`, in which plates are written and read [`by_number`] of this exchange.
    pub fn run<T>(&mut self, use_it: impl FnOnce() -> T) -> T {
        ACTIVE.set(Some(std::mem::take(self)));
        let done = use_it();
        *self = ACTIVE.take().unwrap_or_default();
        done
    }

    /// The number of a plate, and whether the other side has it.
    fn number(&mut self, plate: &Arc<Plate>) -> (u64, bool) {
        if let Some((number, _)) = self.plates.iter().find(|(_, known)| Arc::ptr_eq(known, plate)) {
            return (*number, true);
        }
        self.latest += 1;
        self.keep(self.latest, Arc::clone(plate));
        (self.latest, false)
    }

    fn keep(&mut self, number: u64, plate: Arc<Plate>) {
        // The side that gives the next number has read all numbers so far.
        self.latest = self.latest.max(number);
        if self.plates.len() == KEPT {
            self.plates.pop_front();
        }
        self.plates.push_back((number, plate));
    }
}

/// The serde form of a plate within [`Exchange::run`].
pub mod by_number {
    use super::{ACTIVE, Arc, Plate};
    use serde::{Deserialize as _, Deserializer, Serialize as _, Serializer, de, ser};

    /// Writes the plate's number; with the text of its file the first time.
    ///
    /// # Errors
    /// Outside an exchange, and those of the serialiser.
    pub fn serialize<S: Serializer>(plate: &Arc<Plate>, serializer: S) -> Result<S::Ok, S::Error> {
        let named = ACTIVE.with_borrow_mut(|active| active.as_mut().map(|exchange| exchange.number(plate)));
        let (number, is_known) = named.ok_or_else(|| ser::Error::custom("a plate outside an exchange"))?;
        (number, (!is_known).then(|| plate.to_toml())).serialize(serializer)
    }

    /// Reads a plate by its number.
    ///
    /// # Errors
    /// Outside an exchange; a number that was not sent; a text that is no plate; those of the deserialiser.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Arc<Plate>, D::Error> {
        let (number, text) = <(u64, Option<String>)>::deserialize(deserializer)?;
        let sent = text.map(|text| Plate::from_toml(&text).map(Arc::new)).transpose();
        let sent = sent.map_err(de::Error::custom)?;
        ACTIVE.with_borrow_mut(|active| {
            let exchange = active.as_mut().ok_or_else(|| de::Error::custom("a plate outside an exchange"))?;
            if let Some(plate) = sent {
                exchange.keep(number, Arc::clone(&plate));
                return Ok(plate);
            }
            let known = exchange.plates.iter().find(|(of, _)| *of == number);
            known
                .map(|(_, plate)| Arc::clone(plate))
                .ok_or_else(|| de::Error::custom("a plate that was not sent"))
        })
    }
}

/// The serde form of a plate that needs no identity: the text of its file.
pub(crate) mod by_text {
    use super::Plate;
    use serde::{Deserialize as _, Deserializer, Serializer, de};

    /// Writes the text.
    ///
    /// # Errors
    /// The serialiser's error.
    pub(crate) fn serialize<S: Serializer>(plate: &Plate, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&plate.to_toml())
    }

    /// Reads the plate of a text.
    ///
    /// # Errors
    /// A text that is no plate; that of the deserialiser.
    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Plate, D::Error> {
        Plate::from_toml(&String::deserialize(deserializer)?).map_err(de::Error::custom)
    }
}

/// The serde form of a plate that may be missing: see [`by_number`].
pub mod maybe_by_number {
    use super::{Arc, Plate, by_number};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    struct Sent(#[serde(with = "by_number")] Arc<Plate>);

    /// Writes the plate, if there is one.
    ///
    /// # Errors
    /// As [`by_number::serialize`].
    pub fn serialize<S: Serializer>(plate: &Option<Arc<Plate>>, serializer: S) -> Result<S::Ok, S::Error> {
        plate.clone().map(Sent).serialize(serializer)
    }

    /// Reads the plate, if there is one.
    ///
    /// # Errors
    /// As [`by_number::deserialize`].
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Arc<Plate>>, D::Error> {
        Ok(Option::<Sent>::deserialize(deserializer)?.map(|Sent(plate)| plate))
    }
}

/// The serde form of rows of numbers, each with its frequency: the bytes that they are in memory. A rig has millions of them, and the
/// page's thread, which would read them one by one, draws nothing meanwhile.
pub(crate) mod by_bytes {
    use num_complex::Complex64;
    use serde::de::{Deserializer, Error, Visitor};
    use serde::ser::Serializer;
    use std::fmt;

    type Rows = Vec<(f64, Vec<Complex64>)>;

    pub(crate) fn serialize<S: Serializer>(rows: &Rows, serializer: S) -> Result<S::Ok, S::Error> {
        let mut bytes = Vec::new();
        for (frequency_hz, row) in rows {
            bytes.extend_from_slice(&(row.len() as u64).to_le_bytes());
            bytes.extend_from_slice(&frequency_hz.to_le_bytes());
            bytes.reserve(16 * row.len());
            for number in row {
                bytes.extend_from_slice(&number.re.to_le_bytes());
                bytes.extend_from_slice(&number.im.to_le_bytes());
            }
        }
        serializer.serialize_bytes(&bytes)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Rows, D::Error> {
        struct Bytes;

        impl Visitor<'_> for Bytes {
            type Value = Rows;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the bytes of rows of numbers")
            }

            fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Rows, E> {
                let (words, rest) = bytes.as_chunks::<8>();
                let mut words = words;
                let mut rows = Rows::new();
                while let [count, frequency_hz, others @ ..] = words {
                    let count =
                        usize::try_from(u64::from_le_bytes(*count)).ok().and_then(|it| it.checked_mul(2));
                    let (row, next) = count
                        .and_then(|count| others.split_at_checked(count))
                        .ok_or_else(|| E::custom("a row is cut"))?;
                    let (pairs, _) = row.as_chunks::<2>();
                    let number = |&[re, im]: &[[u8; 8]; 2]| {
                        Complex64::new(f64::from_le_bytes(re), f64::from_le_bytes(im))
                    };
                    rows.push((f64::from_le_bytes(*frequency_hz), pairs.iter().map(number).collect()));
                    words = next;
                }
                if words.is_empty() && rest.is_empty() { Ok(rows) } else { Err(E::custom("a row is cut")) }
            }
        }

        deserializer.deserialize_bytes(Bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex64;
    use serde::{Deserialize, Serialize};

    #[derive(Serialize, Deserialize)]
    struct Message {
        #[serde(with = "by_number")]
        plate: Arc<Plate>,
        #[serde(with = "maybe_by_number")]
        other: Option<Arc<Plate>>,
    }

    fn sent(from: &mut Exchange, to: &mut Exchange, message: &Message) -> (usize, Message) {
        let bytes = from.run(|| postcard::to_extend(message, Vec::new())).unwrap();
        let read = to.run(|| postcard::from_bytes(&bytes)).unwrap();
        (bytes.len(), read)
    }

    #[test]
    fn a_plate_is_sent_once_and_comes_back_as_the_one_that_was_sent() {
        let (mut here, mut there) = (Exchange::default(), Exchange::default());
        for name in crate::presets().iter().map(|preset| preset.name) {
            let plate = Arc::new(crate::preset(name).unwrap());
            let message = Message { plate: Arc::clone(&plate), other: Some(Arc::clone(&plate)) };
            let (first, arrived) = sent(&mut here, &mut there, &message);
            assert_eq!(arrived.plate.spec(), plate.spec(), "{name}");
            assert!(Arc::ptr_eq(&arrived.plate, arrived.other.as_ref().unwrap()));
            let (again, second) = sent(&mut here, &mut there, &message);
            assert!(Arc::ptr_eq(&second.plate, &arrived.plate) && again < first / 2);
            let back = Message { plate: arrived.plate, other: None };
            let (_, back) = sent(&mut there, &mut here, &back);
            assert!(Arc::ptr_eq(&back.plate, &plate) && back.other.is_none());
        }
    }

    #[test]
    fn a_plate_that_comes_back_with_a_result_is_not_taken_for_one_that_was_sent() {
        let (mut here, mut there) = (Exchange::default(), Exchange::default());
        let [asked, made, next] = ["membrane", "al-bending", "latex-membrane"]
            .map(|name| Message { plate: Arc::new(crate::preset(name).unwrap()), other: None });
        let (_, arrived) = sent(&mut here, &mut there, &asked);
        let (_, result) = sent(&mut there, &mut here, &made);
        assert_eq!(result.plate.spec(), made.plate.spec());
        let (_, arrived_next) = sent(&mut here, &mut there, &next);
        assert_eq!(arrived_next.plate.spec(), next.plate.spec());
        for (message, plate) in
            [(&asked, &arrived.plate), (&result, &made.plate), (&next, &arrived_next.plate)]
        {
            assert!(Arc::ptr_eq(&sent(&mut here, &mut there, message).1.plate, plate));
        }
    }

    #[test]
    fn both_sides_forget_the_same_plates_and_a_plate_outside_is_refused() {
        let (mut here, mut there) = (Exchange::default(), Exchange::default());
        let plates: Vec<Arc<Plate>> =
            (0..=KEPT).map(|_| Arc::new(crate::preset("membrane").unwrap())).collect();
        for plate in plates.iter().chain(&plates[..1]) {
            let message = Message { plate: Arc::clone(plate), other: None };
            let (_, arrived) = sent(&mut here, &mut there, &message);
            let (_, back) = sent(&mut there, &mut here, &arrived);
            assert!(Arc::ptr_eq(&back.plate, plate));
        }
        assert_eq!((here.plates.len(), there.plates.len()), (KEPT, KEPT));
        let message = Message { plate: Arc::clone(&plates[0]), other: None };
        assert!(postcard::to_extend(&message, Vec::new()).is_err());
        let bytes = here.run(|| postcard::to_extend(&message, Vec::new())).unwrap();
        assert!(
            Exchange::default().run(|| postcard::from_bytes::<Message>(&bytes)).is_err(),
            "a number that was not sent"
        );
        assert!(there.run(|| postcard::from_bytes::<Message>(&bytes)).is_ok());
    }

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Rows(#[serde(with = "by_bytes")] Vec<(f64, Vec<Complex64>)>);

    /// Bytes as they are.
    struct Raw<'a>(&'a [u8]);

    impl Serialize for Raw<'_> {
        fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            serializer.serialize_bytes(self.0)
        }
    }

    #[test]
    fn rows_of_numbers_come_back_to_the_bit_and_cut_ones_are_refused() {
        let row = vec![Complex64::new(0.1, -0.0), Complex64::new(f64::MIN_POSITIVE, 1e300)];
        let rows = Rows(vec![(20.5, row), (21.0, Vec::new())]);
        let sent = postcard::to_extend(&rows, Vec::new()).unwrap();
        assert_eq!(postcard::from_bytes::<Rows>(&sent).unwrap(), rows);
        // Their length stands before the bytes: 64 of them.
        let [length, bytes @ ..] = sent.as_slice() else { panic!("nothing was sent") };
        assert_eq!((usize::from(*length), bytes.len()), (64, 64));
        for cut in [7, 8, 24, 47, 56, 63] {
            let cut_short = postcard::to_extend(&Raw(&bytes[..cut]), Vec::new()).unwrap();
            assert!(postcard::from_bytes::<Rows>(&cut_short).is_err(), "{cut}");
        }
    }
}

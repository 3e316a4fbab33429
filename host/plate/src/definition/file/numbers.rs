//! A plate file whose numbers vary from plate to plate.

use super::text::Text;
use super::{in_text, parse, read};
use crate::definition::error::{PlateError, PlateFileError};
use crate::definition::fields::SECTIONS;
use crate::definition::plate::Plate;

/// A plate file, parsed once, of which many plates with other numbers are made.
///
/// ```
/// use slipline_plate::{PlateFile, preset};
///
/// let text = preset("membrane").unwrap().to_toml();
/// let (file, nominal) = PlateFile::parse(&text).unwrap();
/// let faster = file.plate_with(&[("model.wave_speed_m_per_s", 12.1)], &nominal).unwrap();
/// assert!(faster.cut_off_hz() > nominal.cut_off_hz());
/// assert!(file.plate_with(&[("loss_factor", 0.9)], &nominal).is_err());
/// ```
pub struct PlateFile<'t>(Text<'t>);

impl<'t> PlateFile<'t> {
    /// Parses a plate file; the plate is the one with the file's own numbers.
    ///
    /// # Errors
    /// As [`Plate::from_toml`].
    pub fn parse(text: &'t str) -> Result<(Self, Plate), PlateFileError> {
        let text = parse(text)?;
        let plate = read(&text, &[], None).map_err(|error| in_text(&text, error))?;
        Ok((Self(text), plate))
    }

    /// The numbers that the file states, each with the path of its field, such as `taper.rate_per_m`.
    #[must_use]
    pub fn numbers(&self) -> Vec<(String, f64)> {
        let given = SECTIONS.iter().filter_map(|schema| self.0.section(schema, &[]).ok().flatten());
        given.flat_map(|section| section.numbers().collect::<Vec<_>>()).collect()
    }

    /// The plate of this file with other numbers, by the paths of their fields. A field that the file does not state is
    /// left alone. What the plates have in common is taken from `nominal`.
    ///
    /// # Errors
    /// As [`Plate::new`].
    pub fn plate_with(&self, changes: &[(&str, f64)], nominal: &Plate) -> Result<Plate, PlateError> {
        read(&self.0, changes, Some(nominal))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets;

    #[test]
    fn every_number_of_a_file_can_be_changed_and_gives_the_plate_of_the_changed_text() {
        for preset in presets() {
            let text = preset.plate().expect("a preset").to_toml();
            let (file, nominal) = PlateFile::parse(&text).expect("valid");
            let numbers = file.numbers();
            assert!(numbers.len() >= 9, "{}: {numbers:?}", preset.name);
            for (path, number) in &numbers {
                // Another number, also where it is 0.
                let other = 1.001 * number + 1e-9;
                let name = path.rsplit('.').next().expect("a name");
                let (section, _) = path.rsplit_once('.').unwrap_or_default();
                // The line of this field in its own section.
                let mut here = "";
                let lines: Vec<String> = text
                    .lines()
                    .map(|line| {
                        here = line.strip_prefix('[').map_or(here, |rest| rest.trim_end_matches(']'));
                        let is_it = here == section && line.starts_with(&format!("{name} = "));
                        if is_it { format!("{name} = {other:?}") } else { line.to_owned() }
                    })
                    .collect();
                let changed = lines.join("\n");
                assert_ne!(changed, text.trim_end(), "{}: {path}", preset.name);
                let with = file.plate_with(&[(path, other)], &nominal);
                match Plate::from_toml(&changed) {
                    Ok(plate) => assert_eq!(with.as_ref(), Ok(&plate), "{}: {path}", preset.name),
                    Err(PlateFileError::Plate { error, .. }) => assert_eq!(with, Err(error), "{path}"),
                    Err(error) => panic!("{path}: {error}"),
                }
            }
            assert_eq!(file.plate_with(&[("no.such", 1.0), ("rate_per_m", 9.0)], &nominal), Ok(nominal));
        }
    }
}

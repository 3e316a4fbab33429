//! Textures in the background: first the tones, fast enough to follow a pointer that draws; then the slower steps.

use crate::jobs::Task;
use crate::jobs::table::TableMade;
use crate::texture::{Made, Wish, make};
use slipline_plate::Progress;
use slipline_plate::feeling::Feeling;
use slipline_plate::texture::{Palette, TextureError};
use std::sync::Arc;

/// The wanted texture and its plate.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct TextureWish {
    /// The plate and its table.
    pub table: Arc<TableMade>,
    /// The wanted texture.
    pub wish: Wish,
    /// RMS displacement of the largest amplitude of a profile, in metres; `None`: as large as the tones allow.
    pub level_m: Option<f64>,
    /// Largest number of tones.
    pub most: usize,
    /// How a finger feels.
    pub feeling: Feeling,
}

impl PartialEq for TextureWish {
    fn eq(&self, other: &Self) -> bool {
        // A table that a page's worker sends back is a copy, but it has the very plate.
        Arc::ptr_eq(&self.table.plate, &other.table.plate)
            && self.table.device_table.crc() == other.table.device_table.crc()
            && self.wish == other.wish
            && self.level_m == other.level_m
            && self.most == other.most
            && self.feeling == other.feeling
    }
}

/// A texture to make.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct TextureJob {
    /// The wanted texture.
    pub wish: TextureWish,
    /// Its tones, if they are computed already and only the slower steps remain.
    pub begun: Option<Arc<Made>>,
}

/// Why a texture was refused; numbers out of range are shown in suitable units.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", if let TextureError::OutOfRange(error) = .0 { error.in_suitable_units() } else { .0.to_string() })]
#[derive(serde::Serialize, serde::Deserialize)]
pub struct TextureRefused(pub TextureError);

/// The result of a job.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Textured {
    /// The wish of the job.
    pub wish: TextureWish,
    /// The texture, or why it was refused.
    pub result: Result<Arc<Made>, TextureRefused>,
    /// RMS displacement of its tones at places uniform from 0 to the plate's end, in metres; empty if there is none.
    pub rms_m: Vec<f64>,
    /// Whether all steps are done.
    pub is_finished: bool,
}

/// The RMS displacement of a texture's tones at the palette's places, in metres.
fn rms_m(palette: &Palette<'_>, made: &Made) -> Result<Vec<f64>, TextureError> {
    let peak_m = palette.table().peak_at_full_scale_m();
    let positions_m: Vec<f64> = made.tones.iter().map(|tone| tone.position_m).collect();
    let powers: Vec<f64> = made.tones.iter().map(|tone| (tone.level * peak_m).powi(2)).collect();
    let squares = palette.squares(&positions_m)?.times(&powers);
    Ok(squares.into_iter().map(f64::sqrt).collect())
}

/// Carries out a job. `None` if it was cancelled.
#[must_use]
pub fn work(job: TextureJob, task: &Task) -> Option<Textured> {
    let TextureJob { wish, begun } = job;
    let palette = Palette::new(&wish.table.plate, &wish.table.drive_table);
    let is_finished = begun.is_some();
    let mut go_on = |share| task.report(share);
    let progress = &mut Progress::new(&mut go_on);
    let made = match begun {
        Some(made) => Made::clone(&made).finished(&palette, &wish.feeling, progress),
        None => {
            make(&palette, &wish.wish, wish.most, &wish.feeling, progress).map(|made| match wish.level_m {
                Some(level_m) => made.at_level(level_m, &palette),
                None => made,
            })
        }
    };
    let drawn = made.and_then(|made| Ok((rms_m(&palette, &made)?, Arc::new(made))));
    let (rms_m, result) = match drawn {
        Ok((rms_m, made)) => (rms_m, Ok(made)),
        Err(TextureError::Stopped(_)) => return None,
        Err(error) => (Vec::new(), Err(TextureRefused(error))),
    };
    let is_finished = is_finished || result.is_err();
    Some(Textured { wish, result, rms_m, is_finished })
}

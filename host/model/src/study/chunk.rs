//! The results of a range of plates, as arrays.

/// Whether a plate has results, and why not. The numbers are those of stores and never change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Status {
    /// Not computed yet; only in stores.
    NotYet = 0,
    /// Every place has its numbers.
    Done = 1,
    /// The plate file refuses the plate: a field is out of its range.
    Refused = 2,
    /// At one place or more the wave does not enter the plate.
    CannotEnter = 3,
    /// At one place or more the wave turns so far beyond the plate's end that it is not solved.
    TooHigh = 4,
    /// At one place or more the amplitude is zero or not finite.
    Silent = 5,
    /// At one place or more the plate in two dimensions is not solved: too fine, or its air does not converge.
    NotSolved = 6,
    /// Its worker has failed at it again and again; only in stores.
    WorkerFailed = 7,
}

impl Status {
    /// Every status, by its number.
    pub const ALL: [Self; 8] = [
        Self::NotYet,
        Self::Done,
        Self::Refused,
        Self::CannotEnter,
        Self::TooHigh,
        Self::Silent,
        Self::NotSolved,
        Self::WorkerFailed,
    ];

    /// Its meaning in one word, for a store's `flag_meanings` and a table's column.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::NotYet => "not_yet",
            Self::Done => "done",
            Self::Refused => "plate_refused",
            Self::CannotEnter => "wave_does_not_enter",
            Self::TooHigh => "turns_far_beyond_the_end",
            Self::Silent => "no_amplitude",
            Self::NotSolved => "not_solved",
            Self::WorkerFailed => "worker_failed",
        }
    }
}

/// The results of the plates `first`, `first` + 1, ... Arrays of two dimensions are flat, plate by plate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chunk {
    /// Number of the first plate.
    pub first: u64,
    /// Status of each plate.
    pub status: Vec<Status>,
    /// The varied fields of each plate, in the unit of the plate file, in the order of [`super::Spec::varied`].
    pub varied: Vec<f64>,
    /// The numbers of each of [`super::Spec::results`], by plate and place.
    pub results: Vec<Vec<f64>>,
}

impl Chunk {
    pub(super) fn empty(first: u64, results: usize) -> Self {
        Self { first, results: vec![Vec::new(); results], ..Self::default() }
    }
}

//! The feeling of a finger by which felt edges are computed.

use crate::setup::file::FeelingText;
use serde::Serialize;
use slipline_plate::feeling::Feeling;

/// A feeling and its source.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FeelingAnswer<'a> {
    /// JSON, text: default, or the file of the feeling
    pub from: &'a str,
    /// The numbers of the finger.
    #[serde(flatten)]
    pub values: FeelingText,
}

impl<'a> FeelingAnswer<'a> {
    /// The fields of a feeling from this file; `None` for that of a usual finger.
    #[must_use]
    pub fn of(feeling: &Feeling, from: Option<&'a str>) -> Self {
        Self { from: from.unwrap_or("default"), values: (*feeling).into() }
    }
}

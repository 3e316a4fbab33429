//! Why a typed text is not taken, as the field shows it.

use slipline_model::setup::Setup;
use slipline_model::setup::edit::{self, Edit};
use slipline_plate::quantity::{NotAllowed, QuantityError};
use std::fmt;

/// Why a typed text is not taken: what was given, what is wrong with it, and the allowed range in the form in which it is typed.
#[derive(Debug)]
pub(crate) struct Refusal {
    given: String,
    reason: NotAllowed<String>,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.given, self.reason)
    }
}

impl std::error::Error for Refusal {}

impl Refusal {
    /// The number of the field `name`, in the unit that `read` gives.
    pub(crate) fn read(
        name: &str,
        text: &str,
        allowed: &str,
        read: fn(&str) -> Result<f64, QuantityError>,
    ) -> Result<f64, Self> {
        read(text).map_err(|mistake| Self {
            given: name.to_owned(),
            reason: NotAllowed { mistake: Some(mistake), allowed: allowed.to_owned() },
        })
    }

    /// A number beyond the allowed range.
    pub(crate) fn beyond(name: &str, text: &str, allowed: &str) -> Self {
        Self {
            given: format!("{name} {}", text.trim()),
            reason: NotAllowed { mistake: None, allowed: allowed.to_owned() },
        }
    }

    /// This edit, if the setup takes it; `text` is the typed text.
    pub(crate) fn check(
        setup: &Setup,
        edit: Edit,
        name: &str,
        text: &str,
        allowed: &str,
    ) -> Result<Edit, Self> {
        match edit::apply(setup, &edit) {
            Ok(_) => Ok(edit),
            Err(_) => Err(Self::beyond(name, text, allowed)),
        }
    }
}

//! Inputs that more than one panel or dialog has: a typed quantity, a slider, a group of fields of one thing.
//!
//! A field shows a value, takes the user's text and returns an intent. What only one page has stays in the page.

pub(crate) mod choice;
pub(crate) mod drive_fields;
pub(crate) mod feeling_fields;
pub(crate) mod field;
pub(crate) mod foreign_form;
pub(crate) mod hold_fields;
pub(crate) mod lines;
pub(crate) mod measure_form;
pub(crate) mod place_field;
pub(crate) mod refusal;
pub(crate) mod sensor_fields;
pub(crate) mod slider;
pub(crate) mod sound;

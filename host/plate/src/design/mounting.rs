//! Mountings of the sheet in its frame, for the edge condition of the wave model.

/// Mounting of the sheet in its frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Mounting {
    /// The sheet lies on a narrow lip that can rotate: supported edges.
    Lip,
    /// A margin of the sheet is clamped and cannot rotate: clamped or fixed edges.
    Gripped,
    /// A margin of the sheet is clamped under tension: a membrane.
    Stretched,
}

impl Mounting {
    /// Two sentences for the user: the parts to cut, and their assembly.
    #[must_use]
    pub fn sentence(self) -> &'static str {
        match self {
            Self::Lip => {
                "Cut the frame twice and lay the plate between the two, its lip of 1 mm over the window's edge. \
                 Keep the frames apart by washers of the plate's thickness on the bolts: the lip must not lift, but it must turn."
            }
            Self::Gripped => {
                "Cut the frame twice and bolt the plate's margin between the two. \
                 Tighten until the edge cannot turn in the window."
            }
            Self::Stretched => {
                "Cut the frame twice, stretch the sheet to its tension and bolt it between the two. \
                 Cut and punch the sheet only once it is stretched: before, it is smaller than drawn."
            }
        }
    }
}

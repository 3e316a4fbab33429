//! How sheet and frame are put together, so that the edges are held as the wave's equation has them.

/// How the frame holds the sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mounting {
    /// On a narrow lip that may turn: supported edges.
    Lip,
    /// By a margin that may not turn: clamped or fixed edges.
    Gripped,
    /// By a margin, under tension: a membrane.
    Stretched,
}

impl Mounting {
    /// What to cut and how to put it together, in two sentences.
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

//! Two setups to compare, A and B: one is on the screen, the other is kept.

use crate::setup::Setup;
use crate::setup::edit::Edit;

/// One of the two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// The first.
    #[default]
    A,
    /// The second.
    B,
}

impl Side {
    /// The other one.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }

    /// Its letter.
    #[must_use]
    pub const fn letter(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }
}

/// The side on the screen, and the setup of the other side.
#[derive(Clone, Debug, Default)]
pub struct Compare {
    side: Side,
    other: Option<Setup>,
}

impl Compare {
    /// The side on the screen.
    #[must_use]
    pub const fn side(&self) -> Side {
        self.side
    }

    /// The setup kept on the other side; `None` before the first switch.
    #[must_use]
    pub const fn other(&self) -> Option<&Setup> {
        self.other.as_ref()
    }

    /// Switches to the other side: keeps the present setup and returns the change that shows the other one.
    /// At the first switch B is a copy of A.
    pub fn switch(&mut self, present: &Setup) -> Edit {
        let next = self.other.replace(present.clone()).unwrap_or_else(|| present.clone());
        self.side = self.side.other();
        Edit::Switch(Box::new(next))
    }

    /// A switch was undone or redone; `left` is the setup that was on the screen until then.
    pub fn undone(&mut self, left: Setup) {
        self.other = Some(left);
        self.side = self.side.other();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::edit::apply;
    use std::sync::Arc;

    #[test]
    fn a_switch_keeps_what_was_changed_on_each_side() {
        let a = Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()));
        let mut compare = Compare::default();
        assert!(compare.other().is_none());
        let b = apply(&a, &compare.switch(&a)).unwrap();
        assert_eq!((&b, compare.side()), (&a, Side::B));
        let b = apply(&b, &Edit::Master(-6.0)).unwrap();
        let back = apply(&b, &compare.switch(&b)).unwrap();
        assert_eq!((&back, compare.side(), compare.other()), (&a, Side::A, Some(&b)));
        compare.undone(back);
        assert_eq!((compare.side(), compare.other()), (Side::B, Some(&a)));
    }
}

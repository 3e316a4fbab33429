//! The two amplitude equations: the one of the wave equation, and the paper's.

/// Which amplitude equation is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Equation {
    /// f'' + (W'/W) f' + k^2 f = 0: what follows from the wave equation.
    Corrected,
    /// f'' + k^2 f = 0: the paper's, which loses the (W'/W) f' term.
    Paper,
}

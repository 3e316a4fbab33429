//! The two amplitude equations: the one that follows from the wave equation, and the paper's.

/// Which amplitude equation is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Equation {
    /// f'' + (W'/W) f' + k^2 f = 0, which follows from the wave equation.
    Corrected,
    /// f'' + k^2 f = 0, the paper's equation (13), which lacks the term (W'/W) f'.
    Paper,
}

//! (being written)

pub mod link {
    pub mod simulated;
}
pub mod mirror;

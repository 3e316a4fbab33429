#![no_std]
#![deny(unsafe_code)]
//! (being written)

pub mod bank;

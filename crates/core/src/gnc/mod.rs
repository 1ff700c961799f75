//! Guidance, navigation (what is seen is believed), control.

pub mod capture;
pub mod error;
pub mod guidance;
pub mod laws;

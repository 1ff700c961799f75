//! Guidance, navigation, control.

pub mod allocation;
pub mod capture;
pub mod error;
pub mod guidance;
pub mod laws;
pub mod navigation;

//! One closed loop with its full history, or many at once: lanes times threads.
//!
//! A flight's result depends on its recipe, the seed and its own index, never on the lane, the thread or the fleet that
//! flies it.

pub mod dispersion;
mod fleet;
mod many;
mod one;

pub use fleet::{Column, Fleet};
pub use many::{Operation, Outcome, Results, Workload, fly_many, fly_workload};
pub use one::{FlightRecord, fly_one};

/// The stop flag of flights that nobody stops.
pub static UNSTOPPED: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);

#[cfg(test)]
mod tests;

//! One closed loop with its full history, or many at once: lanes times threads.
//!
//! A flight's result depends on its recipe, the seed and its own index, never on the lane, the thread or the fleet that
//! flies it.

pub mod dispersion;
mod fleet;
mod many;
mod one;

pub use fleet::{Column, Fleet};
pub use many::{Operation, Outcome, Results, fly_many};
pub use one::{FlightRecord, fly_one};

#[cfg(test)]
mod tests;

//! Two bodies in orbit, the hardware that moves one of them, the laws that command it, and the closed loop of all three.
//!
//! Everything is generic over [`number::Real`]: one `f64` flies one trajectory, SIMD lanes fly several at once.
//! The crate is pure mathematics: no threads, no files, no allocation inside the loop.
//!
//! Rooms, in the order in which the data flows:
//!
//! - [`number`]: the numeric trait, lanes, vectors, quaternions, random streams
//! - [`plant`]: orbit, attitude, propagation, and how two bodies become one
//! - [`hardware`]: sensors and actuators
//! - [`gnc`]: guidance, tracking errors, capture, control laws
//! - [`closed_loop`]: one control period, top to bottom on one screen; [`scene`]: what a batch of flights has in common
//! - [`metrics`], [`history`]: what is kept of a flight; [`clock`]: what its times are called
//!
//! Units are SI. Frames: N inertial, H the target orbit's LVLH frame, C chaser, D debris, S the stack after capture.

pub mod batch;
pub mod case;
pub mod clock;
pub mod closed_loop;
pub mod flight;
pub mod gnc;
pub mod hardware;
pub mod history;
pub mod metrics;
pub mod number;
pub mod observer;
pub mod part;
pub mod plan;
pub mod plant;
pub mod scene;

#[cfg(test)]
mod tests;

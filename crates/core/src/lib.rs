//! Two bodies in orbit, the hardware that moves one of them, the laws that command it, and the closed loop of all three.
//!
//! Everything is generic over [`number::Real`]: one `f64` flies one trajectory, SIMD lanes fly several at once.
//! The crate is pure mathematics: no threads, no files, no allocation inside the loop.
//!
//! Modules, in the order in which they build on each other:
//!
//! - [`number`]: the numeric trait, lanes, vectors, quaternions, random streams
//! - [`batch`]: from one trajectory's numbers to lanes; [`part`]: the one shape of what is on board; [`clock`]: names of times
//! - [`plant`]: orbit, attitude, disturbances, propagation, and how two bodies become one
//! - [`hardware`]: sensors and actuators
//! - [`gnc`]: navigation, guidance, tracking errors, capture, control laws, allocation
//! - [`plan`], [`case`]: what a flight starts from; [`flight`]: its state; [`scene`]: what a batch of flights has in common
//! - [`closed_loop`]: one control period, top to bottom on one screen
//! - [`observer`], [`metrics`], [`history`]: what is kept of a flight
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

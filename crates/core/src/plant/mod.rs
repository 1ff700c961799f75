//! What the spacecraft do by themselves: orbit, attitude, propagation, and two bodies becoming one.

pub mod attitude;
pub mod body;
pub mod disturbances;
pub mod disturbed;
pub mod lvlh;
pub mod motion;
pub mod orbit;
pub mod propagate;
pub mod rk4;
pub mod stack;
pub mod top;
pub mod wrench;

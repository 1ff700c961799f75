//! What stands between the laws and the plant: sensors and actuators.

pub mod actuators;
pub mod sensors;

//! Numbers: the one numeric trait [`Real`] and what is built on it.
//!
//! All of the core is written once, generic over [`Real`]. `f64` flies one trajectory; on x86-64 the lane types
//! (four trajectories with AVX2, eight with AVX-512) fly several in lockstep. Lane types have no public name:
//! a [`Job`] meets them as `R` when [`dispatch()`] runs it on a [`Backend`] that the CPU was seen to have.
//!
//! **Every function that touches an `R` is `#[inline(always)]`.** The lane instructions exist only inside the
//! `#[target_feature]` function that `dispatch` enters; a function left out of line is compiled without them,
//! and each of its operations becomes a call. One such function costs a factor of 3 to 6. For the same reason hot code has
//! no closures or iterator chains over `R`: attributes cannot be trusted to reach them.
//!
//! On a concrete `f64` the standard library's own methods win over those of the trait (`x.exp()` is libm's);
//! write `Real::exp(x)`, or stay generic, to get the code that the lanes run.

mod dispatch;
mod elementary;
mod group;
mod matrix;
mod philox;
mod quaternion;
mod real;
mod scalar;
mod vector;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use dispatch::{Backend, Job, dispatch, fma_peak};
pub use matrix::Mat3;
pub use philox::Stream;
pub use quaternion::Quat;
pub use real::{Bits, Mask, Real, Work};
pub use vector::Vec3;

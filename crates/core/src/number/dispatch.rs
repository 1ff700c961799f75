//! Which instructions to use: chosen at run time, by what the CPU has.
#![allow(unsafe_code)]

use super::real::Real;
#[cfg(target_arch = "x86_64")]
use super::x86::{F64x4, F64x8};
use core::hint::black_box;

/// A set of instructions to compute with. They differ in speed, not in meaning.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Backend {
    /// `f64`, one trajectory at a time: runs everywhere.
    Portable,
    /// Four lanes: x86-64 with AVX2, FMA and BMI2.
    Avx2,
    /// Eight lanes: x86-64 with AVX-512 F, DQ, VL and BW besides.
    Avx512,
}

impl Backend {
    const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The widest that this CPU has.
    pub fn best() -> Self {
        Self::available().last().unwrap_or(Self::Portable)
    }

    /// The quickest for a single flight, which leaves all lanes but one idle: AVX2 where there is one. Its bits are those of AVX-512.
    pub fn best_for_one() -> Self {
        if Self::Avx2.is_available() { Self::Avx2 } else { Self::Portable }
    }

    /// All that this CPU has, narrowest first.
    pub fn available() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|backend| backend.is_available())
    }

    /// Whether this CPU, in this build, can run it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") && is_x86_feature_detected!("bmi2")
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
                    && is_x86_feature_detected!("avx512bw")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// "portable", "avx2" or "avx512".
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Trajectories that fly in lockstep.
    pub fn lanes(self) -> usize {
        match self {
            Self::Portable => 1,
            Self::Avx2 => 4,
            Self::Avx512 => 8,
        }
    }
}

/// Work that can be done in any number type: a closure with a type parameter, which Rust's own closures cannot have.
pub trait Job {
    /// What the work results in.
    type Output;
    /// Does the work. Mark the implementation `#[inline(always)]`, and all it calls that touches an `R`.
    fn run<R: Real>(self) -> Self::Output;
}

/// Runs a job with the numbers of a back end.
///
/// # Panics
/// If the CPU lacks the back end.
pub fn dispatch<J: Job>(backend: Backend, job: J) -> J::Output {
    assert!(
        backend.is_available(),
        "this CPU lacks the back end {}; it has {}",
        backend.name(),
        Backend::available().map(Backend::name).collect::<Vec<_>>().join(", "),
    );
    match backend {
        // SAFETY: the CPU was just seen to have the instructions.
        #[cfg(target_arch = "x86_64")]
        Backend::Avx2 => unsafe { run_avx2(job) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Backend::Avx512 => unsafe { run_avx512(job) },
        _ => job.run::<f64>(),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi2")]
fn run_avx2<J: Job>(job: J) -> J::Output {
    job.run::<F64x4>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx2,fma,bmi2")]
fn run_avx512<J: Job>(job: J) -> J::Output {
    job.run::<F64x8>()
}

/// Keeps the multiply-add units busy for the caller to time; the result is the number of floating-point operations done.
///
/// `flops / seconds` is the peak rate of one core on this back end, the yardstick for everything else that runs on it.
pub fn fma_peak(backend: Backend, iterations: u64) -> f64 {
    dispatch(backend, FmaPeak { iterations })
}

struct FmaPeak {
    iterations: u64,
}

impl Job for FmaPeak {
    type Output = f64;

    #[inline(always)]
    fn run<R: Real>(self) -> f64 {
        // Latency 4 on two units needs 8 chains; 12 leave slack, and room in sixteen registers.
        const CHAINS: usize = 12;
        // x = a x + b settles at b / (1 - a) = 1: no overflow, no subnormals.
        let (a, b) = (R::splat(black_box(0.75)), R::splat(black_box(0.25)));
        let mut x = [R::zero(); CHAINS];
        for (i, x) in x.iter_mut().enumerate() {
            *x = R::splat(black_box(i as f64));
        }
        for _ in 0..self.iterations {
            for x in &mut x {
                *x = x.mul_add(a, b);
            }
        }
        let mut sum = R::zero();
        for x in x {
            sum += x;
        }
        black_box(sum.lane(0));
        (2 * CHAINS * R::LANES) as f64 * self.iterations as f64
    }
}

#[cfg(test)]
mod tests;

//! Random streams: Philox4x32-10, counter-based, so that noise depends on nothing but what it is named by.
//!
//! Salmon, Moraes, Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC'11. Four words from a key and a counter:
//!
//! | | word 0 | word 1 | word 2 | word 3 |
//! |---|---|---|---|---|
//! | key | seed, low | trajectory, low | | |
//! | counter | step | block | trajectory, high | seed, high |
//!
//! The result of a trajectory is therefore the same whatever lane, thread, batch or back end it flies in.

use super::elementary::{exponent_and_fraction, polynomial};
use super::group::Group;
use super::real::{Bits, Real};

/// 2^-32, the spacing of the uniform numbers.
const CELL: f64 = 1.0 / (1u64 << 32) as f64;

/// The stream of random numbers of each lane's trajectory.
#[derive(Clone, Copy, Debug)]
pub struct Stream<R: Real> {
    seed: u64,
    trajectory: R::Bits,
}

impl<R: Real> Stream<R> {
    /// The stream of a campaign's `seed` in which lane `i` flies trajectory number `trajectory(i)`.
    #[inline(always)]
    pub fn new(seed: u64, trajectory: impl FnMut(usize) -> u64) -> Self {
        Self { seed, trajectory: R::Bits::from_fn(trajectory) }
    }

    /// Gives lane `i` another trajectory.
    pub fn set_lane(&mut self, i: usize, trajectory: u64) {
        self.trajectory.set_lane(i, trajectory);
    }

    /// Four uniform 32-bit words for this step and block, each in the low half of its lane; the high halves are undefined.
    #[inline(always)]
    pub fn words(&self, step: u32, block: u32) -> [R::Bits; 4] {
        self.words_at(R::Bits::splat(step as u64), block)
    }

    /// The same for a step of each lane's own, of which the low half counts.
    #[inline(always)]
    fn words_at(&self, step: R::Bits, block: u32) -> [R::Bits; 4] {
        let counter =
            [step, R::Bits::splat(block as u64), self.trajectory.shr::<32>(), R::Bits::splat(self.seed >> 32)];
        philox4x32(counter, [R::Bits::splat(self.seed), self.trajectory])
    }

    /// Four uniform numbers in (0, 1): the midpoints of 2^32 equal cells.
    #[inline(always)]
    pub fn uniforms(&self, step: u32, block: u32) -> [R; 4] {
        let [a, b, c, d] = self.words(step, block);
        [midpoint(a), midpoint(b), midpoint(c), midpoint(d)]
    }

    /// Four independent standard normal numbers, |x| < 6.77: the first two from words 0 and 1, the others from 2 and 3.
    #[inline(always)]
    pub fn normals(&self, step: u32, block: u32) -> [R; 4] {
        let [a, b, c, d] = self.words(step, block);
        let [x, y] = box_muller::<Group<R, 2>>(Group([a, c]), Group([b, d]));
        [x.0[0], y.0[0], x.0[1], y.0[1]]
    }

    /// The first 4 `PAIRS`/2 of [`Stream::normals`] of blocks 0, 1, 2 in a row, two by two, for up to six pairs; all at once.
    /// Each lane has a step of its own, a whole number below 2^32.
    #[inline(always)]
    pub fn normal_pairs<const PAIRS: usize>(&self, step: R) -> [[R; 2]; PAIRS] {
        const { assert!(PAIRS <= 6) };
        // Added to 2^52 a whole number stands in the low bits.
        let step = (step + R::splat((1u64 << 52) as f64)).to_bits();
        let mut words = [[R::Bits::splat(0); 4]; 3];
        for (block, words) in words.iter_mut().enumerate().take(PAIRS.div_ceil(2)) {
            *words = self.words_at(step, block as u32);
        }
        let (mut first, mut second) = ([R::Bits::splat(0); PAIRS], [R::Bits::splat(0); PAIRS]);
        for i in 0..PAIRS {
            first[i] = words[i / 2][2 * (i % 2)];
            second[i] = words[i / 2][2 * (i % 2) + 1];
        }
        let [x, y] = box_muller::<Group<R, PAIRS>>(Group(first), Group(second));
        let mut pairs = [[R::zero(); 2]; PAIRS];
        for (i, pair) in pairs.iter_mut().enumerate() {
            *pair = [x.0[i], y.0[i]];
        }
        pairs
    }
}

/// Ten rounds of Philox. Products read only low halves, so what the sums and exclusive-ors leave in the high halves is harmless.
#[inline(always)]
fn philox4x32<B: Bits>(mut counter: [B; 4], mut key: [B; 2]) -> [B; 4] {
    let multiplier = [B::splat(0xd251_1f53), B::splat(0xcd9e_8d57)];
    let weyl = [B::splat(0x9e37_79b9), B::splat(0xbb67_ae85)];
    for _ in 0..10 {
        let even = counter[0].mul_low32(multiplier[0]);
        let odd = counter[2].mul_low32(multiplier[1]);
        counter = [odd.shr::<32>() ^ counter[1] ^ key[0], odd, even.shr::<32>() ^ counter[3] ^ key[1], even];
        key = [key[0] + weyl[0], key[1] + weyl[1]];
    }
    counter
}

/// (word + 1/2) 2^-32, exactly.
#[inline(always)]
fn midpoint<R: Real>(word: R::Bits) -> R {
    R::from_u32(word).mul_add(R::splat(CELL), R::splat(0.5 * CELL))
}

/// Two normal numbers from two words (Box & Muller 1958): radius √(-2 ln u₁), angle u₂ in turns, from the cosine and the sine.
///
/// With u₂ = b/2 + ¼ + t, b its first bit and |t| <= ¼:  cos 2πu₂ = ∓ sin 2πt,  sin 2πu₂ = ± cos 2πt,  b the sign.
#[inline(always)]
fn box_muller<R: Real>(word_1: R::Bits, word_2: R::Bits) -> [R; 2] {
    let radius = (ln_of_word(midpoint::<R>(word_1)) * R::splat(-2.0)).sqrt();
    let first_bit = word_2.shl::<32>() & R::Bits::splat(1 << 63);
    let signed = R::from_bits(radius.to_bits() ^ first_bit);
    let rest = R::from_u32(word_2 & R::Bits::splat((1 << 31) - 1)) - R::splat((1u64 << 30) as f64);
    let (sin, cos) = sin_cos_of_word(rest * R::splat(core::f64::consts::TAU * CELL));
    [-(signed * sin), signed * cos]
}

/// Logarithm of a midpoint to a relative 2e-11: finer than the 2^-32 between the midpoints of two words.
/// ln x = k ln 2 + 2 artanh s, by Chebyshev interpolation as the next.
#[inline(always)]
fn ln_of_word<R: Real>(x: R) -> R {
    let (k, f) = exponent_and_fraction(x);
    let s = f / (R::splat(2.0) + f);
    let z = s * s;
    let tail = polynomial!(z; 0.6666666655449709, 0.40000121839806127, 0.28550820815960663, 0.23330467216303836);
    k.mul_add(R::splat(core::f64::consts::LN_2), s * z.mul_add(tail, R::splat(2.0)))
}

/// Sine and cosine of |x| <= π/2 to 2e-11: finer than the 2^-32 turns between the angles of two words.
#[inline(always)]
fn sin_cos_of_word<R: Real>(x: R) -> (R, R) {
    let z = x * x;
    let sin = polynomial!(z; 0.9999999999829191, -0.16666666616815567, 0.008333330974207583,
        -0.00019840861179319552, 2.752526981229885e-6, -2.3889217773452806e-8);
    let cos = polynomial!(z; 0.999999999999248, -0.4999999999701275, 0.04166666647285179,
        -0.0013888884170789054, 2.480103992800827e-5, -2.7524670425081664e-7, 1.9907506103760228e-9);
    (x * sin, cos)
}

#[cfg(test)]
mod tests;

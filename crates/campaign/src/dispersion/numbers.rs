//! The uniform numbers of one field: named by seed, run and the field's path alone.
//!
//! The path becomes, by its 64-bit FNV-1a hash, a step and a run of 16 blocks of the core's random stream. All these blocks
//! lie above 2³¹; the sensors' noise uses blocks 0 to 2. Hash: Fowler, Noll & Vo, RFC 9923.

use detumble_core::number::{Bits, Stream};

/// Where a field's numbers stand in a run's stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FieldNumbers {
    step: u32,
    block: u32,
}

impl FieldNumbers {
    pub(super) fn new(path: &str) -> Self {
        let hash = fnv_1a(path);
        let high = (hash >> 32) as u32;
        Self { step: hash as u32, block: 1 << 31 | (high << 4 & 0x7fff_fff0) }
    }

    /// Independent numbers in (0, 1), the midpoints (k + 1/2) 2⁻⁵² of equal cells; `1 - u` is exact. The first of them do
    /// not depend on how many are asked for.
    #[inline]
    pub(super) fn uniforms<const N: usize>(&self, noise: &Stream<f64>) -> [f64; N] {
        const { assert!(N <= 32) };
        const HALF_CELL: f64 = 1.0 / (1u64 << 53) as f64;
        let mut uniforms = [0.0; N];
        for (k, pair) in uniforms.chunks_mut(2).enumerate() {
            let words = noise.words(self.step, self.block | k as u32).map(|word| word.lane(0) & u32::MAX as u64);
            for (uniform, word) in pair.iter_mut().zip(words.chunks(2)) {
                let cell = word[0] << 20 | word[1] >> 12;
                *uniform = (2 * cell + 1) as f64 * HALF_CELL;
            }
        }
        uniforms
    }
}

fn fnv_1a(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_the_published_one() {
        // Test vectors of RFC 9923, appendix C.
        assert_eq!(fnv_1a(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv_1a("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv_1a("foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn a_field_has_sixteen_blocks_that_no_sensor_uses() {
        for path in ["chaser.mass", "debris.tumble_rate", "laws.prrl.translation.gain"] {
            let FieldNumbers { block, .. } = FieldNumbers::new(path);
            assert!(block >= 1 << 31);
            assert_eq!(block & 15, 0);
        }
    }

    #[test]
    fn numbers_are_midpoints_and_do_not_depend_on_how_many_are_drawn() {
        let numbers = FieldNumbers::new("chaser.mass");
        for run in 0..1000 {
            let noise = Stream::new(7, |_| run);
            let six: [f64; 6] = numbers.uniforms(&noise);
            assert_eq!(numbers.uniforms::<3>(&noise), six[..3]);
            assert_eq!(numbers.uniforms::<1>(&noise), six[..1]);
            for u in six {
                let cells = u * 2f64.powi(53);
                assert!(cells % 2.0 == 1.0 && 0.0 < u && u < 1.0);
            }
        }
    }
}

use super::super::{Backend, Bits, Job, Real, Stream, dispatch};

/// Words, normals and uniforms of one step for trajectories first, first + 1, ...
struct Draw {
    seed: u64,
    first: u64,
    step: u32,
    block: u32,
}

/// What one trajectory draws.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Drawn {
    words: [u32; 4],
    uniforms: [f64; 4],
    normals: [f64; 4],
    /// Blocks 0, 1, 2 of the step.
    pairs: [f64; 12],
}

impl Job for Draw {
    type Output = Vec<Drawn>;

    #[inline(always)]
    fn run<R: Real>(self) -> Vec<Drawn> {
        let stream = Stream::<R>::new(self.seed, |i| self.first.wrapping_add(i as u64));
        let words = stream.words(self.step, self.block);
        let uniforms = stream.uniforms(self.step, self.block);
        let normals = stream.normals(self.step, self.block);
        let pairs = stream.normal_pairs::<6>(R::splat(f64::from(self.step)));
        let pairs: [R; 12] = std::array::from_fn(|k| pairs[k / 2][k % 2]);
        (0..R::LANES)
            .map(|i| Drawn {
                words: words.map(|w| w.lane(i) as u32),
                uniforms: uniforms.map(|u| u.lane(i)),
                normals: normals.map(|x| x.lane(i)),
                pairs: pairs.map(|x| x.lane(i)),
            })
            .collect()
    }
}

/// Many normals of one trajectory, four a step.
struct Normals {
    seed: u64,
    steps: u32,
}

impl Job for Normals {
    type Output = Vec<[f64; 4]>;

    #[inline(always)]
    fn run<R: Real>(self) -> Vec<[f64; 4]> {
        let stream = Stream::<R>::new(self.seed, |i| i as u64);
        let mut draws = Vec::new();
        for step in 0..self.steps {
            let normals = stream.normals(step, 0);
            draws.extend((0..R::LANES).map(|i| normals.map(|x| x.lane(i))));
        }
        draws
    }
}

#[test]
fn validation_words_are_those_of_random123() {
    // kat_vectors of Random123 1.14: philox4x32-10.
    let known: [([u32; 4], [u32; 2], [u32; 4]); 3] = [
        ([0; 4], [0; 2], [0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8]),
        ([u32::MAX; 4], [u32::MAX; 2], [0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd]),
        (
            [0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344],
            [0xa4093822, 0x299f31d0],
            [0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1],
        ),
    ];
    let join = |low: u32, high: u32| low as u64 | (high as u64) << 32;
    for backend in Backend::available() {
        for (counter, key, words) in known {
            let draw = Draw {
                seed: join(key[0], counter[3]),
                first: join(key[1], counter[2]),
                step: counter[0],
                block: counter[1],
            };
            assert_eq!(dispatch(backend, draw)[0].words, words, "{}", backend.name());
        }
    }
}

#[test]
fn a_trajectory_draws_the_same_in_every_lane_and_number_type() {
    // Around 2^32, where the trajectory number carries into its high word.
    for first in [0, 1000, u32::MAX as u64 - 3] {
        let draw = |backend, first| dispatch(backend, Draw { seed: 77 << 31, first, step: 5, block: 2 });
        let alone: Vec<_> = (0..8).map(|i| draw(Backend::Portable, first + i)[0]).collect();
        for backend in Backend::available() {
            for shift in 0..8 {
                let (got, want) = (draw(backend, first + shift)[0], alone[shift as usize]);
                assert_eq!((got.words, got.uniforms), (want.words, want.uniforms));
            }
            for (got, want) in draw(backend, first).iter().zip(&alone) {
                assert_eq!((got.words, got.uniforms), (want.words, want.uniforms));
                assert_eq!(got.pairs[8..], got.normals);
                // Normals may differ where multiply-add is not fused, by rounding alone: that of their common radius.
                for (x, y) in got.normals.chunks(2).zip(want.normals.chunks(2)) {
                    let error = (x[0] - y[0]).hypot(x[1] - y[1]);
                    assert!(error <= 1e-15 * y[0].hypot(y[1]), "{x:?} {y:?}");
                }
            }
        }
    }
    if Backend::Avx512.is_available() {
        let draws = [Backend::Avx2, Backend::Avx512]
            .map(|backend| dispatch(backend, Draw { seed: 9, first: 3, step: 0, block: 0 }));
        assert_eq!(draws[0], draws[1][..4]);
    }
}

#[test]
fn normals_are_independent_and_standard() {
    let steps = 250_000;
    for backend in Backend::available() {
        let draws = dispatch(backend, Normals { seed: 2026, steps: steps / backend.lanes() as u32 });
        let count = draws.len() as f64;
        let mean = |f: &dyn Fn(&[f64; 4]) -> f64| draws.iter().map(f).sum::<f64>() / count;
        // Five standard errors of each statistic.
        let error = 5.0 / count.sqrt();
        for i in 0..4 {
            assert!(mean(&|x| x[i]).abs() < error);
            assert!((mean(&|x| x[i].powi(2)) - 1.0).abs() < error * 2f64.sqrt());
            assert!(mean(&|x| x[i].powi(3)).abs() < error * 15f64.sqrt());
            assert!((mean(&|x| x[i].powi(4)) - 3.0).abs() < error * 96f64.sqrt());
            for j in 0..i {
                assert!(mean(&|x| x[i] * x[j]).abs() < error);
                assert!((mean(&|x| x[i].powi(2) * x[j].powi(2)) - 1.0).abs() < error * 8f64.sqrt());
            }
            // P(|x| > k) from the normal distribution.
            for (k, p) in [(1.0, 0.317_310_508), (2.0, 0.045_500_264), (3.0, 0.002_699_796), (4.0, 6.334_248e-5)] {
                let share = mean(&|x| f64::from(x[i].abs() > k));
                assert!((share - p).abs() < error * f64::sqrt(p * (1.0 - p)), "beyond {k}: {share}");
            }
        }
        // From one step to the next of a lane's trajectory, and from lane to lane.
        for lag in [1, backend.lanes()] {
            let product: f64 = draws.iter().zip(&draws[lag..]).map(|(x, y)| x[0] * y[0]).sum();
            assert!((product / count).abs() < error);
        }
    }
}

#[test]
fn uniforms_stay_inside_the_open_interval() {
    use super::midpoint;
    use core::num::Wrapping;
    assert_eq!(midpoint::<f64>(Wrapping(0)), 0.5f64.powi(33));
    assert_eq!(midpoint::<f64>(Wrapping(u64::MAX)), 1.0 - 0.5f64.powi(33));
}

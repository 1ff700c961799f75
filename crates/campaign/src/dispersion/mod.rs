//! Dispersions: what is uncertain about a run, drawn before it flies.
//!
//! Every number of run i comes from its seed, i and the path of its field alone, so a campaign's first runs stay the same
//! however many follow, whoever draws them, and whatever else is dispersed. All arithmetic is plain: no fused
//! multiply-adds, no mathematics library of the platform. The bits are the same on every machine.
//!
//! Correlated fields (a Gaussian copula): the standard normal numbers z that belong to their own draws become y = L z,
//! with L Lᵀ the matrix of correlations; each field then takes the value at the share Φ(y) of its distribution. Between
//! normal fields the matrix is the correlation itself; between others the correlation of ranks is 6/π asin(ρ/2), at
//! most 0.02 off.

mod inertia;
mod marginal;
mod normal;
mod numbers;
mod rotation;

pub use inertia::InertiaDistribution;
pub use marginal::Marginal;
pub use rotation::{DirectionDistribution, Turn};

use detumble_core::number::Stream;
use inertia::InertiaSampler;
use marginal::Quantile;
use numbers::FieldNumbers;
use rotation::{DirectionSampler, Quaternion, TurnSampler};
use serde::Deserialize;

/// All that is dispersed, with nothing left to default.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    /// One for each field.
    pub dispersions: Vec<Dispersion>,
    /// Groups of correlated numbers; no number is in two.
    pub correlations: Vec<Correlation>,
}

/// What a field's values are drawn from.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dispersion {
    /// Of the field, dotted.
    pub path: String,
    /// The distribution.
    pub distribution: Distribution,
}

/// A distribution, by the shape of what it gives. SI, or the unit of the field.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Distribution {
    /// Independent numbers, one or three.
    Elements {
        /// One distribution for each.
        elements: Vec<Marginal>,
    },
    /// A vector by direction and length: three numbers.
    Direction(DirectionDistribution),
    /// An attitude, `nominal` ⊗ turn: unit quaternion, scalar first and not negative; four numbers.
    Attitude {
        /// Normalised when drawn.
        nominal: [f64; 4],
        /// In body axes.
        turn: Turn,
    },
    /// An inertia xx, yy, zz, xy, xz, yz: six numbers.
    Inertia(InertiaDistribution),
}

/// Numbers that are drawn together.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Correlation {
    /// Which: dispersion, and element of it. Its distribution is [`Distribution::Elements`].
    pub members: Vec<(usize, usize)>,
    /// Rows of L, each as long as there are members.
    pub factor: Vec<Vec<f64>>,
}

/// The values of one field.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// Of the field.
    pub path: String,
    /// Numbers a run.
    pub width: usize,
    /// Run by run.
    pub values: Vec<f64>,
}

/// Draws runs `first` to `first + count - 1`, in the order of the dispersions.
///
/// # Panics
///
/// If a correlation has members that are not there, or a factor of another size.
pub fn sample(spec: &Spec, seed: u64, first: u64, count: usize) -> Vec<Drawn> {
    let runs = Runs { seed, first, count };
    let mut drawn: Vec<Drawn> = spec.dispersions.iter().map(|dispersion| runs.of_field(dispersion)).collect();
    for group in &spec.correlations {
        runs.correlate(&spec.dispersions, group, &mut drawn);
    }
    drawn
}

struct Runs {
    seed: u64,
    first: u64,
    count: usize,
}

impl Runs {
    fn noise(&self, run: usize) -> Stream<f64> {
        Stream::new(self.seed, |_| self.first.wrapping_add(run as u64))
    }

    /// `N` values a run from `M` uniform numbers.
    fn rows<const M: usize, const N: usize>(&self, path: &str, of_uniforms: impl Fn([f64; M]) -> [f64; N]) -> Drawn {
        let numbers = FieldNumbers::new(path);
        let mut values = Vec::with_capacity(N * self.count);
        for run in 0..self.count {
            values.extend(of_uniforms(numbers.uniforms(&self.noise(run))));
        }
        Drawn { path: path.to_owned(), width: N, values }
    }

    fn of_field(&self, dispersion: &Dispersion) -> Drawn {
        let path = &dispersion.path;
        match &dispersion.distribution {
            Distribution::Elements { elements } => match elements.as_slice() {
                [one] => {
                    let x = Quantile::new(one);
                    self.rows(path, |[u]: [f64; 1]| [x.at(u)])
                }
                [one, two, three] => {
                    let (x, y, z) = (Quantile::new(one), Quantile::new(two), Quantile::new(three));
                    self.rows(path, |[u, v, w]: [f64; 3]| [x.at(u), y.at(v), z.at(w)])
                }
                _ => panic!("{path}: {} elements; allowed: 1 or 3", elements.len()),
            },
            Distribution::Direction(distribution) => {
                let sampler = DirectionSampler::new(distribution);
                self.rows(path, |u| sampler.at(u))
            }
            Distribution::Attitude { nominal, turn } => {
                let (nominal, turn) = (Quaternion(*nominal), TurnSampler::new(turn));
                self.rows(path, |u| nominal.times(turn.at(u)).canonical().0)
            }
            Distribution::Inertia(distribution) => {
                let sampler = InertiaSampler::new(distribution);
                self.rows(path, |u| sampler.at(u))
            }
        }
    }

    /// Draws the members of a group once more, now together.
    fn correlate(&self, dispersions: &[Dispersion], group: &Correlation, drawn: &mut [Drawn]) {
        let member = |&(field, element): &(usize, usize)| {
            let Dispersion { path, distribution } = &dispersions[field];
            let Distribution::Elements { elements } = distribution else {
                panic!("{path}: not drawn element by element")
            };
            (FieldNumbers::new(path), field, element, Quantile::new(&elements[element]))
        };
        let members: Vec<_> = group.members.iter().map(member).collect();
        let mut z = vec![0.0; members.len()];
        for run in 0..self.count {
            let noise = self.noise(run);
            for ((numbers, _, element, _), z) in members.iter().zip(&mut z) {
                *z = normal::quantile(numbers.uniforms::<3>(&noise)[*element]);
            }
            for ((_, field, element, quantile), row) in members.iter().zip(&group.factor) {
                let y = row.iter().zip(&z).fold(0.0, |sum, (l, z)| sum + l * z);
                let Drawn { width, values, .. } = &mut drawn[*field];
                values[run * *width + *element] = quantile.at_normal(y);
            }
        }
    }
}

#[cfg(test)]
mod tests;

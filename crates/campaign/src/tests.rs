//! Fleets against single flights, back ends, threads and plain recomputation.

mod backends;
mod divergence;
mod fixture;
mod metrics;
mod refill;

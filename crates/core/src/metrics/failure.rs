//! Why a flight failed, as a number and in words.

/// It did not: captured, and settled where the bodies merge.
pub const NONE: u8 = 0;
/// The state became non-finite.
pub const DIVERGED: u8 = 1;
/// Captured, but the stack was not settled at the end.
pub const NOT_SETTLED: u8 = 2;
/// The law has no gains for the body that it is to fly.
pub const NO_GAINS: u8 = 3;
/// Never captured; plus the bit of each of [`THRESHOLDS`] that never held.
pub const NEVER_CAPTURED: u8 = 16;
/// All thresholds held at once, but not for the dwell time.
pub const DWELL_MISSED: u8 = 32;

/// Bit of each threshold in [`NEVER_CAPTURED`].
pub const THRESHOLDS: [(&str, u8); 4] = [("distance", 1), ("angle", 2), ("rate", 4), ("speed", 8)];

/// Every failure in words.
pub fn causes() -> Vec<(u8, String)> {
    let single = [
        (DIVERGED, "diverged"),
        (NO_GAINS, "no gains: the Riccati equation has no solution"),
        (NOT_SETTLED, "captured, not settled"),
        (DWELL_MISSED, "never captured: dwell"),
        (NEVER_CAPTURED, "never captured: not all at once"),
    ];
    let missed = (1..1 << THRESHOLDS.len()).map(|bits: u8| {
        let names = THRESHOLDS.iter().filter(|(_, bit)| bits & bit != 0).map(|&(name, _)| name);
        (NEVER_CAPTURED + bits, format!("never captured: {}", names.collect::<Vec<_>>().join(" + ")))
    });
    single.map(|(code, cause)| (code, cause.to_owned())).into_iter().chain(missed).collect()
}

use super::fixture::{Campaign, LAWS, Way, alone, bits};
use crate::Outcome;
use detumble_core::gnc::laws::SurfaceRate;
use detumble_core::hardware::sensors::NoiseSigmas;
use detumble_core::number::Backend;
use detumble_core::plant::motion::Motion;

const WAYS: [Way; 2] = [Way::Paper, Way::Corrected];
/// No multiple of 4 or 8: the last block is short.
const FLIGHTS: usize = 29;

fn lanes() -> Vec<Backend> {
    Backend::available().filter(|&b| b != Backend::Portable).collect()
}

fn all_bits(outcomes: &[Outcome]) -> Vec<String> {
    outcomes.iter().map(bits).collect()
}

#[test]
fn fleets_have_the_same_bits_on_avx2_and_avx512_on_one_thread_and_two_and_as_single_flights() {
    let (mut captured, mut times) = (0, Vec::new());
    for law in LAWS {
        for way in WAYS {
            let campaign = Campaign::new(law, way, 80, true);
            let backends = lanes();
            let Some(&first) = backends.first() else { return };
            let reference = campaign.fly(FLIGHTS, first, 1);
            for &backend in &backends {
                for threads in [1, 2] {
                    assert_eq!(
                        all_bits(&campaign.fly(FLIGHTS, backend, threads)),
                        all_bits(&reference),
                        "{law} {way:?} {backend:?} {threads} threads"
                    );
                }
                for i in [0, 5, 7, 28] {
                    let alone = alone(&campaign.recipe(i), i, backend);
                    assert_eq!(
                        bits(&alone.summary),
                        bits(&reference[i].summary),
                        "{law} {way:?} {backend:?} flight {i}"
                    );
                    assert_eq!(bits(&last_motion(&alone)), bits(&reference[i].end));
                }
            }
            captured += reference.iter().filter(|o| o.summary.capture_time.is_finite()).count();
            times.extend(reference.iter().map(|o| o.summary.capture_time).filter(|t| t.is_finite()));
        }
    }
    // The comparison is worth something only if captures come early, late and never.
    times.sort_by(f64::total_cmp);
    times.dedup();
    println!("{captured} of {} captured, at {} different times", 10 * FLIGHTS, times.len());
    assert!(captured > 100 && captured < 10 * FLIGHTS && times.len() > 60);
}

fn last_motion(record: &crate::FlightRecord) -> Motion<f64> {
    use detumble_core::number::{Quat, Vec3};
    let row = |name: &str| {
        let series = record.series.iter().find(|s| s.name == name).unwrap();
        series.values[series.values.len() - series.width..].to_vec()
    };
    let vector = |name| Vec3(row(name).try_into().unwrap());
    let quaternion = |name| Quat(row(name).try_into().unwrap());
    Motion {
        position: vector("position"),
        velocity: vector("velocity"),
        chaser_attitude: quaternion("chaser_attitude"),
        chaser_rate: vector("chaser_rate"),
        debris_attitude: quaternion("debris_attitude"),
        debris_rate: vector("debris_rate"),
    }
}

#[test]
fn portable_fleet_has_the_bits_of_its_single_flights_on_any_number_of_threads() {
    for law in LAWS {
        let campaign = Campaign::new(law, Way::Corrected, 60, true);
        let fleet = campaign.fly(7, Backend::Portable, 1);
        assert_eq!(all_bits(&campaign.fly(7, Backend::Portable, 2)), all_bits(&fleet));
        for i in [0, 6] {
            let alone = alone(&campaign.recipe(i), i, Backend::Portable);
            assert_eq!(bits(&alone.summary), bits(&fleet[i].summary));
        }
    }
}

#[test]
fn flights_do_not_depend_on_the_size_of_their_fleet() {
    let campaign = Campaign::new("prrl", Way::Corrected, 60, true);
    for backend in Backend::available() {
        let long = all_bits(&campaign.fly(13, backend, 1));
        for flights in [1, 3, 4, 8, 9] {
            assert_eq!(all_bits(&campaign.fly(flights, backend, 1)), long[..flights]);
        }
        assert!(campaign.fly(0, backend, 2).is_empty());
    }
}

#[test]
fn noise_is_that_of_the_flights_index_in_the_stream() {
    // Two flights with equal numbers and different indices see different noise.
    let campaign = Campaign::new("pd", Way::Paper, 5, true);
    let first = campaign.recipe(0).case;
    for backend in Backend::available() {
        let twins = campaign.fly_changed(2, backend, 1, |_, case| *case = first);
        assert_ne!(bits(&twins[0].end), bits(&twins[1].end));
        let quiet = Campaign { noise: false, ..campaign.clone() };
        let calm = quiet.recipe(0).case;
        let twins = quiet.fly_changed(2, backend, 1, |_, case| *case = calm);
        assert_eq!(bits(&twins[0].end), bits(&twins[1].end));
    }
}

/// Largest difference of the end states: m, m/s, quaternion, rad/s.
fn distance(a: &Motion<f64>, b: &Motion<f64>) -> f64 {
    let vectors = [
        (a.position.0, b.position.0),
        (a.velocity.0, b.velocity.0),
        (a.chaser_rate.0, b.chaser_rate.0),
        (a.debris_rate.0, b.debris_rate.0),
    ];
    let quaternions = [(a.chaser_attitude.0, b.chaser_attitude.0), (a.debris_attitude.0, b.debris_attitude.0)];
    let vectors = vectors.iter().flat_map(|(a, b)| a.iter().zip(b));
    let quaternions = quaternions.iter().flat_map(|(a, b)| a.iter().zip(b));
    vectors.chain(quaternions).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

#[test]
fn portable_numbers_agree_with_lanes_over_600_s_without_noise() {
    let Some(&wide) = lanes().last() else { return };
    let furthest = |campaign: &Campaign| {
        let (portable, lanes) = (campaign.fly(8, Backend::Portable, 2), campaign.fly(8, wide, 1));
        let mut worst = 0.0_f64;
        for (p, l) in portable.iter().zip(&lanes) {
            assert_eq!(p.summary.capture_time.to_bits(), l.summary.capture_time.to_bits());
            worst = worst.max(distance(&p.end, &l.end));
        }
        worst
    };
    for way in WAYS {
        for law in LAWS {
            let mut campaign = Campaign::new(law, way, 600, false);
            // A terminal surface with p < 1 is infinitely steep at zero error. Its own rate taken off is then a kick of any
            // size at each passage through zero: the sampled loop never comes to rest but wanders on without end at about 1e-8 m and
            // 1e-5 rad/s, and where it is on its way at 600 s hangs on round-off. Not a fault of the numbers: such a
            // law does not say more than that. Without the own rate the wandering is a steady cycle, which keeps 1e-11.
            let terminal = law == "tsmc" && way == Way::Corrected;
            // Super-twisting is infinitely steep at s = 0 too: it cycles about the surface, and round-off decides the phase.
            let tolerance = if terminal {
                1e-4
            } else if law == "stsmc" {
                1e-5
            } else {
                1e-12
            };
            let apart = furthest(&campaign);
            println!("{law} {way:?}: {apart:.0e}");
            assert!(apart < tolerance, "{law} {way:?}: {apart:e}");
            if terminal {
                campaign.plan.surface_rate = SurfaceRate::Printed;
                let apart = furthest(&campaign);
                println!("{law} {way:?}, own rate not taken off: {apart:.0e}");
                assert!(apart < 1e-11);
            }
        }
    }
}

/// Flight 2 with some sensors quiet: in a fleet whose other sensors are noisy, and alone.
fn quiet_beside_noisy(quiet: impl Fn(&mut NoiseSigmas<f64>) + Sync) {
    let campaign = Campaign::new("prrl", Way::Paper, 30, true);
    let mut recipe = campaign.recipe(2);
    quiet(&mut recipe.case.sensors);
    for backend in Backend::available() {
        let fleet = campaign.fly_changed(5, backend, 1, |i, case| {
            if i == 2 {
                quiet(&mut case.sensors);
            }
        });
        let alone = alone(&recipe, 2, backend);
        assert_eq!(bits(&alone.summary), bits(&fleet[2].summary), "{backend:?}");
    }
}

#[test]
fn flight_with_quiet_sensors_beside_noisy_ones_has_its_own_bits() {
    quiet_beside_noisy(|sigmas| sigmas.position = 0.0);
    quiet_beside_noisy(|sigmas| sigmas.velocity = 0.0);
    quiet_beside_noisy(|sigmas| sigmas.rate = 0.0);
}

#[test]
fn flight_with_a_quiet_attitude_sensor_beside_noisy_ones_has_its_own_bits() {
    quiet_beside_noisy(|sigmas| sigmas.attitude = 0.0);
}

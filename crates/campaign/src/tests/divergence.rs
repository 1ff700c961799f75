use super::fixture::{Campaign, Way, alone, bits};
use detumble_core::case::Case;
use detumble_core::number::{Backend, Mat3, Vec3};

const LOST: usize = 5;
const FLIGHTS: usize = 11;

/// A body too light for the gains, Kd T/I = 2.7 > 2, and nothing to limit the torque: the sampled loop is unstable.
fn lose(i: usize, case: &mut Case<f64>) {
    if i == LOST {
        case.chaser.inertia = Mat3::from_scale(3e-3);
        case.actuators.torque = Vec3([f64::INFINITY; 3]);
    }
}

#[test]
fn diverged_flight_is_reported_with_its_time_and_its_neighbours_are_untouched() {
    for way in [Way::Paper, Way::Corrected] {
        let campaign = Campaign::new("pd", way, 60, true);
        for backend in Backend::available() {
            let healthy = campaign.fly(FLIGHTS, backend, 1);
            let with_lost = campaign.fly_changed(FLIGHTS, backend, 1, lose);
            for i in 0..FLIGHTS {
                if i != LOST {
                    assert_eq!(bits(&with_lost[i]), bits(&healthy[i]), "{backend:?}, flight {i}");
                    assert!(healthy[i].summary.diverged_time.is_nan());
                }
            }
            // Its history ends with the last whole state, one period earlier.
            let mut recipe = campaign.recipe(LOST);
            lose(LOST, &mut recipe.case);
            let alone = alone(&recipe, LOST, backend);
            let times = &alone.series[0].values;
            let diverged = with_lost[LOST].summary.diverged_time;
            println!("{way:?} {backend:?}: diverged at {diverged} s");
            assert!(diverged > 0.5 && (diverged - times[times.len() - 1] - 0.1).abs() < 1e-9);
            assert_eq!(alone.summary.diverged_time, diverged);
            assert!(alone.series[..7].iter().flat_map(|s| &s.values).all(|x| x.is_finite()));
            // Never captured or settled by a comparison with what is no number.
            assert!(with_lost[LOST].summary.settling_time.is_nan());
        }
    }
}

#[test]
fn flight_that_starts_with_nan_is_diverged_at_zero_and_never_captured() {
    let campaign = Campaign::new("prrl", Way::Paper, 20, true);
    for backend in Backend::available() {
        let outcomes = campaign.fly_changed(6, backend, 1, |i, case| {
            if i == 2 {
                case.start.position = Vec3([0.0, f64::NAN, 0.0]);
            }
        });
        assert_eq!(outcomes[2].summary.diverged_time, 0.0);
        assert!(outcomes[2].summary.capture_time.is_nan());
        assert!(outcomes[1].summary.diverged_time.is_nan());
    }
}

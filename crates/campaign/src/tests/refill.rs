//! Lanes that take the next flight: every flight is still the one it is by itself, and the lanes are busy.

use super::fixture::{Campaign, LAWS, Way, alone, bits, operation};
use crate::{Column, Fleet, fly_many};
use detumble_core::number::Backend;
use detumble_core::plan::End;

#[test]
fn lanes_take_flights_of_unequal_length_one_after_another_and_keep_their_bits() {
    for (law, end) in LAWS.iter().flat_map(|law| [(law, End::Captured), (law, End::Settled)]) {
        let mut campaign = Campaign::new(law, Way::Paper, 300, true);
        (campaign.plan.end, campaign.plan.hold_ticks) = (end, 20);
        for backend in Backend::available() {
            let one = campaign.fly(37, backend, 1);
            assert_eq!(bits(&one), bits(&campaign.fly(37, backend, 2)), "{law} {end:?} {backend:?}");
            for i in [0, 7, 8, 20, 36] {
                let record = alone(&campaign.recipe(i), i, backend);
                assert_eq!(bits(&record.summary), bits(&one[i].summary), "{law} {end:?} {backend:?}, flight {i}");
            }
        }
        let lengths: Vec<_> =
            campaign.fly(37, Backend::best(), 1).iter().map(|outcome| outcome.summary.end_time).collect();
        assert!(lengths.iter().any(|&time| time != lengths[0]), "{law}: all flights last {} s", lengths[0]);
    }
}

#[test]
fn an_early_end_cuts_a_flight_short_and_changes_nothing_before() {
    let whole = Campaign::new("prrl", Way::Corrected, 120, true);
    let mut short = whole.clone();
    (short.plan.end, short.plan.hold_ticks) = (End::Settled, 30);
    let backend = Backend::best_for_one();
    for i in 0..8 {
        let (long, cut) = (alone(&whole.recipe(i), i, backend), alone(&short.recipe(i), i, backend));
        let rows = cut.series[0].values.len();
        for (long, cut) in long.series.iter().zip(&cut.series) {
            assert_eq!(long.values[..rows * long.width], cut.values[..], "flight {i}, {}", cut.name);
        }
        if rows < long.series[0].values.len() {
            let s = cut.summary;
            // Settled from capture + settling_time on, and three seconds later it is over.
            assert!((s.end_time - (s.capture_time + s.settling_time + 3.0)).abs() < 1e-9, "flight {i}: {s:?}");
        }
    }
}

#[test]
fn the_wrench_of_a_tick_at_which_a_flight_ends_is_not_flown_and_not_counted() {
    for law in LAWS {
        let mut campaign = Campaign::new(law, Way::Paper, 300, true);
        campaign.plan.end = End::Captured;
        for outcome in campaign.fly(16, Backend::best(), 1) {
            let s = outcome.summary;
            if s.capture_time.is_finite() {
                assert_eq!((s.end_time, s.failure), (s.capture_time, 0), "{law}");
                assert_eq!(s.delta_v, s.delta_v_to_capture, "{law}");
            }
        }
    }
}

#[test]
fn lanes_are_busy_although_flights_differ_in_length() {
    let mut campaign = Campaign::new("prrl", Way::Paper, 60, false);
    campaign.plan.end = End::Captured;
    let flights = 2000;
    let positions: Vec<f64> = (0..flights).flat_map(|i| campaign.recipe(i).case.start.position.0).collect();
    let column = Column { path: "start.position".into(), values: &positions };
    let fleet = Fleet::new(campaign.recipe(1), vec![column], flights).unwrap();
    let results = fly_many(&fleet, &operation(Backend::best(), 2));
    let use_of_lanes = results.ticks as f64 / results.lane_ticks as f64;
    println!("lanes busy for {use_of_lanes:.3} of the time");
    assert_eq!(results.flights.len(), flights);
    assert!(use_of_lanes > 0.9 && use_of_lanes <= 1.0);
}

#[test]
fn columns_that_belong_nowhere_or_have_another_length_are_refused() {
    let campaign = Campaign::new("prrl", Way::Paper, 1, false);
    let refused = |path: &str, values: &[f64]| {
        let column = Column { path: path.into(), values };
        Fleet::new(campaign.recipe(0), vec![column], 2).err().unwrap()
    };
    assert!(refused("chaser.colour", &[1.0, 2.0]).contains("chaser.colour"));
    assert!(refused("chaser", &[1.0, 2.0]).contains("no number"));
    assert!(refused("law.before.rotation.kp", &[0.0; 6]).contains("law.before.rotation.kp"));
    assert!(refused("start.position", &[0.0; 5]).contains("2 x 3"));
    assert!(Fleet::new(campaign.recipe(0), Vec::new(), 0).is_ok());
}

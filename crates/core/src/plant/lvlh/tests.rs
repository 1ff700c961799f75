use super::*;
use crate::tests::assert_near;

#[test]
fn frame_turns_about_the_orbit_normal_from_its_given_attitude() {
    // A quarter orbit from an attitude of a third of a turn about (1, 1, 1), which takes x -> y -> z -> x.
    let n = 1e-3;
    let orbit = Orbit { mean_motion: n, lvlh_attitude: Quat([0.5; 4]) };
    let quarter = std::f64::consts::FRAC_PI_2 / n;
    let lvlh = Lvlh::at(&orbit, quarter);
    // Radial direction: along-track of t = 0, which is N's z; along-track: opposite to radial of t = 0, N's y.
    assert_near(&lvlh.attitude.rotate(Vec3([1.0, 0.0, 0.0])).0, &[0.0, 0.0, 1.0], 1e-15);
    assert_near(&lvlh.attitude.rotate(Vec3([0.0, 1.0, 0.0])).0, &[0.0, -1.0, 0.0], 1e-15);
    assert_eq!(lvlh.rate, Vec3([0.0, 0.0, n]));
    assert_eq!(Lvlh::at(&orbit, 0.0).attitude, orbit.lvlh_attitude);
}

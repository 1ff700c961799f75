use super::*;
use crate::tests::{Random, assert_near};

const LIMIT: Vec3<f64> = Vec3([0.1, 0.2, 0.4]);

#[test]
fn each_axis_is_clipped_at_its_own_limit() {
    assert_eq!(saturate(Vec3([0.3, -0.3, 0.3]), LIMIT, Saturation::PerAxis), Vec3([0.1, -0.2, 0.3]));
    assert_eq!(saturate(Vec3([-0.1, 0.2, -9.0]), LIMIT, Saturation::PerAxis), Vec3([-0.1, 0.2, -0.4]));
}

#[test]
fn scaling_brings_the_worst_axis_to_its_limit_and_keeps_the_direction() {
    // Excess 3 on x, 1.5 on y.
    assert_near(&saturate(Vec3([0.3, -0.3, 0.06]), LIMIT, Saturation::Scaled).0, &[0.1, -0.1, 0.02], 1e-16);
    let mut noise = Random::new(13);
    for _ in 0..200 {
        let demand = noise.vector(2.0);
        let given = saturate(demand, LIMIT, Saturation::Scaled);
        assert!(given.cross(demand).norm() <= 1e-16 * demand.norm() && given.dot(demand) > 0.0);
        let used = (given.abs() / LIMIT).max_component();
        let needed = (demand.abs() / LIMIT).max_component();
        assert!((used - needed.min(1.0)).abs() < 1e-15);
    }
}

#[test]
fn demands_inside_the_limits_pass_unchanged() {
    for saturation in [Saturation::PerAxis, Saturation::Scaled] {
        for demand in [Vec3([0.05, -0.15, 0.39]), LIMIT, -LIMIT, Vec3::zero()] {
            assert_eq!(saturate(demand, LIMIT, saturation), demand);
        }
    }
}

#[test]
fn infinite_limits_limit_nothing() {
    let demand = Vec3([1e9, -0.3, 0.0]);
    for saturation in [Saturation::PerAxis, Saturation::Scaled] {
        assert_eq!(saturate(demand, Vec3::splat(f64::INFINITY), saturation), demand);
    }
    let mixed = Vec3([f64::INFINITY, 0.1, f64::INFINITY]);
    assert_eq!(saturate(Vec3([7.0, -0.3, 2.0]), mixed, Saturation::PerAxis), Vec3([7.0, -0.1, 2.0]));
    assert_near(&saturate(Vec3([7.0, -0.3, 3.0]), mixed, Saturation::Scaled).0, &[7.0 / 3.0, -0.1, 1.0], 1e-15);
}

#[test]
fn demand_that_is_not_a_number_is_not_hidden() {
    for axis in 0..3 {
        let mut demand = Vec3([0.3, -0.3, 0.06]);
        demand.0[axis] = f64::NAN;
        assert!(saturate(demand, LIMIT, Saturation::PerAxis)[axis].is_nan());
        assert!(saturate(demand, LIMIT, Saturation::Scaled)[axis].is_nan());
    }
}

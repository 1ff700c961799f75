use super::*;
use crate::number::{Mat3, Quat};
use crate::plant::disturbances::Which;
use crate::tests::assert_near;

/// μ of the published case \[m³/s²\].
const MU: f64 = 3.986_004_415e14;

/// From an MRP σ, N -> body, as a quaternion body -> N.
fn from_mrp(sigma: [f64; 3]) -> Quat<f64> {
    let sigma = Vec3(sigma);
    let square = sigma.norm_squared();
    Quat::from_parts((1.0 - square) / (1.0 + square), sigma * (2.0 / (1.0 + square)))
}

#[test]
fn torque_of_the_published_case() {
    // Basilisk's gravity gradient test: a 7000 km, e 1e-4, i 33.3°, node 48.2°, perigee 347.8°, f 85.3°.
    let [a, e, i, node, perigee, f]: [f64; 6] =
        [7e6, 1e-4, 33.3_f64.to_radians(), 48.2_f64.to_radians(), 347.8_f64.to_radians(), 85.3_f64.to_radians()];
    let radius = a * (1.0 - e * e) / (1.0 + e * f.cos());
    let angle = perigee + f;
    let up = Vec3([
        node.cos() * angle.cos() - node.sin() * angle.sin() * i.cos(),
        node.sin() * angle.cos() + node.cos() * angle.sin() * i.cos(),
        angle.sin() * i.sin(),
    ]);
    // Any frame whose x axis is `up` serves as H: turn e_x into it about e_x × up.
    let to_inertial = Quat::from_parts(1.0 + up[0], Vec3([1.0, 0.0, 0.0]).cross(up)).normalized();
    assert_near(&to_inertial.rotate(Vec3([1.0, 0.0, 0.0])).0, &up.0, 1e-15);
    let inertia = Mat3::diagonal(Vec3([500.0, 800.0, 350.0]));
    let body = Exposed {
        which: Which::Chaser,
        to_lvlh: to_inertial.conjugate() * from_mrp([0.1, 0.2, -0.3]),
        inertia: &inertia,
        mean_motion: (MU / radius.powi(3)).sqrt(),
    };
    let known = [-5.337578670497e-5, 1.255502437243e-4, 1.361858945683e-4];
    assert_near(&GravityGradient.step(&mut (), &body).torque.0, &known, 1e-15);
}

use super::*;
use crate::tests::assert_near;

fn blocks(gain: &[Mat3<f64>; 2]) -> Vec<f64> {
    (0..3).flat_map(|i| [gain[0].0[i], gain[1].0[i]].concat()).collect()
}

#[test]
fn validation_translation_gain_is_that_of_scipy() {
    // scipy 1.17.1, linalg.solve_continuous_are, K = Bᵀ P / r, on the full HCW matrix, n = 1.061812e-3.
    let weights = Weights { q_error: Vec3([1e-6, 2e-6, 3e-6]), q_rate: Vec3([1e-3, 2e-3, 4e-3]), r: 1.0 };
    #[rustfmt::skip]
    let scipy = [
        0.001002813933139337, -4.7914633126814406e-05, 0.0, 0.05483645800770391, -0.00036279512092866407, 0.0,
        3.3880955802563426e-05, 0.0014134016371620266, 0.0, -0.00036279512092866407, 0.06946316126676427, 0.0,
        0.0, 0.0, 0.001730923729789581, 0.0, 0.0, 0.08638198573533235,
    ];
    assert_near(&blocks(&translation_gain(&weights, 1.061812e-3)), &scipy, 1e-12);
}

#[test]
fn validation_rotation_gain_of_a_full_inertia_is_that_of_scipy() {
    // As above; ε' = c e_ω with c = 1/2 and, for 2 ε, c = 1.
    let inertia = Mat3([[0.1, 0.01, -0.02], [0.01, 0.12, 0.005], [-0.02, 0.005, 0.06]]);
    let weights = Weights { q_error: Vec3([1.0, 2.0, 3.0]), q_rate: Vec3([10.0, 20.0, 40.0]), r: 1e4 };
    #[rustfmt::skip]
    let scipy = [[
        0.00997217066332761, -0.0002216253230588098, 0.0012624421209044177,
        0.04458018627871088, 0.0004165137650228013, 0.002439520223558684,
        0.00016491926722040357, 0.014139406963467303, -0.0001848269137259211,
        0.0016964523006101403, 0.06077603342829943, -8.577115286904449e-05,
        -0.0007270583860696179, 0.00016749011196131181, 0.01727345011580798,
        -0.00481003821954293, 0.0012042881511331771, 0.07074090340354604,
    ], [
        0.009973854611588924, -0.00022263296948789332, 0.001221607302686512,
        0.05456286556980831, 0.0011102661810448817, 0.0007589244878345525,
        0.00016481911568929638, 0.014139519558774339, -0.0001717089043849371,
        0.002486283567130545, 0.07339289902616543, 0.0004196662439410162,
        -0.0007036041827477611, 0.00015627286367180492, 0.017276521399001127,
        -0.006551607953491292, 0.0016865482189925337, 0.07760057409964281,
    ]];
    for (attitude_error, known) in [(AttitudeError::Epsilon, scipy[0]), (AttitudeError::TwoEpsilon, scipy[1])] {
        assert_near(&blocks(&rotation_gain(&weights, &inertia, attitude_error)), &known, 1e-11);
    }
}

#[test]
fn gains_scale_with_the_weights_as_only_their_ratio_counts() {
    let weights = Weights { q_error: Vec3([1.0, 2.0, 3.0]), q_rate: Vec3([10.0, 20.0, 40.0]), r: 1e4 };
    let scaled = Weights { q_error: weights.q_error * 1e3, q_rate: weights.q_rate * 1e3, r: 1e7 };
    let inertia = Mat3::diagonal(Vec3([0.1, 0.1, 0.05]));
    assert_near(
        &blocks(&rotation_gain(&scaled, &inertia, AttitudeError::Epsilon)),
        &blocks(&rotation_gain(&weights, &inertia, AttitudeError::Epsilon)),
        1e-14,
    );
}

//! Mechanisms: the counts of the survey, and what was found with other programs where it has none.

use crate::check::{Answer, check};
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::SolveMethod;
use cognate_systems::system::System;
use cognate_tests::systems::{from_file, shared, with_conjugates};

fn check_mechanism(name: &str, system: &System, answer: Answer) {
    check(name, system, &SolveOptions::default(), answer);
}

/// Regular finite solutions and paths to infinity.
fn answer(paths: u64, nonsingular: u64, real: Option<u64>) -> Answer {
    Answer {
        paths,
        nonsingular,
        at_infinity: paths - nonsingular,
        real: Some(real),
        ..Answer::default()
    }
}

/// Survey, section 6.1: 6 assemblies by 6 paths; this one has all of them real.
#[test]
fn three_rpr_platform_has_6_real_assemblies() {
    let system = shared("three_rpr_real6");
    check_mechanism("three_rpr_real6", &system, answer(6, 6, None));
    let paired = with_conjugates(system, "t1~T1,t2~T2,t3~T3,g~G,p~P");
    check_mechanism(
        "three_rpr_real6 with conjugates",
        &paired,
        answer(6, 6, Some(6)),
    );
    let total = SolveOptions {
        method: SolveMethod::TotalDegree,
        ..SolveOptions::default()
    };
    check(
        "three_rpr_real6 by total degree",
        &paired,
        &total,
        answer(16, 6, Some(6)),
    );
}

/// P. Dietmaier, The Stewart-Gough platform of general geometry can have 40
/// real postures (1998). The other 88 paths end on the surface without a pose.
#[test]
fn dietmaiers_platform_has_40_real_postures() {
    let answer = |real| Answer {
        paths: 128,
        nonsingular: 40,
        positive_dimensional: 88,
        real: Some(real),
        ..Answer::default()
    };
    let homogeneous = from_file("stewart_gough_dietmaier", "system_homogeneous.bertini");
    check_mechanism("stewart_gough, homogeneous", &homogeneous, answer(Some(40)));
    // In a random complex patch the equations are not real.
    let patched = shared("stewart_gough_dietmaier");
    check_mechanism("stewart_gough, patched", &patched, answer(None));
}

/// The coupler curve is a sextic; a generic hyperplane and a generic line meet it in 6.
#[test]
fn four_bar_curves_have_degree_6() {
    for name in ["four_bar_motion_slice", "four_bar_coupler_line"] {
        check_mechanism(name, &shared(name), answer(6, 6, None));
    }
}

#[test]
fn a_four_bar_has_2_assemblies_for_an_input_angle() {
    let system = shared("four_bar_input_angle");
    let paired = with_conjugates(system, "t1~T1,t2~T2,g~G,p~P");
    check_mechanism("four_bar_input_angle", &paired, answer(3, 2, Some(2)));
}

/// Three linkages and the trivial root 0.
#[test]
fn function_generation_has_4_roots() {
    let system = with_conjugates(shared("function_generation"), "z1~Z1,z2~Z2");
    check_mechanism("function_generation", &system, answer(6, 4, Some(4)));
}

/// Four dyads, all real here; the two other paths end at infinity.
#[test]
fn burmesters_five_poses_have_4_real_dyads() {
    let system = with_conjugates(shared("burmester_five_poses_real4"), "a~A,b~B");
    check_mechanism("burmester_five_poses_real4", &system, answer(6, 4, Some(4)));
}

#[test]
fn a_planar_3r_arm_reaches_a_pose_in_2_ways() {
    let name = "planar_3r_inverse_pose";
    check_mechanism(name, &shared(name), answer(4, 2, Some(2)));
}

/// Three roots of the survey's system (35) and one of the randomisation.
#[test]
fn the_randomised_system_35_has_4_roots() {
    let name = "survey_eq35_randomized";
    check_mechanism(name, &shared(name), answer(4, 4, None));
}

/// R. Manseur, K. L. Doty, A robot manipulator with 16 real inverse kinematic
/// solution sets (1989): 16 and their 16 mirror images, all real.
#[test]
fn manseur_and_dotys_arm_has_32_real_roots() {
    let name = "six_revolute_manseur_doty_tm8";
    check_mechanism(name, &shared(name), answer(64, 32, Some(32)));
}

/// 28 points of the motion curve and 12 on lines without a pose; 24 paths end
/// on a surface without a pose.
#[test]
fn a_griffis_duffy_platform_has_40_nonsingular_points_in_a_slice() {
    let name = "griffis_duffy_typei_slice";
    let answer = Answer {
        paths: 64,
        nonsingular: 40,
        positive_dimensional: 24,
        real: Some(None),
        ..Answer::default()
    };
    check_mechanism(name, &shared(name), answer);
}

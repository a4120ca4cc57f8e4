//! Linkages as CSV: a row each, best first, with every digit.

use super::Sheet;
use std::fmt::Write as _;

const HEADER: &str = "name,class,certified,grade,type,driver,pivot_a_x,pivot_a_y,pivot_b_x,pivot_b_y,\
joint_a_x,joint_a_y,joint_b_x,joint_b_y,point_x,point_y,ground,side_a,coupler,side_b,arm_a,arm_b,\
one_circuit,one_branch,in_order,order,turns_round,swing_degrees,transmission_degrees,size,error";

/// The names of the columns, with the line's end.
pub fn header() -> String {
    format!("{HEADER}\n")
}

/// The table; joints and coupler point are in the position of point 1.
pub fn sheet(sheet: &Sheet) -> String {
    header() + &rows(sheet, None)
}

/// The table without its header; the set's name in a column before the others, if one is given.
pub fn rows(sheet: &Sheet, set: Option<&str>) -> String {
    let mut text = String::new();
    for (name, curve, mechanism) in sheet.linkages() {
        if let Some(set) = set {
            let _ = write!(text, "\"{}\",", set.replace('"', "\"\""));
        }
        let a = &mechanism.assessment;
        let first = &mechanism.realization.poses[0];
        let drive = a.drive();
        let mut row = vec![
            name,
            curve.class.to_string(),
            curve.certified.to_string(),
            a.grade.name().into(),
            a.kind().into(),
            ["a", "b"][a.driver.index()].into(),
        ];
        let places = [first.pivots, first.joints].concat();
        for z in places.iter().chain([&first.point]) {
            row.extend([z.re.to_string(), z.im.to_string()]);
        }
        row.extend(a.lengths.around().map(|l| l.to_string()));
        row.extend(a.lengths.arms.map(|l| l.to_string()));
        row.extend([a.one_circuit, drive.one_branch, drive.in_order].map(|b| b.to_string()));
        let order = drive.order.as_deref().unwrap_or_default();
        let order: Vec<String> = order.iter().map(|k| (k + 1).to_string()).collect();
        row.push(order.join(" "));
        row.push(drive.turns_round.to_string());
        row.push(drive.swing_degrees.map_or(String::new(), |d| d.to_string()));
        row.push(drive.transmission_degrees.to_string());
        row.extend([a.size, mechanism.realization.error].map(|x| x.to_string()));
        let _ = writeln!(text, "{}", row.join(","));
    }
    text
}

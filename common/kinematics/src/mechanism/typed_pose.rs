//! Poses as people type and print them: numbers without names.

use super::Space;
use super::document::{Document, MechanismError};
use super::pose::ReadPose;
use super::target_row::{MOST_TARGETS, PoseForm, Row, is_json, pose_of_row, value};
use super::task::Task;
use super::typed_numbers::{Numbers, check_unit, lines_of_numbers};
use std::iter::Peekable;

/// Ways to type a pose: by how many numbers, with their names.
const TYPED: [&[&str]; 2] = [
    &["x", "y", "z", "qw", "qx", "qy", "qz"],
    &["x", "y", "z", "roll", "pitch", "yaw"],
];

/// A pose as typed, with blanks or commas: x y z qw qx qy qz; x y z roll pitch yaw; a matrix by rows, of three or four rows
/// of four numbers; in the plane x y angle; for a task its columns ([`Task::columns`]).
pub fn typed_pose(text: &str, form: PoseForm) -> Result<ReadPose, MechanismError> {
    let document = Document {
        file: "--pose",
        text,
    };
    pose_of_numbers(&document, &Numbers::of(0, text), form)
}

/// Poses of a file without names: one a line as [`typed_pose`] has it, or a row of a matrix a line. `None` where it begins
/// with names, or where JSON has another form.
pub(super) fn poses_without_names(
    document: &Document<'_>,
    form: PoseForm,
) -> Option<Result<Vec<ReadPose>, MechanismError>> {
    let lines = lines_of_numbers(document.text)?;
    let poses = each_pose(document, lines, form);
    let is_read_as_json = || {
        let document = document.within_limit();
        document.is_ok_and(|document| document.json_tree().is_ok())
    };
    let is_other_json = is_json(document) && poses.is_err() && is_read_as_json();
    (!is_other_json).then_some(poses)
}

fn each_pose<'a>(
    document: &Document<'_>,
    mut lines: Peekable<impl Iterator<Item = Numbers<'a>>>,
    form: PoseForm,
) -> Result<Vec<ReadPose>, MechanismError> {
    let of_task = form.task.columns().len();
    let may_be_rows = form.space != Space::Planar && of_task != ROW;
    let is_row = |line: &Numbers<'_>| may_be_rows && line.words.len() == ROW;
    let mut poses = Vec::new();
    while let Some(mut numbers) = lines.next() {
        if is_row(&numbers) {
            let mut rows = 1;
            while let Some(row) =
                lines.next_if(|row| is_row(row) && (rows < 3 || rows == 3 && is_last_row(row)))
            {
                numbers.words.extend(row.words);
                rows += 1;
            }
        }
        if poses.len() >= MOST_TARGETS {
            let message = format!("more than {MOST_TARGETS} targets");
            return Err(document.error(numbers.at, "", message));
        }
        poses.push(pose_of_numbers(document, &numbers, form)?);
    }
    Ok(poses)
}

/// Numbers of a row of a matrix of rotation and position.
const ROW: usize = 4;

/// Whether these are 0 0 0 1.
fn is_last_row(row: &Numbers<'_>) -> bool {
    let numbers = row.words.iter().map(|word| value(word, false, false));
    numbers.eq([0.0, 0.0, 0.0, 1.0].map(Some))
}

fn pose_of_numbers(
    document: &Document<'_>,
    numbers: &Numbers<'_>,
    form: PoseForm,
) -> Result<ReadPose, MechanismError> {
    let Numbers { at, words } = numbers;
    let in_space = "7 numbers x y z qw qx qy qz, 6 numbers x y z roll pitch yaw, or a matrix of 12 or 16 by rows";
    let columns = form.task.columns();
    let (ways, expected): (Vec<&[&str]>, String) = match (form.space, form.task) {
        (Space::Planar, _) => (
            vec![Task::Planar.columns()],
            "three numbers, x y angle".into(),
        ),
        _ if [12, 16].contains(&words.len()) => return pose_of_matrix(document, numbers),
        (_, Task::Pose) => (
            TYPED.to_vec(),
            format!(
                "{in_space}; where less is asked for, --task position takes x y z, and there are others"
            ),
        ),
        _ => (
            std::iter::once(columns).chain(TYPED).collect(),
            format!("{} numbers {}, or a pose", columns.len(), columns.join(" ")),
        ),
    };
    let Some(header) = ways.iter().find(|way| way.len() == words.len()) else {
        let message = format!("expected {expected}; found {}", words.len());
        return Err(document.error(*at, "", message));
    };
    let cells = header.iter().zip(words).map(|(name, word)| (*name, *word));
    let row = Row {
        at: *at,
        cells: cells.collect(),
    };
    if *header == TYPED[1] || form.task == Task::XyzYaw && *header == columns {
        check_unit(document, *at, &words[3..], form.degrees)?;
    }
    pose_of_row(document, &row, form)
}

/// A pose from a matrix of three rows of four numbers, or four of which the last is 0 0 0 1.
fn pose_of_matrix(
    document: &Document<'_>,
    numbers: &Numbers<'_>,
) -> Result<ReadPose, MechanismError> {
    let error = |message: String| document.error(numbers.at, "", message);
    let number = |word: &&str| {
        let number = value(word, false, false);
        number.ok_or_else(|| error(format!("expected a number, found \"{word}\"")))
    };
    let numbers: Vec<f64> = numbers.words.iter().map(number).collect::<Result<_, _>>()?;
    if numbers
        .get(12..)
        .is_some_and(|last| !last.is_empty() && last != [0.0, 0.0, 0.0, 1.0])
    {
        return Err(error(
            "expected 0 0 0 1 in the last row of the matrix".into(),
        ));
    }
    let entry = |i: usize, j: usize| numbers[4 * i + j];
    let rows = std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
    let position = std::array::from_fn(|i| entry(i, 3).into());
    ReadPose::of_rows(rows, position).map_err(error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::targets::poses;

    fn form(degrees: bool) -> PoseForm {
        PoseForm::whole(Space::Spatial, degrees)
    }

    /// A quarter turn about x as people type it: every way gives the same pose.
    #[test]
    fn a_pose_may_be_typed_in_many_ways() {
        let typed =
            |text: &str| typed_pose(text, form(true)).unwrap_or_else(|e| panic!("{text}: {e}"));
        let first = typed("0.4 0.2 0.1 0.7071067811865476 0.7071067811865476 0 0");
        assert_eq!(ReadPose::warning(&[first]), None);
        for text in [
            "0.4, 0.2, 0.1, 90, 0, 0",
            "0.4 0.2 0.1 pi/2 0 0",
            "1 0 0 0.4 0 0 -1 0.2 0 1 0 0.1",
            "[[1,0,0,0.4],[0,0,-1,0.2],[0,1,0,0.1],[0,0,0,1]]",
            "0.4;0.2;0.1;0.7071;0.7071;0;0",
        ] {
            assert!(
                typed(text).pose.distance(&first.pose, 1.0) < 1e-15,
                "{text}"
            );
        }
        let rounded = typed("0.4 0.2 0.1 0.7071 0.7071 0 0");
        let warning = ReadPose::warning(&[first, rounded, rounded]).expect("a word");
        assert!(
            warning.starts_with("pose 2") && warning.contains("1 others"),
            "{warning}"
        );
    }

    /// As numpy prints matrices, as MATLAB does, and poses one a line.
    #[test]
    fn files_of_numbers_hold_poses() {
        let first = typed_pose("0.4 0.2 0.1 90 0 0", form(true))
            .expect("a pose")
            .pose;
        for (text, count) in [
            (
                "[[ 1.   0.   0.   0.4]\n [ 0.   0.  -1.   0.2]\n [ 0.   1.   0.   0.1]\n [ 0.   0.   0.   1. ]]\n",
                1,
            ),
            (
                "1 0 0 0.4\n0 0 -1 0.2\n0 1 0 0.1\n\n1 0 0 0.4\n0 0 -1 0.2\n0 1 0 0.1\n",
                2,
            ),
            (
                "1,0,0,0.4\n0,0,-1,0.2\n0,1,0,0.1\n0,0,0,1\n1,0,0,0.4\n0,0,-1,0.2\n0,1,0,0.1\n0,0,0,1\n",
                2,
            ),
            ("[[1,0,0,0.4],[0,0,-1,0.2],[0,1,0,0.1],[0,0,0,1]]", 1),
            (
                "0.4 0.2 0.1 90 0 0\n0.4 0.2 0.1 pi/2 0 0\n1 0 0 0.4 0 0 -1 0.2 0 1 0 0.1\n",
                3,
            ),
            (
                "# angles: rad\nx,y,z,roll,pitch,yaw\n0.4,0.2,0.1,1.5707963267948966,0,0\n",
                1,
            ),
            (
                "x;y;z;roll;pitch;yaw\n0.4;0.2;0.1;90;0;0\n0.4;0.2;0.1;π/2;0;0\n",
                2,
            ),
        ] {
            let read = poses("poses.txt", text.as_bytes(), form(true));
            let read = read.unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!(read.len(), count, "{text}");
            assert!(
                read.iter()
                    .all(|read| read.pose.distance(&first, 1.0) < 1e-15),
                "{text}"
            );
        }
        let scara = PoseForm {
            task: Task::XyzYaw,
            ..form(true)
        };
        let rows = "0.3 0.2 0.1 30\n0.3 0.2 0.1 45\n0.3 0.2 0.1 60\n";
        assert_eq!(
            poses("poses.txt", rows.as_bytes(), scara)
                .expect("poses")
                .len(),
            3
        );
        for (text, expected) in [
            ("1 0 0 0.4\n0 0 -1 0.2\n", "poses.txt:1: expected 7 numbers"),
            (
                "0.4 0.2 0.1 90 0 0\n0.4 0.2 0.1\n",
                "poses.txt:2: expected 7 numbers",
            ),
            ("0.4 0.2 0.1 1.5708 0 0\n", "1.5708rad"),
            ("x,y,z\n1,2,3\n", "no column \"roll\""),
        ] {
            let error = poses("poses.txt", text.as_bytes(), form(true)).expect_err(text);
            assert!(error.to_string().contains(expected), "{text}: {error}");
        }
    }

    #[test]
    fn poses_that_may_mean_something_else_are_refused() {
        for (text, degrees, expected) in [
            ("0.4 0.2 0.1 90 0 0", false, "90deg"),
            ("0.4 0.2 0.1 1.5708 0 0", true, "1.5708rad"),
            ("0.4 0.2 0.1", true, "--task position takes x y z"),
            ("0.4 0.2 0.1 0.8 0.7 0 0", true, "of length 1"),
            ("1 0 0 0.4 0 0 -1 0.2 0 1 0 0.1 0 0 1 0", true, "0 0 0 1"),
            ("1 0 0 0.4 0 0 1 0.2 0 1 0 0.1", true, "no rotation"),
        ] {
            let error = typed_pose(text, form(degrees)).expect_err(text).to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}

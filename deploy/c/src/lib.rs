//! libcognate: the functions of `cognate.h`, which describes them.
//!
//! Each function checks its pointers, turns them into Rust's values, calls `cognate_client::in_process`, and turns the
//! answer back. A panic does not cross into the caller's code: it becomes an answer with code 3.

use cognate_client::error::{ClientError, Exit};
use cognate_client::in_process::{self, Arm};
use std::ffi::{CStr, CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Most poses of one call: their answers are held at once.
const MOST_POSES: usize = 10_000_000;

/// Why a call has no answer: the code and the reason.
type Refusal = (Exit, String);

/// An arm behind the caller's pointer.
pub struct CognateArm(Arm);

fn refusal(error: &ClientError) -> Refusal {
    (error.exit(), error.to_string())
}

fn bad_input(message: &str) -> Refusal {
    (Exit::BadInput, message.to_owned())
}

/// Does this work; a panic becomes a refusal.
fn guarded<T>(work: impl FnOnce() -> Result<T, Refusal>) -> Result<T, Refusal> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
        let message = "a fault of this library, not of its input; please report it";
        Err((Exit::Unavailable, message.to_owned()))
    })
}

/// A text of the caller; `name` is for messages.
///
/// # Safety
/// `text` is null, or a text that ends with a zero byte and lives as long as the result is used.
unsafe fn text<'a>(text: *const c_char, name: &str) -> Result<&'a str, Refusal> {
    if text.is_null() {
        return Err(bad_input(&format!("{name}: expected a text, found NULL")));
    }
    // SAFETY: it is not null, and the caller of this function answers for the rest.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str()
        .map_err(|e| bad_input(&format!("{name}: is not UTF-8: {e}")))
}

/// Options of the caller: a JSON array of texts, or null for none.
///
/// # Safety
/// As of [`text`].
unsafe fn options(options: *const c_char) -> Result<Vec<String>, Refusal> {
    if options.is_null() {
        return Ok(Vec::new());
    }
    // SAFETY: the caller of this function answers for it.
    let text = unsafe { text(options, "options") }?;
    serde_json::from_str(text).map_err(|e| {
        bad_input(&format!(
            "options: expected a JSON array of texts such as [\"--seed\", \"3\"]: {e}"
        ))
    })
}

/// Writes a text that the caller owns from then on, or null for none.
///
/// # Safety
/// `place` is null, or a place where a pointer can be written.
unsafe fn give(place: *mut *mut c_char, text: Option<&str>) {
    if place.is_null() {
        return;
    }
    let text = text.map_or(std::ptr::null_mut(), |text| {
        // No answer has a zero byte: JSON escapes it, and messages quote it.
        let text = text.replace('\0', "\\0");
        CString::new(text).map_or(std::ptr::null_mut(), CString::into_raw)
    });
    // SAFETY: it is not null, and the caller of this function answers for the rest.
    unsafe { place.write(text) };
}

/// The arm of the caller's pointer.
///
/// # Safety
/// `arm` is null, or comes from `cognate_arm_open` and was not closed.
unsafe fn arm<'a>(arm: *const CognateArm) -> Result<&'a Arm, Refusal> {
    // SAFETY: the caller of this function answers for it.
    let arm = unsafe { arm.as_ref() };
    arm.map(|arm| &arm.0)
        .ok_or_else(|| bad_input("arm: expected one of cognate_arm_open, found NULL"))
}

/// Version of the library; see `cognate.h`.
#[unsafe(no_mangle)]
pub extern "C" fn cognate_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

/// All isolated solutions of a system; see `cognate.h`.
///
/// # Safety
/// The pointers are as `cognate.h` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cognate_solve(
    system: *const c_char,
    options_text: *const c_char,
    answer: *mut *mut c_char,
) -> c_int {
    let answered = guarded(|| {
        // SAFETY: the caller answers for both texts.
        let (system, options) = unsafe { (text(system, "system")?, options(options_text)?) };
        Ok(in_process::solve(system.as_bytes(), &options))
    });
    let (exit, json) = answered.unwrap_or_else(|(exit, message)| {
        let json = serde_json::json!({"error": message});
        (exit, json.to_string())
    });
    // SAFETY: the caller answers for the place.
    unsafe { give(answer, Some(&json)) };
    exit as c_int
}

/// Reads a mechanism and prepares it; see `cognate.h`.
///
/// # Safety
/// The pointers are as `cognate.h` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cognate_arm_open(
    mechanism: *const c_char,
    options_text: *const c_char,
    error: *mut *mut c_char,
) -> *mut CognateArm {
    let opened = guarded(|| {
        // SAFETY: the caller answers for both texts.
        let (mechanism, options) =
            unsafe { (text(mechanism, "mechanism")?, options(options_text)?) };
        Arm::open(mechanism.as_bytes(), &options).map_err(|e| refusal(&e))
    });
    let message = opened.as_ref().err().map(|(_, message)| message.clone());
    // SAFETY: the caller answers for the place.
    unsafe { give(error, message.as_deref()) };
    opened.map_or(std::ptr::null_mut(), |arm| {
        Box::into_raw(Box::new(CognateArm(arm)))
    })
}

/// Gives an arm back; see `cognate.h`.
///
/// # Safety
/// `arm` is null, or comes from `cognate_arm_open` and was not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cognate_arm_close(arm: *mut CognateArm) {
    if !arm.is_null() {
        // SAFETY: it was made by `Box::into_raw`, and is given back once.
        drop(unsafe { Box::from_raw(arm) });
    }
}

/// Number of the joints of a posture; see `cognate.h`.
///
/// # Safety
/// `pointer` is null, or comes from `cognate_arm_open` and was not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cognate_arm_joints(pointer: *const CognateArm) -> usize {
    // SAFETY: the caller answers for it.
    unsafe { arm(pointer) }.map_or(0, Arm::joints)
}

/// All real postures for several poses; see `cognate.h`.
///
/// # Safety
/// The pointers are as `cognate.h` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cognate_arm_inverse(
    pointer: *const CognateArm,
    poses: *const f64,
    count: usize,
    joints: *mut f64,
    capacity: usize,
    offsets: *mut usize,
    settled: *mut u8,
    error: *mut *mut c_char,
) -> c_int {
    let answered = guarded(|| {
        if offsets.is_null() || (count > 0 && poses.is_null()) {
            return Err(bad_input("poses and offsets: expected places, found NULL"));
        }
        if count > MOST_POSES {
            return Err(bad_input(&format!(
                "count: expected at most {MOST_POSES}, found {count}"
            )));
        }
        // SAFETY: there is room for count + 1 numbers.
        unsafe { std::slice::from_raw_parts_mut(offsets, count + 1) }.fill(0);
        // SAFETY: the caller answers for the arm.
        let arm = unsafe { arm(pointer) }?;
        let matrices: &[[f64; 16]] = match count {
            0 => &[],
            // SAFETY: there are count matrices of 16 numbers, and an array has the alignment of its numbers.
            _ => unsafe { std::slice::from_raw_parts(poses.cast(), count) },
        };
        let answer = arm.inverse(matrices).map_err(|e| refusal(&e))?;
        // SAFETY: there is room for count + 1 numbers.
        unsafe { std::slice::from_raw_parts_mut(offsets, count + 1) }
            .copy_from_slice(&answer.offsets);
        let postures = answer.offsets[count];
        if postures > capacity || (postures > 0 && joints.is_null()) {
            return Err(bad_input(&format!(
                "joints: room for {capacity} postures, there are {postures}"
            )));
        }
        if postures > 0 {
            // SAFETY: there is room for `capacity` postures, which are not fewer.
            unsafe { std::slice::from_raw_parts_mut(joints, answer.joints.len()) }
                .copy_from_slice(&answer.joints);
        }
        if !settled.is_null() {
            // SAFETY: there is room for count bytes.
            let settled = unsafe { std::slice::from_raw_parts_mut(settled, count) };
            for (place, is_settled) in settled.iter_mut().zip(&answer.settled) {
                *place = u8::from(*is_settled);
            }
        }
        Ok(Exit::of_settled(
            answer.settled.iter().all(|settled| *settled),
        ))
    });
    let message = answered.as_ref().err().map(|(_, message)| message.clone());
    // SAFETY: the caller answers for the place.
    unsafe { give(error, message.as_deref()) };
    answered.unwrap_or_else(|(exit, _)| exit) as c_int
}

/// Answers targets, a line of JSON each; see `cognate.h`.
///
/// # Safety
/// The pointers are as `cognate.h` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cognate_arm_answer(
    pointer: *const CognateArm,
    lines: *const c_char,
    answer: *mut *mut c_char,
) -> c_int {
    let answered = guarded(|| {
        // SAFETY: the caller answers for the arm and the text.
        let (arm, lines) = unsafe { (arm(pointer)?, text(lines, "lines")?) };
        arm.answer_lines(lines.as_bytes()).map_err(|e| refusal(&e))
    });
    let (exit, text) = answered.unwrap_or_else(|(exit, message)| {
        let json = serde_json::json!({"error": message});
        (exit, format!("{json}\n"))
    });
    // SAFETY: the caller answers for the place.
    unsafe { give(answer, Some(&text)) };
    exit as c_int
}

/// Gives an answer or an error back; see `cognate.h`.
///
/// # Safety
/// `text` is null, or comes from this library and was not given back.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cognate_free(text: *mut c_char) {
    if !text.is_null() {
        // SAFETY: it was made by `CString::into_raw`, and is given back once.
        drop(unsafe { CString::from_raw(text) });
    }
}

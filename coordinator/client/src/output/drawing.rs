//! A path as a drawing (SVG): its coordinates in the complex plane, and its steps.

use cognate_continuation::tracker::observer::StepEvent;
use num_complex::Complex64;
use std::fmt::Write as _;

/// Width of the whole drawing in pixels.
const WIDTH: f64 = 900.0;
/// Height of the whole drawing in pixels.
const HEIGHT: f64 = 480.0;
/// Side of each of the two panels.
const PANEL: f64 = 380.0;
/// Left edges of the panels.
const LEFT: [f64; 2] = [40.0, 490.0];
/// Upper edge of the panels.
const TOP: f64 = 60.0;

/// Colours that are told apart on white, also by the colour-blind (after Okabe and Ito).
const COLORS: [&str; 7] = [
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000",
];

/// A range of values on an axis, and the pixels that it is drawn on.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn at(&self, value: f64) -> f64 {
        let share = (value - self.low) / (self.high - self.low);
        self.from + share.clamp(0.0, 1.0) * (self.to - self.from)
    }
}

/// The drawing of a path; `title` says which.
pub fn path(title: &str, steps: &[StepEvent]) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
    );
    text(&mut svg, LEFT[0], 28.0, 16, &escaped(title));
    coordinates(&mut svg, steps);
    lengths(&mut svg, steps);
    svg.push_str("</svg>\n");
    svg
}

/// Each coordinate of the chart as a curve, an open circle at its start and a full one at its end.
fn coordinates(svg: &mut String, steps: &[StepEvent]) {
    text(
        svg,
        LEFT[0],
        TOP - 8.0,
        12,
        "coordinates in the complex plane (open: start, full: end)",
    );
    frame(svg, LEFT[0]);
    let accepted: Vec<&StepEvent> = steps.iter().filter(|s| s.accepted).collect();
    let values = accepted.iter().flat_map(|s| &s.point);
    let reach = values
        .map(|z| z.re.abs().max(z.im.abs()))
        .fold(0.0, f64::max)
        .max(1e-300)
        * 1.05;
    let x = Axis {
        low: -reach,
        high: reach,
        from: LEFT[0],
        to: LEFT[0] + PANEL,
    };
    let y = Axis {
        low: -reach,
        high: reach,
        from: TOP + PANEL,
        to: TOP,
    };
    let (middle_x, middle_y) = (x.at(0.0), y.at(0.0));
    line(svg, (x.from, middle_y), (x.to, middle_y), "#ddd");
    line(svg, (middle_x, y.from), (middle_x, y.to), "#ddd");
    let count = accepted.first().map_or(0, |s| s.point.len());
    for c in 0..count {
        let color = COLORS[c % COLORS.len()];
        let place = |z: &Complex64| (x.at(z.re), y.at(z.im));
        let points: Vec<(f64, f64)> = accepted
            .iter()
            .filter_map(|s| s.point.get(c))
            .map(place)
            .collect();
        polyline(svg, &points, color);
        if let (Some(first), Some(last)) = (points.first(), points.last()) {
            circle(svg, *first, "white", color);
            circle(svg, *last, color, color);
        }
    }
    text(svg, x.from, y.from + 16.0, 11, &format!("{:.2e}", -reach));
    text(svg, x.to - 50.0, y.from + 16.0, 11, &format!("{reach:.2e}"));
}

/// Step length and predictor error of every attempted step, on a logarithmic scale.
fn lengths(svg: &mut String, steps: &[StepEvent]) {
    text(
        svg,
        LEFT[1],
        TOP - 8.0,
        12,
        "step length (blue; rejected: red), predictor error (grey), by number of the step",
    );
    frame(svg, LEFT[1]);
    let x = Axis {
        low: 0.0,
        high: steps.len().max(2) as f64 - 1.0,
        from: LEFT[1],
        to: LEFT[1] + PANEL,
    };
    let step_lengths = steps.iter().flat_map(|s| [s.step, s.predictor_error]);
    let exponents: Vec<f64> = step_lengths.filter_map(exponent).collect();
    let low = exponents
        .iter()
        .copied()
        .fold(0.0, f64::min)
        .floor()
        .clamp(-18.0, -2.0);
    let y = Axis {
        low,
        high: 0.0,
        from: TOP + PANEL,
        to: TOP,
    };
    let mut decade = 0.0;
    while decade >= low {
        line(svg, (x.from, y.at(decade)), (x.to, y.at(decade)), "#eee");
        text(
            svg,
            x.to + 4.0,
            y.at(decade) + 4.0,
            10,
            &format!("1e{decade}"),
        );
        decade -= 2.0;
    }
    let curve = |value: fn(&StepEvent) -> f64| -> Vec<(f64, f64)> {
        let numbered = steps.iter().enumerate();
        numbered
            .filter_map(|(i, s)| Some((x.at(i as f64), y.at(exponent(value(s))?))))
            .collect()
    };
    polyline(svg, &curve(|s| s.predictor_error), "#aaa");
    polyline(svg, &curve(|s| s.step), COLORS[0]);
    for (i, s) in steps.iter().enumerate().filter(|(_, s)| !s.accepted) {
        if let Some(e) = exponent(s.step) {
            circle(svg, (x.at(i as f64), y.at(e)), COLORS[1], COLORS[1]);
        }
    }
}

/// The decimal logarithm, where there is one.
#[expect(
    clippy::disallowed_methods,
    reason = "where a line is drawn is no result"
)]
fn exponent(x: f64) -> Option<f64> {
    (x.is_finite() && x > 0.0).then(|| x.log10())
}

fn frame(svg: &mut String, left: f64) {
    let _ = writeln!(
        svg,
        "<rect x=\"{left}\" y=\"{TOP}\" width=\"{PANEL}\" height=\"{PANEL}\" fill=\"none\" stroke=\"#999\"/>"
    );
}

fn line(svg: &mut String, a: (f64, f64), b: (f64, f64), color: &str) {
    let _ = writeln!(
        svg,
        "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{color}\"/>",
        a.0, a.1, b.0, b.1
    );
}

fn polyline(svg: &mut String, points: &[(f64, f64)], color: &str) {
    svg.push_str("<polyline fill=\"none\" stroke-width=\"1.3\" stroke=\"");
    let _ = write!(svg, "{color}\" points=\"");
    for (x, y) in points {
        let _ = write!(svg, "{x:.1},{y:.1} ");
    }
    svg.push_str("\"/>\n");
}

fn circle(svg: &mut String, at: (f64, f64), fill: &str, stroke: &str) {
    let _ = writeln!(
        svg,
        "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3.5\" fill=\"{fill}\" stroke=\"{stroke}\"/>",
        at.0, at.1
    );
}

fn text(svg: &mut String, x: f64, y: f64, size: u32, content: &str) {
    let _ = writeln!(
        svg,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\">{content}</text>"
    );
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(i: u32, accepted: bool) -> StepEvent {
        let s = f64::from(i) / 10.0;
        StepEvent {
            phase: "tracking",
            t: Complex64::new(1.0 - s, 0.0),
            step: 0.1,
            accepted,
            predictor_error: 1e-5,
            correction: 1e-11,
            precision_bits: 53,
            point: vec![Complex64::new(s, 1.0 - s), Complex64::new(-s, 0.5)],
        }
    }

    #[test]
    fn a_drawing_has_a_curve_for_each_coordinate_and_a_mark_for_each_rejection() {
        let steps = [step(1, true), step(2, false), step(3, true)];
        let svg = path("a<b & c", &steps);
        assert!(svg.contains("a&lt;b &amp; c"));
        assert_eq!(svg.matches("<polyline").count(), 4);
        assert_eq!(svg.matches("<circle").count(), 5);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn a_path_without_steps_can_be_drawn() {
        let svg = path("none", &[]);
        assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    }
}

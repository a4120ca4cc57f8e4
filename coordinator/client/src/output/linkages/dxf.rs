//! A linkage as a DXF drawing (release 12, which every program reads): links, pivots, coupler
//! curve and points, each on a layer of its own, in the units of the points.

use cognate_kinematics::coupler_curve;
use cognate_kinematics::linkage::Linkage;
use num_complex::Complex64;
use std::fmt::Write as _;

/// Layers and their colours, by AutoCAD's numbers.
const LAYERS: [(&str, u8); 5] = [
    ("GROUND", 8),
    ("LINKS", 5),
    ("COUPLER", 30),
    ("CURVE", 1),
    ("POINTS", 7),
];

/// The drawing, in the position of point 1.
pub fn drawing(first: &Linkage, points: &[Complex64]) -> String {
    let mut out = Drawing::default();
    let [a, b] = first.pivots;
    let [p, q] = first.joints;
    // Marks are a fiftieth of what they mark.
    let mark = first
        .lengths()
        .around()
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min)
        / 50.0;
    out.line("GROUND", a, b);
    for pivot in [a, b] {
        out.circle("GROUND", pivot, 2.0 * mark);
    }
    out.line("LINKS", a, p);
    out.line("LINKS", b, q);
    for joint in [p, q] {
        out.circle("LINKS", joint, mark);
    }
    for (from, to) in [(p, q), (p, first.point), (q, first.point)] {
        out.line("COUPLER", from, to);
    }
    for circuit in coupler_curve::circuits(first) {
        out.polyline("CURVE", &circuit.points);
    }
    for (k, &point) in points.iter().enumerate() {
        out.point("POINTS", point);
        out.text(
            "POINTS",
            point + Complex64::new(mark, mark),
            3.0 * mark,
            &(k + 1).to_string(),
        );
    }
    out.finish()
}

/// Pairs of a group code and a value, a line each.
#[derive(Default)]
struct Drawing {
    entities: String,
}

impl Drawing {
    fn pair(text: &mut String, code: u16, value: &str) {
        let _ = write!(text, "{code:>3}\r\n{value}\r\n");
    }

    fn entity(&mut self, kind: &str, layer: &str) {
        Self::pair(&mut self.entities, 0, kind);
        Self::pair(&mut self.entities, 8, layer);
    }

    /// Codes 10, 20, 30 for the first place of an entity, 11, 21, 31 for the second.
    fn place(&mut self, which: u16, z: Complex64) {
        for (code, value) in [(10, z.re), (20, z.im), (30, 0.0)] {
            Self::pair(&mut self.entities, code + which, &number(value));
        }
    }

    fn number(&mut self, code: u16, value: f64) {
        Self::pair(&mut self.entities, code, &number(value));
    }

    fn line(&mut self, layer: &str, from: Complex64, to: Complex64) {
        self.entity("LINE", layer);
        self.place(0, from);
        self.place(1, to);
    }

    fn circle(&mut self, layer: &str, centre: Complex64, radius: f64) {
        self.entity("CIRCLE", layer);
        self.place(0, centre);
        self.number(40, radius);
    }

    fn point(&mut self, layer: &str, at: Complex64) {
        self.entity("POINT", layer);
        self.place(0, at);
    }

    fn text(&mut self, layer: &str, at: Complex64, height: f64, text: &str) {
        self.entity("TEXT", layer);
        self.place(0, at);
        self.number(40, height);
        Self::pair(&mut self.entities, 1, text);
    }

    /// Closed (70: 1).
    fn polyline(&mut self, layer: &str, points: &[Complex64]) {
        self.entity("POLYLINE", layer);
        Self::pair(&mut self.entities, 66, "1");
        self.place(0, Complex64::default());
        Self::pair(&mut self.entities, 70, "1");
        for &point in points {
            self.entity("VERTEX", layer);
            self.place(0, point);
        }
        self.entity("SEQEND", layer);
    }

    fn finish(self) -> String {
        let mut text = String::new();
        let mut pair = |code: u16, value: &str| Self::pair(&mut text, code, value);
        for (code, value) in [
            (0, "SECTION"),
            (2, "HEADER"),
            (9, "$ACADVER"),
            (1, "AC1009"),
            (0, "ENDSEC"),
        ] {
            pair(code, value);
        }
        for (code, value) in [(0, "SECTION"), (2, "TABLES"), (0, "TABLE"), (2, "LAYER")] {
            pair(code, value);
        }
        pair(70, &LAYERS.len().to_string());
        for (name, color) in LAYERS {
            pair(0, "LAYER");
            pair(2, name);
            pair(70, "0");
            pair(62, &color.to_string());
            pair(6, "CONTINUOUS");
        }
        for (code, value) in [
            (0, "ENDTAB"),
            (0, "ENDSEC"),
            (0, "SECTION"),
            (2, "ENTITIES"),
        ] {
            pair(code, value);
        }
        text.push_str(&self.entities);
        for (code, value) in [(0, "ENDSEC"), (0, "EOF")] {
            Self::pair(&mut text, code, value);
        }
        text
    }
}

/// Every digit, with a point or an exponent, as readers of DXF expect a real number.
fn number(x: f64) -> String {
    format!("{x:?}")
}

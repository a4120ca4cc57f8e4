//! Records: results as bytes that are stored and hashed.
//!
//! One layout, written by hand so that it is the same for ever: magic with the
//! version, number of records, then each record with its length before it; all
//! numbers little endian. A record ends with the facts that only some results
//! have, each behind its tag, ascending. A NaN is written as the one NaN, so that two machines
//! agree. The hash is over these bytes before any compression; neither time nor
//! worker is in them.

use crate::flat_result::FlatResult;
use cognate_continuation::bend::{Bend, Number};
use cognate_continuation::certification::{Certificate, Certification, Uncertified};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::{
    AskedFit, BoundaryKey, Coordinates, Counts, LocalDimension, MovedSlice, NUMBERS, PathIndex,
    PathResult,
};
use cognate_continuation::sharpening::{Sharpened, Sharpening, Unsharpened};
use cognate_continuation::start_points::Digest;
use cognate_continuation::start_systems::polyhedral::branches::{BranchCount, CountedCells};
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_continuation::work::Work;
use cognate_numeric::exact_text::{exact_text, read_exact};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::DoubleDouble;
use num_complex::Complex64;

const MAGIC: &[u8; 8] = b"CGNRES01";

/// Tags of the facts that only some results have. Tags only grow.
mod tag {
    pub const ASKED: u8 = 1;
    pub const CERTIFIED: u8 = 2;
    pub const UNCERTIFIED: u8 = 3;
    pub const LOCAL_DIMENSION: u8 = 4;
    pub const SHARPENED: u8 = 5;
    pub const UNSHARPENED: u8 = 6;
    pub const BOUNDARY: u8 = 7;
    pub const MIXED_CELLS: u8 = 8;
    pub const UNCOUNTED: u8 = 9;
    pub const MOVED_SLICES: u8 = 10;
    pub const BEND: u8 = 11;
}

/// Bytes that hold no records.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the object of path results is damaged at byte {at}: {what}")]
pub struct DamagedRecords {
    /// Byte at which reading stopped.
    pub at: usize,
    /// Description of the fault at that byte.
    pub what: &'static str,
}

/// The records of these results.
pub fn encode<'a>(results: impl IntoIterator<Item = &'a ItemResult>) -> Vec<u8> {
    let mut w = Writer(Vec::with_capacity(4096));
    w.0.extend_from_slice(MAGIC);
    w.u64(0);
    let mut count = 0u64;
    for result in results {
        let start = w.0.len();
        w.u32(0);
        w.record(&result.into());
        let length = u32::try_from(w.0.len() - start - 4)
            .expect("a path has far fewer than 2^28 coordinates");
        w.0[start..start + 4].copy_from_slice(&length.to_le_bytes());
        count += 1;
    }
    w.0[8..16].copy_from_slice(&count.to_le_bytes());
    w.0
}

/// The hash of records.
pub fn hash(records: &[u8]) -> Digest {
    crate::digest::of_bytes(records)
}

/// Reads what [`encode`] wrote of items of this kind of work.
pub fn decode(records: &[u8], work: Work) -> Result<Vec<ItemResult>, DamagedRecords> {
    let mut r = Reader {
        bytes: records,
        at: 0,
    };
    if r.take(8)? != MAGIC {
        return Err(r.damaged("it does not begin with the right magic"));
    }
    let count = r.u64()?;
    let mut results = Vec::new();
    for _ in 0..count {
        let length = r.u32()? as usize;
        let end = r.at + length;
        if end > records.len() {
            return Err(r.damaged("a record is longer than what is there"));
        }
        let result = r.record(end)?;
        if r.at != end {
            return Err(r.damaged("a record has another length than it says"));
        }
        let of_another = r.damaged("a result of another kind of work");
        results.push(result.into_item(work).map_err(|_| of_another)?);
    }
    if r.at != records.len() {
        return Err(r.damaged("there is more than the records"));
    }
    Ok(results)
}

struct Writer(Vec<u8>);

impl Writer {
    fn u32(&mut self, value: u32) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    fn u64(&mut self, value: u64) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    fn f64(&mut self, value: f64) {
        let bits = if value.is_nan() {
            0x7ff8_0000_0000_0000
        } else {
            value.to_bits()
        };
        self.u64(bits);
    }

    fn complex(&mut self, z: Complex64) {
        self.f64(z.re);
        self.f64(z.im);
    }

    /// A number of two doubles each for real and imaginary part.
    fn numbers(&mut self, numbers: &[Number]) {
        self.length(numbers.len());
        for part in numbers.iter().flat_map(|z| [z.re, z.im]) {
            part.parts().iter().for_each(|&x| self.f64(x));
        }
    }

    fn length(&mut self, length: usize) {
        self.u32(u32::try_from(length).expect("a path has far fewer than 2^32 coordinates"));
    }

    fn record(&mut self, result: &FlatResult) {
        self.path(&result.path);
        self.facts(result);
    }

    /// The fields that every result has.
    fn path(&mut self, path: &PathResult) {
        let PathResult {
            origin,
            attempt,
            outcome,
            endpoint,
            t,
            residual,
            condition,
            accuracy,
            winding_number,
            infinity_turns,
            precision_bits,
            counts,
            asked: _,
            local_dimension: _,
            boundary: _,
        } = path;
        self.u64(origin.0);
        self.0.extend_from_slice(&attempt.to_le_bytes());
        self.0.push(match outcome {
            PathOutcome::Regular => 1,
            PathOutcome::Singular => 2,
            PathOutcome::Diverging => 3,
            PathOutcome::PutAside => 4,
            PathOutcome::Failed(Failure::InvalidStartPoint) => 16,
            PathOutcome::Failed(Failure::StepTooSmall) => 17,
            PathOutcome::Failed(Failure::TooManySteps) => 18,
            PathOutcome::Failed(Failure::EndgameUnsettled) => 19,
            PathOutcome::Failed(Failure::KilledItsWorker) => 20,
        });
        // The kind of the coordinates: other arithmetics get other numbers.
        let Coordinates::Double(values) = endpoint;
        self.0.push(0);
        self.length(values.len());
        values.iter().for_each(|&z| self.complex(z));
        self.complex(*t);
        self.f64(*residual);
        self.f64(*condition);
        self.f64(*accuracy);
        // A winding number is at least 1, so 0 stands for none.
        self.u32(winding_number.unwrap_or(0));
        self.length(infinity_turns.len());
        for turns in infinity_turns {
            self.0.extend_from_slice(&turns.to_le_bytes());
        }
        self.u32(*precision_bits);
        let Counts {
            steps,
            rejections,
            evaluations,
            exchanges,
            turns,
        } = counts;
        for count in [steps, rejections, evaluations, exchanges, turns] {
            self.u32(*count);
        }
    }

    /// The facts that only some results have, in the order of their tags.
    fn facts(&mut self, result: &FlatResult) {
        let FlatResult {
            path,
            certification,
            sharpening,
            mixed_cells,
            bend,
        } = result;
        if let Some(fit) = &path.asked {
            self.asked_fit(fit);
        }
        if let Some(certification) = certification {
            self.certification(certification);
        }
        if let Some(local_dimension) = &path.local_dimension {
            self.dual_space(local_dimension);
        }
        if let Some(sharpening) = sharpening {
            self.sharpening(sharpening);
        }
        if let Some(key) = path.boundary.as_deref() {
            self.boundary_key(key);
        }
        if let Some(count) = mixed_cells {
            self.branch_count(count);
        }
        if let Some(local_dimension) = &path.local_dimension {
            self.moved_slices(&local_dimension.moved_slices);
        }
        if let Some(bend) = bend.as_deref() {
            self.bend(bend);
        }
    }

    fn asked_fit(&mut self, fit: &AskedFit) {
        let AskedFit {
            residual,
            correction,
        } = fit;
        self.0.push(tag::ASKED);
        self.f64(*residual);
        self.f64(*correction);
    }

    fn certification(&mut self, certification: &Certification) {
        match certification {
            Certification::Certified(certificate) => self.certificate(certificate),
            Certification::Uncertified(reason) => {
                self.0.push(tag::UNCERTIFIED);
                self.0.push(match reason {
                    Uncertified::DamagedPoint => 1,
                    Uncertified::NoEnclosure => 2,
                    Uncertified::NewtonLeaves => 3,
                    Uncertified::Singular => 4,
                    Uncertified::NoContraction => 5,
                });
            }
        }
    }

    /// Dual space and bound of a local dimension; the moved slices have a tag of their own.
    fn dual_space(&mut self, local_dimension: &LocalDimension) {
        let LocalDimension {
            dual_dimensions,
            bound,
            margin,
            moved_slices: _,
        } = local_dimension;
        self.0.push(tag::LOCAL_DIMENSION);
        self.length(dual_dimensions.len());
        dual_dimensions.iter().for_each(|&d| self.u32(d));
        self.u64(*bound);
        self.f64(*margin);
    }

    fn sharpening(&mut self, sharpening: &Sharpening) {
        match sharpening {
            Sharpening::Sharpened(point) => {
                let Sharpened {
                    values,
                    accuracy,
                    deflations,
                    precision_bits,
                } = &**point;
                self.0.push(tag::SHARPENED);
                self.exact_parts(values);
                self.f64(*accuracy);
                self.u32(*deflations);
                self.u32(*precision_bits);
            }
            Sharpening::Unsharpened(reason) => {
                self.0.push(tag::UNSHARPENED);
                self.0.push(match reason {
                    Unsharpened::DamagedPoint => 1,
                    Unsharpened::NotRegular => 2,
                    Unsharpened::NewtonLeaves => 3,
                });
            }
        }
    }

    fn boundary_key(&mut self, key: &BoundaryKey) {
        let BoundaryKey { numbers, margin } = key;
        self.0.push(tag::BOUNDARY);
        numbers.iter().for_each(|&number| self.f64(number));
        self.f64(*margin);
    }

    fn branch_count(&mut self, count: &BranchCount) {
        match count {
            BranchCount::Counted(counted) => {
                let CountedCells {
                    cells,
                    volume,
                    time_exponent,
                } = counted;
                self.0.push(tag::MIXED_CELLS);
                self.u64(*cells);
                self.u64(*volume);
                self.u32(*time_exponent);
            }
            BranchCount::Tie => self.0.extend_from_slice(&[tag::UNCOUNTED, 1]),
            BranchCount::TooLarge => self.0.extend_from_slice(&[tag::UNCOUNTED, 2]),
        }
    }

    /// The moved slices of a local dimension, if there are any.
    fn moved_slices(&mut self, slices: &[MovedSlice]) {
        if slices.is_empty() {
            return;
        }
        self.0.push(tag::MOVED_SLICES);
        self.length(slices.len());
        for slice in slices {
            self.f64(slice.distance);
            self.f64(slice.residual);
            self.f64(slice.reached);
        }
    }

    fn bend(&mut self, bend: &Bend) {
        let Bend {
            velocity,
            acceleration,
            error,
        } = bend;
        self.0.push(tag::BEND);
        self.numbers(velocity);
        self.numbers(acceleration);
        self.f64(*error);
    }
}

impl Writer {
    fn exact_parts(&mut self, values: &[ComplexRational]) {
        self.length(values.len());
        for part in values.iter().flat_map(|z| [&z.re, &z.im]) {
            let text = exact_text(part).expect("numbers of points and boxes are dyadic");
            self.length(text.len());
            self.0.extend_from_slice(text.as_bytes());
        }
    }

    fn certificate(&mut self, certificate: &Certificate) {
        let Certificate {
            centre,
            radius,
            error,
            contraction,
            precision_bits,
        } = certificate;
        self.0.push(tag::CERTIFIED);
        self.exact_parts(centre);
        for numbers in [radius, error] {
            self.length(numbers.len());
            numbers.iter().for_each(|&x| self.f64(x));
        }
        self.f64(*contraction);
        self.u32(*precision_bits);
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn damaged(&self, what: &'static str) -> DamagedRecords {
        DamagedRecords { at: self.at, what }
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], DamagedRecords> {
        let end = self.at.checked_add(length);
        let bytes = end.and_then(|end| self.bytes.get(self.at..end));
        let bytes = bytes.ok_or_else(|| self.damaged("it ends too soon"))?;
        self.at += length;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], DamagedRecords> {
        Ok(self
            .take(N)?
            .try_into()
            .expect("as many bytes as asked for"))
    }

    fn u32(&mut self) -> Result<u32, DamagedRecords> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, DamagedRecords> {
        self.array().map(u64::from_le_bytes)
    }

    fn f64(&mut self) -> Result<f64, DamagedRecords> {
        self.array().map(f64::from_le_bytes)
    }

    fn complex(&mut self) -> Result<Complex64, DamagedRecords> {
        Ok(Complex64::new(self.f64()?, self.f64()?))
    }

    /// A length of items of this many bytes each, which must still be there.
    fn length(&mut self, size: usize) -> Result<usize, DamagedRecords> {
        let length = self.u32()? as usize;
        if length * size > self.bytes.len() - self.at {
            return Err(self.damaged("a list is longer than what is there"));
        }
        Ok(length)
    }

    fn exact(&mut self) -> Result<Rational, DamagedRecords> {
        let length = self.length(1)?;
        let text = std::str::from_utf8(self.take(length)?).ok();
        text.and_then(read_exact)
            .ok_or_else(|| self.damaged("no exact number"))
    }

    fn exact_parts(&mut self) -> Result<Vec<ComplexRational>, DamagedRecords> {
        // Each coordinate has two numbers, each a length and at least `0x0p0`.
        let count = self.length(18)?;
        (0..count)
            .map(|_| Ok(ComplexRational::new(self.exact()?, self.exact()?)))
            .collect()
    }

    fn numbers(&mut self) -> Result<Vec<Number>, DamagedRecords> {
        let count = self.length(32)?;
        let part = |r: &mut Self| {
            let parts = [r.f64()?, r.f64()?];
            DoubleDouble::from_parts(parts).ok_or_else(|| r.damaged("no number of two doubles"))
        };
        (0..count)
            .map(|_| {
                Ok(Number {
                    re: part(self)?,
                    im: part(self)?,
                })
            })
            .collect()
    }

    fn certificate(&mut self) -> Result<Certificate, DamagedRecords> {
        let centre = self.exact_parts()?;
        let mut numbers = || -> Result<Vec<f64>, DamagedRecords> {
            let count = self.length(8)?;
            (0..count).map(|_| self.f64()).collect()
        };
        let certificate = Certificate {
            centre,
            radius: numbers()?,
            error: numbers()?,
            contraction: self.f64()?,
            precision_bits: self.u32()?,
        };
        if certificate.is_sound() {
            Ok(certificate)
        } else {
            Err(self.damaged("the parts of a certificate do not belong together"))
        }
    }

    /// One record, which ends there.
    fn record(&mut self, end: usize) -> Result<FlatResult, DamagedRecords> {
        let mut result = FlatResult::from(self.path()?);
        let mut last = 0;
        while self.at < end {
            let [next] = self.array()?;
            if next <= last {
                return Err(self.damaged("facts that do not ascend"));
            }
            last = next;
            self.fact(next, &mut result)?;
        }
        Ok(result)
    }

    /// The fields that every record has.
    fn path(&mut self) -> Result<PathResult, DamagedRecords> {
        let origin = PathIndex(self.u64()?);
        let attempt = self.array().map(u16::from_le_bytes)?;
        let outcome = match self.array::<1>()?[0] {
            1 => PathOutcome::Regular,
            2 => PathOutcome::Singular,
            3 => PathOutcome::Diverging,
            4 => PathOutcome::PutAside,
            16 => PathOutcome::Failed(Failure::InvalidStartPoint),
            17 => PathOutcome::Failed(Failure::StepTooSmall),
            18 => PathOutcome::Failed(Failure::TooManySteps),
            19 => PathOutcome::Failed(Failure::EndgameUnsettled),
            20 => PathOutcome::Failed(Failure::KilledItsWorker),
            _ => return Err(self.damaged("an outcome that this version does not know")),
        };
        if self.array::<1>()? != [0] {
            return Err(self.damaged("coordinates of a kind that this version does not know"));
        }
        let coordinates = self.length(16)?;
        let endpoint = (0..coordinates)
            .map(|_| self.complex())
            .collect::<Result<_, _>>()?;
        let t = self.complex()?;
        let (residual, condition, accuracy) = (self.f64()?, self.f64()?, self.f64()?);
        let winding_number = Some(self.u32()?).filter(|&w| w > 0);
        let groups = self.length(4)?;
        let infinity_turns = (0..groups)
            .map(|_| self.array().map(i32::from_le_bytes))
            .collect::<Result<_, _>>()?;
        Ok(PathResult {
            origin,
            attempt,
            outcome,
            endpoint: Coordinates::Double(endpoint),
            t,
            residual,
            condition,
            accuracy,
            winding_number,
            infinity_turns,
            precision_bits: self.u32()?,
            counts: Counts {
                steps: self.u32()?,
                rejections: self.u32()?,
                evaluations: self.u32()?,
                exchanges: self.u32()?,
                turns: self.u32()?,
            },
            asked: None,
            local_dimension: None,
            boundary: None,
        })
    }

    /// The fact behind a tag.
    fn fact(&mut self, tag: u8, result: &mut FlatResult) -> Result<(), DamagedRecords> {
        match tag {
            tag::ASKED => result.path.asked = Some(self.asked_fit()?),
            tag::CERTIFIED => {
                let certificate = Box::new(self.certificate()?);
                result.certification = Some(Certification::Certified(certificate));
            }
            tag::UNCERTIFIED => {
                result.certification = Some(Certification::Uncertified(self.uncertified()?));
            }
            tag::LOCAL_DIMENSION => result.path.local_dimension = Some(self.dual_space()?),
            tag::MOVED_SLICES => self.moved_slices(&mut result.path)?,
            tag::SHARPENED => {
                let point = Box::new(self.sharpened()?);
                result.sharpening = Some(Sharpening::Sharpened(point));
            }
            tag::UNSHARPENED => {
                result.sharpening = Some(Sharpening::Unsharpened(self.unsharpened()?));
            }
            tag::BOUNDARY => result.path.boundary = Some(Box::new(self.boundary_key()?)),
            tag::MIXED_CELLS => {
                result.mixed_cells = Some(BranchCount::Counted(self.counted_cells()?));
            }
            tag::UNCOUNTED => result.mixed_cells = Some(self.uncounted()?),
            tag::BEND => result.bend = Some(Box::new(self.bend()?)),
            _ => return Err(self.damaged("a fact that this version does not know")),
        }
        Ok(())
    }

    fn asked_fit(&mut self) -> Result<AskedFit, DamagedRecords> {
        Ok(AskedFit {
            residual: self.f64()?,
            correction: self.f64()?,
        })
    }

    fn uncertified(&mut self) -> Result<Uncertified, DamagedRecords> {
        Ok(match self.array::<1>()?[0] {
            1 => Uncertified::DamagedPoint,
            2 => Uncertified::NoEnclosure,
            3 => Uncertified::NewtonLeaves,
            4 => Uncertified::Singular,
            5 => Uncertified::NoContraction,
            _ => return Err(self.damaged("a reason that this version does not know")),
        })
    }

    /// Dual space and bound of a local dimension, still without moved slices.
    fn dual_space(&mut self) -> Result<LocalDimension, DamagedRecords> {
        let orders = self.length(4)?;
        Ok(LocalDimension {
            dual_dimensions: (0..orders).map(|_| self.u32()).collect::<Result<_, _>>()?,
            bound: self.u64()?,
            margin: self.f64()?,
            moved_slices: Vec::new(),
        })
    }

    /// Moved slices, which belong to the local dimension that was read before.
    fn moved_slices(&mut self, path: &mut PathResult) -> Result<(), DamagedRecords> {
        let count = self.length(24)?;
        let slice = |reader: &mut Self| {
            Ok(MovedSlice {
                distance: reader.f64()?,
                residual: reader.f64()?,
                reached: reader.f64()?,
            })
        };
        let slices: Vec<MovedSlice> = (0..count).map(|_| slice(self)).collect::<Result<_, _>>()?;
        let Some(local_dimension) = &mut path.local_dimension else {
            return Err(self.damaged("moved slices without a dual space"));
        };
        if !slices.iter().all(MovedSlice::is_sound) {
            return Err(self.damaged("a moved slice that is none"));
        }
        local_dimension.moved_slices = slices;
        Ok(())
    }

    fn sharpened(&mut self) -> Result<Sharpened, DamagedRecords> {
        let point = Sharpened {
            values: self.exact_parts()?,
            accuracy: self.f64()?,
            deflations: self.u32()?,
            precision_bits: self.u32()?,
        };
        if !point.is_sound() {
            return Err(self.damaged("an accuracy that is none"));
        }
        Ok(point)
    }

    fn unsharpened(&mut self) -> Result<Unsharpened, DamagedRecords> {
        Ok(match self.array::<1>()?[0] {
            1 => Unsharpened::DamagedPoint,
            2 => Unsharpened::NotRegular,
            3 => Unsharpened::NewtonLeaves,
            _ => return Err(self.damaged("a reason that this version does not know")),
        })
    }

    fn boundary_key(&mut self) -> Result<BoundaryKey, DamagedRecords> {
        let mut numbers = [0.0; NUMBERS];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        let margin = self.f64()?;
        let key = BoundaryKey { numbers, margin };
        if !key.is_sound() {
            return Err(self.damaged("a key that is none"));
        }
        Ok(key)
    }

    fn counted_cells(&mut self) -> Result<CountedCells, DamagedRecords> {
        Ok(CountedCells {
            cells: self.u64()?,
            volume: self.u64()?,
            time_exponent: self.u32()?,
        })
    }

    /// The reason why branches of mixed cells are not counted.
    fn uncounted(&mut self) -> Result<BranchCount, DamagedRecords> {
        Ok(match self.array::<1>()?[0] {
            1 => BranchCount::Tie,
            2 => BranchCount::TooLarge,
            _ => return Err(self.damaged("a reason that this version does not know")),
        })
    }

    fn bend(&mut self) -> Result<Bend, DamagedRecords> {
        let bend = Bend {
            velocity: self.numbers()?,
            acceleration: self.numbers()?,
            error: self.f64()?,
        };
        if !bend.is_sound() {
            return Err(self.damaged("derivatives that do not belong together"));
        }
        Ok(bend)
    }
}

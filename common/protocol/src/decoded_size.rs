//! Decoded size: the memory that a message takes once it is decoded, from its bytes alone.
//!
//! A submessage of two bytes may stand for a structure of hundreds, so that a limit on bytes does not
//! bound memory. The bytes are gone through once, by the descriptors of the messages, and nothing is
//! made of them. What is no message of the type is found on the way.

use crate::DESCRIPTORS;
use prost::Message;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorSet};
use std::collections::HashMap;
use std::sync::LazyLock;

/// Messages within messages; prost refuses deeper ones, too.
const DEEPEST: usize = 100;

/// Fault in the bytes of a message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WireError {
    /// No message has this name.
    #[error("there is no message {0}")]
    UnknownMessage(String),
    /// The bytes are no message of this type.
    #[error("byte {at}: {what}; expected a message {message}")]
    Malformed {
        /// Offset from the beginning of the outermost message.
        at: usize,
        /// Description of the fault at that offset.
        what: &'static str,
        /// Name of the innermost message around it.
        message: String,
    },
}

/// Form of a field's values on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Varint,
    Fixed32,
    Fixed64,
    Text,
    Bytes,
    Message(usize),
}

#[derive(Clone, Copy, Debug)]
struct Field {
    kind: Kind,
    repeated: bool,
}

/// A message type.
#[derive(Debug)]
struct Shape {
    name: String,
    /// Bytes of its structure without what its lists hold, estimated from above.
    size: usize,
    fields: HashMap<u32, Field>,
}

/// All message types, and where each is by its full name.
struct Shapes {
    all: Vec<Shape>,
    by_name: HashMap<String, usize>,
}

static SHAPES: LazyLock<Shapes> = LazyLock::new(Shapes::of_descriptors);

impl Shapes {
    fn of_descriptors() -> Self {
        let files = FileDescriptorSet::decode(DESCRIPTORS)
            .expect("the descriptors were made by the compiler of the messages");
        let mut named_messages: Vec<(String, DescriptorProto)> = Vec::new();
        for file in files.file {
            let package = file.package().to_owned();
            collect(&package, file.message_type, &mut named_messages);
        }
        let by_name: HashMap<String, usize> = named_messages
            .iter()
            .enumerate()
            .map(|(i, (name, _))| (name.clone(), i))
            .collect();
        let shapes = named_messages
            .iter()
            .map(|(name, message)| Shape {
                name: name.clone(),
                size: size_of_message(message, &named_messages, &by_name, 0),
                fields: message
                    .field
                    .iter()
                    .map(|field| (field.number() as u32, field_of(field, &by_name)))
                    .collect(),
            })
            .collect();
        Self {
            all: shapes,
            by_name,
        }
    }
}

/// Messages and those that are declared in them.
fn collect(
    scope: &str,
    messages: Vec<DescriptorProto>,
    named_messages: &mut Vec<(String, DescriptorProto)>,
) {
    for mut message in messages {
        let name = format!("{scope}.{}", message.name());
        collect(
            &name,
            std::mem::take(&mut message.nested_type),
            named_messages,
        );
        named_messages.push((name, message));
    }
}

fn field_of(field: &FieldDescriptorProto, by_name: &HashMap<String, usize>) -> Field {
    let kind = match field.r#type() {
        Type::Fixed32 | Type::Sfixed32 | Type::Float => Kind::Fixed32,
        Type::Fixed64 | Type::Sfixed64 | Type::Double => Kind::Fixed64,
        Type::String => Kind::Text,
        Type::Bytes => Kind::Bytes,
        Type::Message | Type::Group => by_name
            .get(field.type_name().trim_start_matches('.'))
            .map_or(Kind::Bytes, |&message| Kind::Message(message)),
        _ => Kind::Varint,
    };
    Field {
        kind,
        repeated: field.label() == Label::Repeated,
    }
}

/// Bytes of a message's structure: lists and recursive messages are pointers, of a choice all members
/// are counted.
fn size_of_message(
    message: &DescriptorProto,
    named_messages: &[(String, DescriptorProto)],
    by_name: &HashMap<String, usize>,
    depth: usize,
) -> usize {
    let size = |field: &FieldDescriptorProto| match (field.label(), field.r#type()) {
        (Label::Repeated, _) | (_, Type::String) => 24,
        (_, Type::Bytes) => 32,
        (_, Type::Message) if depth < 3 => {
            let name = field.type_name().trim_start_matches('.');
            let inner = by_name.get(name).and_then(|&at| named_messages.get(at));
            inner.map_or(8, |(_, inner)| {
                8 + size_of_message(inner, named_messages, by_name, depth + 1)
            })
        }
        _ => 16,
    };
    // The members of a choice share their place.
    let mut choices: HashMap<i32, usize> = HashMap::new();
    let mut total = 0;
    for field in &message.field {
        match field.oneof_index {
            Some(choice) => {
                let largest = choices.entry(choice).or_default();
                *largest = (*largest).max(8 + size(field));
            }
            None => total += size(field),
        }
    }
    total + choices.values().sum::<usize>()
}

/// Bytes that the message of this full name (`cognate.v1.ReportRequest`) takes in memory once decoded,
/// estimated from above; a list may have taken twice as much while it grew.
pub fn decoded_size(message: &str, bytes: &[u8]) -> Result<usize, WireError> {
    let shapes = &*SHAPES;
    let shape_index = shapes.by_name.get(message);
    let &shape = shape_index.ok_or_else(|| WireError::UnknownMessage(message.to_owned()))?;
    let mut scan = Scan {
        bytes,
        at: 0,
        total: shapes.all[shape].size,
    };
    scan.message(shape, bytes.len(), 0)?;
    Ok(scan.total)
}

/// Bytes that are gone through.
struct Scan<'a> {
    bytes: &'a [u8],
    at: usize,
    total: usize,
}

impl Scan<'_> {
    fn malformed(&self, shape: usize, what: &'static str) -> WireError {
        WireError::Malformed {
            at: self.at,
            what,
            message: SHAPES.all[shape].name.clone(),
        }
    }

    fn varint(&mut self, end: usize, shape: usize) -> Result<u64, WireError> {
        let mut value = 0u64;
        for k in 0..10 {
            let byte = self.bytes[..end].get(self.at).copied();
            let Some(byte) = byte else {
                return Err(self.malformed(shape, "the number is cut off"));
            };
            self.at += 1;
            value |= u64::from(byte & 0x7f) << (7 * k);
            if byte < 0x80 {
                return match k == 9 && byte > 1 {
                    true => Err(self.malformed(shape, "the number is larger than 64 bits")),
                    false => Ok(value),
                };
            }
        }
        Err(self.malformed(shape, "the number has no end"))
    }

    fn skip(&mut self, length: u64, end: usize, shape: usize) -> Result<(), WireError> {
        match usize::try_from(length).ok().filter(|&l| l <= end - self.at) {
            Some(length) => {
                self.at += length;
                Ok(())
            }
            None => Err(self.malformed(shape, "the field is longer than what is around it")),
        }
    }

    /// One message up to `end`; its own structure is counted already.
    fn message(&mut self, shape: usize, end: usize, depth: usize) -> Result<(), WireError> {
        if depth > DEEPEST {
            return Err(self.malformed(shape, "messages are nested too deeply"));
        }
        while self.at < end {
            let (number, wire_type) = self.tag(end, shape)?;
            match SHAPES.all[shape].fields.get(&number).copied() {
                None => self.unknown(number, wire_type, end, (shape, depth))?,
                Some(field) => self.field(field, wire_type, end, shape, depth)?,
            }
        }
        Ok(())
    }

    /// The number and the wire type of a field.
    fn tag(&mut self, end: usize, shape: usize) -> Result<(u32, u64), WireError> {
        let tag = self.varint(end, shape)?;
        let number = u32::try_from(tag >> 3).ok();
        let number = number.filter(|&n| n > 0 && n < 1 << 29);
        let number = number.ok_or_else(|| self.malformed(shape, "the number of the field is none"));
        Ok((number?, tag & 7))
    }

    /// A field of a later version, or of another program: a group, too, which lasts until its end is marked.
    fn unknown(
        &mut self,
        number: u32,
        wire_type: u64,
        end: usize,
        (shape, depth): (usize, usize),
    ) -> Result<(), WireError> {
        match wire_type {
            0 => self.varint(end, shape).map(drop),
            1 => self.skip(8, end, shape),
            5 => self.skip(4, end, shape),
            2 => {
                let length = self.varint(end, shape)?;
                self.skip(length, end, shape)
            }
            3 if depth >= DEEPEST => Err(self.malformed(shape, "groups are nested too deeply")),
            3 => loop {
                match self.tag(end, shape)? {
                    (other, 4) if other == number => return Ok(()),
                    (_, 4) => return Err(self.malformed(shape, "another group ends here")),
                    (inner, kind) => self.unknown(inner, kind, end, (shape, depth + 1))?,
                }
            },
            _ => Err(self.malformed(shape, "the field has no such wire type")),
        }
    }

    fn field(
        &mut self,
        field: Field,
        wire_type: u64,
        end: usize,
        shape: usize,
        depth: usize,
    ) -> Result<(), WireError> {
        let scalar = |bytes: usize| if field.repeated { 2 * bytes } else { 0 };
        match (field.kind, wire_type) {
            (Kind::Varint, 0) => {
                self.total += scalar(8);
                self.varint(end, shape).map(drop)
            }
            (Kind::Fixed32, 5) => {
                self.total += scalar(4);
                self.skip(4, end, shape)
            }
            (Kind::Fixed64, 1) => {
                self.total += scalar(8);
                self.skip(8, end, shape)
            }
            (kind, 2) => {
                let length = self.varint(end, shape)?;
                let begin = self.at;
                self.skip(length, end, shape)?;
                let last = self.at;
                self.at = begin;
                self.delimited(Field { kind, ..field }, last, shape, depth)
            }
            _ => Err(self.malformed(shape, "the field has another wire type")),
        }
    }

    /// A field of known length, up to `last`.
    fn delimited(
        &mut self,
        field: Field,
        last: usize,
        shape: usize,
        depth: usize,
    ) -> Result<(), WireError> {
        let length = last - self.at;
        let place_size = |size: usize| if field.repeated { 2 * size } else { size };
        match field.kind {
            Kind::Message(inner) => {
                self.total += place_size(SHAPES.all[inner].size);
                self.message(inner, last, depth + 1)?;
            }
            Kind::Text => {
                self.total += place_size(24) + length;
                if std::str::from_utf8(&self.bytes[self.at..last]).is_err() {
                    return Err(self.malformed(shape, "the text is not UTF-8"));
                }
            }
            // The bytes stay where they are.
            Kind::Bytes => self.total += place_size(32),
            // Packed lists.
            _ if !field.repeated => {
                return Err(self.malformed(shape, "the field has another wire type"));
            }
            Kind::Fixed32 | Kind::Fixed64 => {
                let each = if field.kind == Kind::Fixed32 { 4 } else { 8 };
                self.total += 2 * length;
                if !length.is_multiple_of(each) {
                    return Err(self.malformed(shape, "the last number of the list is cut off"));
                }
            }
            Kind::Varint => {
                while self.at < last {
                    self.varint(last, shape)?;
                    self.total += 16;
                }
            }
        }
        self.at = last;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::v1;

    fn report(results: usize) -> v1::ReportRequest {
        v1::ReportRequest {
            identity: Some(v1::WorkerIdentity {
                worker: "w".into(),
                session: "s".into(),
            }),
            chunks: vec![v1::ChunkReport {
                results: vec![v1::PathResult::default(); results],
                ..v1::ChunkReport::default()
            }],
        }
    }

    const REPORT: &str = "cognate.v1.ReportRequest";

    #[test]
    fn empty_results_weigh_what_their_structures_do() {
        let n = 100_000;
        let bytes = report(n).encode_to_vec();
        assert!(bytes.len() < 3 * n);
        let size = decoded_size(REPORT, &bytes).unwrap();
        assert!(size >= n * size_of::<v1::PathResult>(), "{size}");
        assert!(size <= n * 8 * size_of::<v1::PathResult>(), "{size}");
    }

    #[test]
    fn unknown_groups_are_skipped_as_when_decoding() {
        let groups = |count: usize| {
            let begin = std::iter::repeat_n([0xa3, 0x06], count).flatten();
            let end = std::iter::repeat_n([0xa4, 0x06], count).flatten();
            begin.chain(end).collect::<Vec<u8>>()
        };
        let cut_off = groups(3)[..9].to_vec();
        let other_end = vec![0xa3, 0x06, 0xac, 0x06];
        for (bytes, is_taken) in [
            (groups(1), true),
            (groups(90), true),
            (groups(5_000), false),
            (cut_off, false),
            (other_end, false),
        ] {
            assert_eq!(decoded_size(REPORT, &bytes).is_ok(), is_taken);
            assert_eq!(v1::ReportRequest::decode(&bytes[..]).is_ok(), is_taken);
        }
    }

    #[test]
    fn sizes_are_estimated_from_above() {
        for (name, size) in [
            ("PathResult", size_of::<v1::PathResult>()),
            ("ChunkReport", size_of::<v1::ChunkReport>()),
            ("Node", size_of::<v1::Node>()),
            ("LeaseId", size_of::<v1::LeaseId>()),
            ("SymmetryGenerator", size_of::<v1::SymmetryGenerator>()),
            ("SubmitRequest", size_of::<v1::SubmitRequest>()),
            ("Options", size_of::<v1::Options>()),
        ] {
            let estimate = decoded_size(&format!("cognate.v1.{name}"), &[]).unwrap();
            assert!(estimate >= size, "{name}: {estimate} for {size}");
            assert!(estimate <= 8 * size, "{name}: {estimate} for {size}");
        }
    }

    /// Whatever decodes has a size, and what has none does not decode.
    #[test]
    fn what_is_malformed_is_found() {
        let mut seed = 7u64;
        let mut next = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as usize
        };
        let sound = report(3).encode_to_vec();
        let mut refused = 0;
        for _ in 0..20_000 {
            let mut bytes = sound.clone();
            for _ in 0..1 + next() % 3 {
                let at = next() % bytes.len();
                bytes[at] = next() as u8;
            }
            bytes.truncate(bytes.len() - next() % 4);
            let decodes = v1::ReportRequest::decode(bytes.as_slice()).is_ok();
            let weighed = decoded_size(REPORT, &bytes).is_ok();
            assert!(decodes || !weighed, "{bytes:?}");
            refused += u32::from(!weighed);
        }
        assert!(refused > 1000, "{refused}");
        assert!(decoded_size(REPORT, &sound).is_ok());
        assert!(decoded_size("cognate.v1.Nothing", &[]).is_err());
    }
}

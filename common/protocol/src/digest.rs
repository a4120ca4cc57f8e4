//! Digest of a system: its name by content, the same on every machine.
//!
//! BLAKE3 over an encoding of our own: every length written, numbers little
//! endian, rationals in lowest terms in decimal, names in order. Protobuf
//! bytes are not canonical, so they are not used. The graph counts as it
//! stands: the order of its nodes decides the order of roundings. Settings are
//! no part of it.

use crate::error::ProtocolError;
use crate::{from_proto, to_proto, v1};
use cognate_continuation::start_points::Digest;
use cognate_systems::system::System;

/// Version of the encoding; a change of it gives every system a new name.
const MAGIC: &[u8] = b"cognate system 1\n";

/// Bytes that hold no system.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DamagedSystem {
    /// The encoding is broken.
    #[error("the encoded system is damaged at byte {at}: {what}")]
    Encoding {
        /// Byte at which reading stopped.
        at: usize,
        /// Description of the fault at that byte.
        what: &'static str,
    },
    /// The bytes decode, but the content is no system.
    #[error(transparent)]
    Content(#[from] ProtocolError),
}

/// The digest of these bytes.
pub fn of_bytes(bytes: &[u8]) -> Digest {
    Digest(*blake3::hash(bytes).as_bytes())
}

/// The digest of a checked system: that of the bytes of [`encode_system`].
pub fn of_system(system: &System) -> Digest {
    of_bytes(&encode_system(system))
}

/// The canonical bytes of a checked system.
pub fn encode_system(system: &System) -> Vec<u8> {
    // By way of the message, which has every field of a system in order.
    let m = to_proto::problem::system(system);
    let mut w = Writer(MAGIC.to_vec());
    w.list(&m.variables, |w, name| w.text(name));
    w.list(&m.parameters, |w, name| w.text(name));
    w.list(&m.groups, |w, group| {
        w.byte(u8::from(group.homogeneous));
        w.words(&group.variables);
    });
    w.list(&m.nodes, |w, node| w.node(node));
    w.list(&m.equations, |w, equation| {
        w.word(equation.node);
        w.text(&equation.name);
    });
    w.list(m.path_variable.as_slice(), |w, &index| w.word(index));
    w.list(&m.conjugates, |w, pair| {
        w.word(pair.first);
        w.word(pair.second);
    });
    w.list(&m.degenerate, |w, set| {
        use v1::degenerate_set::Set;
        w.text(&set.name);
        match set.set.as_ref().expect("every set is written whole") {
            Set::Nonzero(node) => {
                w.byte(0);
                w.word(*node);
            }
            Set::Equations(list) => {
                w.byte(1);
                w.words(&list.nodes);
            }
        }
    });
    w.list(&m.symmetry, |w, generator| {
        use v1::symmetry_generator::Action;
        match generator
            .action
            .as_ref()
            .expect("every generator is written whole")
        {
            Action::Permutation(p) => {
                w.byte(0);
                w.words(&p.images);
            }
            Action::Map(list) => {
                w.byte(1);
                w.words(&list.nodes);
            }
        }
    });
    // Systems without a scaling and without helpers write nothing here: their digests are older than both.
    if !m.unit_exponents.is_empty() || !m.helpers.is_empty() {
        let exponents = m.unit_exponents.iter();
        w.words(&exponents.map(|e| e.cast_unsigned()).collect::<Vec<u32>>());
    }
    if !m.helpers.is_empty() {
        w.list(&m.helpers, |w, helper| w.helper(helper));
    }
    w.0
}

/// Reads what [`encode_system`] wrote, with every check of a message.
pub fn decode_system(bytes: &[u8]) -> Result<System, DamagedSystem> {
    let mut r = Reader { bytes, at: 0 };
    if r.take(MAGIC.len())? != MAGIC {
        return Err(r.damaged("it does not begin with the right magic"));
    }
    let message = v1::System {
        variables: r.list(Reader::text)?,
        parameters: r.list(Reader::text)?,
        groups: r.list(|r| {
            Ok(v1::VariableGroup {
                homogeneous: r.flag()?,
                variables: r.words()?,
            })
        })?,
        nodes: r.list(Reader::node)?,
        equations: r.list(|r| {
            Ok(v1::Equation {
                node: r.word()?,
                name: r.text()?,
            })
        })?,
        path_variable: match r.list(Reader::word)?.as_slice() {
            [] => None,
            [index] => Some(*index),
            _ => return Err(r.damaged("there are several path variables")),
        },
        conjugates: r.list(|r| {
            Ok(v1::ConjugatePair {
                first: r.word()?,
                second: r.word()?,
            })
        })?,
        degenerate: r.list(|r| {
            use v1::degenerate_set::Set;
            Ok(v1::DegenerateSet {
                name: r.text()?,
                set: Some(if r.flag()? {
                    Set::Equations(v1::NodeList { nodes: r.words()? })
                } else {
                    Set::Nonzero(r.word()?)
                }),
            })
        })?,
        symmetry: r.list(|r| {
            use v1::symmetry_generator::Action;
            Ok(v1::SymmetryGenerator {
                action: Some(if r.flag()? {
                    Action::Map(v1::NodeList { nodes: r.words()? })
                } else {
                    Action::Permutation(v1::Permutation { images: r.words()? })
                }),
            })
        })?,
        unit_exponents: match r.at < bytes.len() {
            true => r.words()?.into_iter().map(u32::cast_signed).collect(),
            false => Vec::new(),
        },
        helpers: match r.at < bytes.len() {
            true => r.list(Reader::helper)?,
            false => Vec::new(),
        },
    };
    if r.at != bytes.len() {
        return Err(r.damaged("there is more than the system"));
    }
    Ok(from_proto::problem::system(&message)?)
}

struct Writer(Vec<u8>);

impl Writer {
    fn byte(&mut self, byte: u8) {
        self.0.push(byte);
    }

    fn word(&mut self, word: u32) {
        self.0.extend_from_slice(&word.to_le_bytes());
    }

    fn list<T>(&mut self, list: &[T], mut item: impl FnMut(&mut Self, &T)) {
        self.0.extend_from_slice(&(list.len() as u64).to_le_bytes());
        list.iter().for_each(|x| item(self, x));
    }

    fn text(&mut self, text: &str) {
        self.list(text.as_bytes(), |w, &byte| w.byte(byte));
    }

    fn words(&mut self, words: &[u32]) {
        self.list(words, |w, &word| w.word(word));
    }

    fn helper(&mut self, helper: &v1::Helper) {
        use v1::helper::Kind;
        match helper.kind.as_ref().expect("every helper is written whole") {
            Kind::Root(root) => {
                self.byte(0);
                self.words(&[root.variable, root.degree, root.radicand]);
                self.byte(u8::from(root.real));
            }
            Kind::Angle(angle) => {
                self.byte(1);
                self.text(&angle.name);
                let mut words = vec![angle.cosine, angle.sine];
                // Angles in radians are written as before there were other units, so that their digests stay.
                if (angle.unit_denominator, angle.unit_pi_power) != (0, 0) {
                    words.extend([angle.unit_denominator, angle.unit_pi_power.cast_unsigned()]);
                }
                self.words(&words);
            }
        }
    }

    fn node(&mut self, node: &v1::Node) {
        use v1::node::Kind;
        let mut pair = |tag: u8, m: &v1::Binary| {
            self.byte(tag);
            self.word(m.left);
            self.word(m.right);
        };
        match node.kind.as_ref().expect("every node is written whole") {
            Kind::Constant(z) => {
                self.byte(0);
                self.text(&z.re);
                self.text(&z.im);
            }
            Kind::Variable(index) => {
                self.byte(1);
                self.word(*index);
            }
            Kind::Parameter(index) => {
                self.byte(2);
                self.word(*index);
            }
            Kind::Add(m) => pair(3, m),
            Kind::Subtract(m) => pair(4, m),
            Kind::Multiply(m) => pair(5, m),
            Kind::Divide(m) => pair(6, m),
            Kind::Negate(a) => {
                self.byte(7);
                self.word(*a);
            }
            Kind::Power(m) => {
                self.byte(8);
                self.word(m.base);
                self.word(m.exponent);
            }
            Kind::Root(m) => {
                self.byte(9);
                self.word(m.base);
                self.text(&m.exponent);
            }
            Kind::Function(m) => {
                self.byte(10);
                self.0.extend_from_slice(&m.function.to_le_bytes());
                self.word(m.argument);
            }
        }
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn damaged(&self, what: &'static str) -> DamagedSystem {
        DamagedSystem::Encoding { at: self.at, what }
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], DamagedSystem> {
        let end = self.at.checked_add(length);
        let bytes = end.and_then(|end| self.bytes.get(self.at..end));
        let bytes = bytes.ok_or_else(|| self.damaged("it ends too soon"))?;
        self.at += length;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], DamagedSystem> {
        Ok(self
            .take(N)?
            .try_into()
            .expect("as many bytes as asked for"))
    }

    fn word(&mut self) -> Result<u32, DamagedSystem> {
        self.array().map(u32::from_le_bytes)
    }

    fn flag(&mut self) -> Result<bool, DamagedSystem> {
        match self.array()? {
            [0] => Ok(false),
            [1] => Ok(true),
            [_] => Err(self.damaged("a choice that this version does not know")),
        }
    }

    /// Every item takes at least a byte, so a length beyond the end is refused before any of it.
    fn length(&mut self) -> Result<usize, DamagedSystem> {
        let length = self.array().map(u64::from_le_bytes)?;
        usize::try_from(length)
            .ok()
            .filter(|&n| n <= self.bytes.len() - self.at)
            .ok_or_else(|| self.damaged("a list is longer than what is there"))
    }

    fn list<T>(
        &mut self,
        mut item: impl FnMut(&mut Self) -> Result<T, DamagedSystem>,
    ) -> Result<Vec<T>, DamagedSystem> {
        (0..self.length()?).map(|_| item(self)).collect()
    }

    fn text(&mut self) -> Result<String, DamagedSystem> {
        let length = self.length()?;
        let bytes = self.take(length)?;
        std::str::from_utf8(bytes)
            .map(str::to_owned)
            .map_err(|_| self.damaged("a text is not UTF-8"))
    }

    fn words(&mut self) -> Result<Vec<u32>, DamagedSystem> {
        self.list(Self::word)
    }

    fn helper(&mut self) -> Result<v1::Helper, DamagedSystem> {
        use v1::helper::Kind;
        let kind = if self.flag()? {
            let name = self.text()?;
            let (cosine, sine, unit_denominator, unit_pi_power) = match *self.words()?.as_slice() {
                [cosine, sine] => (cosine, sine, 0, 0),
                [cosine, sine, denominator, power] => {
                    (cosine, sine, denominator, power.cast_signed())
                }
                _ => return Err(self.damaged("an angle has two variables, and perhaps a unit")),
            };
            Kind::Angle(v1::HelperAngle {
                name,
                cosine,
                sine,
                unit_denominator,
                unit_pi_power,
            })
        } else {
            let &[variable, degree, radicand] = self.words()?.as_slice() else {
                return Err(self.damaged("a root has a variable, a degree and a radicand"));
            };
            let real = self.flag()?;
            Kind::Root(v1::HelperRoot {
                variable,
                degree,
                radicand,
                real,
            })
        };
        Ok(v1::Helper { kind: Some(kind) })
    }

    fn node(&mut self) -> Result<v1::Node, DamagedSystem> {
        use v1::node::Kind;
        let [tag] = self.array()?;
        let kind = match tag {
            0 => Kind::Constant(v1::ExactComplex {
                re: self.text()?,
                im: self.text()?,
            }),
            1 => Kind::Variable(self.word()?),
            2 => Kind::Parameter(self.word()?),
            3..=6 => {
                let m = v1::Binary {
                    left: self.word()?,
                    right: self.word()?,
                };
                match tag {
                    3 => Kind::Add(m),
                    4 => Kind::Subtract(m),
                    5 => Kind::Multiply(m),
                    _ => Kind::Divide(m),
                }
            }
            7 => Kind::Negate(self.word()?),
            8 => Kind::Power(v1::Power {
                base: self.word()?,
                exponent: self.word()?,
            }),
            9 => Kind::Root(v1::Root {
                base: self.word()?,
                exponent: self.text()?,
            }),
            10 => Kind::Function(v1::FunctionCall {
                function: self.array().map(i32::from_le_bytes)?,
                argument: self.word()?,
            }),
            _ => return Err(self.damaged("a node of a kind that this version does not know")),
        };
        Ok(v1::Node { kind: Some(kind) })
    }
}

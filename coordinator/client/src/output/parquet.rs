//! Parquet: flat tables as a file that every data tool reads.
//!
//! The small part of the format that a flat table needs: one plain page for
//! each column of a row group, compressed with zstd, and the footer in Thrift's
//! compact protocol (parquet.apache.org, "File Format"). A library for it would
//! double the time that this program takes to build.

use std::io::{self, Write};

/// Values of one column of a row group; absent ones are `None`.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// A column of whole numbers.
    Int(Vec<i64>),
    /// A column of whole numbers, some of them absent.
    OptionalInt(Vec<Option<i64>>),
    /// Doubles.
    Double(Vec<f64>),
    /// Texts.
    Text(Vec<String>),
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Int(v) => v.len(),
            Self::OptionalInt(v) => v.len(),
            Self::Double(v) => v.len(),
            Self::Text(v) => v.len(),
        }
    }

    /// The physical type, by the format's numbers.
    fn physical_type(&self) -> i32 {
        match self {
            Self::Int(_) | Self::OptionalInt(_) => 2,
            Self::Double(_) => 5,
            Self::Text(_) => 6,
        }
    }

    /// The bytes of a plain page.
    fn page(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        match self {
            Self::Int(values) => {
                values.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
            }
            Self::OptionalInt(values) => {
                let levels = presence(values);
                bytes.extend((levels.len() as u32).to_le_bytes());
                bytes.extend(levels);
                let there = values.iter().flatten();
                there.for_each(|v| bytes.extend(v.to_le_bytes()));
            }
            Self::Double(values) => {
                values.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
            }
            Self::Text(values) => {
                for v in values {
                    bytes.extend((v.len() as u32).to_le_bytes());
                    bytes.extend(v.as_bytes());
                }
            }
        }
        bytes
    }
}

/// Which values are there, as runs: twice the length, then 0 or 1.
fn presence(values: &[Option<i64>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for run in values.chunk_by(|a, b| a.is_some() == b.is_some()) {
        varint(&mut bytes, (run.len() as u64) << 1);
        bytes.push(u8::from(run[0].is_some()));
    }
    bytes
}

/// Thrift's compact protocol, as far as Parquet's headers need it.
#[derive(Default)]
struct Compact {
    bytes: Vec<u8>,
    last: i16,
    outer: Vec<i16>,
}

const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

fn varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push((value as u8) | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

impl Compact {
    /// The head of a field; all field numbers here are near their predecessors.
    fn field(&mut self, id: i16, kind: u8) {
        let step = id - self.last;
        assert!(
            (1..16).contains(&step),
            "fields are written in ascending order"
        );
        self.bytes.push(((step as u8) << 4) | kind);
        self.last = id;
    }

    fn i32(&mut self, id: i16, value: i32) {
        self.field(id, I32);
        varint(&mut self.bytes, zigzag(value.into()));
    }

    fn i64(&mut self, id: i16, value: i64) {
        self.field(id, I64);
        varint(&mut self.bytes, zigzag(value));
    }

    fn text(&mut self, id: i16, value: &str) {
        self.field(id, BINARY);
        self.bare_text(value);
    }

    fn bare_text(&mut self, value: &str) {
        varint(&mut self.bytes, value.len() as u64);
        self.bytes.extend(value.as_bytes());
    }

    fn list(&mut self, id: i16, kind: u8, length: usize) {
        self.field(id, LIST);
        if length < 15 {
            self.bytes.push(((length as u8) << 4) | kind);
        } else {
            self.bytes.push(0xf0 | kind);
            varint(&mut self.bytes, length as u64);
        }
    }

    /// A structure, as a field or, without a number, as an item of a list.
    fn structure(&mut self, id: Option<i16>, content: impl FnOnce(&mut Self)) {
        if let Some(id) = id {
            self.field(id, STRUCT);
        }
        self.outer.push(self.last);
        self.last = 0;
        content(self);
        self.bytes.push(0);
        self.last = self.outer.pop().expect("pushed above");
    }
}

/// Where a column of a row group stands in the file.
struct Chunk {
    offset: i64,
    values: i64,
    plain_bytes: i64,
    stored_bytes: i64,
}

/// A table that is being written, row group after row group.
pub struct Table<W: Write> {
    out: W,
    at: i64,
    /// Name and, for the footer, an empty sample of each column.
    columns: Vec<(String, Values)>,
    groups: Vec<(i64, Vec<Chunk>)>,
}

/// The compression of all pages, by the format's number: zstd.
const ZSTD: i32 = 6;
/// The compression level: fast, and these columns of noise do not shrink much more.
const LEVEL: i32 = 1;
const MAGIC: &[u8; 4] = b"PAR1";

impl<W: Write> Table<W> {
    /// Begins a table with these columns, given by their names and empty values.
    pub fn new(mut out: W, columns: Vec<(String, Values)>) -> io::Result<Self> {
        out.write_all(MAGIC)?;
        Ok(Self {
            out,
            at: 4,
            columns,
            groups: vec![],
        })
    }

    /// Writes a row group: the values of each column, all equally many.
    pub fn group(&mut self, columns: &[Values]) -> io::Result<()> {
        let rows = columns.first().map_or(0, Values::len);
        assert_eq!(columns.len(), self.columns.len(), "a column is missing");
        let mut chunks = vec![];
        for column in columns {
            assert_eq!(column.len(), rows, "all columns have the same length");
            let plain = column.page();
            let stored = zstd::bulk::compress(&plain, LEVEL)?;
            let mut header = Compact::default();
            header.structure(None, |h| {
                h.i32(1, 0);
                h.i32(2, plain.len() as i32);
                h.i32(3, stored.len() as i32);
                h.structure(Some(5), |page| {
                    page.i32(1, rows as i32);
                    page.i32(2, 0);
                    page.i32(3, 3);
                    page.i32(4, 3);
                });
            });
            self.out.write_all(&header.bytes)?;
            self.out.write_all(&stored)?;
            let head = header.bytes.len() as i64;
            chunks.push(Chunk {
                offset: self.at,
                values: rows as i64,
                plain_bytes: head + plain.len() as i64,
                stored_bytes: head + stored.len() as i64,
            });
            self.at += head + stored.len() as i64;
        }
        self.groups.push((rows as i64, chunks));
        Ok(())
    }

    /// Writes the footer.
    pub fn finish(mut self) -> io::Result<()> {
        let footer = self.footer();
        self.out.write_all(&footer)?;
        self.out.write_all(&(footer.len() as u32).to_le_bytes())?;
        self.out.write_all(MAGIC)?;
        self.out.flush()
    }

    fn footer(&self) -> Vec<u8> {
        let mut footer = Compact::default();
        footer.structure(None, |f| {
            f.i32(1, 1);
            f.list(2, STRUCT, self.columns.len() + 1);
            f.structure(None, |root| {
                root.text(4, "schema");
                root.i32(5, self.columns.len() as i32);
            });
            for (name, sample) in &self.columns {
                f.structure(None, |column| {
                    column.i32(1, sample.physical_type());
                    column.i32(3, i32::from(matches!(sample, Values::OptionalInt(_))));
                    column.text(4, name);
                    if matches!(sample, Values::Text(_)) {
                        column.i32(6, 0);
                    }
                });
            }
            f.i64(3, self.groups.iter().map(|(rows, _)| rows).sum());
            f.list(4, STRUCT, self.groups.len());
            for (rows, chunks) in &self.groups {
                f.structure(None, |group| self.row_group(group, *rows, chunks));
            }
            f.text(6, concat!("cognate ", env!("CARGO_PKG_VERSION")));
        });
        footer.bytes
    }

    fn row_group(&self, group: &mut Compact, rows: i64, chunks: &[Chunk]) {
        group.list(1, STRUCT, chunks.len());
        for (chunk, (name, sample)) in chunks.iter().zip(&self.columns) {
            group.structure(None, |column| {
                column.i64(2, chunk.offset);
                column.structure(Some(3), |meta| {
                    meta.i32(1, sample.physical_type());
                    // Plain values; runs where presence is said.
                    meta.list(2, I32, 2);
                    varint(&mut meta.bytes, zigzag(0));
                    varint(&mut meta.bytes, zigzag(3));
                    meta.list(3, BINARY, 1);
                    meta.bare_text(name);
                    meta.i32(4, ZSTD);
                    meta.i64(5, chunk.values);
                    meta.i64(6, chunk.plain_bytes);
                    meta.i64(7, chunk.stored_bytes);
                    meta.i64(9, chunk.offset);
                });
            });
        }
        group.i64(2, chunks.iter().map(|c| c.plain_bytes).sum());
        group.i64(3, rows);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_thrift_writes_them() {
        assert_eq!([0, -1, 1, -2, 2].map(zigzag), [0, 1, 2, 3, 4]);
        let mut bytes = vec![];
        varint(&mut bytes, 300);
        assert_eq!(bytes, [0xac, 0x02]);
    }

    #[test]
    fn presence_is_written_as_runs() {
        assert_eq!(
            presence(&[Some(7), Some(8), None, Some(9)]),
            [4, 1, 2, 0, 2, 1]
        );
        assert_eq!(presence(&[]), Vec::<u8>::new());
    }

    #[test]
    fn a_file_begins_and_ends_as_the_format_says() {
        let columns = || {
            vec![
                ("n".to_string(), Values::Int(vec![])),
                ("t".to_string(), Values::Text(vec![])),
            ]
        };
        let mut file = vec![];
        let mut table = Table::new(&mut file, columns()).expect("memory");
        let values = [
            Values::Int(vec![1, -1]),
            Values::Text(vec!["a".into(), "bc".into()]),
        ];
        table.group(&values).expect("memory");
        table.finish().expect("memory");
        assert!(file.starts_with(MAGIC) && file.ends_with(MAGIC));
        let end = file.len() - 8;
        let length =
            u32::from_le_bytes(file[end..end + 4].try_into().expect("four bytes")) as usize;
        let footer = &file[end - length..end];
        // version 1; a list of three structures, the first without fields 1 to 3.
        assert_eq!(footer[..4], [0x15, 0x02, 0x19, 0x3c]);
        assert_eq!(footer.last(), Some(&0));
        let name = b"cognate ";
        assert!(footer.windows(name.len()).any(|w| w == name));
    }
}

//! NPZ of `NumPy`: an uncompressed ZIP archive of arrays, as written by `numpy.savez`.
//!
//! The archive follows PKWARE's APPNOTE 6.3.10. The size of each array is known in advance, so all
//! arrays are written at the same time, each at its place. Files carry the earliest date that the
//! format supports.

use std::io::{self, SeekFrom};

use crc32fast::Hasher;

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        Content, Form, Format, ImageFormat,
        format::cannot_hold_pixel,
        npy,
        output::{Draw, Output, WriteSeek},
        pixel::{Array, Pixel, Sample},
    },
};

impl ImageFormat {
    /// Named `NumPy` arrays.
    pub const NPZ: Self = Self(&Format {
        endings: &["npz"],
        content: Content::Arrays,
        holds: |pixel| layout(pixel).is_some(),
        encode,
        ..Format::PLAIN
    });
}

/// Version 4.5, which has 64-bit sizes; UTF-8 names; no compression; 1980-01-01 at 0:00.
const COMMON: [u8; 10] = [45, 0, 0, 8, 0, 0, 0, 0, 0x21, 0];
/// The value of a 32-bit field whose 64-bit number is stored elsewhere.
const ELSEWHERE: [u8; 4] = [255; 4];

/// Returns the arrays, if the numbers of each pixel are adjacent in all of them.
fn layout(pixel: Pixel<'_>) -> Option<&[Array]> {
    match pixel {
        Pixel::Arrays(all) => {
            let known = all.iter().all(|array| npy::layout(array.pixel).is_some());
            known.then_some(all)
        }
        _ => None,
    }
}

fn encode(output: Output, form: Form, draw: Draw) -> Result<(), Error> {
    let Form { size, pixel, .. } = form;
    let arrays = layout(pixel).ok_or_else(|| cannot_hold_pixel(ImageFormat::NPZ, pixel))?;
    let mut end = 0;
    let entries = arrays.iter().filter_map(|array| {
        let entry = NpzArray::new(array, size, end)?;
        end = entry.data() + entry.bytes;
        Some(entry)
    });
    let mut entries: Vec<_> = entries.collect();
    let row = size.width() as usize * pixel.bytes();
    output.going_back(|file| {
        draw(&mut |rows| {
            let mut begin = 0;
            for entry in &mut entries {
                let here = begin..begin + entry.row;
                begin = here.end;
                let rows = rows.chunks(row).map(|row| &row[here.clone()]);
                entry.append(rows, file).map_err(Error::writing)?;
            }
            Ok(())
        })?;
        write_directory(&entries, end, file).map_err(Error::writing)
    })
}

/// A file in the archive.
struct NpzArray {
    name: String,
    sample: Sample,
    header: Vec<u8>,
    /// Number of bytes in a row, and in the header and all rows.
    row: usize,
    bytes: u64,
    /// The offset of the file, and the offset of its next rows.
    begin: u64,
    next: u64,
    sum: Hasher,
}

impl NpzArray {
    fn new(array: &Array, size: Size, begin: u64) -> Option<Self> {
        let (count, sample) = npy::layout(array.pixel)?;
        let header = npy::header(size, count, sample);
        let row = size.width() as usize * array.pixel.bytes();
        let mut entry = Self {
            name: format!("{}.npy", array.name),
            sample,
            row,
            bytes: header.len() as u64 + row as u64 * u64::from(size.height()),
            begin,
            next: 0,
            sum: Hasher::new(),
            header,
        };
        entry.sum.update(&entry.header);
        entry.next = entry.data() + entry.header.len() as u64;
        Some(entry)
    }

    /// Returns the offset of the data.
    fn data(&self) -> u64 {
        self.begin + self.local_header().len() as u64
    }

    fn append<'a>(
        &mut self,
        rows: impl Iterator<Item = &'a [u8]>,
        file: &mut dyn WriteSeek,
    ) -> io::Result<()> {
        let rows: Vec<u8> = rows.flatten().copied().collect();
        let rows = self.sample.little_endian(&rows);
        self.sum.update(&rows);
        file.seek(SeekFrom::Start(self.next))?;
        self.next += rows.len() as u64;
        file.write_all(&rows)
    }

    /// Returns the header in front of the data.
    fn local_header(&self) -> Vec<u8> {
        let sizes = [self.bytes; 2];
        [b"PK\x03\x04", &COMMON[..], &self.fields(&sizes)].concat()
    }

    /// Returns the entry in the directory at the end: the same fields and the offset of the file.
    fn directory_header(&self) -> Vec<u8> {
        let numbers = [self.bytes, self.bytes, self.begin];
        let fields = self.fields(&numbers);
        // After the lengths of the name and the extra field: no comment, the first disk, no
        // attributes.
        let (before, after) = fields.split_at(16);
        let between = [&[0; 10][..], &ELSEWHERE].concat();
        let made_by = &COMMON[..2];
        [b"PK\x01\x02", made_by, &COMMON, before, &between, after].concat()
    }

    /// Returns the checksum, the sizes, the lengths of the name and the extra field, the name, and
    /// the extra field with the 64-bit numbers.
    fn fields(&self, numbers: &[u64]) -> Vec<u8> {
        let numbers: Vec<[u8; 8]> = numbers.iter().map(|number| number.to_le_bytes()).collect();
        let numbers = numbers.as_flattened();
        let sum = self.sum.clone().finalize().to_le_bytes();
        let length = |length: usize| (length as u16).to_le_bytes();
        let (name, extra) = (length(self.name.len()), length(4 + numbers.len()));
        let kind = [1, 0];
        let parts: [&[u8]; _] = [
            &sum,
            &ELSEWHERE,
            &ELSEWHERE,
            &name,
            &extra,
            self.name.as_bytes(),
            &kind,
            &length(numbers.len()),
            numbers,
        ];
        parts.concat()
    }
}

/// Writes the header of each file in front of it, then the directory at `begin`.
fn write_directory(entries: &[NpzArray], begin: u64, file: &mut dyn WriteSeek) -> io::Result<()> {
    for entry in entries {
        file.seek(SeekFrom::Start(entry.begin))?;
        file.write_all(&entry.local_header())?;
        file.write_all(&entry.header)?;
    }
    let directory: Vec<u8> = entries
        .iter()
        .flat_map(NpzArray::directory_header)
        .collect();
    file.seek(SeekFrom::Start(begin))?;
    file.write_all(&directory)?;
    // The ZIP64 end record, its locator, then the end record that refers to them.
    let bytes = directory.len() as u64;
    file.write_all(b"PK\x06\x06")?;
    file.write_all(&44_u64.to_le_bytes())?;
    file.write_all(&[45, 0, 45, 0, 0, 0, 0, 0, 0, 0, 0, 0])?;
    for number in [entries.len() as u64, entries.len() as u64, bytes, begin] {
        file.write_all(&number.to_le_bytes())?;
    }
    file.write_all(b"PK\x06\x07\0\0\0\0")?;
    file.write_all(&(begin + bytes).to_le_bytes())?;
    file.write_all(&[1, 0, 0, 0])?;
    file.write_all(b"PK\x05\x06\0\0\0\0")?;
    file.write_all(&[255; 12])?;
    file.write_all(&[0, 0])
}

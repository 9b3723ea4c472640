//! NPZ of `NumPy`: a ZIP archive of arrays, not compressed, as `numpy.savez` writes it.
//!
//! The form is that of PKWARE's APPNOTE 6.3.10. The size of each array is known beforehand, so that
//! all of them are written at once, each at its place. The date of a file is the first one there
//! is.

use std::io::{self, SeekFrom};

use crc32fast::Hasher;

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        Content, Draw, Form, Format, ImageFormat,
        format::cannot_hold_pixel,
        npy,
        output::{Output, WriteSeek},
        pixel::{Array, Pixel, Sample},
    },
};

impl ImageFormat {
    /// Named arrays of `NumPy`.
    pub const NPZ: Self = Self(&Format {
        endings: &["npz"],
        content: Content::Arrays,
        holds: |pixel| layout(pixel).is_some(),
        encode,
        ..Format::PLAIN
    });
}

/// Version 4.5, with sizes of 64 bits; names are UTF-8; stored as they are; 1980-01-01 at 0:00.
const COMMON: [u8; 10] = [45, 0, 0, 8, 0, 0, 0, 0, 0x21, 0];
/// Where a number of 32 bits has one of 64 bits elsewhere.
const ELSEWHERE: [u8; 4] = [255; 4];

/// The arrays, each of numbers side by side.
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
        let entry = Entry::new(array, size, end)?;
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

/// A file of the archive.
struct Entry {
    name: String,
    sample: Sample,
    header: Vec<u8>,
    /// The bytes of a row, and of header and all rows.
    row: usize,
    bytes: u64,
    /// Where it begins, and where its next rows belong.
    begin: u64,
    next: u64,
    sum: Hasher,
}

impl Entry {
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

    /// Where its data begins.
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

    /// What stands before the data.
    fn local_header(&self) -> Vec<u8> {
        let sizes = [self.bytes; 2];
        [b"PK\x03\x04", &COMMON[..], &self.fields(&sizes)].concat()
    }

    /// What stands in the directory at the end: the same, and where the file is.
    fn directory_header(&self) -> Vec<u8> {
        let numbers = [self.bytes, self.bytes, self.begin];
        let fields = self.fields(&numbers);
        // After the lengths of name and numbers: no comment, the first disk, no attributes.
        let (before, after) = fields.split_at(16);
        let between = [&[0; 10][..], &ELSEWHERE].concat();
        let made_by = &COMMON[..2];
        [b"PK\x01\x02", made_by, &COMMON, before, &between, after].concat()
    }

    /// The sum, the sizes, the lengths of name and numbers, the name, and the numbers of 64 bits.
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

/// Writes what stands before each file, and after all of them, from `begin` on.
fn write_directory(entries: &[Entry], begin: u64, file: &mut dyn WriteSeek) -> io::Result<()> {
    for entry in entries {
        file.seek(SeekFrom::Start(entry.begin))?;
        file.write_all(&entry.local_header())?;
        file.write_all(&entry.header)?;
    }
    let directory: Vec<u8> = entries.iter().flat_map(Entry::directory_header).collect();
    file.seek(SeekFrom::Start(begin))?;
    file.write_all(&directory)?;
    // The end with numbers of 64 bits, then where that is, then the end that refers to it.
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

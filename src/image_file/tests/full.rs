//! Writers that fail.

use std::io::{self, Cursor, Seek, SeekFrom, Write};

use super::{SIZE, cases};
use crate::{diagnostic::error::ErrorKind, image_file::output::Output};

/// A disk with room for this many bytes.
struct Full {
    file: Cursor<Vec<u8>>,
    room: u64,
}

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = self.room.saturating_sub(self.file.position()) as usize;
        if room == 0 && !bytes.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.file.write(&bytes[..room.min(bytes.len())])
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Full {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        self.file.seek(place)
    }
}

#[test]
fn a_full_disk_is_an_error_wherever_it_is_full() {
    for case in cases() {
        let file = case.file(SIZE);
        let disk = |room: usize| Full {
            file: Cursor::new(Vec::new()),
            room: room as u64,
        };
        let all = [0, 1, 20, 200, 600].into_iter();
        let all = all.chain([file.len() / 2, file.len() - 1]);
        for room in all.filter(|room| *room < file.len()) {
            let mut disk = [disk(room), disk(room)];
            let [as_file, as_stream] = &mut disk;
            for output in [Output::File(as_file), Output::Stream(as_stream)] {
                let refused = case.write(output, SIZE, &[]).unwrap_err();
                assert_eq!(
                    refused.kind(),
                    ErrorKind::Unavailable,
                    "{} {room}",
                    case.name
                );
            }
        }
        let mut disk = disk(file.len());
        case.write(Output::File(&mut disk), SIZE, &[]).unwrap();
        assert!(*disk.file.get_ref() == file, "{}", case.name);
    }
}

#[test]
fn an_error_of_the_renderer_is_passed_on() {
    use crate::{
        diagnostic::error::Error,
        image_file::{Encoding, Form, Sink},
    };

    for case in cases() {
        let encoding = Encoding {
            compression: case.compression,
            ..Encoding::default()
        };
        let draw = &mut |_: Sink| Err(Error::interrupted());
        let output = Output::Stream(&mut io::sink());
        let size = super::size(SIZE);
        let done = case.format.encode(
            output,
            Form {
                size,
                pixel: case.pixel,
                encoding,
            },
            draw,
        );
        assert_eq!(
            done.unwrap_err().kind(),
            ErrorKind::Interrupted,
            "{}",
            case.name
        );
    }
}

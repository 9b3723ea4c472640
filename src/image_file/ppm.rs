//! PPM, the binary kind: a line of text, then the pixels as they are.

use std::io::Write;

use crate::{error::Error, film::Size, image_file::Sink};

pub(super) fn encode(
    mut writer: impl Write,
    size: Size,
    draw: impl FnOnce(Sink) -> Result<(), Error>,
) -> Result<(), Error> {
    let (width, height) = (size.width(), size.height());
    write!(writer, "P6\n{width} {height}\n255\n").map_err(Error::writing)?;
    draw(&mut |bytes| writer.write_all(bytes).map_err(Error::writing))?;
    writer.flush().map_err(Error::writing)
}

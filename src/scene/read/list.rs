//! The list that may be as long as the file, read in blocks on all threads.
//!
//! Blocks are cut at a guess: after a comma that appears to be between two geometries. The guess
//! counts only if the previous block ended right there, with a geometry expected next. So the
//! blocks together read exactly what one reader would have read, whatever the text. After a wrong
//! guess, one reader reads it all.

use std::{
    iter,
    sync::{Mutex, PoisonError},
};

use serde::Deserialize;

use super::{
    reader::{Misfit, Reader, Result},
    source::BLOCK,
};
use crate::{parallel::Pool, scene::format::geometry::GeometryModel};

/// Maximum number of blocks per thread that wait to be joined. It is small because a waiting
/// geometry occupies the list of its block.
const BLOCKS_PER_THREAD: usize = 4;
/// Shorter texts are read whole by one thread.
pub(crate) const LARGE: usize = 1 << 20;

/// The end of a block.
#[derive(Clone, Copy)]
enum End {
    /// At the start of the next geometry.
    Geometry(usize),
    /// After the list.
    List(usize),
}

/// The geometries of a list, and the text after it.
struct List<T> {
    geometries: Vec<GeometryModel>,
    /// The total length of the blocks inside of the list.
    filled: usize,
    /// The end of the list in the first of the other blocks.
    end: usize,
    rest: Vec<T>,
}

/// Reads a list of geometries.
pub(super) fn geometries<const RON: bool>(
    reader: &mut Reader<'_, RON>,
) -> Result<Vec<GeometryModel>> {
    let (open, close) = Reader::<RON>::LIST;
    reader.expect(open)?;
    if reader.take(close) {
        return Ok(Vec::new());
    }
    reader.skip_blank();
    let start = reader.at;
    let text = reader.text.get(start..).ok_or(Misfit)?;
    let pool = reader.pool.unwrap_or(&Pool::Calling);
    if let Some(source) = reader.source {
        let blocks = source.blocks(text, guess::<RON>);
        let list = read_blocks::<RON, _>(blocks, source.length, pool)?;
        (reader.text, reader.at) = (source.rest(&list.rest), list.end);
        return Ok(list.geometries);
    }
    if text.len() >= LARGE && pool.threads() > 1 {
        let mut rest = text;
        let blocks = iter::from_fn(|| {
            let cut = rest
                .get(BLOCK..)
                .and_then(|_| guess::<RON>(rest.as_bytes(), BLOCK));
            let (block, others) = rest.split_at_checked(cut.unwrap_or(rest.len()))?;
            rest = others;
            (!block.is_empty()).then_some(Ok(block))
        });
        if let Ok(list) = read_blocks::<RON, _>(blocks, text.len(), pool) {
            reader.at = start + list.filled + list.end;
            return Ok(list.geometries);
        }
    }
    let mut all = Vec::new();
    match read_block::<RON>(text, usize::MAX, &mut all)? {
        End::List(at) => reader.at = start + at,
        End::Geometry(_) => return Err(Misfit),
    }
    Ok(all)
}

/// Reads blocks on all threads, of a text of about this many bytes.
fn read_blocks<const RON: bool, T: AsRef<str> + Send>(
    blocks: impl Iterator<Item = Result<T>> + Send,
    length: usize,
    pool: &Pool,
) -> Result<List<T>> {
    // Buffers of earlier blocks, reused because fresh memory costs more than filling it.
    let spare = Mutex::new(Vec::new());
    let lock = || spare.lock().unwrap_or_else(PoisonError::into_inner);
    let read = |block: Result<T>| {
        let (block, mut part) = (block?, lock().pop().unwrap_or_default());
        let text = block.as_ref();
        let end = read_block::<RON>(text, text.len(), &mut part);
        Ok((block, part, end))
    };
    let mut list = List {
        geometries: Vec::new(),
        filled: 0,
        end: 0,
        rest: Vec::new(),
    };
    let ahead = pool.threads() * BLOCKS_PER_THREAD;
    pool.in_order(blocks, ahead, read, |block| {
        let (block, mut part, end) = block?;
        // There are no geometries after the list, whatever the block contains.
        if !list.rest.is_empty() {
            list.rest.push(block);
            return Ok(());
        }
        if list.geometries.is_empty() && matches!(end, Ok(End::Geometry(_))) {
            // With a little more than the first block predicts, the list rarely has to grow, which
            // would take as much memory again.
            let expected = part.len() as f64 / block.as_ref().len() as f64 * length as f64;
            list.geometries = Vec::with_capacity((expected * 1.02) as usize);
        }
        list.geometries.append(&mut part);
        lock().push(part);
        match end? {
            End::Geometry(at) if at == block.as_ref().len() => list.filled += at,
            End::Geometry(_) => return Err(Misfit),
            End::List(at) => {
                list.end = at;
                list.rest.push(block);
            }
        }
        Ok(())
    })?;
    if list.rest.is_empty() {
        Err(Misfit)
    } else {
        Ok(list)
    }
}

/// Reads the geometry at the start of a text and those after it, up to the first that starts at or
/// after `stop`.
fn read_block<const RON: bool>(
    text: &str,
    stop: usize,
    all: &mut Vec<GeometryModel>,
) -> Result<End> {
    let (_, close) = Reader::<RON>::LIST;
    let mut reader = Reader::<RON>::new(text, 0);
    loop {
        let mut geometry = GeometryModel::deserialize(&mut reader)?;
        if let Some(before) = all.last() {
            geometry.share_material(before);
        }
        all.push(geometry);
        let comma = reader.take(b',');
        if (RON || !comma) && reader.take(close) {
            return Ok(End::List(reader.at));
        }
        if !comma {
            return Err(Misfit);
        }
        reader.skip_blank();
        if reader.at >= stop {
            return Ok(End::Geometry(reader.at));
        }
    }
}

/// Returns the place of an apparent start of a geometry, at or after a place.
fn guess<const RON: bool>(bytes: &[u8], from: usize) -> Option<usize> {
    let mut at = from;
    loop {
        at += 1 + bytes.get(at..)?.iter().position(|byte| *byte == b',')?;
        let start = behind_blanks::<RON>(bytes, at)?;
        // Other commas are followed by numbers, by fields in lower case or in quotes, and by words
        // of a comment.
        match bytes.get(start)? {
            b'A'..=b'Z' if RON => {
                let rest = bytes[start..].iter();
                let word = rest.take_while(|byte| byte.is_ascii_alphanumeric()).count();
                if bytes.get(start + word) == Some(&b'(') {
                    return Some(start);
                }
            }
            b'{' if !RON => return Some(start),
            _ => {}
        }
    }
}

/// Returns the first place at or after `at` that is neither white space nor a comment.
fn behind_blanks<const RON: bool>(bytes: &[u8], mut at: usize) -> Option<usize> {
    loop {
        let rest = bytes.get(at..)?;
        at += match rest {
            [byte, ..] if byte.is_ascii_whitespace() => 1,
            [b'/', b'/', ..] if RON => rest.iter().position(|byte| *byte == b'\n')?,
            [b'/', b'*', ..] if RON => 2 + rest.windows(2).position(|pair| pair == b"*/")?,
            _ => return Some(at),
        };
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Seek, Write};

    use super::{super::source::Source, *};

    /// Spheres whose text sometimes contains a false start of another one.
    fn spheres<const RON: bool>(traps: bool) -> String {
        let sphere = |index: u32| {
            let trap = if traps && index.is_multiple_of(3) {
                if RON { "/*), Sphere(*/ " } else { "}}, {\\" }
            } else {
                ""
            };
            if RON {
                format!("Sphere(center: (0, -0.5, {index}), {trap}radius: 1, color: \"#fff\")")
            } else {
                let trap = trap.trim_end_matches('\\');
                format!(
                    "{{\"Sphere\": {{\"center\": [0, -0.5, {index}], \"radius\": 1, \
                     \"color\": \"{trap}\"}}}}"
                )
            }
        };
        let all: Vec<_> = (0..40_000).map(sphere).collect();
        format!("[{}] x", all.join(",\n"))
    }

    fn blocks_are_as_the_whole<const RON: bool>() {
        let pool = Pool::new(Some(2));
        for traps in [false, true] {
            let text = spheres::<RON>(traps);
            let mut whole = Vec::new();
            let end = read_block::<RON>(&text[1..], usize::MAX, &mut whole).unwrap();
            assert!(matches!(end, End::List(at) if text[1 + at..] == *" x"));
            assert_eq!(whole.len(), 40_000);

            let mut reader = Reader::<RON>::new(&text, 0);
            reader.pool = Some(&pool);
            let all = geometries(&mut reader).unwrap();
            assert!(all == whole && text[reader.at..] == *" x");

            let mut file = tempfile::tempfile().unwrap();
            file.write_all(text.as_bytes()).unwrap();
            for pool in [&Pool::Calling, &pool] {
                file.rewind().unwrap();
                let source = Source::new(&file, text.len()).unwrap();
                let mut reader = Reader::<RON>::begin(&source);
                reader.pool = Some(pool);
                match geometries(&mut reader) {
                    Ok(all) => {
                        assert!(!traps && all == whole);
                        assert_eq!(&reader.text[reader.at..], " x");
                    }
                    Err(Misfit) => assert!(traps),
                }
            }
        }
    }

    #[test]
    fn blocks_of_ron_equal_the_whole() {
        blocks_are_as_the_whole::<true>();
    }

    #[test]
    fn blocks_of_json_equal_the_whole() {
        blocks_are_as_the_whole::<false>();
    }

    #[test]
    fn a_geometry_in_a_comment_is_never_read() {
        let comment = "), // was, Sphere(center: (9, 9, 9), radius: 1, color: \"#f00\"),\nSphere(";
        let text = spheres::<true>(false).replace("),\nSphere(", comment);
        let pool = Pool::new(Some(2));
        let mut reader = Reader::<true>::new(&text, 0);
        reader.pool = Some(&pool);
        assert_eq!(geometries(&mut reader).unwrap().len(), 40_000);
        // In blocks it is unknown, or the same.
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        file.rewind().unwrap();
        let source = Source::new(&file, text.len()).unwrap();
        let list = geometries(&mut Reader::<true>::begin(&source));
        assert!(list.is_err() || list.is_ok_and(|all| all.len() == 40_000));
    }

    #[test]
    fn comments_between_geometries_are_accepted() {
        let comment = "), // Carbon, Chain A, Sphere\n /* of, Two */ Sphere(";
        let text = spheres::<true>(false).replace("),\nSphere(", comment);
        let cut = guess::<true>(text.as_bytes(), 200).unwrap();
        assert!(text[..cut].ends_with("*/ ") && text[cut..].starts_with("Sphere("));
        let pool = Pool::new(Some(2));
        let blocks = iter::successors(Some(1), |at| guess::<true>(text.as_bytes(), at + 1000));
        let starts: Vec<usize> = blocks.chain([text.len()]).collect();
        let blocks = starts.windows(2).map(|pair| Ok(&text[pair[0]..pair[1]]));
        let list = read_blocks::<true, _>(blocks, text.len(), &pool).unwrap();
        assert!(starts.len() > 1000 && list.geometries.len() == 40_000);
    }

    #[test]
    fn any_fault_is_left_to_the_slow_readers() {
        let text = spheres::<true>(false);
        let broken = text.replace("39990)", "39990");
        let mut reader = Reader::<true>::new(&broken, 0);
        assert!(geometries(&mut reader).is_err());
        for text in ["[", "[,]", "[1]", "[Sphere()]"] {
            assert!(
                geometries(&mut Reader::<true>::new(text, 0)).is_err(),
                "{text}"
            );
        }
        assert!(geometries(&mut Reader::<true>::new("[ ]", 0)).is_ok_and(|all| all.is_empty()));
    }
}

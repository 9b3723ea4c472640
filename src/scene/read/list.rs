//! The list that may be as long as the file, read in blocks on all threads.
//!
//! A block starts at a guess: behind a comma that looks as if it stood between two geometries. The
//! guess counts only if the block before has ended right there, where a geometry is due; so the
//! blocks together have read what one reader would have read, whatever the text is.

use serde::Deserialize;

use super::reader::{Reader, Result, Unknown};
use crate::{parallel::Pool, scene::model::GeometryModel};

/// The field of a scene that the list is.
pub(super) const LONG_LIST: &str = "geometries";

/// How much text a block has.
const BLOCK: usize = 1 << 18;
/// How many blocks each thread reads before they are put together: few, for until then a geometry
/// is held in a list of its block.
const BLOCKS_PER_THREAD: usize = 4;
/// Texts shorter than this are read by one thread.
pub(crate) const SEVERAL_THREADS: usize = 1 << 20;

/// Where a block has ended.
#[derive(Clone, Copy)]
enum End {
    /// Where the next geometry starts.
    Geometry(usize),
    /// Behind the list.
    List(usize),
}

/// Reads a list of geometries.
pub(super) fn geometries<const RON: bool>(
    reader: &mut Reader<'_, RON>,
) -> Result<Vec<GeometryModel>> {
    let (open, close) = Reader::<RON>::LIST;
    reader.expect(open)?;
    let mut all = Vec::new();
    if reader.take(close) {
        return Ok(all);
    }
    let text = reader.text;
    let first = reader.at;
    let mut end = read_block::<RON>(text, first, first.saturating_add(BLOCK), &mut all)?;
    if let End::Geometry(at) = end {
        // With a little more than the first block promises, the list seldom has to grow, which
        // would take as much memory again.
        let expected = all.len() as f64 / (at - first) as f64 * (text.len() - at) as f64;
        all.reserve_exact((expected * 1.02) as usize);
    }
    loop {
        match end {
            End::List(at) => {
                reader.at = at;
                return Ok(all);
            }
            End::Geometry(at) => {
                let is_large = text.len() - at >= SEVERAL_THREADS;
                end = match reader.pool.filter(|pool| is_large && pool.threads() > 1) {
                    None => read_block::<RON>(text, at, usize::MAX, &mut all)?,
                    Some(pool) => read_blocks::<RON>(text, at, pool, &mut all)?,
                };
            }
        }
    }
}

/// Reads some blocks from `start` on all threads; fewer where a guess was wrong.
fn read_blocks<const RON: bool>(
    text: &str,
    start: usize,
    pool: &Pool,
    all: &mut Vec<GeometryModel>,
) -> Result<End> {
    let blocks = pool.threads() * BLOCKS_PER_THREAD;
    let guesses = (1..blocks).map_while(|block| guess::<RON>(text, start + block * BLOCK));
    let mut starts: Vec<usize> = [start].into_iter().chain(guesses).collect();
    starts.dedup();
    // A block goes on to where the next is guessed to start, the last as far as a block should.
    let stops = starts.iter().skip(1).copied();
    let stops = stops.chain([start.saturating_add(blocks * BLOCK)]);
    let pieces: Vec<_> = starts.iter().copied().zip(stops).collect();
    let parts = pool.map(pieces, |(start, stop)| {
        let mut part = Vec::new();
        read_block::<RON>(text, start, stop, &mut part).map(|end| (part, end))
    });
    let mut end = End::Geometry(start);
    for (start, part) in starts.into_iter().zip(parts) {
        match end {
            End::Geometry(at) if at == start => {
                let (mut part, part_end) = part?;
                all.append(&mut part);
                end = part_end;
            }
            // Either the guess was wrong, and so were perhaps those behind, or this is the end.
            _ => break,
        }
    }
    Ok(end)
}

/// Reads the geometry at `start` and those behind it, up to the first that starts at or behind
/// `stop`.
fn read_block<const RON: bool>(
    text: &str,
    start: usize,
    stop: usize,
    all: &mut Vec<GeometryModel>,
) -> Result<End> {
    let (_, close) = Reader::<RON>::LIST;
    let mut reader = Reader::<RON>::new(text, start);
    loop {
        all.push(GeometryModel::deserialize(&mut reader)?);
        let comma = reader.take(b',');
        if (RON || !comma) && reader.take(close) {
            return Ok(End::List(reader.at));
        }
        if !comma {
            return Err(Unknown);
        }
        reader.skip_blank();
        if reader.at >= stop {
            return Ok(End::Geometry(reader.at));
        }
    }
}

/// Where a geometry seems to start, at or behind a place.
fn guess<const RON: bool>(text: &str, from: usize) -> Option<usize> {
    let bytes = text.as_bytes();
    let mut at = from;
    loop {
        at += 1 + bytes.get(at..)?.iter().position(|byte| *byte == b',')?;
        let blanks = bytes.get(at..)?.iter();
        let start = at + blanks.take_while(|byte| byte.is_ascii_whitespace()).count();
        // Behind other commas stand numbers, fields in small letters or in quotes.
        match bytes.get(start)? {
            b'A'..=b'Z' if RON => return Some(start),
            b'{' if !RON => return Some(start),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Spheres whose text has, now and then, what looks like the start of another one.
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

    fn read_in_blocks<const RON: bool>(text: &str) -> (Vec<GeometryModel>, usize, u32) {
        let pool = Pool::new(Some(2)).unwrap();
        let (mut all, mut at, mut rounds) = (Vec::new(), 1, 0);
        loop {
            rounds += 1;
            match read_blocks::<RON>(text, at, &pool, &mut all).unwrap() {
                End::Geometry(next) => at = next,
                End::List(end) => return (all, end, rounds),
            }
        }
    }

    fn blocks_are_as_the_whole<const RON: bool>() {
        for traps in [false, true] {
            let text = spheres::<RON>(traps);
            let mut whole = Vec::new();
            let end = read_block::<RON>(&text, 1, usize::MAX, &mut whole).unwrap();
            let (all, at, rounds) = read_in_blocks::<RON>(&text);
            assert!(matches!(end, End::List(end) if end == at) && text[at..] == *" x");
            assert!(all == whole && all.len() == 40_000);
            // With no trap every guess is right.
            let fewest = (text.len() / (2 * BLOCKS_PER_THREAD * BLOCK) + 1) as u32;
            assert!(rounds >= fewest && (traps || rounds == fewest), "{rounds}");
        }
    }

    #[test]
    fn blocks_of_ron_are_as_the_whole() {
        blocks_are_as_the_whole::<true>();
    }

    #[test]
    fn blocks_of_json_are_as_the_whole() {
        blocks_are_as_the_whole::<false>();
    }

    #[test]
    fn a_fault_anywhere_is_unknown() {
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

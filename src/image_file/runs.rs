//! Runs of equal bytes, as stored in HDR and EXR files.

/// A piece of a byte sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteRun<'a> {
    /// The number of repetitions, and the repeated byte.
    Equal(u8, u8),
    /// Bytes as they are.
    Unequal(&'a [u8]),
}

/// The maximum length of a piece: the length, negative in some EXR pieces, is one signed byte.
const LONGEST: usize = 127;

/// Splits bytes into pieces. Fewer than `shortest` equal bytes are not a run.
pub(super) fn runs(mut bytes: &[u8], shortest: usize) -> impl Iterator<Item = ByteRun<'_>> {
    std::iter::from_fn(move || {
        let first = *bytes.first()?;
        let most = &bytes[..bytes.len().min(LONGEST)];
        let equal = most.iter().take_while(|byte| **byte == first).count();
        if equal >= shortest {
            bytes = &bytes[equal..];
            return Some(ByteRun::Equal(equal as u8, first));
        }
        let is_run = |run: &[u8]| run.iter().all(|byte| *byte == run[0]);
        let next = bytes.windows(shortest).take(LONGEST).position(is_run);
        let (unequal, rest) = bytes.split_at(next.unwrap_or(most.len()));
        bytes = rest;
        Some(ByteRun::Unequal(unequal))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_bytes_are_runs_if_there_are_enough_of_them() {
        let found: Vec<_> = runs(b"aabbbbcdd", 3).collect();
        let expected = [
            ByteRun::Unequal(b"aa"),
            ByteRun::Equal(4, b'b'),
            ByteRun::Unequal(b"cdd"),
        ];
        assert_eq!(found, expected);
        assert_eq!(runs(b"", 3).next(), None);
    }

    #[test]
    fn no_piece_is_too_long() {
        let mut bytes = vec![7; 300];
        bytes.extend((0..=255).chain(0..40));
        for shortest in [3, 4] {
            let mut again = Vec::new();
            for run in runs(&bytes, shortest) {
                match run {
                    ByteRun::Equal(count, byte) => again.extend(vec![byte; usize::from(count)]),
                    ByteRun::Unequal(unequal) => again.extend(unequal),
                }
                assert!(!matches!(run, ByteRun::Equal(128.., _)));
                assert!(!matches!(run, ByteRun::Unequal(bytes) if bytes.len() > LONGEST));
            }
            assert_eq!(again, bytes);
        }
    }
}

//! `--frames`: a selection of frames of an animation.

use std::str::FromStr;

/// The frames to draw of each scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Frames {
    /// All frames.
    All,
    /// The frames with these numbers, in the order given.
    Named(Vec<u32>),
}

/// The error for a text that does not name frames.
const WRONG: &str =
    "expected `all`, or numbers and ranges below 1000000, such as 0-239 or 1-3,5,7-20:2";

/// The maximum number of frames of an animation.
const MOST: u32 = 1_000_000;

impl FromStr for Frames {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, &'static str> {
        let number = |text: &str| {
            let number = text.trim().parse().ok();
            number.filter(|number| *number < MOST).ok_or(WRONG)
        };
        if text == "all" {
            return Ok(Self::All);
        }
        let mut frames = Vec::new();
        for part in text.split(',') {
            let (range, step) = match part.split_once(':') {
                Some((range, step)) => (range, number(step)?),
                None => (part, 1),
            };
            let (first, last) = match range.split_once('-') {
                Some((first, last)) => (number(first)?, number(last)?),
                None => (number(range)?, number(range)?),
            };
            if step == 0 || last < first || frames.len() > MOST as usize {
                return Err(WRONG);
            }
            frames.extend((first..=last).step_by(step as usize));
        }
        Ok(Self::Named(frames))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_ranges() {
        let frames = |text: &str| text.parse::<Frames>().ok();
        let named = |numbers: &[u32]| Some(Frames::Named(numbers.to_vec()));
        assert_eq!(frames("0-3"), named(&[0, 1, 2, 3]));
        assert_eq!(frames("1-3,5,7-12:2"), named(&[1, 2, 3, 5, 7, 9, 11]));
        assert_eq!(frames("4"), named(&[4]));
        assert_eq!(frames("all"), Some(Frames::All));
        for text in [
            "",
            "a",
            "3-1",
            "1-",
            "-1",
            "1-3:0",
            "1,,2",
            "0-1000000",
            "1-2-3",
        ] {
            assert_eq!(frames(text), None, "{text}");
        }
    }
}

//! The numbers of the pictures of a run: every scene, by every row, at every frame.

use std::ops::Range;

use strahl::{Configs, Document, SceneFile};

use super::Args;

/// Which picture a number stands for; the pictures themselves are never listed.
pub(super) struct Numbers {
    /// The number of frames of each scene, if pictures are of frames.
    frames: Option<Vec<u32>>,
    /// The frames that are drawn of every scene, unless it is all.
    named: Option<Vec<u32>>,
    /// The number of the first picture of each scene, and behind them the number of pictures.
    firsts: Vec<u64>,
}

impl Numbers {
    /// Those of scenes with so many frames each.
    pub(super) fn new(rows: u64, frames: Vec<u32>, named: Option<Vec<u32>>) -> Self {
        let firsts = firsts(frames.iter().map(|frames| rows * u64::from(*frames)));
        Self {
            frames: Some(frames),
            named,
            firsts,
        }
    }

    /// Those of scenes of which no frames are asked for.
    pub(super) fn still(rows: u64, scenes: usize) -> Self {
        Self {
            frames: None,
            named: None,
            firsts: firsts((0..scenes).map(|_| rows)),
        }
    }

    /// Those of all frames of each scene, which is read for it, and the scene if it is a single one.
    /// One that cannot be read counts as one picture, which tells why.
    pub(super) fn all(
        args: &Args,
        scenes: &[SceneFile],
        configs: &Configs,
        rows: u64,
    ) -> (Self, Option<Document>) {
        let read = |file: &SceneFile| args.read(&file.path, configs, args.threads()).ok();
        if let [file] = scenes {
            let document = read(file);
            let frames = document.as_ref().map_or(1, Document::frames);
            return (Self::new(rows, vec![frames], None), document);
        }
        let frames = |file| read(file).map_or(1, |document| document.frames());
        (
            Self::new(rows, scenes.iter().map(frames).collect(), None),
            None,
        )
    }

    /// The last of the frames that are named.
    pub(super) fn last_named(&self) -> Option<u32> {
        self.named.iter().flatten().max().copied()
    }

    /// Whether the pictures are of frames.
    pub(super) const fn have_frames(&self) -> bool {
        self.frames.is_some()
    }

    /// How many there are.
    pub(super) fn len(&self) -> u64 {
        self.firsts.last().copied().unwrap_or(0)
    }

    /// The numbers of the pictures of a scene.
    pub(super) fn of_scene(&self, scene: usize) -> Range<u64> {
        let first = |scene| self.firsts.get(scene).copied().unwrap_or_default();
        first(scene)..first(scene + 1)
    }

    /// The scene, the row and the frame of a picture.
    pub(super) fn item(&self, number: u64) -> (usize, usize, Option<u32>) {
        let behind = self.firsts.partition_point(|first| *first <= number);
        let scene = behind.saturating_sub(1);
        let inside = number - self.of_scene(scene).start;
        let frames = self.frames.as_ref();
        let Some(count) = frames.map(|frames| frames.get(scene).copied().unwrap_or(1)) else {
            return (scene, inside as usize, None);
        };
        let count = u64::from(count.max(1));
        let (row, frame) = (inside / count, inside % count);
        let named = self.named.as_ref();
        let frame = named.map_or(Some(frame as u32), |all| all.get(frame as usize).copied());
        (scene, row as usize, frame)
    }
}

/// Where each of some lengths begins, one behind the other, and where the last ends.
fn firsts(lengths: impl Iterator<Item = u64>) -> Vec<u64> {
    let mut firsts = vec![0];
    let mut end = 0;
    for length in lengths {
        end += length;
        firsts.push(end);
    }
    firsts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_has_frames_of_its_own() {
        let numbers = Numbers::new(2, vec![3, 1], None);
        let all: Vec<_> = (0..numbers.len()).map(|at| numbers.item(at)).collect();
        let expected = [
            (0, 0, 0),
            (0, 0, 1),
            (0, 0, 2),
            (0, 1, 0),
            (0, 1, 1),
            (0, 1, 2),
            (1, 0, 0),
            (1, 1, 0),
        ];
        assert_eq!(
            all,
            expected.map(|(scene, row, frame)| (scene, row, Some(frame)))
        );
        assert_eq!(numbers.of_scene(1), 6..8);
    }

    #[test]
    fn named_frames_come_in_their_order() {
        let numbers = Numbers::new(1, vec![2, 2], Some(vec![7, 4]));
        assert_eq!(numbers.item(1), (0, 0, Some(4)));
        assert_eq!(numbers.item(2), (1, 0, Some(7)));
        assert_eq!(numbers.last_named(), Some(7));
        assert_eq!(Numbers::still(3, 2).item(4), (1, 1, None));
    }
}

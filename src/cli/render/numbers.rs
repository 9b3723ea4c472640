//! The numbers of the pictures of a run: each scene with each row, at each frame, by each camera.

use std::ops::Range;

use strahl::{
    Document,
    jobs::{Configs, SceneFile},
};

use super::{Args, frames::Frames};

/// A mapping from numbers to pictures; the pictures themselves are never listed.
pub(super) struct Numbers {
    /// The number of frames of each scene, if there is a picture per frame.
    frames: Option<Vec<u32>>,
    /// The frames to draw of every scene, unless all are drawn.
    named: Option<Vec<u32>>,
    /// The names of the cameras of each scene, if each has its own picture.
    cameras: Vec<Vec<String>>,
    /// The number of the first picture of each scene, followed by the total number of pictures.
    firsts: Vec<u64>,
}

impl Numbers {
    /// Returns the numbers for the scenes of a run, and the scene if it is the only one and had to
    /// be read.
    ///
    /// Scenes are read to count their frames or cameras. One that cannot be read counts as one
    /// picture, which reports the reason.
    pub(super) fn of(
        args: &Args,
        scenes: &[SceneFile],
        configs: &Configs,
        rows: u64,
        wanted: Option<&Frames>,
    ) -> (Self, Option<Document>) {
        let is_read = args.cameras.is_all() || matches!(wanted, Some(Frames::All));
        let (mut frames, mut cameras, mut read) = (Vec::new(), Vec::new(), None);
        for file in scenes {
            let document = is_read.then(|| args.read(&file.path, configs, args.threads()).ok());
            let document = document.flatten();
            frames.push(match wanted {
                Some(Frames::All) => document.as_ref().map_or(1, Document::frames),
                Some(Frames::Named(named)) => named.len() as u32,
                None => 1,
            });
            let names = document.iter().flat_map(Document::cameras);
            let names = names.filter(|_| args.cameras.is_all());
            cameras.push(names.map(str::to_owned).collect());
            read = document.filter(|_| scenes.len() == 1);
        }
        let named = match wanted {
            Some(Frames::Named(named)) => Some(named.clone()),
            _ => None,
        };
        let frames = wanted.map(|_| frames);
        (Self::new(rows, frames, named, cameras), read)
    }

    fn new(
        rows: u64,
        frames: Option<Vec<u32>>,
        named: Option<Vec<u32>>,
        cameras: Vec<Vec<String>>,
    ) -> Self {
        let mut firsts = vec![0];
        let mut end = 0;
        for (scene, cameras) in cameras.iter().enumerate() {
            let frames = frames.as_ref().and_then(|frames| frames.get(scene));
            end += rows * u64::from(frames.copied().unwrap_or(1)) * cameras.len().max(1) as u64;
            firsts.push(end);
        }
        Self {
            frames,
            named,
            cameras,
            firsts,
        }
    }

    /// Returns the name of a camera of a scene.
    pub(super) fn camera(&self, scene: usize, camera: usize) -> Option<&str> {
        Some(self.cameras.get(scene)?.get(camera)?)
    }

    /// Returns the last of the named frames.
    pub(super) fn last_named(&self) -> Option<u32> {
        self.named.iter().flatten().max().copied()
    }

    /// Returns true if there is a picture per frame.
    pub(super) const fn have_frames(&self) -> bool {
        self.frames.is_some()
    }

    /// Returns true if the pictures are only those of one scene by its cameras.
    pub(super) fn are_views_of_one(&self) -> bool {
        let [cameras] = &*self.cameras else {
            return false;
        };
        !cameras.is_empty() && cameras.len() as u64 == self.len()
    }

    /// Returns the total number.
    pub(super) fn len(&self) -> u64 {
        self.firsts.last().copied().unwrap_or(0)
    }

    /// Returns the numbers of a scene's pictures.
    pub(super) fn of_scene(&self, scene: usize) -> Range<u64> {
        let first = |scene| self.firsts.get(scene).copied().unwrap_or_default();
        first(scene)..first(scene + 1)
    }

    /// Returns the scene, the row, the frame and the camera of a picture.
    pub(super) fn item(&self, number: u64) -> (usize, usize, Option<u32>, usize) {
        let behind = self.firsts.partition_point(|first| *first <= number);
        let scene = behind.saturating_sub(1);
        let inside = number - self.of_scene(scene).start;
        let cameras = self
            .cameras
            .get(scene)
            .map_or(1, |cameras| cameras.len().max(1)) as u64;
        let (inside, camera) = (inside / cameras, (inside % cameras) as usize);
        let frames = self.frames.as_ref();
        let Some(count) = frames.map(|frames| frames.get(scene).copied().unwrap_or(1)) else {
            return (scene, inside as usize, None, camera);
        };
        let count = u64::from(count.max(1));
        let (row, frame) = (inside / count, inside % count);
        let named = self.named.as_ref();
        let frame = named.map_or(Some(frame as u32), |all| all.get(frame as usize).copied());
        (scene, row as usize, frame, camera)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn items(numbers: &Numbers) -> Vec<(usize, usize, Option<u32>, usize)> {
        (0..numbers.len()).map(|at| numbers.item(at)).collect()
    }

    #[test]
    fn every_scene_has_frames_of_its_own() {
        let numbers = Numbers::new(2, Some(vec![3, 1]), None, vec![Vec::new(); 2]);
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
            items(&numbers),
            expected.map(|(scene, row, frame)| (scene, row, Some(frame), 0))
        );
        assert_eq!(numbers.of_scene(1), 6..8);
    }

    #[test]
    fn every_camera_counts() {
        let cameras = vec![vec!["a".to_owned(), "b".to_owned()], Vec::new()];
        let numbers = Numbers::new(1, Some(vec![2, 2]), Some(vec![7, 4]), cameras);
        let expected = [
            (0, 7, 0),
            (0, 7, 1),
            (0, 4, 0),
            (0, 4, 1),
            (1, 7, 0),
            (1, 4, 0),
        ];
        assert_eq!(
            items(&numbers),
            expected.map(|(scene, frame, camera)| (scene, 0, Some(frame), camera))
        );
        assert_eq!(numbers.camera(0, 1), Some("b"));
        assert_eq!(numbers.camera(1, 0), None);
        assert_eq!(numbers.last_named(), Some(7));
    }

    #[test]
    fn pictures_without_frames_have_none() {
        let numbers = Numbers::new(3, None, None, vec![Vec::new(); 2]);
        assert_eq!(numbers.item(4), (1, 1, None, 0));
    }
}

//! The pictures of a run: each scene with each row, at each frame, by each camera.

use std::sync::Arc;

use strahl::{
    Document,
    jobs::{Configs, SceneFile},
};

use crate::cli::render::args::Args;

use super::frames::Frames;

/// A picture of the run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Item {
    /// The index among all pictures.
    pub(super) number: u64,
    pub(super) scene: usize,
    pub(super) row: Option<usize>,
    pub(super) frame: Option<u32>,
    /// The name of the camera, if each has its own picture.
    pub(super) camera: Option<Arc<str>>,
}

/// Returns the pictures in order, and the scene if it is the only one and had to be read.
///
/// Scenes are read to count their frames or cameras. One that cannot be read counts as one picture,
/// which reports the reason.
pub(super) fn items(
    args: &Args,
    scenes: &[SceneFile],
    configs: &Configs,
    rows: Option<usize>,
    wanted: Option<&Frames>,
) -> (Vec<Item>, Option<Document>) {
    let is_read = args.cameras.is_all() || matches!(wanted, Some(Frames::All));
    let (mut items, mut read) = (Vec::new(), None);
    for (scene, file) in scenes.iter().enumerate() {
        let document = is_read.then(|| args.read(&file.path, configs, args.draw.threads()).ok());
        let document = document.flatten();
        let frames: Vec<Option<u32>> = match wanted {
            Some(Frames::All) => {
                let count = document.as_ref().map_or(1, Document::frames);
                (0..count).map(Some).collect()
            }
            Some(Frames::Named(named)) => named.iter().copied().map(Some).collect(),
            None => vec![None],
        };
        let names = document.iter().flat_map(Document::cameras);
        let names = names.filter(|_| args.cameras.is_all());
        let cameras: Vec<Arc<str>> = names.map(Arc::from).collect();
        add(&mut items, scene, rows, &frames, &cameras);
        read = document.filter(|_| scenes.len() == 1);
    }
    (items, read)
}

/// Adds the pictures of a scene.
fn add(
    items: &mut Vec<Item>,
    scene: usize,
    rows: Option<usize>,
    frames: &[Option<u32>],
    cameras: &[Arc<str>],
) {
    for row in 0..rows.unwrap_or(1) {
        for frame in frames {
            for camera in 0..cameras.len().max(1) {
                items.push(Item {
                    number: items.len() as u64,
                    scene,
                    row: rows.map(|_| row),
                    frame: *frame,
                    camera: cameras.get(camera).cloned(),
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_change_first_then_frames_then_rows() {
        let mut items = Vec::new();
        let cameras = ["a".into(), "b".into()];
        add(&mut items, 0, None, &[None], &[]);
        add(&mut items, 1, Some(2), &[Some(7), Some(4)], &cameras);
        let found = items.iter().map(|item| {
            let camera = item.camera.as_deref();
            (item.number, item.scene, item.row, item.frame, camera)
        });
        assert_eq!(
            found.collect::<Vec<_>>(),
            [
                (0, 0, None, None, None),
                (1, 1, Some(0), Some(7), Some("a")),
                (2, 1, Some(0), Some(7), Some("b")),
                (3, 1, Some(0), Some(4), Some("a")),
                (4, 1, Some(0), Some(4), Some("b")),
                (5, 1, Some(1), Some(7), Some("a")),
                (6, 1, Some(1), Some(7), Some("b")),
                (7, 1, Some(1), Some(4), Some("a")),
                (8, 1, Some(1), Some(4), Some("b")),
            ]
        );
    }
}

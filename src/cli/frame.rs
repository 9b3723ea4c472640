//! The frame of an animation that a command shows.

use strahl::Scene;

use super::failure::Failure;

#[derive(clap::Args)]
#[group(skip)]
pub(super) struct FrameArgs {
    /// Frame of the scene's animation, counted from 0; default: 0
    #[arg(long, value_name = "N")]
    frame: Option<u32>,
}

impl FrameArgs {
    /// Returns the number of the frame, if one is given.
    pub(super) const fn number(&self) -> Option<u32> {
        self.frame
    }

    /// Returns the scene at the frame.
    pub(super) fn of(&self, scene: Scene) -> Result<Scene, Failure> {
        match self.frame {
            Some(number) => Ok(scene.frame(number)?),
            None => Ok(scene),
        }
    }
}

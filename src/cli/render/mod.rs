//! `strahl render`: pictures of scenes.

pub(crate) mod args;
mod draw;
pub(crate) mod frames;
mod items;
mod list;
mod many;
mod movie;
pub(crate) mod one;
mod output;
pub(crate) mod pattern;
pub(crate) mod sampling;
mod series;
mod shared;
pub(crate) mod source;
mod summary;

use std::time::Instant;

pub(crate) use self::args::Args;
use super::{failure::Failure, interrupt};

pub(crate) fn run(args: &Args, start: Instant) -> Result<(), Failure> {
    let cancel = interrupt::cancel_on_signal();
    args.check_format()?;
    if args.is_many() {
        if args.depfile.is_some() {
            return Err(Failure::usage(
                "--depfile is for a picture or a movie of one scene, not for the rows of --params or \
                 several scenes; `strahl info SCENE --depfile FILE` writes the files of a scene",
            ));
        }
        many::run(args, start, &cancel)
    } else {
        one::run(args, start, &cancel)
    }
}

//! End-to-end tests of the program: arguments, files, pipes, terminals and signals.

mod arguments;
mod cameras;
mod config;
mod copies;
mod diff;
mod diff_folders;
mod diff_layers;
mod disc;
mod fault_tables;
mod fit;
mod fixing;
mod folders;
mod formats;
mod fuzz;
mod groups;
mod info;
mod inputs;
mod layers;
mod lit;
mod lit_pixels;
mod many;
mod movies;
mod names;
mod options;
mod parts;
mod rewriting;
mod row_cells;
mod sampling;
mod scene_faults;
mod setting;
mod shapes;
mod shards;
mod stamps;
mod support;
mod tables;
mod targets;
mod timings;
mod validating;
mod values;
mod writing;

#[cfg(unix)]
mod attacks;
#[cfg(unix)]
mod depfile;
#[cfg(unix)]
mod disks;
#[cfg(unix)]
mod foreign;
#[cfg(unix)]
mod pipes;
mod places;
mod places_in_files;
#[cfg(unix)]
mod signals;
#[cfg(unix)]
mod special_files;
#[cfg(unix)]
mod terminal;
#[cfg(unix)]
mod typed;
mod validate_watch;
#[cfg(unix)]
mod watch;

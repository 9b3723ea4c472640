//! The time that a command took, on standard error.

use std::{
    fmt::Write as _,
    io::{self, Write as _},
    time::Instant,
};

use serde_json::Value;
use strahl::{
    diagnostic::read_text,
    parallel::{Stage, Timings},
    text::Stamp,
};

use super::output::OutputFormat;

/// The figures that `--timings` prints besides the times.
pub(super) struct Work {
    /// The start of the program.
    pub(super) start: Instant,
    /// Number of rays: one for each sample of each pixel.
    pub(super) rays: u64,
    /// Number of geometries in the world.
    pub(super) geometries: usize,
    /// Number of threads that drew.
    pub(super) threads: usize,
}

/// Prints the times of a picture that was just finished.
pub(super) fn print(format: OutputFormat, timings: &Timings, work: &Work) {
    let total = work.start.elapsed();
    let stages = Stage::ALL.iter();
    let stages = stages.map(|stage| (stage.name(), timings.of(*stage)));
    let times = stages.chain([("total", total)]);
    let memory = peak_memory();
    let counts = [
        ("rays", work.rays),
        ("geometries", work.geometries as u64),
        ("threads", work.threads as u64),
    ];
    let mut text = String::new();
    match format {
        OutputFormat::Human => {
            for (name, time) in times {
                let milliseconds = time.as_secs_f64() * 1e3;
                let _ = writeln!(text, "{name:<6} {milliseconds:>12.3} ms");
            }
            let memory = memory.map(|bytes| ("KiB of peak memory", bytes / 1024));
            for (name, count) in counts.into_iter().chain(memory) {
                let _ = writeln!(text, "{count:>19} {name}");
            }
        }
        OutputFormat::Json => {
            // Written by hand, because a map of serde_json sorts its keys.
            let _ = write!(text, "{{{}", Stamp::Timings);
            let mut field = |name: &str, value: Value| {
                let _ = write!(text, ",\"{name}\":{value}");
            };
            times.for_each(|(name, time)| field(&format!("{name}_s"), time.as_secs_f64().into()));
            for (name, count) in counts {
                field(name, count.into());
            }
            field("peak_memory_bytes", memory.into());
            text.push('}');
        }
    }
    // Whoever closed standard error does not want the message.
    let _ = writeln!(io::stderr(), "{}", text.trim_end());
}

/// Returns the peak memory of the process, if the system reports it: on Linux.
fn peak_memory() -> Option<u64> {
    let status = read_text("/proc/self/status", 1 << 16).ok()?;
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = peak.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

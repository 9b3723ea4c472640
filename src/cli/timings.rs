//! The time that a command took, on standard error.

use std::{
    fmt::Write as _,
    fs,
    io::{self, Write as _},
    time::{Duration, Instant},
};

use strahl::{
    parallel::{Stage, Timings},
    text::Stamp,
};

use super::OutputFormat;

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
    let text = match format {
        OutputFormat::Human => human(times, work, memory),
        OutputFormat::Json => json(times, work, memory),
    };
    // Whoever closed standard error does not want the message.
    let _ = writeln!(io::stderr(), "{}", text.trim_end());
}

fn human(
    times: impl Iterator<Item = (&'static str, Duration)>,
    work: &Work,
    memory: Option<u64>,
) -> String {
    let mut text = String::new();
    for (name, time) in times {
        let milliseconds = time.as_secs_f64() * 1e3;
        let _ = writeln!(text, "{name:<6} {milliseconds:>12.3} ms");
    }
    let counts = [
        ("rays", Some(work.rays)),
        ("geometries", Some(work.geometries as u64)),
        ("threads", Some(work.threads as u64)),
        ("KiB of peak memory", memory.map(|bytes| bytes / 1024)),
    ];
    for (name, count) in counts {
        if let Some(count) = count {
            let _ = writeln!(text, "{count:>19} {name}");
        }
    }
    text
}

fn json(
    times: impl Iterator<Item = (&'static str, Duration)>,
    work: &Work,
    memory: Option<u64>,
) -> String {
    let times = times.map(|(name, time)| (format!("{name}_s"), time.as_secs_f64().into()));
    let counts = [
        ("rays", work.rays.into()),
        ("geometries", work.geometries.into()),
        ("threads", work.threads.into()),
        ("peak_memory_bytes", memory.into()),
    ];
    let counts = counts.map(|(name, count)| (name.to_owned(), count));
    let fields: Vec<(String, serde_json::Value)> = times.chain(counts).collect();
    // Written by hand, because a map of serde_json sorts its keys.
    let fields: Vec<_> = fields
        .iter()
        .map(|(name, value)| format!("\"{name}\":{value}"))
        .collect();
    format!("{{{},{}}}", Stamp::Timings, fields.join(","))
}

/// Returns the peak memory of the process, if the system reports it: on Linux.
fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = peak.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

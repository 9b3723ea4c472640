//! Pictures whose light follows paths, sampled in rounds: within a time, or by several runs.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use strahl::{
    Error, RenderOptions, Scene, diagnostic::folder_of, film::SampleCount, render::PictureSums,
};

use crate::cli::{
    failure::Failure,
    record::{self, FOLDER},
    scene::print_warning,
};

/// The longest time of a round, after which the samples may be written to a file.
const ROUND: Duration = Duration::from_secs(10);
/// The shortest time between two writes: those of quick pictures are not worth it.
const BETWEEN: Duration = Duration::from_secs(1);
/// The least ratio of the time between two writes and that of a write.
const RATIO: u32 = 20;

/// The options of pictures that are sampled in rounds.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
#[group(skip)]
pub(crate) struct SamplingArgs {
    /// Stop adding paths after this time, such as 90s, 15m or 2h; the picture is that of fewer samples.
    /// For several pictures, the time of each
    #[arg(long, value_name = "TIME", value_parser = time)]
    time_limit: Option<Duration>,
    /// Keep the samples of pictures by paths next to them, in .strahl/, so that --resume with more
    /// --samples continues them
    #[arg(long)]
    keep_samples: bool,
}

impl SamplingArgs {
    /// Returns the option that is given, if any.
    pub(super) fn given(self) -> Option<&'static str> {
        match self {
            Self {
                time_limit: Some(_),
                ..
            } => Some("--time-limit"),
            Self {
                keep_samples: true, ..
            } => Some("--keep-samples"),
            _ => None,
        }
    }

    /// Rejects options that do not apply to movies.
    pub(super) fn check_movie(self) -> Result<(), Failure> {
        match self.given() {
            Some(option) => {
                let message = format!("{option} is for pictures, not for movies");
                Err(Failure::usage(message))
            }
            None => Ok(()),
        }
    }

    /// Returns the time limit of each picture.
    pub(super) const fn time_limit(self) -> Option<Duration> {
        self.time_limit
    }

    /// Samples a picture in rounds, if that is of use. Without `path` it goes to standard output. `resume`
    /// continues the samples of an earlier run.
    pub(super) fn sample(
        self,
        scene: &Scene,
        path: Option<&Path>,
        options: RenderOptions,
        (resume, quiet): (bool, bool),
    ) -> Result<Sampled, Failure> {
        let has_file = path.is_some() && (resume || self.keep_samples);
        if !scene.follows_paths() {
            return match self.given() {
                Some(option) => {
                    let message = format!("{option} is for scenes with `lighting: Path()`");
                    Err(Failure::usage(message))
                }
                None => Ok(Sampled::whole(options)),
            };
        }
        let is_small = scene.pixels(&options) <= PictureSums::MOST_PIXELS;
        let is_asked = self.given().is_some() || (has_file && is_small);
        if !is_asked {
            return Ok(Sampled::whole(options));
        }
        // A picture that cannot be written is not sampled for hours before that is told.
        scene.check_picture(path.unwrap_or(Path::new("-")), &options)?;
        let mut rounds = RoundFiles {
            scene,
            file: path.filter(|_| has_file).map(file_of),
            options: &options,
            written: Instant::now(),
            cost: Duration::ZERO,
        };
        let known = rounds.known(resume, quiet)?;
        let most = options.sample_count(scene).count();
        let mut reached = known.as_ref().map_or(0, PictureSums::samples);
        let (start, mut last) = (Instant::now(), None);
        let sums = scene.add_samples(known, &options, |sums| {
            let pace = last.map(|(begun, count): (Instant, u32)| begun.elapsed() / count);
            if last.is_some() {
                rounds.write_at_times(sums)?;
            }
            let left = self
                .time_limit
                .map(|limit| limit.saturating_sub(start.elapsed()));
            let Some(next) = next(reached, most, pace, left) else {
                return Ok(None);
            };
            last = Some((Instant::now(), next - reached));
            reached = next;
            Ok(SampleCount::new(next).ok())
        })?;
        if self.keep_samples {
            rounds.write(&sums)?;
        }
        let file = rounds.file.filter(|_| !self.keep_samples);
        let samples =
            SampleCount::new(reached).map_err(|error| Failure::usage(error.to_string()))?;
        Ok(Sampled {
            // The rounds have been counted.
            options: options.samples(samples).sums(sums).on_progress(|_| ()),
            file,
            samples: Some(reached),
        })
    }
}

/// Returns the number of samples after the next round; `None` if there is none. `pace` is the time of a sample
/// of all pixels, `left` that of all rounds.
fn next(reached: u32, most: u32, pace: Option<Duration>, left: Option<Duration>) -> Option<u32> {
    let fits = |time: Duration| match pace {
        Some(pace) => (time.as_secs_f64() / pace.as_secs_f64().max(1e-9)) as u32,
        None => u32::from(!time.is_zero()),
    };
    // Each round doubles the samples, so that the picture begins with a quick one.
    let doubled = reached.max(1).min(most.saturating_sub(reached));
    let more = doubled.min(fits(ROUND).max(1));
    let more = match left {
        Some(left) if reached > 0 => more.min(fits(left)),
        _ => more,
    };
    (more > 0).then_some(reached + more)
}

/// Returns the file of the samples of a picture.
fn file_of(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".samples");
    folder_of(path).join(FOLDER).join(name)
}

/// A picture and the file that keeps its samples between rounds.
struct RoundFiles<'a> {
    scene: &'a Scene,
    file: Option<PathBuf>,
    options: &'a RenderOptions,
    /// The last time when it was written, and how long that took.
    written: Instant,
    cost: Duration,
}

impl RoundFiles<'_> {
    /// Returns the samples of an earlier run.
    fn known(&self, resume: bool, quiet: bool) -> Result<Option<PictureSums>, Failure> {
        let Some(file) = self.file.as_deref().filter(|_| resume) else {
            return Ok(None);
        };
        match self.scene.read_sums(file, self.options) {
            Ok(known) => Ok(known),
            Err(error) if error.is_cancelled() => Err(error.into()),
            Err(error) => {
                if !quiet {
                    print_warning(&format!("{error}; all samples are drawn again"));
                }
                Ok(None)
            }
        }
    }

    /// Writes the file if that is due.
    fn write_at_times(&mut self, sums: &PictureSums) -> Result<(), Error> {
        match self.written.elapsed() > BETWEEN.max(self.cost * RATIO) {
            true => self.write(sums),
            false => Ok(()),
        }
    }

    /// Writes the file, if there is one.
    fn write(&mut self, sums: &PictureSums) -> Result<(), Error> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        let start = Instant::now();
        record::prepare(file).map_err(|error| Error::writing_failed(file, error))?;
        self.scene.save_sums(file, sums, self.options)?;
        (self.written, self.cost) = (Instant::now(), start.elapsed());
        Ok(())
    }
}

/// A picture whose samples are known, if it is one of rounds.
pub(super) struct Sampled {
    /// The options that draw it.
    pub(super) options: RenderOptions,
    /// The number of its samples.
    pub(super) samples: Option<u32>,
    /// The file of its samples, which is not needed once it is drawn.
    file: Option<PathBuf>,
}

impl Sampled {
    /// Returns a picture that is drawn in one run.
    pub(super) const fn whole(options: RenderOptions) -> Self {
        Self {
            options,
            samples: None,
            file: None,
        }
    }

    /// Removes the file of the samples, and its folder unless that has others.
    pub(super) fn finish(&self) {
        if let Some(file) = &self.file
            && fs::remove_file(file).is_ok()
        {
            let _ = fs::remove_dir(folder_of(file));
        }
    }
}

/// Returns a time with its unit.
fn time(text: &str) -> Result<Duration, &'static str> {
    let units = [("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let number = |(unit, seconds): (&str, f64)| {
        let number: f64 = text.strip_suffix(unit)?.parse().ok()?;
        let time = Duration::try_from_secs_f64(number * seconds).ok()?;
        (!time.is_zero()).then_some(time)
    };
    let time = units.into_iter().find_map(number);
    time.ok_or("expected a time above 0 with its unit, such as 90s, 15m or 2h")
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn times_have_units() {
        assert_eq!(time("90s"), Ok(90 * SECOND));
        assert_eq!(time("1.5m"), Ok(90 * SECOND));
        assert_eq!(time("2h"), Ok(7200 * SECOND));
        for wrong in [
            "90", "0s", "-1s", "s", "1d", "nans", "infs", "1e300h", "1 s",
        ] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn rounds_double_until_all_samples_or_no_time_is_left() {
        let mut all = vec![0];
        while let Some(more) = next(all[all.len() - 1], 100, Some(SECOND / 1000), None) {
            all.push(more);
        }
        assert_eq!(all, [0, 1, 2, 4, 8, 16, 32, 64, 100]);
        // A round of ten seconds has ten samples of a second.
        assert_eq!(next(64, 1000, Some(SECOND), None), Some(74));
        assert_eq!(next(64, 1000, Some(60 * SECOND), None), Some(65));
        assert_eq!(next(64, 1000, Some(SECOND), Some(3 * SECOND)), Some(67));
        assert_eq!(next(64, 1000, Some(SECOND), Some(SECOND / 2)), None);
        // A picture has at least one sample.
        assert_eq!(next(0, 1000, None, Some(Duration::ZERO)), Some(1));
        assert_eq!(next(64, 1000, None, Some(Duration::ZERO)), None);
        assert_eq!(next(64, 1000, None, Some(SECOND)), Some(65));
    }
}

//! What a run of many pictures keeps beside them: which there are to be, which are done, and by what
//! checksums these are known.
//!
//! The records of a folder are files in `.strahl/` in it, one for each process that has worked there
//! at a time, so that nobody shares one. A line is an object; each is written at once and at the
//! end, so that a process that was killed leaves at most half a line behind, which nobody reads.

use std::{
    collections::{HashMap, HashSet},
    fs::{self, File, OpenOptions},
    io::{self, Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use strahl::{Error, Shard, Stamp, Stamped};

/// The folder of the records, in that of the pictures.
pub(super) const FOLDER: &str = ".strahl";
const ENDING: &str = "jsonl";
/// How many processes may work on one part at once.
const MOST: usize = 1000;

/// A line of a record.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line {
    Plan(Plan),
    Done(Done),
    Failed(Failed),
    /// What was found in a folder and is no scene.
    Skipped(String),
}

/// A line with whatever else stands in it, such as the stamp.
#[derive(Deserialize)]
struct AnyLine {
    #[serde(flatten)]
    line: Line,
}

/// What a run is going to make.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Plan {
    /// The version of the program.
    pub(super) version: String,
    /// Which part of the job this is.
    pub(super) shard: u32,
    pub(super) shards: u32,
    /// What all parts are to make has this many pictures.
    pub(super) total: u64,
    /// The pictures of this part.
    pub(super) pictures: Vec<String>,
}

impl Plan {
    /// Whether another plan is that of a part of the same job.
    fn is_of(&self, other: &Self) -> bool {
        (self.shards, self.total) == (other.shards, other.total)
    }
}

/// A picture that is there, as `pictures` of a plan calls it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Done {
    pub(super) picture: String,
    /// A hash of all that it was made of.
    pub(super) hash: String,
    pub(super) files: Vec<Written>,
}

/// A picture that could not be drawn.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Failed {
    pub(super) picture: String,
    pub(super) error: String,
}

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Written {
    /// From the folder of the pictures.
    pub(super) file: String,
    pub(super) bytes: u64,
    pub(super) sha256: String,
}

impl Written {
    /// What is in a file now.
    pub(super) fn of(folder: &Path, file: &str) -> io::Result<Self> {
        let mut sum = Sha256::new();
        let bytes = io::copy(&mut File::open(folder.join(file))?, &mut sum)?;
        let sum = sum.finalize();
        Ok(Self {
            file: file.to_owned(),
            bytes,
            sha256: sum.iter().map(|byte| format!("{byte:02x}")).collect(),
        })
    }

    /// Whether the file is still as it was written.
    pub(super) fn is_there(&self, folder: &Path) -> bool {
        let length = fs::metadata(folder.join(&self.file)).map(|found| found.len());
        length.is_ok_and(|length| length == self.bytes)
            && Self::of(folder, &self.file).is_ok_and(|found| found == *self)
    }
}

/// Everything that the records of a folder say.
#[derive(Debug, Default)]
pub(super) struct Records {
    /// The plan of each part of the newest job.
    pub(super) plans: Vec<Plan>,
    /// Each picture may have been made several times, by several processes and of several things.
    done: HashMap<String, Vec<Done>>,
    pub(super) failed: HashMap<String, Failed>,
    pub(super) skipped: HashSet<String>,
}

impl Records {
    /// Reads the records of a folder; one without any has none.
    pub(super) fn read(folder: &Path) -> Result<Self, Error> {
        let records = folder.join(FOLDER);
        let unreadable = |error| Error::reading_failed(&records, error);
        let entries = match fs::read_dir(&records) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Self::default()),
            Err(error) => return Err(unreadable(error)),
        };
        let mut files = Vec::new();
        for entry in entries {
            let entry = entry.map_err(unreadable)?;
            if entry
                .path()
                .extension()
                .is_some_and(|ending| ending == ENDING)
            {
                let changed = entry.metadata().and_then(|found| found.modified());
                files.push((changed.ok(), entry.path()));
            }
        }
        files.sort();
        let mut all = Self::default();
        for (_, path) in files {
            all.add(&path)
                .map_err(|error| Error::reading_failed(&path, error))?;
        }
        Ok(all)
    }

    fn add(&mut self, path: &Path) -> io::Result<()> {
        let bytes = fs::read(path)?;
        let mut newest = None;
        for line in bytes.split(|byte| *byte == b'\n') {
            // What cannot be read is half a line, or from a later version.
            let read = serde_json::from_slice::<AnyLine>(line);
            match read.map(|line| line.line) {
                Ok(Line::Plan(plan)) => newest = Some(plan),
                Ok(Line::Done(done)) => {
                    let all = self.done.entry(done.picture.clone()).or_default();
                    all.retain(|other| other.hash != done.hash);
                    all.push(done);
                }
                Ok(Line::Failed(failed)) => {
                    self.failed.insert(failed.picture.clone(), failed);
                }
                Ok(Line::Skipped(picture)) => {
                    self.skipped.insert(picture);
                }
                Err(_) => {}
            }
        }
        // A later plan of a part takes the place of an earlier one; one of another job, of all.
        if let Some(plan) = newest {
            self.plans
                .retain(|other| plan.is_of(other) && other.shard != plan.shard);
            self.plans.push(plan);
        }
        Ok(())
    }

    /// A picture as it was last made of what has this hash; without a hash, of anything.
    pub(super) fn done(&self, picture: &str, hash: Option<&str>) -> impl Iterator<Item = &Done> {
        let all = self.done.get(picture).into_iter().flatten();
        all.filter(move |done| hash.is_none_or(|hash| done.hash == hash))
    }
}

/// Writes the record of a run.
pub(super) struct Recorder(Mutex<File>);

impl Recorder {
    /// Begins a record in a folder, or goes on with one that no other process writes.
    pub(super) fn open(folder: &Path, plan: &Plan) -> Result<Self, Error> {
        let records = folder.join(FOLDER);
        let unwritable = |error| Error::writing_failed(&records, error);
        fs::create_dir_all(&records).map_err(unwritable)?;
        let file = open(&records, plan).map_err(unwritable)?;
        let recorder = Self(Mutex::new(file));
        recorder
            .write(&Line::Plan(plan.clone()))
            .map_err(unwritable)?;
        Ok(recorder)
    }

    pub(super) fn done(&self, done: &Done) -> io::Result<()> {
        self.write(&Line::Done(done.clone()))
    }

    pub(super) fn failed(&self, picture: &str, error: &str) -> io::Result<()> {
        self.write(&Line::Failed(Failed {
            picture: picture.to_owned(),
            error: error.to_owned(),
        }))
    }

    pub(super) fn skipped(&self, picture: &str) -> io::Result<()> {
        self.write(&Line::Skipped(picture.to_owned()))
    }

    fn write(&self, line: &Line) -> io::Result<()> {
        let mut text = serde_json::to_string(&Stamped::new(Stamp::Record, line))?;
        text.push('\n');
        let mut file = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(text.as_bytes())
    }
}

/// A file that only this process writes, at the end of a line.
fn open(records: &Path, plan: &Plan) -> io::Result<File> {
    let part = format!("{}-of-{}", plan.shard, plan.shards);
    for number in 0..MOST {
        let path = records.join(format!("{part}-{number}.{ENDING}"));
        let mut file = OpenOptions::new()
            .read(true)
            .append(true)
            .create(true)
            .open(&path)?;
        match file.try_lock() {
            Ok(()) => {
                end_line(&mut file)?;
                return Ok(file);
            }
            Err(fs::TryLockError::WouldBlock) => {}
            // A file system without locks: a name that nobody else has.
            Err(fs::TryLockError::Error(_)) => break,
        }
    }
    let named = tempfile::Builder::new()
        .prefix(&format!("{part}-"))
        .suffix(&format!(".{ENDING}"))
        .tempfile_in(records)?;
    let (file, _path): (File, PathBuf) = named.keep().map_err(|error| error.error)?;
    Ok(file)
}

/// Ends the line of a process that was killed while it wrote one.
fn end_line(file: &mut File) -> io::Result<()> {
    if file.metadata()?.len() == 0 {
        return Ok(());
    }
    let mut last = [0];
    file.seek(SeekFrom::End(-1))?;
    file.read_exact(&mut last)?;
    if last != *b"\n" {
        file.write_all(b"\n")?;
    }
    Ok(())
}

/// The plan of a part.
pub(super) fn plan(shard: Shard, total: u64, pictures: Vec<String>) -> Plan {
    Plan {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        shard: shard.index(),
        shards: shard.count(),
        total,
        pictures,
    }
}

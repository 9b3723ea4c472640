//! Records of a run of many pictures, kept next to them: the planned pictures, the finished ones,
//! and their checksums.
//!
//! The records of a folder are files in its `.strahl/`, one for each process that works there at
//! the same time, so that no two share one. Each line is an object, written at once to the end of
//! the file, so that a killed process leaves at most half a line, which is ignored.

use std::{
    collections::{HashMap, HashSet},
    fs::{self, File, OpenOptions},
    io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write},
    path::{Component, Path, PathBuf},
    sync::Mutex,
};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use strahl::{
    Error,
    diagnostic::{folder_of, is_at, open_file},
    jobs::Shard,
    text::{Stamp, Stamped},
};

use super::threads::lock;

/// The folder of the records, in that of the pictures.
pub(super) const FOLDER: &str = ".strahl";
const ENDING: &str = "jsonl";
/// The maximum number of processes working on one part at once.
const MOST: usize = 1000;
/// The maximum length of a line: a plan of a few million pictures.
const LONGEST_LINE: u64 = 1 << 28;
/// The maximum number of versions of a picture to remember.
const MOST_WAYS: usize = 64;

/// A line of a record.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Line {
    Plan(Plan),
    Done(Done),
    Failed(Failed),
    /// A file found in a folder that is not a scene.
    Skipped(String),
}

/// A line with any other fields, such as the stamp.
#[derive(Deserialize)]
struct AnyLine {
    #[serde(flatten)]
    line: Line,
}

/// The pictures that a run will make.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Plan {
    /// The version of the program.
    pub(super) version: String,
    /// The number of this part of the job, and the number of parts.
    pub(super) shard: u32,
    pub(super) shards: u32,
    /// Number of pictures of all parts together.
    pub(super) total: u64,
    /// The pictures of this part.
    pub(super) pictures: Vec<String>,
}

impl Plan {
    /// Returns true if the plan is valid and its pictures are in the folder.
    fn is_sound(&self) -> bool {
        Shard::new(self.shard, self.shards).is_ok()
            && self.pictures.len() as u64 <= self.total
            && self.pictures.iter().all(|picture| is_inside(picture))
    }

    /// Returns true if another plan is for a part of the same job.
    fn is_of(&self, other: &Self) -> bool {
        (self.shards, self.total) == (other.shards, other.total)
    }
}

/// A finished picture, named as in `pictures` of a plan.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Done {
    pub(super) picture: String,
    /// A hash of everything it was made from.
    pub(super) hash: String,
    pub(super) files: Vec<Written>,
}

impl Done {
    /// Returns true if it names files, all of them in the folder.
    fn is_sound(&self) -> bool {
        !self.files.is_empty() && self.files.iter().all(|file| is_inside(&file.file))
    }
}

/// Returns true if a name stays in the folder that it starts in.
fn is_inside(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    !name.is_empty() && parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
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
    /// The path from the folder of the pictures.
    pub(super) file: String,
    pub(super) bytes: u64,
    pub(super) sha256: String,
}

impl Written {
    /// Returns the size and checksum of a file as it is now.
    pub(super) fn of(folder: &Path, file: &str) -> io::Result<Self> {
        let mut sum = Sha256::new();
        let bytes = io::copy(&mut open_file(folder.join(file))?, &mut sum)?;
        Ok(Self {
            file: file.to_owned(),
            bytes,
            sha256: format!("{:x}", sum.finalize()),
        })
    }

    /// Returns true if the file is unchanged since it was written.
    pub(super) fn is_there(&self, folder: &Path) -> bool {
        let found = fs::metadata(folder.join(&self.file));
        // Reading a pipe would block.
        found.is_ok_and(|found| found.is_file() && found.len() == self.bytes)
            && Self::of(folder, &self.file).is_ok_and(|found| found == *self)
    }
}

/// The contents of all records in a folder.
#[derive(Debug, Default)]
pub(super) struct Records {
    /// The plan of each part of the newest job.
    pub(super) plans: Vec<Plan>,
    /// The finished pictures. Each may have been made several times, by several processes and from
    /// different inputs.
    done: HashMap<String, Vec<Done>>,
    pub(super) failed: HashMap<String, Failed>,
    pub(super) skipped: HashSet<String>,
}

impl Records {
    /// Reads the records of a folder; empty if it has none.
    pub(super) fn read(folder: &Path) -> Result<Self, Error> {
        let records = folder.join(FOLDER);
        let unreadable = |error| Error::reading_failed(&records, error);
        unless_gone(check_folder(&records)).map_err(unreadable)?;
        let Some(entries) = unless_gone(fs::read_dir(&records)).map_err(unreadable)? else {
            return Ok(Self::default());
        };
        let mut files = Vec::new();
        for entry in entries {
            let path = entry.map_err(unreadable)?.path();
            if path.extension().is_some_and(|ending| ending == ENDING) {
                let found = unless_gone(check_file(&path));
                let found = found.map_err(|error| Error::reading_failed(&path, error))?;
                files.extend(found.map(|found| (found.modified().ok(), path)));
            }
        }
        files.sort();
        let mut all = Self::default();
        for (_, path) in files {
            unless_gone(all.add(&path)).map_err(|error| Error::reading_failed(&path, error))?;
        }
        Ok(all)
    }

    fn add(&mut self, path: &Path) -> io::Result<()> {
        let mut file = BufReader::new(open_file(path)?);
        let mut newest = None;
        let mut line = Vec::new();
        loop {
            line.clear();
            let most = LONGEST_LINE + 1;
            let length = file.by_ref().take(most).read_until(b'\n', &mut line)?;
            if length as u64 == most {
                let message = format!("a line is longer than {LONGEST_LINE} bytes");
                return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
            }
            if length == 0 {
                break;
            }
            // An unreadable line is incomplete or from a later version.
            let read = serde_json::from_slice::<AnyLine>(&line);
            match read.map(|line| line.line) {
                Ok(Line::Plan(plan)) if plan.is_sound() => newest = Some(plan),
                Ok(Line::Done(done)) if done.is_sound() => {
                    let all = self.done.entry(done.picture.clone()).or_default();
                    all.retain(|other| other.hash != done.hash);
                    all.truncate(MOST_WAYS - 1);
                    all.insert(0, done);
                }
                Ok(Line::Failed(failed)) => {
                    self.failed.insert(failed.picture.clone(), failed);
                }
                Ok(Line::Skipped(picture)) => {
                    self.skipped.insert(picture);
                }
                Ok(_) | Err(_) => {}
            }
        }
        // A later plan replaces an earlier one of the same part, and all those of another job.
        if let Some(plan) = newest {
            self.plans
                .retain(|other| plan.is_of(other) && other.shard != plan.shard);
            self.plans.push(plan);
        }
        Ok(())
    }

    /// Returns the records of a picture made from inputs with this hash, newest first; without a
    /// hash, all of them.
    pub(super) fn done(&self, picture: &str, hash: Option<&str>) -> impl Iterator<Item = &Done> {
        let all = self.done.get(picture).into_iter().flatten();
        all.filter(move |done| hash.is_none_or(|hash| done.hash == hash))
    }
}

/// Returns `None` for a file that another process has removed, as it may at any time.
fn unless_gone<T>(found: io::Result<T>) -> io::Result<Option<T>> {
    match found {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// Checks that the records are in a real folder, and not elsewhere through a link.
fn check_folder(records: &Path) -> io::Result<()> {
    match fs::symlink_metadata(records)?.is_dir() {
        true => Ok(()),
        false => Err(io::Error::other("is not a folder; remove it")),
    }
}

/// Creates the folder of records, if it does not exist.
fn make_folder(records: &Path) -> io::Result<()> {
    if fs::symlink_metadata(records).is_err() {
        fs::create_dir_all(records)?;
    }
    check_folder(records)
}

/// Prepares to write another file in a folder of records, which is made if it does not exist.
pub(super) fn prepare(file: &Path) -> io::Result<()> {
    make_folder(folder_of(file))?;
    unless_gone(check_file(file)).map(|_| ())
}

/// Checks that a record is a file of this folder, and returns its metadata.
fn check_file(path: &Path) -> io::Result<fs::Metadata> {
    let found = fs::symlink_metadata(path)?;
    let wrong = "a record is a file, not a link or a device; remove it";
    let found = found.is_file().then_some(found);
    found.ok_or_else(|| io::Error::other(wrong))
}

/// A writer for the record of a run.
pub(super) struct Recorder {
    file: Mutex<File>,
    path: PathBuf,
    /// True if the record was empty before.
    is_new: bool,
}

impl Recorder {
    /// Starts a record in a folder, or continues one that no other process is writing.
    pub(super) fn open(folder: &Path, plan: &Plan) -> Result<Self, Error> {
        let records = folder.join(FOLDER);
        let mut opened = Ok(None);
        for _ in 0..MOST {
            opened = unless_gone(make_folder(&records).and_then(|()| open(&records, plan)));
            if !matches!(opened, Ok(None)) {
                break;
            }
        }
        let opened = opened.and_then(|opened| opened.ok_or(io::ErrorKind::NotFound.into()));
        let recorder = opened.map_err(|error| Error::writing_failed(&records, error))?;
        recorder.write(&Line::Plan(plan.clone()))?;
        Ok(recorder)
    }

    /// Removes what is no longer needed: the record, unless another run has written to it too, and
    /// its folder, unless it contains anything else.
    pub(super) fn remove(self) {
        if self.is_new && fs::remove_file(&self.path).is_ok() {
            let _ = self.path.parent().map(fs::remove_dir);
        }
    }

    /// Appends a line.
    pub(super) fn write(&self, line: &Line) -> Result<(), Error> {
        let text = serde_json::to_string(&Stamped::new(Stamp::Record, line));
        let written = text.map_err(io::Error::from).and_then(|text| {
            let mut file = lock(&self.file);
            file.write_all((text + "\n").as_bytes())
        });
        written.map_err(|error| Error::writing_failed(folder_of(&self.path), error))
    }
}

/// Opens a record that only this process writes, at the end of a line.
fn open(records: &Path, plan: &Plan) -> io::Result<Recorder> {
    let part = format!("{}-of-{}", plan.shard, plan.shards);
    for number in 0..MOST {
        let path = records.join(format!("{part}-{number}.{ENDING}"));
        let mut options = OpenOptions::new();
        options.read(true).append(true);
        // A link would lead out of the folder: it is not followed, and no file is created through
        // it.
        let file = match check_file(&path) {
            Ok(_) => options.open(&path),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                options.create_new(true).open(&path)
            }
            Err(error) => Err(error),
        };
        let mut file = match file {
            Ok(file) => file,
            // Another process was faster.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            Err(error) => return Err(error),
        };
        match file.try_lock() {
            Ok(()) if is_at(&file, &path) => {
                end_line(&mut file)?;
                return Ok(Recorder {
                    is_new: file.metadata()?.len() == 0,
                    file: Mutex::new(file),
                    path,
                });
            }
            Ok(()) | Err(fs::TryLockError::WouldBlock) => {}
            // The file system has no locks: use a name that nobody else has.
            Err(fs::TryLockError::Error(_)) => break,
        }
    }
    let named = tempfile::Builder::new()
        .prefix(&format!("{part}-"))
        .suffix(&format!(".{ENDING}"))
        .tempfile_in(records)?;
    let (file, path) = named.keep().map_err(|error| error.error)?;
    Ok(Recorder {
        file: Mutex::new(file),
        path,
        is_new: true,
    })
}

/// Ends the line of a process that was killed while writing it.
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

/// Returns the plan of a part.
pub(super) fn plan(shard: Shard, total: u64, pictures: Vec<String>) -> Plan {
    Plan {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        shard: shard.index(),
        shards: shard.count(),
        total,
        pictures,
    }
}

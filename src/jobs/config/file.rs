//! Parsing of a `strahl.toml`.

use std::{collections::HashSet, ops::Range, path::Path};

use ignore::gitignore::GitignoreBuilder;
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use crate::{
    diagnostic::{Code, Severity, error::Error, levels::Levels},
    jobs::config::{Config, are_too_many},
    report::OutputFormat,
    text::{
        lines::Lines,
        nearest::{list, nearest, quote},
    },
};

/// The keys that a file may have.
const KEYS: &[&str] = &[
    "exclude",
    "deny",
    "warn",
    "allow",
    "max-diagnostics",
    "output-format",
    "allow-outside",
];

type TomlValue<'t> = Spanned<DeValue<'t>>;
/// A function that changes the level of a code.
type SetLevel = fn(&mut Levels, Code);

/// The range of a fault, and its message.
type ConfigFault = (Range<usize>, String);

/// Parses the text of a file.
pub(super) fn parse(text: &str, path: &Path) -> Result<Config, Error> {
    config(text, path).map_err(|(range, message)| {
        let place = Lines::new(text).position(range.start);
        let (path, line, column) = (path.display(), place.line, place.column);
        Error::refused(format!("{path}:{line}:{column}: {message}"))
    })
}

fn config(text: &str, path: &Path) -> Result<Config, ConfigFault> {
    let table = DeTable::parse(text).map_err(|error| {
        let message = error.message().lines().collect::<Vec<_>>().join(", ");
        (error.span().unwrap_or_default(), message)
    })?;
    let mut reader = ConfigReader {
        excluded: GitignoreBuilder::new(path.parent().unwrap_or(Path::new(""))),
        levels: Vec::new(),
        named: HashSet::new(),
        config: Config::default(),
    };
    // The keys are sorted by name, but the first fault in the text is reported.
    let mut entries: Vec<_> = table.get_ref().iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    for (key, value) in entries {
        match &**key.get_ref() {
            "exclude" => reader.exclude(value)?,
            "deny" => reader.level(Levels::deny, value, true)?,
            "warn" => reader.level(Levels::warn, value, false)?,
            "allow" => reader.level(Levels::allow, value, false)?,
            "max-diagnostics" => reader.max_diagnostics(value)?,
            "output-format" => reader.output_format(value)?,
            "allow-outside" => reader.allow_outside(value)?,
            name => return Err((key.span(), unknown("key", name, KEYS))),
        }
    }
    // The level of a single code takes precedence over that of all warnings.
    for (set, code) in reader.levels {
        set(&mut reader.config.levels, code);
    }
    Ok(reader.config)
}

/// The values read so far.
struct ConfigReader {
    excluded: GitignoreBuilder,
    /// The changes of levels, with their codes.
    levels: Vec<(SetLevel, Code)>,
    named: HashSet<Code>,
    config: Config,
}

impl ConfigReader {
    fn exclude(&mut self, value: &TomlValue<'_>) -> Result<(), ConfigFault> {
        let patterns = strings(value)?;
        let too_many = || (value.span(), "too many patterns".to_owned());
        if are_too_many(patterns.iter().map(|(pattern, _)| *pattern)) {
            return Err(too_many());
        }
        for (pattern, range) in patterns {
            let added = self.excluded.add_line(None, pattern);
            added.map_err(|_| (range, format!("{} is not a pattern", quote(pattern))))?;
        }
        let excluded = self.excluded.build();
        let excluded = excluded.map_err(|_| too_many())?;
        self.config.excluded = Some(excluded);
        Ok(())
    }

    fn level(
        &mut self,
        level: SetLevel,
        value: &TomlValue<'_>,
        may_be_all: bool,
    ) -> Result<(), ConfigFault> {
        for (name, range) in strings(value)? {
            if name == "warnings" && may_be_all {
                self.config.levels.deny_warnings();
                continue;
            }
            let code = warning(name).map_err(|message| (range.clone(), message))?;
            if !self.named.insert(code) {
                return Err((range, format!("{} is named twice", quote(name))));
            }
            self.levels.push((level, code));
        }
        Ok(())
    }

    fn max_diagnostics(&mut self, value: &TomlValue<'_>) -> Result<(), ConfigFault> {
        let integer = value.get_ref().as_integer();
        let integer = integer.map(|number| usize::from_str_radix(number.as_str(), number.radix()));
        // A whole number may be written as a float, as in a scene.
        let float = value.get_ref().as_float();
        let whole =
            float.and_then(|number| number.as_str().trim_end_matches('0').strip_suffix('.'));
        let number = integer
            .or_else(|| whole.map(str::parse))
            .and_then(Result::ok);
        let wrong = || wrong(value, "a number of 0 or more");
        self.config.max_diagnostics = Some(number.ok_or_else(wrong)?);
        Ok(())
    }

    fn output_format(&mut self, value: &TomlValue<'_>) -> Result<(), ConfigFault> {
        let name = string(value)?;
        let format = name.parse().map_err(|_| {
            let known = OutputFormat::ALL.iter().map(|format| format.name());
            let known: Vec<_> = known.collect();
            (value.span(), unknown("output format", name, &known))
        })?;
        self.config.output_format = Some(format);
        Ok(())
    }

    fn allow_outside(&mut self, value: &TomlValue<'_>) -> Result<(), ConfigFault> {
        let allow = value.get_ref().as_bool();
        self.config.allow_outside = allow.ok_or_else(|| wrong(value, "`true` or `false`"))?;
        Ok(())
    }
}

/// Returns the warning with a name.
fn warning(name: &str) -> Result<Code, String> {
    match name.parse::<Code>() {
        Ok(code) if code.severity() == Severity::Warning => Ok(code),
        Ok(_) => Err(format!(
            "{} is an error; only warnings can be changed",
            quote(name)
        )),
        Err(_) => {
            let known: Vec<_> = Code::WARNINGS.iter().map(|code| code.name()).collect();
            Err(unknown("warning", name, &known))
        }
    }
}

fn strings<'v>(value: &'v TomlValue<'_>) -> Result<Vec<(&'v str, Range<usize>)>, ConfigFault> {
    let array = value.get_ref().as_array();
    let array = array.ok_or_else(|| wrong(value, "an array of strings"))?;
    array
        .iter()
        .map(|item| Ok((string(item)?, item.span())))
        .collect()
}

fn string<'v>(value: &'v TomlValue<'_>) -> Result<&'v str, ConfigFault> {
    value
        .get_ref()
        .as_str()
        .ok_or_else(|| wrong(value, "a string"))
}

fn wrong(value: &TomlValue<'_>, expected: &str) -> ConfigFault {
    let found = match value.get_ref() {
        DeValue::Integer(number) => quote(&number.to_string()),
        DeValue::Float(number) => quote(&number.to_string()),
        DeValue::Array(_) => "an array".to_owned(),
        other => format!("a {}", other.type_str()),
    };
    (value.span(), format!("expected {expected}, found {found}"))
}

fn unknown(what: &str, name: &str, known: &[&str]) -> String {
    let found = quote(name);
    match nearest(name, known) {
        Some(meant) => format!("unknown {what} {found}; did you mean {}?", quote(meant)),
        None => format!("unknown {what} {found}, expected one of {}", list(known)),
    }
}

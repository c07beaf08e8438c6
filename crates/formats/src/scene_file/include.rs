//! Scene files and what they include.

use super::diagnose::{check_tables, content_fault, syntax_fault};
use super::document::Document;
use super::overrides::apply_overrides;
use super::source::{Fault, MAX_BYTES, Source, Step, list_entries};
use crate::folder::{NameSyntax, resolve};
use crate::{ErrorKind, FileError, Report};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, Deserializer};

/// Longest chain of files that include each other.
const MAX_DEPTH: usize = 16;
/// Most files of one scene.
const MAX_FILES: usize = 1024;

/// A scene file that was read.
pub(super) struct Part {
    pub source: Source,
    pub document: Document,
}

/// Reads a scene file and all that it includes, in order; the first part is the file itself.
pub(super) fn read_parts(
    path: &Path,
    overrides: &[(String, String)],
    report: &mut Report,
) -> Result<Vec<Part>, FileError> {
    let mut parts = vec![];
    let mut source = Source::read(path, report)?;
    source.overrides = overrides.to_vec();
    let mut reader = Reader {
        parts: &mut parts,
        chain: vec![],
        bytes: 0,
        report,
    };
    reader.add(source)?;
    Ok(parts)
}

struct Reader<'a> {
    parts: &'a mut Vec<Part>,
    /// The files that are being read, each included by the one before, as written and canonical.
    chain: Vec<(PathBuf, PathBuf)>,
    bytes: u64,
    report: &'a mut Report,
}

impl Reader<'_> {
    fn add(&mut self, mut source: Source) -> Result<(), FileError> {
        self.bytes += source.text.len() as u64;
        let canonical = source
            .path
            .canonicalize()
            .map_err(|e| FileError::io(&source.path, &e))?;
        self.chain.push((source.path.clone(), canonical));
        let document = match understand(&source) {
            Ok((entries, document)) => {
                source.entries = entries;
                document.map_err(|error| source.error(content_fault(&error, &source)))?
            }
            Err(fault) => return Err(source.error(fault)),
        };
        let index = self.parts.len();
        let includes = document.include.clone();
        self.parts.push(Part { source, document });
        for (i, name) in includes.iter().enumerate() {
            let next = self.open(index, i, name)?;
            self.add(next)?;
        }
        self.chain.pop();
        Ok(())
    }

    /// Opens an included file, or refuses it at the line that names it.
    fn open(&mut self, part: usize, i: usize, name: &str) -> Result<Source, FileError> {
        let source = &self.parts[part].source;
        let key = [Step::Key("include".to_owned())];
        let whole = source.entry(&key).map_or(0..0, |e| e.value.clone());
        let fault = |kind, message: String| {
            source.error(Fault {
                kind,
                span: whole.clone(),
                message,
            })
        };
        let refuse =
            |message: String| fault(ErrorKind::Input, format!("include {}: {message}", i + 1));
        let path = resolve(&source.path, name, NameSyntax::Plain)
            .map_err(|e| refuse(e.message().to_owned()))?;
        let canonical = path.canonicalize().map_err(|e| FileError::io(&path, &e))?;
        if self.chain.iter().any(|(_, seen)| *seen == canonical) {
            return Err(refuse(format!(
                "\"{name}\" includes itself: {}",
                self.show_chain(&path)
            )));
        }
        if self.chain.len() >= MAX_DEPTH {
            let message = format!(
                "more than {MAX_DEPTH} files include each other: {}",
                self.show_chain(&path)
            );
            return Err(fault(ErrorKind::Limit, message));
        }
        let size = std::fs::metadata(&path)
            .map_err(|e| FileError::io(&path, &e))?
            .len();
        if self.bytes + size > MAX_BYTES || self.parts.len() >= MAX_FILES {
            let message = format!(
                "the scene with its included files is over {MAX_BYTES} bytes or {MAX_FILES} files"
            );
            return Err(fault(ErrorKind::Limit, message));
        }
        Source::read(&path, self.report)
    }

    fn show_chain(&self, last: &Path) -> String {
        let names = self
            .chain
            .iter()
            .map(|(path, _)| path.as_path())
            .chain([last]);
        names
            .map(|p| p.display().to_string())
            .collect::<Vec<_>>()
            .join(" -> ")
    }
}

type Understood = (Vec<super::source::Entry>, Result<Document, toml::de::Error>);

/// Parses a text and deserialises it.
fn understand(source: &Source) -> Result<Understood, Fault> {
    let mut root = DeTable::parse(&source.text).map_err(|e| syntax_fault(&e, source))?;
    apply_overrides(source, root.get_mut())?;
    check_tables(root.get_ref())?;
    let entries = list_entries(root.get_ref());
    Ok((entries, Document::deserialize(Deserializer::from(root))))
}

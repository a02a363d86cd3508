//! The errors found in one file, gathered so that all of them are told at once.

use std::ops::Range;

use super::source::Source;
use crate::{Error, ErrorKind};

/// More errors than this help nobody.
pub(super) const MOST_ERRORS: usize = 20;
/// Reading stops at this many, before a file of nothing but errors takes long.
const ENOUGH_ERRORS: usize = 1000;

/// The errors found so far, each with the byte where it stands.
pub(super) struct Found<'a> {
    pub(super) source: &'a Source<'a>,
    errors: Vec<(usize, ErrorKind, Option<usize>)>,
}

impl<'a> Found<'a> {
    pub(super) fn new(source: &'a Source<'a>) -> Self {
        Self { source, errors: Vec::new() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.errors.is_empty()
    }

    /// Whether reading on would help nobody.
    pub(super) fn is_enough(&self) -> bool {
        self.errors.len() >= ENOUGH_ERRORS
    }

    pub(super) fn add(&mut self, kind: ErrorKind, span: Option<Range<usize>>) {
        let offset = span.map(|span| span.start);
        self.errors.push((offset.unwrap_or(usize::MAX), kind, offset));
    }

    /// `read`, or else the first errors in the order of the file.
    pub(super) fn or<T>(mut self, read: T) -> Result<T, Error> {
        self.errors.sort_by_key(|(order, ..)| *order);
        let errors = self.errors.into_iter().take(MOST_ERRORS);
        let errors = errors.map(|(_, kind, offset)| self.source.error(kind, offset)).collect();
        match Error::first_of(errors) {
            Some(error) => Err(error),
            None => Ok(read),
        }
    }
}

//! Unfolding: how much memory a file may ask for, given how long it is. Accessors may look at the
//! same bytes again and again, or at none, so that a small file could ask for any number of
//! vertices; limits on these numbers alone would have to be those of the largest honest file.

use super::ReadLimits;
use crate::{Error, ErrorKind};

/// Bytes that any file may unfold to, however short it is.
pub(super) const FREE: u64 = 1 << 26;

/// A vertex: position, normal and texture coordinates.
pub(super) const VERTEX: u64 = 32;
/// A triangle: three numbers of vertices.
pub(super) const TRIANGLE: u64 = 12;
/// An instance: its transform.
pub(super) const INSTANCE: u64 = 48;

/// What meshes and instances have been counted to take.
#[derive(Clone, Debug)]
pub(super) struct Unfolding {
    n_read: u64,
    limit: u64,
    taken: u64,
}

impl Unfolding {
    /// For a model of whose files `n_read` bytes were read.
    pub(super) fn new(limits: &ReadLimits, n_read: u64) -> Self {
        let limit = n_read.saturating_mul(limits.unfolding).saturating_add(FREE);
        Self { n_read, limit, taken: 0 }
    }

    /// Counts `n` elements of so many `bytes` each, which something at `at` asks for.
    pub(super) fn take(&mut self, n: u64, bytes: u64, at: &str) -> Result<(), Error> {
        self.taken = self.taken.saturating_add(n.saturating_mul(bytes));
        if self.taken <= self.limit {
            return Ok(());
        }
        let (at, bytes, limit, n_read) = (at.to_owned(), self.taken, self.limit, self.n_read);
        Err(Error::new(ErrorKind::Unfolds { at, bytes, limit, n_read }))
    }
}

//! Buffers and views of them: bytes that are there.

use std::borrow::Cow;
use std::collections::hash_map::Entry;

use sapwood_geom::{FixedMap, fixed_state};

use super::document::{Document, List, invalid};
use super::folder::Folder;
use super::schema;
use crate::Error;

/// A document with the bytes of every buffer that a view looks into.
pub(super) struct Buffers<'a> {
    pub(super) document: &'a Document<'a>,
    buffers: FixedMap<usize, Cow<'a, [u8]>>,
}

/// Some bytes of a buffer.
#[derive(Clone, Copy)]
pub(super) struct View<'b> {
    pub(super) bytes: &'b [u8],
    /// From one element to the next, if the view says so.
    pub(super) stride: Option<u64>,
}

impl<'a> Buffers<'a> {
    /// Reads the buffers. `bin` is the binary chunk of the file, if it has one.
    pub(super) fn of(
        document: &'a Document<'a>,
        bin: Option<&'a [u8]>,
        folder: &mut Folder,
    ) -> Result<Self, Error> {
        let mut buffers = FixedMap::with_hasher(fixed_state());
        for index in 0..document.len(List::BufferViews) {
            let at = List::BufferViews.entry(index);
            let view: schema::BufferView = document.get(List::BufferViews, index, &at)?;
            if let Entry::Vacant(place) = buffers.entry(view.buffer) {
                let user = format_args!("{at}.buffer");
                let buffer = document.get(List::Buffers, view.buffer, user)?;
                place.insert(bytes_of(&buffer, view.buffer, bin, folder)?);
            }
        }
        Ok(Self { document, buffers })
    }

    /// The bytes of view `index`, for something at `user`.
    pub(super) fn view(&self, index: usize, user: &str) -> Result<View<'_>, Error> {
        let view: schema::BufferView = self.document.get(List::BufferViews, index, user)?;
        let bytes = &*self.buffers[&view.buffer];
        let end = view.byte_offset.checked_add(view.byte_length);
        // What lies within a slice fits a machine word.
        let inside = end.and_then(|end| bytes.get(view.byte_offset as usize..end as usize));
        let inside = inside.filter(|_| end.is_some_and(|end| end <= bytes.len() as u64));
        let Some(bytes) = inside else {
            let found = format!(
                "{} bytes from byte {} on, of a buffer of {}",
                view.byte_length,
                view.byte_offset,
                bytes.len()
            );
            let at = List::BufferViews.entry(index);
            return Err(invalid(at, found, "bytes that the buffer has"));
        };
        Ok(View { bytes, stride: view.byte_stride })
    }
}

fn bytes_of<'a>(
    buffer: &schema::Buffer<'_>,
    index: usize,
    bin: Option<&'a [u8]>,
    folder: &mut Folder,
) -> Result<Cow<'a, [u8]>, Error> {
    let at = List::Buffers.entry(index);
    let mut bytes = match (&buffer.uri, bin) {
        (Some(uri), _) => Cow::Owned(folder.read(&uri.0, &format!("{at}.uri"))?),
        (None, Some(bin)) if index == 0 => Cow::Borrowed(bin),
        (None, _) => {
            let accepted = "a URI; the first buffer of a binary file needs none";
            return Err(invalid(at, "it has no bytes", accepted));
        }
    };
    let there = bytes.len() as u64;
    if buffer.byte_length > there {
        let found = format!("{}, but {there} bytes are there", buffer.byte_length);
        return Err(invalid(format_args!("{at}.byteLength"), found, "no more than are there"));
    }
    let length = buffer.byte_length as usize;
    match &mut bytes {
        Cow::Borrowed(bytes) => *bytes = &bytes[..length],
        Cow::Owned(bytes) => bytes.truncate(length),
    }
    Ok(bytes)
}

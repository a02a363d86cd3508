//! Accessors: typed elements in views, checked as a whole before any of them is read.

use super::buffers::Buffers;
use super::document::{List, invalid};
use super::schema;
use crate::{Error, ErrorKind};

/// The most elements of an accessor that has no bytes; they are all zero.
const MOST_ZEROS: u64 = 1 << 20;

/// A type of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::I8 => "i8",
            Self::U8 => "u8",
            Self::I16 => "i16",
            Self::U16 => "u16",
            Self::U32 => "u32",
            Self::F32 => "f32",
        }
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number that `bytes` hold; whole numbers are shares of their range where they are
    /// `normalized`.
    fn float(self, normalized: bool, bytes: &[u8]) -> f32 {
        let (value, range) = match (self, bytes) {
            (Self::I8, [a, ..]) => (f32::from(*a as i8), 127.0),
            (Self::U8, [a, ..]) => (f32::from(*a), 255.0),
            (Self::I16, [a, b, ..]) => (f32::from(i16::from_le_bytes([*a, *b])), 32767.0),
            (Self::U16, [a, b, ..]) => (f32::from(u16::from_le_bytes([*a, *b])), 65535.0),
            (Self::U32, [a, b, c, d, ..]) => {
                (u32::from_le_bytes([*a, *b, *c, *d]) as f32, u32::MAX as f32)
            }
            (Self::F32, [a, b, c, d, ..]) => return f32::from_le_bytes([*a, *b, *c, *d]),
            _ => return 0.0,
        };
        if normalized { (value / range).max(-1.0) } else { value }
    }

    fn whole(self, bytes: &[u8]) -> u32 {
        match (self, bytes) {
            (Self::U8, [a, ..]) => u32::from(*a),
            (Self::U16, [a, b, ..]) => u32::from(u16::from_le_bytes([*a, *b])),
            (Self::U32, [a, b, c, d, ..]) => u32::from_le_bytes([*a, *b, *c, *d]),
            _ => 0,
        }
    }
}

/// What a user of an accessor can read.
pub(super) struct Wanted {
    /// Its name in glTF.
    pub(super) shape: &'static str,
    pub(super) n_components: usize,
    pub(super) components: &'static [Component],
}

use Component::{F32, I8, I16, U8, U16, U32};

/// Positions and normals; whole numbers are those of `KHR_mesh_quantization`.
pub(super) const VECTORS: Wanted =
    Wanted { shape: "VEC3", n_components: 3, components: &[F32, I8, U8, I16, U16] };
/// Texture coordinates, likewise.
pub(super) const PAIRS: Wanted =
    Wanted { shape: "VEC2", n_components: 2, components: &[F32, I8, U8, I16, U16] };
/// Rotations.
pub(super) const QUATERNIONS: Wanted =
    Wanted { shape: "VEC4", n_components: 4, components: &[F32, I8, I16] };
/// Numbers of vertices.
pub(super) const INDICES: Wanted =
    Wanted { shape: "SCALAR", n_components: 1, components: &[U8, U16, U32] };

impl Wanted {
    fn told(&self) -> String {
        let names: Vec<_> = self.components.iter().map(|component| component.name()).collect();
        match names.as_slice() {
            [others @ .., last] if !others.is_empty() => {
                format!("{} of {} or {last}", self.shape, others.join(", "))
            }
            names => format!("{} of {}", self.shape, names.concat()),
        }
    }
}

/// The elements of an accessor; all of them are there.
pub(super) struct Elements<'b> {
    /// The accessor, as messages name it.
    at: String,
    n: usize,
    component: Component,
    normalized: bool,
    /// Where the first one begins; nothing where all are zero.
    dense: Option<Strided<'b>>,
    sparse: Option<Sparse<'b>>,
}

/// Bytes of equal elements, from the first one on.
#[derive(Clone, Copy)]
struct Strided<'b> {
    bytes: &'b [u8],
    stride: usize,
}

/// Elements that stand for others.
struct Sparse<'b> {
    indices: Strided<'b>,
    component: Component,
    values: Strided<'b>,
    n: usize,
}

impl<'b> Elements<'b> {
    /// Looks at accessor `index` for something at `user`.
    pub(super) fn of(
        buffers: &'b Buffers<'_>,
        index: usize,
        user: &str,
        wanted: &Wanted,
    ) -> Result<Self, Error> {
        let accessor: schema::Accessor<'_> = buffers.document.get(List::Accessors, index, user)?;
        let at = List::Accessors.entry(index);
        let component = Component::of(accessor.component_type).ok_or_else(|| {
            let found = accessor.component_type.to_string();
            invalid(format_args!("{at}.componentType"), found, "5120 to 5123, 5125 or 5126")
        })?;
        let is_wanted = accessor.shape.0 == wanted.shape && wanted.components.contains(&component);
        if !is_wanted {
            let shape = &accessor.shape.0;
            let shape = if shape.len() > 10 { accessor.shape.quoted() } else { shape.to_string() };
            let found = format!("{at} holds {shape} of {}", component.name());
            return Err(invalid(user, found, wanted.told()));
        }
        let size = component.size() * wanted.n_components;
        let dense = match accessor.buffer_view {
            Some(view) => {
                let place = (view, accessor.byte_offset);
                Some(strided(buffers, place, (accessor.count, size), &at)?)
            }
            None if accessor.count > MOST_ZEROS => {
                let (found, limit) = (accessor.count, MOST_ZEROS);
                let what = "elements without bytes";
                return Err(Error::new(ErrorKind::OverLimit { at, found, what, limit }));
            }
            None => None,
        };
        let sparse = match &accessor.sparse {
            Some(sparse) => Some(Sparse::of(buffers, sparse, (accessor.count, size), &at)?),
            None => None,
        };
        // Bytes are there for each of them, so they can be counted in a machine word.
        let n = accessor.count as usize;
        Ok(Self { at, n, component, normalized: accessor.normalized, dense, sparse })
    }

    pub(super) fn len(&self) -> usize {
        self.n
    }

    /// Whether any of them is more than zero by default.
    pub(super) fn has_bytes(&self) -> bool {
        self.dense.is_some() || self.sparse.is_some()
    }

    /// As messages name the accessor.
    pub(super) fn at(&self) -> &str {
        &self.at
    }

    /// Whether some of them stand for others.
    pub(super) fn is_sparse(&self) -> bool {
        self.sparse.is_some()
    }

    /// Reads vectors of `N` numbers, as many as were wanted: all of them, or those with the rising
    /// numbers `chosen`, which are there.
    pub(super) fn floats<const N: usize>(
        &self,
        chosen: Option<&[u32]>,
    ) -> Result<Vec<[f32; N]>, Error> {
        let size = self.component.size();
        let read = |bytes: &[u8]| {
            let mut vector = [0.0; N];
            for (number, bytes) in vector.iter_mut().zip(bytes.chunks_exact(size)) {
                *number = self.component.float(self.normalized, bytes);
            }
            vector
        };
        let Some(chosen) = chosen else { return self.read([0.0; N], N * size, read) };
        if self.is_sparse() {
            let all = self.read([0.0; N], N * size, read)?;
            return Ok(chosen.iter().map(|i| all[*i as usize]).collect());
        }
        Ok(match &self.dense {
            Some(dense) => {
                chosen.iter().map(|i| read(dense.element(*i as usize, N * size))).collect()
            }
            None => vec![[0.0; N]; chosen.len()],
        })
    }

    /// Reads whole numbers.
    pub(super) fn whole_numbers(&self) -> Result<Vec<u32>, Error> {
        self.read(0, self.component.size(), |bytes| self.component.whole(bytes))
    }

    fn read<T: Clone>(
        &self,
        zero: T,
        size: usize,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, Error> {
        let mut elements = match &self.dense {
            Some(dense) => {
                let mut elements = Vec::with_capacity(self.n);
                elements.extend((0..self.n).map(|i| read(dense.element(i, size))));
                elements
            }
            None => vec![zero; self.n],
        };
        let Some(sparse) = &self.sparse else { return Ok(elements) };
        let mut next = 0;
        for i in 0..sparse.n {
            let index = sparse.component.whole(sparse.indices.element(i, sparse.component.size()));
            let Some(place) = elements.get_mut(index as usize).filter(|_| index >= next) else {
                let at = format_args!("{}.sparse.indices", self.at);
                let accepted = format!("rising numbers below {}", self.n);
                return Err(invalid(at, format!("number {i} is {index}"), accepted));
            };
            *place = read(sparse.values.element(i, size));
            next = index.saturating_add(1);
        }
        Ok(elements)
    }
}

impl<'b> Sparse<'b> {
    fn of(
        buffers: &'b Buffers<'_>,
        sparse: &schema::Sparse,
        (n_elements, size): (u64, usize),
        at: &str,
    ) -> Result<Self, Error> {
        let schema::Sparse { count, indices, values } = sparse;
        if *count > n_elements {
            let accepted = format!("at most {n_elements}");
            return Err(invalid(format_args!("{at}.sparse.count"), count.to_string(), accepted));
        }
        let component = Component::of(indices.component_type);
        let component = component
            .filter(|component| INDICES.components.contains(component))
            .ok_or_else(|| {
                let at = format_args!("{at}.sparse.indices.componentType");
                invalid(at, indices.component_type.to_string(), "5121, 5123 or 5125")
            })?;
        let place = (indices.buffer_view, indices.byte_offset);
        let what = (*count, component.size());
        let indices = strided(buffers, place, what, &format!("{at}.sparse.indices"))?;
        let place = (values.buffer_view, values.byte_offset);
        let values = strided(buffers, place, (*count, size), &format!("{at}.sparse.values"))?;
        Ok(Self { indices, component, values, n: *count as usize })
    }
}

impl<'b> Strided<'b> {
    fn element(&self, i: usize, size: usize) -> &'b [u8] {
        &self.bytes[i * self.stride..][..size]
    }
}

/// `count` elements of `size` bytes in a view, for something at `at`; all of them are there.
fn strided<'b>(
    buffers: &'b Buffers<'_>,
    (view, offset): (usize, u64),
    (count, size): (u64, usize),
    at: &str,
) -> Result<Strided<'b>, Error> {
    let index = view;
    let view = buffers.view(index, &format!("{at}.bufferView"))?;
    let stride = view.stride.unwrap_or(size as u64);
    if stride < size as u64 {
        let at = format!("{}.byteStride", List::BufferViews.entry(index));
        return Err(invalid(
            at,
            stride.to_string(),
            format!("{size} or more, for elements of as many bytes"),
        ));
    }
    let there = view.bytes.len() as u64;
    let end = match count.checked_sub(1) {
        None => Some(offset),
        Some(last) => last
            .checked_mul(stride)
            .and_then(|end| end.checked_add(size as u64))
            .and_then(|end| end.checked_add(offset)),
    };
    if end.is_none_or(|end| end > there) {
        let found = format!(
            "{count} elements of {size} bytes, {stride} apart, from byte {offset} on, in a view of \
             {there}"
        );
        return Err(invalid(at, found, "elements that are there"));
    }
    Ok(Strided { bytes: &view.bytes[offset as usize..], stride: stride as usize })
}

//! Content digests: 128 bits that stand for a value's content.
//!
//! Two values with equal digests are taken to be equal, so a type must write everything that
//! tells its values apart. The hash is SipHash-1-3 with 128 bits of output and fixed keys: the
//! same on every machine and in every run.

use std::hash::Hasher as _;
use std::ops::Deref;
use std::sync::{Arc, LazyLock, OnceLock};

use glam::{Affine3, Mat3, Quat, Vec2, Vec3, Vec4};
use siphasher::sip128::{Hasher128 as _, SipHasher13};

/// 128 bits that stand for a value's content.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Digest {
    // Two halves, for a u128 would make every row that holds a digest align to 16 bytes.
    high: u64,
    low: u64,
}

impl Digest {
    /// The digest with these bits.
    pub const fn from_bits(bits: u128) -> Self {
        Self { high: (bits >> 64) as u64, low: bits as u64 }
    }

    /// The bits.
    pub const fn bits(self) -> u128 {
        (self.high as u128) << 64 | self.low as u128
    }

    /// The digest of one value.
    pub fn of<T: Content + ?Sized>(value: &T) -> Self {
        let mut digester = Digester::new();
        value.write(&mut digester);
        digester.finish()
    }
}

impl std::fmt::Debug for Digest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:032x}", self.bits())
    }
}

/// Something whose content can be digested.
///
/// Write every field that tells two values apart, each in a fixed order, with a length before
/// anything of variable length. Floats count by their bits.
pub trait Content {
    /// Feeds the value's content to `digester`.
    fn write(&self, digester: &mut Digester);
}

/// Collects content and ends in a [`Digest`].
pub struct Digester {
    hasher: SipHasher13,
    /// Bytes that the hasher has not seen yet. Content comes in numbers of a few bytes each, and
    /// the hasher is several times as fast on long runs of them.
    pending: [u8; PENDING],
    n_pending: usize,
}

const PENDING: usize = 128;

impl Digester {
    /// An empty digester.
    pub fn new() -> Self {
        Self { hasher: SipHasher13::new(), pending: [0; PENDING], n_pending: 0 }
    }

    /// Adds raw bytes, without their length.
    #[inline]
    pub fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        let end = self.n_pending + bytes.len();
        match self.pending.get_mut(self.n_pending..end) {
            Some(room) => {
                room.copy_from_slice(bytes);
                self.n_pending = end;
            }
            None => self.hash(bytes),
        }
        self
    }

    /// Adds a few bytes whose number is known when this is compiled.
    #[inline(always)]
    fn fixed<const N: usize>(&mut self, bytes: [u8; N]) {
        match self.pending[self.n_pending.min(PENDING)..].first_chunk_mut() {
            Some(room) => {
                *room = bytes;
                self.n_pending += N;
            }
            None => self.hash(&bytes),
        }
    }

    /// Hashes what is pending, and these bytes where they are many.
    #[cold]
    fn hash(&mut self, bytes: &[u8]) {
        self.hasher.write(&self.pending[..self.n_pending]);
        self.n_pending = 0;
        match self.pending.get_mut(..bytes.len()) {
            Some(room) => {
                room.copy_from_slice(bytes);
                self.n_pending = bytes.len();
            }
            None => self.hasher.write(bytes),
        }
    }

    /// Adds a value.
    pub fn add<T: Content + ?Sized>(&mut self, value: &T) -> &mut Self {
        value.write(self);
        self
    }

    /// The digest of everything added so far.
    pub fn finish(&self) -> Digest {
        let mut hasher = self.hasher;
        hasher.write(&self.pending[..self.n_pending]);
        Digest::from_bits(hasher.finish128().as_u128())
    }
}

impl Default for Digester {
    fn default() -> Self {
        Self::new()
    }
}

macro_rules! content_by_bytes {
    ($($t:ty),*) => {$(
        impl Content for $t {
            #[inline]
            fn write(&self, digester: &mut Digester) {
                digester.fixed(self.to_le_bytes());
            }
        }
    )*};
}
content_by_bytes!(u8, u16, u32, u64, u128, i8, i16, i32, i64, f32, f64);

impl Content for usize {
    fn write(&self, digester: &mut Digester) {
        (*self as u64).write(digester);
    }
}

impl Content for bool {
    fn write(&self, digester: &mut Digester) {
        u8::from(*self).write(digester);
    }
}

impl Content for () {
    fn write(&self, _: &mut Digester) {}
}

impl Content for str {
    fn write(&self, digester: &mut Digester) {
        self.len().write(digester);
        digester.bytes(self.as_bytes());
    }
}

impl Content for String {
    fn write(&self, digester: &mut Digester) {
        self.as_str().write(digester);
    }
}

impl Content for Digest {
    fn write(&self, digester: &mut Digester) {
        self.bits().write(digester);
    }
}

impl<T: Content + ?Sized> Content for &T {
    fn write(&self, digester: &mut Digester) {
        (**self).write(digester);
    }
}

impl<T: Content + ?Sized> Content for Arc<T> {
    fn write(&self, digester: &mut Digester) {
        (**self).write(digester);
    }
}

impl<T: Content> Content for Option<T> {
    fn write(&self, digester: &mut Digester) {
        match self {
            None => 0u8.write(digester),
            Some(value) => {
                1u8.write(digester);
                value.write(digester);
            }
        }
    }
}

impl<T: Content> Content for [T] {
    fn write(&self, digester: &mut Digester) {
        self.len().write(digester);
        for value in self {
            value.write(digester);
        }
    }
}

impl<T: Content, const N: usize> Content for [T; N] {
    fn write(&self, digester: &mut Digester) {
        for value in self {
            value.write(digester);
        }
    }
}

impl<T: Content> Content for Vec<T> {
    fn write(&self, digester: &mut Digester) {
        self.as_slice().write(digester);
    }
}

impl<A: Content, B: Content> Content for (A, B) {
    fn write(&self, digester: &mut Digester) {
        self.0.write(digester);
        self.1.write(digester);
    }
}

macro_rules! content_by_floats {
    ($($t:ty => $n:literal),*) => {$(
        impl Content for $t {
            #[inline]
            fn write(&self, digester: &mut Digester) {
                let floats: [f32; $n] = self.to_array();
                let mut bytes = [0; $n * 4];
                for (chunk, float) in bytes.chunks_exact_mut(4).zip(floats) {
                    chunk.copy_from_slice(&float.to_le_bytes());
                }
                digester.fixed(bytes);
            }
        }
    )*};
}
content_by_floats!(Vec2 => 2, Vec3 => 3, Vec4 => 4, Quat => 4);

impl Content for Mat3 {
    fn write(&self, digester: &mut Digester) {
        self.x_axis.write(digester);
        self.y_axis.write(digester);
        self.z_axis.write(digester);
    }
}

impl Content for Affine3 {
    fn write(&self, digester: &mut Digester) {
        self.matrix3.write(digester);
        self.translation.write(digester);
    }
}

/// A shared value that takes its digest at most once.
///
/// Use it for content that travels through several components: the bytes are digested the first
/// time that somebody asks, and never again.
pub struct Shared<T>(Arc<Inner<T>>);

struct Inner<T> {
    digest: OnceLock<Digest>,
    value: Value<T>,
}

enum Value<T> {
    Here(T),
    /// Made when somebody looks for the first time.
    Later(LazyLock<Shared<T>, Maker<T>>),
}

type Maker<T> = Box<dyn FnOnce() -> Shared<T> + Send + Sync>;

impl<T: Content> Shared<T> {
    /// Shares `value`; its content is not looked at yet.
    pub fn new(value: T) -> Self {
        Self(Arc::new(Inner { digest: OnceLock::new(), value: Value::Here(value) }))
    }

    /// The digest of the value; the first call costs one pass over its content.
    pub fn digest(&self) -> Digest {
        *self.0.digest.get_or_init(|| Digest::of(&**self))
    }
}

impl<T> Shared<T> {
    /// Shares `value` under a digest that the caller vouches for: equal digests must mean equal
    /// values. For values that follow from something digested already.
    pub fn with_digest(digest: Digest, value: T) -> Self {
        Self(Arc::new(Inner { digest: OnceLock::from(digest), value: Value::Here(value) }))
    }

    /// Shares what `make` will make when somebody looks at it for the first time, if ever, under
    /// a digest that the caller vouches for as for [`with_digest`](Self::with_digest).
    ///
    /// Whoever looks while it is being made waits; `make` must not look at what it makes.
    pub fn later(digest: Digest, make: impl FnOnce() -> Shared<T> + Send + Sync + 'static) -> Self {
        let value = Value::Later(LazyLock::new(Box::new(make)));
        Self(Arc::new(Inner { digest: OnceLock::from(digest), value }))
    }

    /// Whether both are one and the same allocation.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Deref for Shared<T> {
    type Target = T;

    fn deref(&self) -> &T {
        match &self.0.value {
            Value::Here(value) => value,
            Value::Later(value) => value,
        }
    }
}

impl<T: Content> Content for Shared<T> {
    fn write(&self, digester: &mut Digester) {
        self.digest().write(digester);
    }
}

impl<T: Content> PartialEq for Shared<T> {
    fn eq(&self, other: &Self) -> bool {
        self.is_same(other) || self.digest() == other.digest()
    }
}

impl<T: std::fmt::Debug> std::fmt::Debug for Shared<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        (**self).fmt(f)
    }
}

/// Implements [`Content`] for a struct by writing the listed fields in order.
///
/// ```
/// use sapwood_geom::{content, Digest};
/// struct Pole { height: f32, radius: f32 }
/// content!(Pole { height, radius });
/// assert_ne!(
///     Digest::of(&Pole { height: 1.0, radius: 0.1 }),
///     Digest::of(&Pole { height: 0.1, radius: 1.0 }),
/// );
/// ```
#[macro_export]
macro_rules! content {
    ($t:ty { $($field:ident),* $(,)? }) => {
        impl $crate::Content for $t {
            fn write(&self, digester: &mut $crate::Digester) {
                // A field added to the type and not to the list fails to compile here.
                let Self { $($field),* } = self;
                $($crate::Content::write($field, digester);)*
                let _ = digester;
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_keep_neighbours_apart() {
        assert_ne!(Digest::of(&vec![vec![1u8], vec![]]), Digest::of(&vec![vec![], vec![1u8]]));
        assert_ne!(Digest::of(&("ab", "c")), Digest::of(&("a", "bc")));
    }

    #[test]
    fn content_counts_however_it_is_cut_into_pieces() {
        let bytes: Vec<u8> = (0..1000u32).map(|i| (i * i) as u8).collect();
        let whole = Digester::new().bytes(&bytes).finish();
        for piece in [1, 3, 8, 127, 128, 129, 500] {
            let mut digester = Digester::new();
            bytes.chunks(piece).for_each(|piece| _ = digester.bytes(piece));
            assert_eq!(digester.finish(), whole, "{piece}");
        }
    }

    #[test]
    fn shared_content_counts_by_value() {
        let (a, b) = (Shared::new(vec![1u32, 2]), Shared::new(vec![1u32, 2]));
        assert_eq!(a, b);
        assert_ne!(a, Shared::new(vec![1u32, 3]));
    }

    #[test]
    fn what_is_made_later_is_made_once_and_not_for_its_digest() {
        let made = Arc::new(std::sync::atomic::AtomicU32::new(0));
        let count = Arc::clone(&made);
        let digest = Digest::of("two numbers");
        let later = Shared::later(digest, move || {
            count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            Shared::new(vec![1u32, 2])
        });
        let other = later.clone();
        let n_made = || made.load(std::sync::atomic::Ordering::Relaxed);
        assert_eq!((later.digest(), other == later, n_made()), (digest, true, 0));
        assert_eq!((other[1], later.len(), n_made()), (2, 2, 1));
    }

    #[test]
    fn digests_are_the_same_in_every_run() {
        assert_eq!(format!("{:?}", Digest::of(&1.5f32)).len(), 32);
        assert_eq!(Digest::of("sapwood"), Digest::of(&String::from("sapwood")));
    }
}

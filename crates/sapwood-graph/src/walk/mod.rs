//! Walks: reading a render graph in one of four orders, and discovering what is still to be
//! compiled for it.
//!
//! A traversal runs in two steps. [`discover`] descends only where something is missing or may
//! be out of date, notes wants, has them provided and goes on below them. [`walk`] then reads.
//! Neither recurses on the machine stack.

mod discover;
mod interest;
mod order;

pub use discover::discover;
pub use interest::{Approach, Everything, Inside, Interest, Under};
pub use order::{At, Order, Path, walk};

use crate::{Interrupted, Provide};

/// Compiles what `interest` asks for, then walks over it and calls `visitor` for every node.
///
/// # Errors
/// When compiling was cancelled or a budget ran out; nothing is walked then.
pub fn traverse<I: Interest>(
    provide: &mut dyn Provide,
    order: Order,
    interest: &I,
    visitor: &mut dyn FnMut(&At<'_, I::State>),
) -> Result<(), Interrupted> {
    discover(provide, interest)?;
    walk(&*provide, order, interest, visitor);
    Ok(())
}

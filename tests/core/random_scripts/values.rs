//! What value sub-graphs answer: every occurrence in them asked in turn.

use super::mirror::Mirror;
use super::what::{Push, Pushes, What};
use sapwood::scene::PushMode;

/// Something in a value sub-graph cannot be asked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unanswerable;

/// What the sub-graph that a node asks answers: what its components offer, combined.
pub(super) fn answer<T>(
    mirror: &Mirror,
    effective: &[Option<What>],
    node: usize,
    offer: impl Fn(&What) -> Option<T>,
    combine: impl Fn(T, T) -> T,
) -> Result<Option<T>, Unanswerable> {
    let mut answer = None;
    let mut stack: Vec<usize> = mirror.nodes[node].asks.into_iter().collect();
    while let Some(at) = stack.pop() {
        let what = effective[at].ok_or(Unanswerable)?;
        if let Some(offered) = offer(&what) {
            answer = Some(match answer {
                None => offered,
                Some(earlier) => combine(earlier, offered),
            });
        }
        let children = mirror.nodes[at].children.iter().map(|(child, _)| *child);
        match what {
            What::Switch(false) | What::Selector(None) => {}
            What::Selector(Some(shown)) => stack.extend(children.skip(shown).take(1)),
            _ => stack.extend(children.rev()),
        }
    }
    Ok(answer)
}

/// What an attribute offers of a slot that it pushes.
pub(super) fn pushed<T>(what: &What, push: impl Fn(&Pushes) -> Option<Push<T>>) -> Option<T> {
    let What::Attribute(pushes) = what else { return None };
    let push = push(pushes).filter(|push| push.mode != PushMode::Inherit)?;
    push.held
}

//! The one opening between whoever compiles plans and whoever walks them.

use std::any::Any;
use std::fmt;

use sapwood_geom::Bound;
use sapwood_geom::glam::Affine3;

use crate::{Eye, Fragment, Interfaces, Kind, Parts};

/// A plan in a context; what walks step on. Valid within one traversal: afterwards numbers
/// may be used again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SiteId(pub u32);

/// The environment of a place: the chain of slot pushes above it. Valid within one traversal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct EnvId(pub u32);

/// An unfilled link that a walk met, and the environment it met it in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Want {
    /// The environment of the site.
    pub env: EnvId,
    /// The site whose link is unfilled.
    pub site: SiteId,
    /// The number of the link.
    pub link: u32,
}

/// What stands behind a link at the moment.
#[derive(Clone, Copy, Debug)]
pub enum Supplied<'a> {
    /// The child's site, up to date itself; what is below it may not be.
    Ready(SiteId),
    /// The child's site as it was before something that it read changed.
    Previous(SiteId),
    /// Nothing yet, but the rule told a bound.
    Foreseen(&'a Bound),
    /// Nothing yet.
    Unknown,
    /// Nothing, for a reason that compiling again would not mend.
    Failed(&'a Diagnostic),
}

/// What walks see of a plan.
#[derive(Clone, Copy)]
pub struct PlanRef<'a> {
    /// The kind of the component that was compiled.
    pub kind: Kind,
    /// Whether the component was placed in the scene by the user, not emitted by a rule.
    pub authored: bool,
    /// The render nodes.
    pub fragment: &'a Fragment,
    /// What the rule made for its `visit` and for handlers.
    pub data: &'a (dyn Any + Send + Sync),
    /// As what the rule offers its data.
    pub interfaces: &'a Interfaces,
    /// The plan's parts.
    pub parts: &'a Parts,
    /// The site's live values.
    pub live: &'a [Affine3],
    /// Why the component could not be compiled, if it could not.
    pub error: Option<&'a Diagnostic>,
}

/// Hands out compiled plans to walks. Walks only read.
pub trait Supply: Sync {
    /// Where walks begin.
    fn root(&self) -> (EnvId, SiteId);

    /// The plan of a site.
    fn plan(&self, site: SiteId) -> PlanRef<'_>;

    /// What stands behind `link` of `site` in `env`, and the environment there.
    fn enter(&self, env: EnvId, site: SiteId, link: u32) -> (EnvId, Supplied<'_>);

    /// Whether everything below the site is compiled and up to date, so that no walk below it
    /// can meet a want.
    fn is_settled(&self, site: SiteId) -> bool;

    /// The bound of everything below the site in the site's own frame, where it is known.
    fn bound(&self, site: SiteId) -> Option<&Bound>;

    /// From where the view is looked at, in the root's frame, if that is known: what faces the
    /// eye turns to it.
    fn eye(&self) -> Option<&Eye>;
}

/// Fills wants between walks.
pub trait Provide: Supply {
    /// Compiles and links what is wanted, as one batch.
    ///
    /// A want whose environment no longer fits its site is left alone: a further pass from the
    /// root meets it again at its proper place.
    ///
    /// # Errors
    /// When the caller cancelled or a budget ran out; what was done so far stays.
    fn provide(&mut self, wants: &[Want]) -> Result<(), Interrupted>;

    /// Opens a pass over the graph: environments of the pass before are forgotten.
    fn begin_pass(&mut self);

    /// Closes a pass: brings up to date what sites know of everything below them.
    fn settle(&mut self);
}

/// Why a traversal ended before it was complete.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Interrupted {
    /// The caller asked for it.
    Cancelled,
    /// A budget ran out.
    Exhausted {
        /// What ran out, in words: `triangles`.
        what: &'static str,
        /// How much was allowed.
        limit: u64,
        /// Kind of the component whose compiling, or picking, went beyond the limit.
        component: &'static str,
    },
}

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cancelled => f.write_str("cancelled"),
            Self::Exhausted { what, limit, component } => {
                write!(
                    f,
                    "more than {limit} {what} would be needed; the limit was met in a component \
                     of kind {component}"
                )
            }
        }
    }
}

impl std::error::Error for Interrupted {}

/// Why a component or a link yields nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The kind of the component concerned.
    pub kind: Kind,
    /// What went wrong, in words.
    pub message: String,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind, self.message)
    }
}

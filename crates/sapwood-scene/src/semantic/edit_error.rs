//! Why an edit is refused. A refused edit changes nothing.

use std::fmt;

use crate::NodeId;

/// Why an edit is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EditError {
    /// The node was removed, or belongs to another scene.
    Gone {
        /// The node.
        node: NodeId,
    },
    /// The component can hold no child, or has its only one already.
    Full {
        /// The would-be parent.
        parent: NodeId,
        /// Its kind.
        kind: &'static str,
    },
    /// The node is no child of the parent.
    NotAChild {
        /// The parent.
        parent: NodeId,
        /// The node that is not among its children.
        child: NodeId,
    },
    /// There is no child at this place.
    OutOfRange {
        /// The parent.
        parent: NodeId,
        /// The place asked for.
        index: usize,
        /// How many children there are.
        len: usize,
    },
    /// The edge would close a cycle.
    Cycle {
        /// The nodes from the would-be child down to the would-be parent, with their kinds.
        path: Vec<(NodeId, &'static str)>,
    },
}

impl fmt::Display for EditError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gone { node } => write!(f, "node {node:?} is not in the scene"),
            Self::Full { parent, kind } => {
                write!(f, "{kind} {parent:?} cannot hold another child")
            }
            Self::NotAChild { parent, child } => {
                write!(f, "node {child:?} is no child of node {parent:?}")
            }
            Self::OutOfRange { parent, index, len } => {
                write!(f, "node {parent:?} has {len} children, there is none at {index}")
            }
            Self::Cycle { path } => {
                f.write_str("the edge would close a cycle: ")?;
                let n = path.len();
                for (i, (node, kind)) in path.iter().enumerate() {
                    if n > 8 && i == 4 {
                        write!(f, "... {} more ... -> ", n - 7)?;
                    }
                    if n <= 8 || i < 4 || i >= n - 3 {
                        write!(f, "{kind} {node:?} -> ")?;
                    }
                }
                f.write_str("itself")
            }
        }
    }
}

impl std::error::Error for EditError {}

//! Which parts a drawn node shows, so that whoever picks a triangle learns which leaf it is.
//!
//! The parts themselves may lie in the plan that holds the node, or in one above it: a surface
//! shows the stems of the branch that emitted it.

use std::sync::Arc;

use sapwood_geom::{Content, Digester};

use crate::{Kind, Part};

/// Which parts a drawn node shows: rows of one kind, in the nearest plan, from the node's own
/// upwards, that has parts of that kind.
///
/// What is counted are the triangles of a mesh, the instances of a repeated mesh, or lines.
#[derive(Clone, Debug)]
pub struct Shown {
    kind: Kind,
    /// For each row, the number behind the last that shows it; nothing where number `i` shows
    /// row `i`.
    ends: Option<Arc<[u32]>>,
    /// For each of `ends`, the row; nothing where they show one after the other.
    rows: Option<Arc<[u32]>>,
}

impl Shown {
    /// Instance or line `i` shows row `i` of the parts of type `P`.
    pub fn each<P: Part>() -> Self {
        Self { kind: Kind::of::<P>(), ends: None, rows: None }
    }

    /// Row `i` of the parts of type `P` is shown by the triangles, instances or lines from
    /// `ends[i - 1]` up to but not including `ends[i]`.
    pub fn spans<P: Part>(ends: impl Into<Arc<[u32]>>) -> Self {
        Self { kind: Kind::of::<P>(), ends: Some(ends.into()), rows: None }
    }

    /// Row `rows[i]` of the parts of type `P` is shown by the triangles, instances or lines from
    /// `ends[i - 1]` up to but not including `ends[i]`; several of these may show one row.
    pub fn rows<P: Part>(ends: impl Into<Arc<[u32]>>, rows: impl Into<Arc<[u32]>>) -> Self {
        Self { kind: Kind::of::<P>(), ends: Some(ends.into()), rows: Some(rows.into()) }
    }

    /// The largest row that anything shows, of `n` triangles, instances or lines.
    pub fn largest_row(&self, n: usize) -> Option<u32> {
        match &self.rows {
            Some(rows) => rows.iter().max().copied(),
            None => self.row((n as u32).checked_sub(1)?),
        }
    }

    /// The kind of the parts.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The row that triangle, instance or line `number` shows; nothing behind the last.
    pub fn row(&self, number: u32) -> Option<u32> {
        let Some(ends) = &self.ends else { return Some(number) };
        let row = ends.partition_point(|end| *end <= number);
        match &self.rows {
            Some(rows) => rows.get(row).copied(),
            None => (row < ends.len()).then_some(row as u32),
        }
    }

    /// What is wrong, in words, for a node that draws `n` triangles, instances or lines.
    pub fn fault(&self, n: usize) -> Option<String> {
        let ends = self.ends.as_deref()?;
        if self.rows.as_ref().is_some_and(|rows| rows.len() != ends.len()) {
            return Some(format!("spans of {} that show too many rows or too few", self.kind));
        }
        let is_ordered = ends.is_sorted() && ends.last().is_none_or(|end| *end as usize <= n);
        (!is_ordered).then(|| format!("spans of {} that are not in order up to {n}", self.kind))
    }
}

impl Content for Shown {
    fn write(&self, digester: &mut Digester) {
        digester.add(self.kind.name());
        match &self.ends {
            None => digester.add(&0u8),
            Some(ends) => digester.add(&1u8).add(ends),
        };
        if let Some(rows) = &self.rows {
            digester.add(rows);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Named;
    use sapwood_geom::content;

    struct Pip;
    content!(Pip {});
    impl Named for Pip {
        const NAME: &'static str = "pip";
    }
    impl Part for Pip {}

    #[test]
    fn rows_are_found_by_their_spans() {
        let shown = Shown::spans::<Pip>([2, 2, 5]);
        let rows = [0, 1, 2, 4, 5].map(|number| shown.row(number));
        assert_eq!(rows, [Some(0), Some(0), Some(2), Some(2), None]);
        assert_eq!(Shown::each::<Pip>().row(7), Some(7));
        assert_eq!(shown.fault(5), None);
        assert!(shown.fault(4).is_some());
        assert!(Shown::spans::<Pip>([3, 1]).fault(9).is_some());
        let mixed = Shown::rows::<Pip>([2, 3, 5], [7, 0, 7]);
        assert_eq!([0, 2, 4, 5].map(|number| mixed.row(number)), [Some(7), Some(0), Some(7), None]);
        assert_eq!((mixed.largest_row(5), mixed.fault(5)), (Some(7), None));
        assert!(Shown::rows::<Pip>([2], [7, 0]).fault(5).is_some());
    }
}

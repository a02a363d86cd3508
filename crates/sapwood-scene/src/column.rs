//! Columns: the one type in which rows are stored.
//!
//! Rows are addressed by number and numbers are used again. Everything goes through these few
//! functions, so that the storage can become pages when snapshots need cheap copies.

use std::any::Any;

/// Rows of one type, addressed by number.
#[derive(Debug)]
pub(crate) struct Column<T> {
    rows: Vec<Option<T>>,
    free: Vec<u32>,
}

impl<T> Column<T> {
    pub(crate) fn new() -> Self {
        Self { rows: Vec::new(), free: Vec::new() }
    }

    /// Stores a row and tells its number.
    pub(crate) fn insert(&mut self, row: T) -> u32 {
        if let Some(number) = self.free.pop() {
            self.rows[number as usize] = Some(row);
            return number;
        }
        let number = u32::try_from(self.rows.len()).expect("a column has fewer than 2^32 rows");
        self.rows.push(Some(row));
        number
    }

    /// Takes a row out; its number may be used again.
    pub(crate) fn remove(&mut self, number: u32) -> Option<T> {
        let row = self.rows.get_mut(number as usize)?.take();
        if row.is_some() {
            self.free.push(number);
        }
        row
    }

    pub(crate) fn get(&self, number: u32) -> Option<&T> {
        self.rows.get(number as usize)?.as_ref()
    }

    pub(crate) fn get_mut(&mut self, number: u32) -> Option<&mut T> {
        self.rows.get_mut(number as usize)?.as_mut()
    }

    /// How many rows there are.
    pub(crate) fn len(&self) -> usize {
        self.rows.len() - self.free.len()
    }

    /// The rows with their numbers, in order of number.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, &T)> {
        self.rows.iter().enumerate().filter_map(|(i, row)| Some((i as u32, row.as_ref()?)))
    }
}

/// For numbers that are known to be in use; a wrong one is a fault of this crate.
impl<T> std::ops::Index<u32> for Column<T> {
    type Output = T;

    fn index(&self, number: u32) -> &T {
        self.rows[number as usize].as_ref().expect("the row is in use")
    }
}

impl<T> std::ops::IndexMut<u32> for Column<T> {
    fn index_mut(&mut self, number: u32) -> &mut T {
        self.rows[number as usize].as_mut().expect("the row is in use")
    }
}

/// A column whose type is forgotten.
pub(crate) trait AnyColumn: Send + Sync {
    /// The row with this number, which must be in use.
    fn row(&self, number: u32) -> &(dyn Any + Send + Sync);
    /// Takes a row out.
    fn discard(&mut self, number: u32);
    /// Stores a row of the column's own type.
    fn insert_boxed(&mut self, row: Box<dyn Any>) -> u32;
    /// The column itself, for whoever knows its type.
    fn as_any_mut(&mut self) -> &mut dyn Any;
}

impl<T: Any + Send + Sync> AnyColumn for Column<T> {
    fn row(&self, number: u32) -> &(dyn Any + Send + Sync) {
        &self[number]
    }

    fn discard(&mut self, number: u32) {
        self.remove(number);
    }

    fn insert_boxed(&mut self, row: Box<dyn Any>) -> u32 {
        let row = row.downcast::<T>().expect("rows go to the column of their own type");
        self.insert(*row)
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_used_again() {
        let mut column = Column::new();
        let (a, b) = (column.insert('a'), column.insert('b'));
        assert_eq!(column.remove(a), Some('a'));
        assert_eq!(column.remove(a), None);
        assert_eq!(column.insert('c'), a);
        assert_eq!(column.iter().collect::<Vec<_>>(), [(a, &'c'), (b, &'b')]);
        assert_eq!((column.len(), column.get(7)), (2, None));
    }
}

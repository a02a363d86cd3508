//! Columns: the one type in which rows are stored.
//!
//! Rows are addressed by number and numbers are used again. They lie in pages, so that a column
//! that grows moves none of its rows beyond the first page, and touches no memory twice. Everything
//! goes through these few functions, so that pages can be shared when snapshots need cheap copies.

use std::any::Any;

/// Rows in a page, as a power of two.
const PAGE_BITS: u32 = 10;

const PAGE: usize = 1 << PAGE_BITS;

/// Rows of one type, addressed by number.
#[derive(Debug)]
pub(crate) struct Column<T> {
    /// All of them full but the last. The first grows as vectors do: most columns are short.
    pages: Vec<Vec<Option<T>>>,
    free: Vec<u32>,
}

impl<T> Column<T> {
    pub(crate) fn new() -> Self {
        Self { pages: Vec::new(), free: Vec::new() }
    }

    /// Stores a row and tells its number.
    pub(crate) fn insert(&mut self, row: T) -> u32 {
        if let Some(number) = self.free.pop() {
            let (page, place) = place(number);
            self.pages[page][place] = Some(row);
            return number;
        }
        if self.pages.last().is_none_or(|page| page.len() == PAGE) {
            let size = if self.pages.is_empty() { 0 } else { PAGE };
            self.pages.push(Vec::with_capacity(size));
        }
        let number = u32::try_from(self.n_numbers()).expect("a column has fewer than 2^32 rows");
        if let Some(page) = self.pages.last_mut() {
            page.push(Some(row));
        }
        number
    }

    /// How many numbers were ever given.
    fn n_numbers(&self) -> usize {
        self.pages.last().map_or(0, |last| (self.pages.len() - 1) * PAGE + last.len())
    }

    /// Takes a row out; its number may be used again.
    pub(crate) fn remove(&mut self, number: u32) -> Option<T> {
        let (page, place) = place(number);
        let row = self.pages.get_mut(page)?.get_mut(place)?.take();
        if row.is_some() {
            self.free.push(number);
        }
        row
    }

    pub(crate) fn get(&self, number: u32) -> Option<&T> {
        let (page, place) = place(number);
        self.pages.get(page)?.get(place)?.as_ref()
    }

    pub(crate) fn get_mut(&mut self, number: u32) -> Option<&mut T> {
        let (page, place) = place(number);
        self.pages.get_mut(page)?.get_mut(place)?.as_mut()
    }

    /// How many rows there are.
    pub(crate) fn len(&self) -> usize {
        self.n_numbers() - self.free.len()
    }

    /// The rows with their numbers, in order of number.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, &T)> {
        let rows = self.pages.iter().flatten().enumerate();
        rows.filter_map(|(i, row)| Some((i as u32, row.as_ref()?)))
    }
}

/// The page of a row, and its place there.
fn place(number: u32) -> (usize, usize) {
    ((number >> PAGE_BITS) as usize, number as usize & (PAGE - 1))
}

/// For numbers that are known to be in use; a wrong one is a fault of this crate.
impl<T> std::ops::Index<u32> for Column<T> {
    type Output = T;

    fn index(&self, number: u32) -> &T {
        let (page, place) = place(number);
        self.pages[page][place].as_ref().expect("the row is in use")
    }
}

impl<T> std::ops::IndexMut<u32> for Column<T> {
    fn index_mut(&mut self, number: u32) -> &mut T {
        let (page, place) = place(number);
        self.pages[page][place].as_mut().expect("the row is in use")
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

    #[test]
    fn rows_of_all_pages_are_found() {
        let mut column = Column::new();
        let n = 2 * PAGE as u32 + 7;
        (0..n).for_each(|i| assert_eq!(column.insert(i), i));
        assert!(column.iter().all(|(number, row)| number == *row));
        for (page, place) in [(0, 0), (0, PAGE - 1), (1, 0), (2, 6)] {
            let number = (page * PAGE + place) as u32;
            assert_eq!((column[number], column.remove(number)), (number, Some(number)));
        }
        assert_eq!((column.len(), column.get(n)), (n as usize - 4, None));
        assert_eq!([6, 0].map(|_| column.insert(n)), [2 * PAGE as u32 + 6, PAGE as u32]);
        assert_eq!(column.get(n), None);
    }
}

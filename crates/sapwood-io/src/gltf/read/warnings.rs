//! What was passed over: told once for each kind of thing, with the first place and how many more
//! there are.

/// Warnings while a file is read.
#[derive(Default)]
pub(super) struct Warnings(Vec<Warning>);

struct Warning {
    /// What is not as it should be, or as it is drawn.
    what: String,
    /// Where it was met first.
    at: String,
    n_more: u64,
}

/// More kinds of warnings than a reader would look at.
const MOST: usize = 100;

impl Warnings {
    /// Notes something at a place; an empty place stands for the file.
    pub(super) fn add(&mut self, at: impl FnOnce() -> String, what: &str) {
        if let Some(known) = self.0.iter_mut().find(|known| known.what == what) {
            known.n_more += 1;
        } else if self.0.len() < MOST {
            self.0.push(Warning { what: what.to_owned(), at: at(), n_more: 0 });
        }
    }

    /// One line for each kind, in the order in which they were met.
    pub(super) fn into_lines(self) -> Vec<String> {
        let line = |Warning { what, at, n_more }: Warning| match (at.as_str(), n_more) {
            ("", _) => what,
            (at, 0) => format!("{at}: {what}"),
            (at, n) => format!("{at} and {n} more: {what}"),
        };
        self.0.into_iter().map(line).collect()
    }
}

//! What verifying tells.

use std::fmt;

use crate::Kind;

/// What verifying found, and how much it looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Faults, in pre-order of where they were met first.
    pub findings: Vec<Finding>,
    /// How many more there are that are not told.
    pub n_more: u64,
    /// Sites that were looked at.
    pub n_sites: u64,
    /// Distinct plans that were looked at.
    pub n_plans: u64,
    /// Distinct meshes that were looked at.
    pub n_meshes: u64,
    /// Triangles of these, each counted once.
    pub n_triangles: u64,
    /// Edges of these that bound one triangle only; no fault, for leaves are open.
    pub n_open_edges: u64,
    limit: usize,
}

/// A fault, and where it was met first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// The links from the root to the plan concerned.
    pub path: Vec<u32>,
    /// The kind of the component concerned.
    pub kind: Kind,
    /// What is wrong, in words.
    pub message: String,
}

/// How bad a fault is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// It may be meant.
    Warning,
    /// It breaks an invariant.
    Error,
}

impl Report {
    /// A report of nothing yet, which tells at most `limit` findings.
    pub fn new(limit: usize) -> Self {
        Self {
            findings: Vec::new(),
            n_more: 0,
            n_sites: 0,
            n_plans: 0,
            n_meshes: 0,
            n_triangles: 0,
            n_open_edges: 0,
            limit,
        }
    }

    /// Adds a finding, or counts it where the limit is reached.
    pub fn add(&mut self, finding: Finding) {
        if self.findings.len() < self.limit {
            self.findings.push(finding);
        } else {
            self.n_more += 1;
        }
    }

    /// Whether nothing was found.
    pub fn is_clean(&self) -> bool {
        self.findings.is_empty() && self.n_more == 0
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Warning => "warning",
            Self::Error => "error",
        })
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} at ", self.severity, self.kind)?;
        if self.path.is_empty() {
            f.write_str("the root")?;
        }
        for (i, link) in self.path.iter().enumerate() {
            write!(f, "{}{link}", if i > 0 { "/" } else { "" })?;
        }
        write!(f, ": {}", self.message)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for finding in &self.findings {
            writeln!(f, "{finding}")?;
        }
        if self.n_more > 0 {
            writeln!(f, "... and {} more", self.n_more)?;
        }
        let Self { n_sites, n_plans, n_meshes, n_triangles, n_open_edges, .. } = self;
        let n = self.findings.len() as u64 + self.n_more;
        write!(
            f,
            "{n} faults in {n_sites} sites, {n_plans} plans, {n_meshes} meshes with {n_triangles} \
             triangles and {n_open_edges} open edges"
        )
    }
}

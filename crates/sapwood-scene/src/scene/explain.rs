//! A view taken apart, as text: the debugger for people who write rules.
//!
//! Three lists that refer to each other: the components of the semantic graph, the plans that
//! they were compiled to with what was read, and the sites that the plans stand in with the
//! slots they are found by. Everything is numbered in the order in which a walk from the root
//! meets it, so that the same scene gives the same text.

use std::fmt::Write as _;

use sapwood_geom::{Digest, FixedMap, fixed_state};
use sapwood_graph::{SiteId, Supply};

use super::Scene;
use crate::compile::{Cache, Link, Pull, Site, Target};
use crate::rules::ReadKey;
use crate::slots::SlotKey;
use crate::{NodeId, PushMode, ViewError, ViewId};

impl Scene {
    /// Everything that stands behind a view: components, plans with their reads, and sites with
    /// their keys, as stable text. Each of the three lists has at most `max_lines` lines.
    ///
    /// What the plans draw is told by [`dump`](Self::dump). Values are told by the first eight
    /// digits of their digests: equal ones are equal, and where two plans of one component
    /// differ, so does one of those.
    ///
    /// # Errors
    /// When the view is closed, or compiling was interrupted.
    pub fn explain(&mut self, view: ViewId, max_lines: usize) -> Result<String, ViewError> {
        self.complete(view, |pull| {
            let mut text = List::new(max_lines);
            text.heading("semantic graph");
            components(pull, &mut text);
            let met = Met::below(pull);
            text.heading("plans");
            plans(pull, &met, &mut text);
            text.heading("sites");
            sites(pull, &met, &mut text);
            text.finish()
        })
    }
}

/// Text in lists of limited length.
struct List {
    text: String,
    max_lines: usize,
    n_lines: usize,
}

impl List {
    fn new(max_lines: usize) -> Self {
        Self { text: String::new(), max_lines, n_lines: 0 }
    }

    fn heading(&mut self, heading: &str) {
        self.end();
        self.text.push_str(heading);
        self.text.push('\n');
    }

    fn line(&mut self, depth: usize, line: &str) {
        self.n_lines += 1;
        if self.n_lines <= self.max_lines {
            let _ = writeln!(self.text, "{:1$}{line}", "", 2 * (depth + 1));
        }
    }

    fn end(&mut self) {
        let n_more = self.n_lines.saturating_sub(self.max_lines);
        if n_more > 0 {
            let _ = writeln!(self.text, "  ... {n_more} lines more");
        }
        self.n_lines = 0;
    }

    fn finish(mut self) -> String {
        self.end();
        self.text
    }
}

/// The components below the view's root, each once, with its children below it.
fn components(pull: &Pull<'_>, text: &mut List) {
    let graph = pull.graph();
    let mut met: FixedMap<NodeId, ()> = FixedMap::with_hasher(fixed_state());
    let mut stack = vec![(pull.root_node(), 0, "")];
    while let Some((node, depth, role)) = stack.pop() {
        let Ok(row) = graph.node(node) else { continue };
        let kind = graph.storage.kind(row.component);
        if met.insert(node, ()).is_some() {
            text.line(depth, &format!("{role}{kind} {node:?}, as above"));
            continue;
        }
        let mut line = format!("{role}{kind} {node:?}, edited at {}", row.edited);
        for (source, input) in graph.fields.inputs(node) {
            let _ = write!(line, ", {input} driven by {source:?}");
        }
        text.line(depth, &line);
        let first = stack.len();
        stack.extend(graph.values.asked_by(node).map(|top| (top, depth + 1, "asks ")));
        stack.extend(graph.children(node).map(|(child, _)| (child, depth + 1, "")));
        stack[first..].reverse();
    }
}

/// Sites and plans in the order in which a walk from the root meets them.
struct Met {
    sites: Vec<SiteId>,
    site_numbers: FixedMap<SiteId, usize>,
    plans: Vec<u32>,
    plan_numbers: FixedMap<u32, usize>,
}

impl Met {
    fn below(pull: &Pull<'_>) -> Self {
        let mut met = Self {
            sites: Vec::new(),
            site_numbers: FixedMap::with_hasher(fixed_state()),
            plans: Vec::new(),
            plan_numbers: FixedMap::with_hasher(fixed_state()),
        };
        let mut stack = vec![pull.root().1];
        while let Some(site) = stack.pop() {
            if met.site_numbers.contains_key(&site) {
                continue;
            }
            let row = &pull.cache().sites[site.0];
            met.sites.push(site);
            met.site_numbers.insert(site, met.sites.len());
            let mut plans = vec![row.plan];
            while let Some(plan) = plans.pop() {
                if !met.plan_numbers.contains_key(&plan) {
                    met.plans.push(plan);
                    met.plan_numbers.insert(plan, met.plans.len());
                    let first = plans.len();
                    plans.extend(pull.cache().ingredients_of(plan));
                    plans[first..].reverse();
                }
            }
            stack.extend(row.links.iter().rev().filter_map(|link| match link {
                Link::Site(child, _) => Some(*child),
                Link::Unfilled | Link::Failed(_) => None,
            }));
        }
        met
    }
}

fn plans(pull: &Pull<'_>, met: &Met, text: &mut List) {
    for (i, number) in met.plans.iter().enumerate() {
        let mut line = plan_line(pull.cache(), i + 1, *number);
        let made_of = pull.cache().ingredients_of(*number);
        tell_all(&mut line, "made of", made_of.map(|plan| format!("p{}", met.plan_numbers[&plan])));
        text.line(0, &line);
    }
}

fn plan_line(cache: &Cache, number: usize, plan: u32) -> String {
    let plan = &cache.plans[plan];
    let kind = cache.kind_of(plan);
    let mut line = match (plan.target, cache.rules.get(plan.rule as usize)) {
        (Target::Authored(node), Some(rule)) => {
            format!("p{number} {kind} {node:?} by {}", rule.identity.name)
        }
        (Target::Emitted(emitted), Some(rule)) => {
            let digest = short(cache.emitted[emitted].digest);
            format!("p{number} {kind} {digest} by {}", rule.identity.name)
        }
        (Target::View(_), _) | (_, None) => format!("p{number} {kind}"),
    };
    if let Some(error) = &plan.error {
        let _ = write!(line, ": error: {}", error.message);
    }
    let mut tell = |n: u64, what: &str| {
        if n > 0 {
            let _ = write!(line, ", {n} {what}{}", if n == 1 { "" } else { "s" });
        }
    };
    tell(plan.links.len() as u64, "link");
    tell(u64::from(plan.fragment.n_live()), "live value");
    tell(plan.fragment.n_triangles(), "triangle");
    for (kind, n) in plan.parts.lengths() {
        let _ = write!(line, ", {n} {kind}");
    }
    let pushes = plan.scopes.iter().map(|scope| {
        let how = match scope.mode {
            PushMode::Normal => "",
            PushMode::Force => "force ",
            PushMode::Protect => "protect ",
            PushMode::Inherit => "inherit ",
        };
        format!("{how}{} {}", scope.slot.name(), short(scope.value.digest))
    });
    tell_all(&mut line, "pushes", pushes);
    let mut by_name: Vec<_> = plan.reads.iter().collect();
    by_name.sort_by_key(|read| read.key.name());
    let reads = by_name.into_iter().map(|read| {
        let name = read.key.name();
        match &read.key {
            ReadKey::Forced(_) => format!("{name} (if forced) {}", short(read.value)),
            ReadKey::Slot(slot) if slot.served().is_some() => served(cache, *slot, read.value),
            ReadKey::Slot(_) | ReadKey::Projection(_) => format!("{name} {}", short(read.value)),
        }
    });
    tell_all(&mut line, "reads", reads);
    line
}

fn sites(pull: &Pull<'_>, met: &Met, text: &mut List) {
    for (i, site) in met.sites.iter().enumerate() {
        let row = &pull.cache().sites[site.0];
        text.line(0, &site_line(pull.cache(), met, i + 1, row));
        for link in &row.links {
            if let Link::Failed(failed) = link {
                text.line(1, &format!("link failed: {}", failed.0));
            }
        }
    }
}

fn site_line(cache: &Cache, met: &Met, number: usize, row: &Site) -> String {
    let mut line = format!("s{number} of p{}", met.plan_numbers[&row.plan]);
    if !row.is_closed {
        line.push_str(", open");
    }
    if row.is_moving {
        line.push_str(", moving");
    }
    if row.remembers {
        line.push_str(", remembers");
    }
    let value = |(slot, digest): &(SlotKey, Digest)| match slot.served() {
        Some(_) => served(cache, *slot, *digest),
        None => format!("{} {}", slot.name(), short(*digest)),
    };
    let mut key: Vec<String> = row.key.iter().map(value).collect();
    key.sort_unstable();
    tell_all(&mut line, "found by", key.into_iter());
    let below: Vec<usize> = row
        .links
        .iter()
        .filter_map(|link| match link {
            Link::Site(child, _) => met.site_numbers.get(child).copied(),
            Link::Unfilled | Link::Failed(_) => None,
        })
        .collect();
    tell_all(&mut line, "links to", runs(&below).into_iter());
    line
}

/// Which rule was found to serve a kind.
fn served(cache: &Cache, slot: SlotKey, value: Digest) -> String {
    let rule = cache.rules.iter().find(|known| known.identity.digest() == value);
    let rule = rule.map_or("nothing", |known| known.identity.name);
    format!("{} by {rule}", slot.name())
}

/// Adds `word` and a list, if there is anything in it.
fn tell_all(line: &mut String, word: &str, mut list: impl Iterator<Item = String>) {
    if let Some(first) = list.next() {
        let _ = write!(line, "; {word} {first}");
        list.for_each(|next| {
            let _ = write!(line, ", {next}");
        });
    }
}

/// Site numbers in order, with what follows each other or repeats drawn together.
fn runs(numbers: &[usize]) -> Vec<String> {
    let mut words = Vec::new();
    for run in numbers.chunk_by(|a, b| *b == *a + 1) {
        match run {
            [] => {}
            [one] => words.push(format!("s{one}")),
            [first, .., last] => words.push(format!("s{first} to s{last}")),
        }
    }
    let mut told: Vec<String> = Vec::new();
    for same in words.chunk_by(|a, b| a == b) {
        match same.len() {
            1 => told.push(same[0].clone()),
            n => told.push(format!("{n} times {}", same[0])),
        }
    }
    told
}

/// The first eight digits of a digest.
fn short(digest: Digest) -> String {
    format!("{digest:?}").chars().take(8).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_told_in_runs() {
        assert_eq!(runs(&[2, 3, 4, 9, 9, 9, 1]), ["s2 to s4", "3 times s9", "s1"]);
        assert!(runs(&[]).is_empty());
    }

    #[test]
    fn each_list_ends_at_its_limit() {
        let mut list = List::new(1);
        list.heading("a");
        list.line(0, "one");
        list.line(0, "two");
        list.heading("b");
        list.line(0, "one");
        assert_eq!(list.finish(), "a\n  one\n  ... 1 lines more\nb\n  one\n");
    }
}

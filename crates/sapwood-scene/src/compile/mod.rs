//! Compiling: from components to plans and sites, one file for each step.
//!
//! A want names a link, the environment it was met in, and so a component in a context. It is
//! [resolved](resolve) to the rule that serves its kind, [found](find) among the plans by what was
//! read, or made by running the rule's [`init`](init), its [ingredients] first, and
//! [published](publish); the `init`s of a [batch] run side by side. The plan in its context is a
//! site, and the parent's [link] leads to it. A pass ends when sites are [settled](settle), where
//! rings of emitted components are broken into errors ([cycles]); moving ones are [visited](visit);
//! what nothing shows is [evicted](evict).

mod batch;
mod cache;
mod cycles;
mod emitted;
mod evict;
mod find;
mod ingredients;
mod init;
mod link;
mod plan_group;
mod publish;
mod pull;
mod pushes;
mod resolve;
mod settle;
mod visit;

pub(crate) use cache::{Cache, Link, NOT_CHECKED, Site, Target};
pub(crate) use pull::Pull;

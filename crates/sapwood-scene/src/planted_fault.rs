//! Faults that tests plant in the compiler, to prove that random scripts find them.

/// A fault in the compiler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlantedFault {
    /// Now and then a mark does not climb to the parents.
    DroppedMark,
    /// Reads of placement are not recorded.
    DroppedRead,
    /// What was read for an ingredient is not counted as read by who asked for it.
    DroppedIngredient,
    /// A plan made anew is taken to equal the one before.
    EarlyStop,
    /// What is forced is left out of the keys of sites.
    ForgottenForce,
    /// What is driven is not noted as out of date.
    KeptDriven,
    /// What asks a value sub-graph is not marked.
    UnmarkedAsker,
}

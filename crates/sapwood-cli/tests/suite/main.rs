//! Runs of the program, as from a shell.

mod files_drawn;
mod interrupts;
mod outputs;
mod own_leaves;
mod pictures;
mod program;
mod runs;
mod seeds;
mod species_files;
mod welded;
mod wind;

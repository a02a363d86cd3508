//! Runs of the program, as from a shell.

mod files_drawn;
mod interrupts;
mod outputs;
mod pictures;
mod program;
mod runs;
mod species_files;
mod welded;
mod wind;

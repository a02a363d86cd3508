//! Pictures: what rays meet, what is compiled for them, and what the result looks like.

mod agreement;
mod analytic;
mod laziness;
mod sameness;
mod scenes;
mod unfit;

//! Pictures: what rays meet, what is compiled for them, and what the result looks like.

mod agreement;
mod analytic;
mod compared;
mod distance;
mod golden;
mod laziness;
mod sameness;
mod scenes;
mod sharing;
mod unfit;

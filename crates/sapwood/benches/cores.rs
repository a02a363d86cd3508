//! What a second core does for many distinct trees, with an allocator in which threads do not wait
//! for each other; `cargo bench -p sapwood --bench trees -- cores` tells the same of the system's.

mod grove;

use mimalloc::MiMalloc;

#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() {
    ["quaking_aspen", "black_tupelo"].into_iter().for_each(grove::cores);
}

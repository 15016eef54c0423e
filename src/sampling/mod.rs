//! Generators, sequences, and warps with their densities.
//!
//! - [`generator`]: a random number for every (seed, pixel, sample, dimension)
//! - [`sobol`], [`halton`], [`r2`]: sequences (`joe_kuo` and `primes` hold their constants), and Owen's scrambling
//! - [`stratified`], [`latin_hypercube`], [`multi_jittered`]: point sets of a given size
//! - [`fibonacci_sphere`], [`vogel_disk`]: spirals
//! - [`poisson_disk`], [`blue_noise_mask`]: points and pixels that keep their distance
//! - [`star_discrepancy`], [`discrepancy`], [`power_spectrum`]: how even a set is
//! - [`sampler`]: any of these for a pixel's samples, for kernels
//! - [`disk`], [`triangle`], [`sphere`], [`hemisphere`], [`cosine_hemisphere`], [`cone`], [`spherical_triangle`],
//!   [`spherical_rectangle`]: the unit square warped onto each, with inverses and densities
//! - [`area_to_solid_angle`]: a density of another measure
//! - [`tabulated`], [`alias_table`]: points and indices in proportion to given weights
//! - [`metropolis_hastings`], [`gibbs`]: Markov chains over pictures

pub mod alias_table;
pub mod area_to_solid_angle;
pub mod blue_noise_mask;
pub mod cone;
pub mod cosine_hemisphere;
pub mod discrepancy;
pub mod disk;
pub mod fibonacci_sphere;
pub mod generator;
pub mod gibbs;
pub mod halton;
pub(crate) mod hash;
pub mod hemisphere;
mod joe_kuo;
pub mod latin_hypercube;
pub mod metropolis_hastings;
pub mod multi_jittered;
pub mod poisson_disk;
pub mod power_spectrum;
mod primes;
pub mod r2;
pub mod sampler;
pub mod sobol;
pub mod sphere;
pub mod spherical_rectangle;
pub mod spherical_triangle;
pub mod star_discrepancy;
pub mod stratified;
pub mod tabulated;
pub mod triangle;
pub mod vogel_disk;

use crate::dispatch;
use crate::parallel::{self, Interrupted, Rows, Watch};
use crate::real::{Lanes, Real};

/// A point of the closed unit square as it is; NaN beyond it, where no warp holds.
#[inline(always)]
fn in_square<V: Lanes>(u: [V; 2]) -> [V; 2] {
    // Comparisons by hand: methods of the standard library would be called outside the dispatch.
    let (zero, one, nan) = (u[0].num(0.0), u[0].num(1.0), u[0].like(V::Elem::NAN));
    let inside = zero.less_eq(u[0]) & u[0].less_eq(one) & zero.less_eq(u[1]) & u[1].less_eq(one);
    [V::select(inside, u[0], nan), V::select(inside, u[1], nan)]
}

/// Coordinates that rounding brought to one, just below it.
#[inline(always)]
fn below_one<T: Real>(u: [T; 2]) -> [T; 2] {
    let (one, last) = (T::one(), T::one().next_down());
    [T::select(u[0] >= one, last, u[0]), T::select(u[1] >= one, last, u[1])]
}

/// `f(i, row)` for every row `i` of `width` columns.
fn rows<T: Real>(
    watch: &mut dyn Watch,
    out: &mut [T],
    width: usize,
    f: impl Fn(u64, &mut [T]) + Sync,
) -> Result<(), Interrupted> {
    let piece = ((1 << 13) / width.max(1)).max(1);
    parallel::for_each(
        watch,
        Rows { data: out, width },
        piece,
        |first, rows| dispatch!(_s => rows_body(first as u64, rows, &f)),
    )
}

#[inline(always)]
fn rows_body<T: Real>(first: u64, rows: Rows<'_, T>, f: &impl Fn(u64, &mut [T])) {
    for (i, row) in rows.data.chunks_exact_mut(rows.width.max(1)).enumerate() {
        f(first + i as u64, row);
    }
}

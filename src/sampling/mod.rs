//! Generators, sequences, and warps with their densities.
//!
//! - [`generator`]: a random number for every (seed, pixel, sample, dimension)
//! - [`sobol`]: Sobol' sequences and Owen's scrambling (`joe_kuo` holds their direction numbers)
//! - [`disk`], [`triangle`], [`cosine_hemisphere`]: the unit square warped onto each, with inverses and densities

pub mod alias_table;
pub mod area_to_solid_angle;
pub mod cone;
pub mod cosine_hemisphere;
pub mod disk;
pub mod generator;
pub mod hemisphere;
mod joe_kuo;
pub mod sobol;
pub mod sphere;
pub mod spherical_rectangle;
pub mod spherical_triangle;
pub mod tabulated;
pub mod triangle;

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;

/// A point of the closed unit square as it is; NaN beyond it, where no warp holds.
#[inline(always)]
fn in_square<T: Real>(u: [T; 2]) -> [T; 2] {
    let unit = T::zero()..=T::one();
    if unit.contains(&u[0]) && unit.contains(&u[1]) { u } else { [T::NAN; 2] }
}

/// `f` of every item.
fn map<T: Real, const A: usize, const B: usize>(
    watch: &mut dyn Watch,
    input: &[[T; A]],
    out: &mut [[T; B]],
    f: impl Fn([T; A]) -> [T; B] + Sync,
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (input, out),
        1 << 14,
        |_, (input, out)| dispatch!(_s => map_body(input, out, &f)),
    )
}

#[inline(always)]
fn map_body<T: Real, const A: usize, const B: usize>(
    input: &[[T; A]],
    out: &mut [[T; B]],
    f: &impl Fn([T; A]) -> [T; B],
) {
    for i in 0..out.len() {
        out[i] = f(input[i]);
    }
}

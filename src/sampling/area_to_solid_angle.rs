//! From a density per area of a surface to one per solid angle of a point that sees it: dω = |cos θ| dA / r².
//!
//! M. F. Cohen, J. R. Wallace, *Radiosity and Realistic Image Synthesis*, 1993, section 2.4.

use crate::real::{Lanes, Real};
use crate::vec::Vec3;

/// What `density` at `point` becomes as seen from `origin`, or what it came from (`inverse`). The normal need not be
/// unit. Edge-on, the density per solid angle is infinite.
#[inline(always)]
pub fn area_to_solid_angle<T: Real>(
    inverse: bool,
    density: T,
    point: Vec3<T>,
    normal: Vec3<T>,
    origin: Vec3<T>,
) -> T {
    let to = point + -origin;
    let size = Lanes::max(Lanes::max(to.x.abs(), to.y.abs()), to.z.abs());
    // In units of the longest component nothing leaves the range but the result.
    let (d, n) = (to.map(|c| c / size), normal.normalize());
    let squared = d.dot(d);
    let cosine = d.dot(n).abs() / squared.sqrt();
    if inverse { density * cosine / squared / size / size } else { density * squared / cosine * size * size }
}

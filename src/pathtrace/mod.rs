//! The references: ray casting, direct light with its error, path tracing.
//!
//! - [`ray_cast`]: what each pixel's centre sees
//! - [`direct_light`]: light from the lights, once reflected, with shadows, at given points
//! - [`path_trace`]: all light paths

pub mod direct_light;
mod emitters;
pub mod path_trace;
pub mod ray_cast;
mod surface;

use crate::accel::Ray;
use crate::real::Real;
use crate::vec::Vec3;
pub use emitters::Emitters;
pub use surface::Surfaces;

/// A pinhole: pixel coordinates (x, y) look along `corner + x · right + y · down`.
#[derive(Clone, Copy, Debug)]
pub struct Pinhole<T> {
    pub eye: Vec3<T>,
    pub corner: Vec3<T>,
    pub right: Vec3<T>,
    pub down: Vec3<T>,
}

impl<T: Real> Pinhole<T> {
    /// The unit direction through a point of the picture.
    #[inline(always)]
    fn direction(&self, x: T, y: T) -> Vec3<T> {
        (self.corner + self.right * x + self.down * y).normalize()
    }
}

/// A ray that leaves a surface: it starts `offset` above the side that `wi` points to, so that it does not meet the
/// surface again by rounding.
#[inline(always)]
fn leave<T: Real>(point: Vec3<T>, normal: Vec3<T>, wi: Vec3<T>, offset: T, t_max: T) -> Ray<T> {
    let origin = point + normal * offset.copysign(wi.dot(normal));
    Ray { origin: origin.to_array(), direction: wi.to_array(), t_min: T::zero(), t_max, ignore_face: -1 }
}

/// Mean and spread of samples that come one by one, in double.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    count: f64,
    mean: [f64; 3],
    squares: [f64; 3],
}

impl Tally {
    /// B. P. Welford, *Note on a method for calculating corrected sums of squares and products*, 1962.
    #[inline(always)]
    fn add<T: Real>(&mut self, x: Vec3<T>) {
        self.count += 1.0;
        let x = x.to_array();
        for c in 0..3 {
            let x = x[c].to_f64();
            let off = x - self.mean[c];
            self.mean[c] += off / self.count;
            self.squares[c] += off * (x - self.mean[c]);
        }
    }
    /// Of the mean of independent samples; unknown for less than two.
    #[inline(always)]
    fn variance(&self) -> [f64; 3] {
        let n = self.count;
        self.squares.map(|s| if n < 2.0 { f64::INFINITY } else { s / (n * (n - 1.0)) })
    }
}

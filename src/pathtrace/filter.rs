//! Pixel filters: where the samples of a pixel lie.
//!
//! Samples are drawn in proportion to the filter, so each counts alike: the mean of a pixel's samples is the filtered
//! picture without bias, and their variance over their number that of the mean. Each pixel has samples of its own, also where
//! filters overlap, so the noise of neighbours stays independent. Both axes are drawn alone, each by its inverse
//! distribution, which keeps strata strata. Filters are nowhere negative and even.
//!
//! The box and the tent have closed inverses. The Gaussian (less its value at the border, where it ends) and the
//! Blackman-Harris window become linear pieces: [`CELLS`] from the centre to the border, in each of which the share of
//! the samples is exact. So far as that, 10⁻⁴ of its height, the filter differs from its formula.
//!
//! M. Ernst, M. Stamminger, G. Greiner, *Filter importance sampling*, 2006; F. J. Harris, *On the use of windows for
//! harmonic analysis with the discrete Fourier transform*, 1978.

use crate::math;
use crate::real::Real;

/// Linear pieces from the centre to the border.
pub const CELLS: usize = 128;
/// Steps of the guide to the piece of a share.
const GUIDE: usize = 256;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    Box,
    Tent,
    /// Of this standard deviation, in pixels.
    Gaussian(f64),
    BlackmanHarris,
}

/// A filter over [-radius, radius] on both axes.
#[derive(Clone, Debug)]
pub struct Filter {
    pub shape: Shape,
    /// In pixels; zero puts all samples at the centre.
    pub radius: f64,
    pieces: Option<Box<Pieces>>,
}

/// Half a filter as linear pieces over [0, 1] (times the radius).
#[derive(Clone, Debug)]
struct Pieces {
    /// Heights at the pieces' ends, scaled to the whole half's share of one.
    height: [f64; CELLS + 1],
    /// Share of what lies nearer than each end.
    share: [f64; CELLS + 1],
    /// The last piece that begins at or before the share i / GUIDE.
    guide: [u8; GUIDE],
}

impl Shape {
    /// The height at `x` in [0, 1] of the radius, by the formula, up to a factor.
    fn height(self, x: f64, radius: f64) -> f64 {
        match self {
            Shape::Box => 1.0,
            Shape::Tent => 1.0 - x,
            Shape::Gaussian(deviation) => {
                let narrow = 0.5 * (radius / deviation) * (radius / deviation);
                f64::max(math::exp(-narrow * x * x) - math::exp(-narrow), 0.0)
            }
            Shape::BlackmanHarris => {
                let turn = |k: f64| math::sin_cos(std::f64::consts::PI * k * x).1;
                0.35875 + 0.48829 * turn(1.0) + 0.14128 * turn(2.0) + 0.01168 * turn(3.0)
            }
        }
    }
}

impl Pieces {
    fn of(shape: Shape, radius: f64) -> Box<Self> {
        let at = |i: f64| shape.height(i / CELLS as f64, radius);
        let mut height = [0.0; CELLS + 1];
        let mut share = [0.0; CELLS + 1];
        // Simpson's rule, exact to 10⁻¹¹ of a piece.
        let mut mass = [0.0; CELLS];
        for i in 0..CELLS {
            mass[i] = (at(i as f64) + 4.0 * at(i as f64 + 0.5) + at(i as f64 + 1.0)) / 6.0;
        }
        let total: f64 = mass.iter().sum();
        for i in 0..CELLS {
            share[i + 1] = share[i] + mass[i] / total;
            height[i] = at(i as f64);
        }
        height[CELLS] = at(CELLS as f64);
        share[CELLS] = 1.0;
        let mut guide = [0; GUIDE];
        for (i, g) in guide.iter_mut().enumerate() {
            let u = i as f64 / GUIDE as f64;
            *g = (share.partition_point(|&s| s <= u) - 1).min(CELLS - 1) as u8;
        }
        Box::new(Pieces { height, share, guide })
    }

    /// The piece of a share, and how far into it.
    #[inline(always)]
    fn invert(&self, u: f64) -> f64 {
        let mut i = self.guide[((u * GUIDE as f64) as usize).min(GUIDE - 1)] as usize;
        while i + 1 < CELLS && self.share[i + 1] <= u {
            i += 1;
        }
        let within = f64::min((u - self.share[i]) / (self.share[i + 1] - self.share[i]), 1.0);
        // Within a piece the density goes linearly from a to b: x (2a + (b − a) x) = within · (a + b).
        let (a, b) = (self.height[i], self.height[i + 1]);
        let mass = within * (a + b);
        let x = mass / (a + (a * a + (b - a) * mass).max(0.0).sqrt());
        (i as f64 + f64::min(x, 1.0)) / CELLS as f64
    }

    /// The density on the half's [0, 1].
    #[inline(always)]
    fn density(&self, x: f64) -> f64 {
        let place = x * CELLS as f64;
        let i = (place as usize).min(CELLS - 1);
        let (a, b) = (self.height[i], self.height[i + 1]);
        let mass = (self.share[i + 1] - self.share[i]) * CELLS as f64;
        mass * 2.0 * (a + (b - a) * (place - i as f64)) / (a + b)
    }
}

impl Filter {
    pub fn new(shape: Shape, radius: f64) -> Self {
        let pieces = match shape {
            Shape::Box | Shape::Tent => None,
            Shape::Gaussian(_) | Shape::BlackmanHarris => Some(Pieces::of(shape, radius)),
        };
        Filter { shape, radius, pieces }
    }

    /// Every pixel's own square.
    pub fn pixel() -> Self {
        Filter::new(Shape::Box, 0.5)
    }

    /// The offset from the pixel's centre, in pixels, on one axis, of a number in [0, 1]: rising with it.
    #[inline(always)]
    pub fn warp1<T: Real>(&self, u: T) -> T {
        let (half, one) = (T::of(0.5), T::one());
        let upper = u >= half;
        // Counted from the centre, so that both sides mirror each other.
        let v = if upper { u + u - one } else { one - (u + u) };
        let x = match &self.pieces {
            None if self.shape == Shape::Box => v,
            // 1 − √(1 − v), without cancellation.
            None => v / (one + (one - v).sqrt()),
            Some(pieces) => T::of(pieces.invert(v.to_f64())),
        };
        let x = x * T::of(self.radius);
        if upper { x } else { -x }
    }

    /// The offset from the pixel's centre of a point of the unit square.
    #[inline(always)]
    pub fn warp<T: Real>(&self, u: [T; 2]) -> [T; 2] {
        [self.warp1(u[0]), self.warp1(u[1])]
    }

    /// The density with which [`Filter::warp1`] gives an offset, per pixel: the filter, scaled to one.
    #[inline(always)]
    pub fn density(&self, x: f64) -> f64 {
        if self.radius == 0.0 {
            return if x == 0.0 { f64::INFINITY } else { x * 0.0 };
        }
        let at = x.abs() / self.radius;
        let half = match &self.pieces {
            _ if at > 1.0 => 0.0,
            None if self.shape == Shape::Box => 1.0,
            None => 2.0 * (1.0 - at),
            Some(pieces) => pieces.density(at),
        };
        0.5 * half / self.radius + x * 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warps_rise_and_reach_both_borders() {
        for shape in [Shape::Box, Shape::Tent, Shape::Gaussian(0.5), Shape::BlackmanHarris] {
            let filter = Filter::new(shape, 2.0);
            let xs: Vec<f64> = (0..=1000).map(|i| filter.warp1(i as f64 / 1000.0)).collect();
            assert!(xs.windows(2).all(|w| w[0] < w[1]), "{shape:?}");
            assert_eq!((xs[0], xs[500], xs[1000]), (-2.0, 0.0, 2.0), "{shape:?}");
        }
    }
}

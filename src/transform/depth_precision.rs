//! What a depth buffer tells apart at a distance: from one stored value to the next, through a perspective projection.
//!
//! In each convention the depth is `A + B / z`; a step `s` in it is the step `z r / (1 - r)` in distance, `r = s z / |B|`.
//!
//! N. Reed, *Depth precision visualized*, 2015; E. Lengyel, *Projection matrix tricks*, 2007.

use super::projection::Depth;
use crate::math::ln;
use crate::real::Real;

/// How a depth is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// z/w of the convention, in single precision.
    Float32,
    /// The range of the convention mapped to [0, 1], in this many equal steps.
    Unorm(u32),
}

/// The distance to the next stored value away from the eye (infinite where there is none), and log2 of `1 / r`: the bits
/// of the distance that are left. NaN outside `[near, far]`.
#[inline(always)]
pub fn depth_precision<T: Real>(distance: T, [near, far]: [T; 2], depth: Depth, storage: Storage) -> [T; 2] {
    let (one, two) = (T::one(), T::of(2.0));
    if !(near > T::zero() && far > near && distance >= near && distance <= far && distance < T::INFINITY) {
        return [T::NAN; 2];
    }
    let infinite = far == T::INFINITY;
    let over = if infinite { one } else { far / (far - near) };
    // z/w of the reversed convention, from which the others follow.
    let left = if infinite { one } else { (far - distance) / (far - near) };
    let reversed = near / distance * left;
    let (step, gain) = match storage {
        Storage::Unorm(steps) => (one / T::of(f64::from(steps)), near * over),
        Storage::Float32 => match depth {
            Depth::Standard => (above(one - two * reversed), two * near * over),
            Depth::ZeroToOne => (above(one - reversed), near * over),
            Depth::Reversed => (below(reversed), near * over),
        },
    };
    let r = step * distance / gain;
    if r >= one {
        return [T::INFINITY, T::zero()];
    }
    [distance * (r / (one - r)), -(ln(r) / T::of(std::f64::consts::LN_2))]
}

/// From the nearest single to the next above it.
#[inline(always)]
fn above<T: Real>(x: T) -> T {
    let stored = x.to_f64() as f32;
    T::of(f64::from(stored.next_up()) - f64::from(stored))
}

#[inline(always)]
fn below<T: Real>(x: T) -> T {
    above(-x)
}

//! Projections to clip space, -w ≤ x, y ≤ w; the viewport; and the distance back from a depth.
//!
//! Three depth conventions: standard (OpenGL, z/w from -1 at near to 1 at far), zero to one (near to far), and reversed
//! (1 at near to 0 at far, which spreads floating-point precision evenly). The far plane may be infinite.
//!
//! N. Reed, *Depth precision visualized*, 2015 (reversed depth); E. Lengyel, *Projection matrix tricks*, 2007.

use super::{Rows4, fill};
use crate::math::tan;
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    Standard,
    ZeroToOne,
    Reversed,
}

/// Left, right, bottom, top, near, far: at the near plane for a perspective projection.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Frustum<T>(pub [T; 6]);

impl<T: Real> Frustum<T> {
    /// Symmetric, from a vertical field of view in radians and the ratio of width to height.
    #[inline(always)]
    pub fn from_fov(fov_y: T, aspect: T, near: T, far: T) -> Self {
        let top = near * tan(fov_y * T::of(0.5));
        let right = top * aspect;
        Frustum([-right, right, -top, top, near, far])
    }
}

/// The perspective projection, or NaN where the planes do not bound a volume.
#[inline(always)]
pub fn perspective<T: Real>(frustum: Frustum<T>, depth: Depth) -> Rows4<T> {
    let Frustum([l, r, b, t, n, f]) = frustum;
    let (zero, one, two) = (T::zero(), T::one(), T::of(2.0));
    if !(n > zero && f > n && l != r && b != t) {
        return [[T::NAN; 4]; 4];
    }
    // far / (far - near) and near / (far - near), with their limits at infinity.
    let (over, under) = if f == T::INFINITY { (one, zero) } else { (f / (f - n), n / (f - n)) };
    let (a, c) = match depth {
        Depth::Standard => (-(over + under), -(two * n * over)),
        Depth::ZeroToOne => (-over, -(n * over)),
        Depth::Reversed => (under, n * over),
    };
    [
        [two * n / (r - l), zero, (r + l) / (r - l), zero],
        [zero, two * n / (t - b), (t + b) / (t - b), zero],
        [zero, zero, a, c],
        [zero, zero, -one, zero],
    ]
}

/// The orthographic projection, or NaN where the planes do not bound a volume.
#[inline(always)]
pub fn orthographic<T: Real>(frustum: Frustum<T>, depth: Depth) -> Rows4<T> {
    let Frustum([l, r, b, t, n, f]) = frustum;
    let (zero, one, two) = (T::zero(), T::one(), T::of(2.0));
    if !(l != r && b != t && n != f && (f - n).is_finite()) {
        return [[T::NAN; 4]; 4];
    }
    let (a, c) = match depth {
        Depth::Standard => (-two / (f - n), -(f + n) / (f - n)),
        Depth::ZeroToOne => (-one / (f - n), -n / (f - n)),
        Depth::Reversed => (one / (f - n), f / (f - n)),
    };
    [
        [two / (r - l), zero, zero, -(r + l) / (r - l)],
        [zero, two / (t - b), zero, -(t + b) / (t - b)],
        [zero, zero, a, c],
        [zero, zero, zero, one],
    ]
}

/// [`perspective`] over an array.
pub fn perspective_many<T: Real>(
    watch: &mut dyn Watch,
    frusta: &[[T; 6]],
    depth: Depth,
    out: &mut [Rows4<T>],
) -> Result<(), Interrupted> {
    fill(watch, out, |i| perspective(Frustum(frusta[i]), depth))
}

/// [`perspective`] over an array of vertical field of view, aspect, near, far.
pub fn perspective_fov_many<T: Real>(
    watch: &mut dyn Watch,
    fields: &[[T; 4]],
    depth: Depth,
    out: &mut [Rows4<T>],
) -> Result<(), Interrupted> {
    fill(watch, out, |i| {
        let [fov_y, aspect, near, far] = fields[i];
        if !(fov_y > T::zero() && fov_y < T::PI && aspect > T::zero()) {
            return [[T::NAN; 4]; 4];
        }
        perspective(Frustum::from_fov(fov_y, aspect, near, far), depth)
    })
}

/// [`orthographic`] over an array.
pub fn orthographic_many<T: Real>(
    watch: &mut dyn Watch,
    frusta: &[[T; 6]],
    depth: Depth,
    out: &mut [Rows4<T>],
) -> Result<(), Interrupted> {
    fill(watch, out, |i| orthographic(Frustum(frusta[i]), depth))
}

/// Normalised device coordinates to pixels: x to the right, y down, the picture's corner at `origin`; z stays.
pub fn viewport<T: Real>(size: [T; 2], origin: [T; 2]) -> Rows4<T> {
    let (zero, one, half) = (T::zero(), T::one(), T::of(0.5));
    let [w, h] = size.map(|s| s * half);
    [
        [w, zero, zero, origin[0] + w],
        [zero, -h, zero, origin[1] + h],
        [zero, zero, one, zero],
        [zero, zero, zero, one],
    ]
}

/// The distance along the line of sight (-z in eye space) that `projection` maps to the depth z/w. The projection's
/// four entries that concern depth say which convention it is of.
#[inline(always)]
pub fn linear_depth<T: Real>(depth: T, projection: &Rows4<T>) -> T {
    let (a, b) = (projection[2][2], projection[2][3]);
    let (c, d) = (projection[3][2], projection[3][3]);
    (depth * d - b) / (depth * c - a)
}

/// [`linear_depth`] of an array under one projection.
pub fn linear_depth_many<T: Real>(
    watch: &mut dyn Watch,
    depth: &[T],
    projection: &Rows4<T>,
    out: &mut [T],
) -> Result<(), Interrupted> {
    crate::parallel::for_each(
        watch,
        (depth, out),
        1 << 16,
        |_, (depth, out): (&[T], &mut [T])| crate::dispatch!(_s => linear_depth_body(depth, projection, out)),
    )
}

#[inline(always)]
fn linear_depth_body<T: Real>(depth: &[T], projection: &Rows4<T>, out: &mut [T]) {
    for (out, &depth) in out.iter_mut().zip(depth) {
        *out = linear_depth(depth, projection);
    }
}

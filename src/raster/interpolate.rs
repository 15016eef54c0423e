//! Vertex attributes at what was rasterised, and how fast they change over the screen.
//!
//! With perspective-correct `u` and `v` an attribute is `a + (b - a) u + (c - a) v`; a constant one is kept to the bit.
//! In the weights `λ` of a triangle's planes, `u = λ1 / (λ0 + λ1 + λ2)`, so its derivative is
//! `(λ1' - u (λ0' + λ1' + λ2')) / (λ0 + λ1 + λ2)`: no differences between pixels, hence right at silhouettes too.
//!
//! P. S. Heckbert, *Survey of Texture Mapping*, 1986. M. Olano, T. Greer, *Triangle Scan Conversion using 2D
//! Homogeneous Coordinates*, 1997.

use super::Depth;
use super::samples::{self, SUBPIXELS};
use super::setup::{Planes, Screen, planes};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Rows, Watch};
use crate::real::Real;

/// Samples of one task.
const SAMPLES: usize = 1 << 13;

/// Values of `channels` components at each vertex.
#[derive(Clone, Copy)]
pub struct Attributes<'a, T> {
    pub values: &'a [T],
    pub channels: usize,
    pub faces: &'a [[i32; 3]],
}

impl<'a, T> Attributes<'a, T> {
    #[inline(always)]
    fn at(&self, vertex: i32) -> &'a [T] {
        &self.values[vertex as usize * self.channels..][..self.channels]
    }
}

/// What was rasterised: faces (-1 for none) and coordinates of every sample.
#[derive(Clone, Copy)]
pub struct Seen<'a, T> {
    pub face: &'a [i32],
    pub u: &'a [T],
    pub v: &'a [T],
}

/// One attribute at `(u, v)` of a triangle with values `a`, `b`, `c`.
#[inline(always)]
pub fn mix<T: Real>(a: T, b: T, c: T, u: T, v: T) -> T {
    a + ((b - a) * u + (c - a) * v)
}

/// Attributes of every sample, zero where there is no face. Faces and indices must be in range.
pub fn interpolate<T: Real>(
    watch: &mut dyn Watch,
    attributes: Attributes<T>,
    seen: Seen<T>,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let out = Rows { data: out, width: attributes.channels };
    parallel::for_each(
        watch,
        (seen.face, seen.u, seen.v, out),
        SAMPLES,
        |_, (face, u, v, out)| dispatch!(_s => values(attributes, Seen { face, u, v }, out.data)),
    )
}

#[inline(always)]
fn values<T: Real>(attributes: Attributes<T>, seen: Seen<T>, out: &mut [T]) {
    let n = attributes.channels;
    for (i, &face) in seen.face.iter().enumerate() {
        let out = &mut out[i * n..][..n];
        if face < 0 {
            out.fill(T::zero());
            continue;
        }
        let [a, b, c] = attributes.faces[face as usize];
        let (a, b, c) = (attributes.at(a), attributes.at(b), attributes.at(c));
        for k in 0..n {
            out[k] = mix(a[k], b[k], c[k], seen.u[i], seen.v[i]);
        }
    }
}

/// The picture that was rasterised, as derivatives need it.
#[derive(Clone, Copy)]
pub struct View<'a, T> {
    pub clip: &'a [[T; 4]],
    pub width: usize,
    pub height: usize,
    pub samples: usize,
}

/// Derivatives of the attributes of every sample to the right (`dx`) and downwards (`dy`), per pixel; zero where there
/// is no face, or where the triangle is edge-on.
pub fn derivatives<T: Real>(
    watch: &mut dyn Watch,
    attributes: Attributes<T>,
    seen: Seen<T>,
    view: View<T>,
    dx: &mut [T],
    dy: &mut [T],
) -> Result<(), Interrupted> {
    let n = attributes.channels;
    let (dx, dy) = (Rows { data: dx, width: n }, Rows { data: dy, width: n });
    let data = (seen.face, seen.u, seen.v, dx, dy);
    parallel::for_each(
        watch,
        data,
        SAMPLES,
        |first, (face, u, v, dx, dy)| dispatch!(_s => slopes(attributes, Seen { face, u, v }, view, first, dx.data, dy.data)),
    )
}

#[inline(always)]
fn slopes<T: Real>(
    attributes: Attributes<T>,
    seen: Seen<T>,
    view: View<T>,
    first: usize,
    dx: &mut [T],
    dy: &mut [T],
) {
    let n = attributes.channels;
    let positions = samples::positions(view.samples).expect("1, 2, 4 or 8 samples");
    // Derivatives of u and v do not depend on what z means.
    let screen = Screen::new(view.width, view.height, Depth::Standard);
    for (i, &face) in seen.face.iter().enumerate() {
        let (dx, dy) = (&mut dx[i * n..][..n], &mut dy[i * n..][..n]);
        if face < 0 {
            dx.fill(T::zero());
            dy.fill(T::zero());
            continue;
        }
        let [a, b, c] = attributes.faces[face as usize];
        let clip = [view.clip[a as usize], view.clip[b as usize], view.clip[c as usize]];
        let (pixel, sample) = ((first + i) / view.samples, (first + i) % view.samples);
        let reference = [(pixel % view.width) as i32, (pixel / view.width) as i32];
        let [sx, sy] = positions[sample];
        let offset = [T::of(sx as f64 / SUBPIXELS as f64), T::of(sy as f64 / SUBPIXELS as f64)];
        let planes = planes(face, clip, reference, &screen);
        let [du, dv] = coordinate_slopes(&planes, offset, [seen.u[i], seen.v[i]]);
        let (a, b, c) = (attributes.at(a), attributes.at(b), attributes.at(c));
        for k in 0..n {
            let (along_u, along_v) = (b[k] - a[k], c[k] - a[k]);
            dx[k] = along_u * du[0] + along_v * dv[0];
            dy[k] = along_u * du[1] + along_v * dv[1];
        }
    }
}

/// `[du/dx, du/dy]` and `[dv/dx, dv/dy]` at a point given relative to the planes' reference.
#[inline(always)]
fn coordinate_slopes<T: Real>(planes: &Planes<T>, at: [T; 2], uv: [T; 2]) -> [[T; 2]; 2] {
    let mut sum = [T::zero(); 3];
    for i in 0..3 {
        for k in 0..3 {
            sum[k] += planes.weights[i][k];
        }
    }
    let total = sum[0] * at[0] + (sum[2] + sum[1] * at[1]);
    let mut slopes = [[T::zero(); 2]; 2];
    if total > T::zero() {
        for (i, coordinate) in slopes.iter_mut().enumerate() {
            for axis in 0..2 {
                coordinate[axis] = (planes.weights[i + 1][axis] - uv[i] * sum[axis]) / total;
            }
        }
    }
    slopes
}

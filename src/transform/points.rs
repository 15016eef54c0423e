//! Points, vectors and normals through matrices, to pixels and back.
//!
//! One matrix serves a whole array, or each point has its own. What lies behind the eye (w ≤ 0) has no pixel: NaN.

use super::{Rows3, Rows4, normal_matrix::normal_matrix};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::vec::{Mat3, Mat4, Vec3, Vec4};

const PIECE: usize = 1 << 14;

/// What becomes of each point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// w = 1, divided by the resulting w.
    Point,
    /// w = 0: the linear part alone.
    Vector,
    /// By the normal matrix, then unit length.
    Normal,
}

/// Each item with its matrix: `matrices` holds one for all, or one each.
pub fn transform<T: Real>(
    watch: &mut dyn Watch,
    kind: Kind,
    points: &[[T; 3]],
    matrices: &[Rows4<T>],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    match kind {
        Kind::Point => map(watch, points, matrices, out, Mat4::from_rows, |m, p| {
            over_w(m.mul_point(p.into())).to_array()
        }),
        Kind::Vector => map(
            watch,
            points,
            matrices,
            out,
            |r| Mat4::from_rows(r).mat3(),
            |m, p| m.mul_vec(p.into()).to_array(),
        ),
        Kind::Normal => map(
            watch,
            points,
            matrices,
            out,
            |r| normal_matrix(Mat4::from_rows(r).mat3()),
            |m: &Mat3<T>, p| m.mul_vec(p.into()).normalize().to_array(),
        ),
    }
}

/// Points to homogeneous coordinates, before any division: clip space, if the matrices project.
pub fn homogeneous<T: Real>(
    watch: &mut dyn Watch,
    points: &[[T; 3]],
    matrices: &[Rows4<T>],
    out: &mut [[T; 4]],
) -> Result<(), Interrupted> {
    map(watch, points, matrices, out, Mat4::from_rows, |m, p| m.mul_point(p.into()).to_array())
}

/// [`transform`] in the plane; normals have no kind of their own there.
pub fn transform_2d<T: Real>(
    watch: &mut dyn Watch,
    kind: Kind,
    points: &[[T; 2]],
    matrices: &[Rows3<T>],
    out: &mut [[T; 2]],
) -> Result<(), Interrupted> {
    if kind == Kind::Point {
        map(watch, points, matrices, out, Mat3::from_rows, |m, p| {
            let Vec3 { x, y, z } = plane_point(m, p);
            [x / z, y / z]
        })
    } else {
        map(watch, points, matrices, out, Mat3::from_rows, |Mat3([a, b, _]), [x, y]| {
            [a.x * x + b.x * y, a.y * x + b.y * y]
        })
    }
}

/// [`homogeneous`] in the plane.
pub fn homogeneous_2d<T: Real>(
    watch: &mut dyn Watch,
    points: &[[T; 2]],
    matrices: &[Rows3<T>],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    map(watch, points, matrices, out, Mat3::from_rows, |m, p| plane_point(m, p).to_array())
}

#[inline(always)]
fn plane_point<T: Real>(&Mat3([a, b, c]): &Mat3<T>, [x, y]: [T; 2]) -> Vec3<T> {
    a * x + b * y + c
}

/// Points to pixels of a picture of `size` (x right, y down) and depth z/w.
pub fn project<T: Real>(
    watch: &mut dyn Watch,
    points: &[[T; 3]],
    matrices: &[Rows4<T>],
    size: [T; 2],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    let half = size.map(|s| s * T::of(0.5));
    map(watch, points, matrices, out, Mat4::from_rows, |m: &Mat4<T>, p| {
        let clip = m.mul_point(p.into());
        let visible = if clip.w > T::zero() { clip.w } else { T::NAN };
        let ndc = clip.xyz().map(|c| c / visible);
        [(ndc.x + T::one()) * half[0], (T::one() - ndc.y) * half[1], ndc.z]
    })
}

/// The inverse of [`project`], given the matrices' inverses.
pub fn unproject<T: Real>(
    watch: &mut dyn Watch,
    pixels: &[[T; 3]],
    inverses: &[Rows4<T>],
    size: [T; 2],
    out: &mut [[T; 3]],
) -> Result<(), Interrupted> {
    let twice = size.map(|s| T::of(2.0) / s);
    map(watch, pixels, inverses, out, Mat4::from_rows, |m, [x, y, z]| {
        let ndc = Vec3::new(x * twice[0] - T::one(), T::one() - y * twice[1], z);
        over_w(m.mul_point(ndc)).to_array()
    })
}

/// The inverse, computed in double precision; None if the matrix is singular.
pub fn inverse<T: Real>(m: &Rows4<f64>) -> Option<Rows4<T>> {
    // glam takes columns; the transpose of the inverse is the inverse of the transpose.
    let m = glam::DMat4::from_cols_array_2d(m);
    let inverse = m.inverse();
    let finite = m.determinant() != 0.0 && inverse.is_finite();
    finite.then(|| inverse.to_cols_array_2d().map(|row| row.map(T::of)))
}

#[inline(always)]
fn over_w<T: Real>(p: Vec4<T>) -> Vec3<T> {
    p.xyz().map(|c| c / p.w)
}

/// Applies `f` to each item and what `prepare` made of its matrix; a common matrix is prepared once.
fn map<T: Real, R: Copy + Sync, M: Sync, const D: usize, const N: usize>(
    watch: &mut dyn Watch,
    points: &[[T; D]],
    matrices: &[R],
    out: &mut [[T; N]],
    prepare: impl Fn(R) -> M + Sync,
    f: impl Fn(&M, [T; D]) -> [T; N] + Sync,
) -> Result<(), Interrupted> {
    if let [common] = matrices {
        let m = prepare(*common);
        parallel::for_each(
            watch,
            (points, out),
            PIECE,
            |_, (points, out): (&[[T; D]], &mut [[T; N]])| dispatch!(_s => common_body(points, out, |p| f(&m, p))),
        )
    } else {
        parallel::for_each(
            watch,
            (points, matrices, out),
            PIECE,
            |_, (points, matrices, out)| dispatch!(_s => each_body(points, matrices, out, |m, p| f(&prepare(m), p))),
        )
    }
}

#[inline(always)]
fn common_body<T: Real, const D: usize, const N: usize>(
    points: &[[T; D]],
    out: &mut [[T; N]],
    f: impl Fn([T; D]) -> [T; N],
) {
    for (out, &p) in out.iter_mut().zip(points) {
        *out = f(p);
    }
}

#[inline(always)]
fn each_body<T: Real, R: Copy, const D: usize, const N: usize>(
    points: &[[T; D]],
    matrices: &[R],
    out: &mut [[T; N]],
    f: impl Fn(R, [T; D]) -> [T; N],
) {
    for ((out, &p), &m) in out.iter_mut().zip(points).zip(matrices) {
        *out = f(m, p);
    }
}

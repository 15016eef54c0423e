//! What of a segment lies within an axis-aligned rectangle or box, by two algorithms:
//!
//! - [`Method::CohenSutherland`]: codes of the regions in which the ends lie reject and accept; else an end moves to a
//!   border that its code names, and so on. W. Newman, R. Sproull, *Principles of Interactive Computer Graphics*, 1979.
//! - [`Method::LiangBarsky`]: the parameters at which the segment passes each border shrink an interval. Y. Liang, B. Barsky,
//!   *A New Concept and Method for Line Clipping*, ACM Transactions on Graphics 3(1), 1984.
//!
//! Whether anything is left is decided exactly beforehand, so that a corner touched is a point, by either. What is left
//! lies within the box to the bit.

use super::predicate;
use crate::real::{Lanes, Real};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    CohenSutherland,
    LiangBarsky,
}

/// What is left of a segment, and how it was found.
#[derive(Clone, Copy, Debug)]
pub struct Clipped<T, const N: usize> {
    pub hit: bool,
    pub ends: [[T; N]; 2],
    /// Where along the segment, from 0 to 1.
    pub t: [T; 2],
    /// Regions of the ends: bit 2 k below the box on axis k, bit 2 k + 1 above it.
    pub codes: [u8; 2],
}

/// The region of a point around the box.
#[inline(always)]
pub fn region<T: Real, const N: usize>(p: [T; N], [low, high]: [[T; N]; 2]) -> u8 {
    let mut code = 0;
    for k in 0..N {
        code |= ((p[k] < low[k]) as u8) << (2 * k) | ((p[k] > high[k]) as u8) << (2 * k + 1);
    }
    code
}

/// Whether a segment meets the box: no border has both ends beyond it, and in no coordinate plane does its line pass the
/// rectangle by.
#[inline(never)]
fn meets<T: Real, const N: usize>([p, q]: [[T; N]; 2], b: [[T; N]; 2]) -> bool {
    if region(p, b) & region(q, b) != 0 {
        return false;
    }
    let at = |v: [T; N], k: usize| v[k].to_f64();
    for i in 0..N {
        for j in i + 1..N {
            let flat = |v: [T; N]| [at(v, i), at(v, j), 0.0];
            let (p, q, low, high) = (flat(p), flat(q), flat(b[0]), flat(b[1]));
            // The corners farthest to the left and to the right of the line.
            let corner = |right: bool| {
                let x = if (q[1] > p[1]) == right { high[0] } else { low[0] };
                let y = if (q[0] > p[0]) == right { low[1] } else { high[1] };
                [x, y, 0.0]
            };
            if predicate::turn([0, 1], p, q, corner(false)) < 0.0
                || predicate::turn([0, 1], p, q, corner(true)) > 0.0
            {
                return false;
            }
        }
    }
    true
}

/// The parameter at which the segment reaches `border` on axis `k`.
#[inline(always)]
fn parameter<T: Real>(p: T, q: T, border: T) -> T {
    (border - p) / (q - p)
}

/// The point at `t`, from the nearer end.
#[inline(always)]
fn at<T: Real, const N: usize>(p: [T; N], q: [T; N], t: T) -> [T; N] {
    let mut x = p;
    for k in 0..N {
        let d = q[k] - p[k];
        x[k] = if t < T::of(0.5) { p[k] + t * d } else { q[k] - (T::one() - t) * d };
    }
    x
}

#[inline(always)]
fn cohen_sutherland<T: Real, const N: usize>(p: [T; N], q: [T; N], b: [[T; N]; 2]) -> ([[T; N]; 2], [T; 2]) {
    let (mut ends, mut t) = ([p, q], [T::zero(), T::one()]);
    for e in 0..2 {
        // Each border moves an end at most once: then it lies on it.
        for _ in 0..2 * N {
            let code = region(ends[e], b);
            if code == 0 {
                break;
            }
            let bit = code.trailing_zeros() as usize;
            let (k, border) = (bit / 2, b[bit % 2][bit / 2]);
            t[e] = parameter(p[k], q[k], border).clamp01();
            ends[e] = at(p, q, t[e]);
            ends[e][k] = border;
        }
    }
    (ends, t)
}

#[inline(always)]
fn liang_barsky<T: Real, const N: usize>(
    p: [T; N],
    q: [T; N],
    [low, high]: [[T; N]; 2],
) -> ([[T; N]; 2], [T; 2]) {
    let mut t = [T::zero(), T::one()];
    // The borders on which the ends come to lie.
    let mut onto = [None, None];
    for k in 0..N {
        if p[k] == q[k] {
            continue;
        }
        let (near, far) = if p[k] < q[k] { (low[k], high[k]) } else { (high[k], low[k]) };
        let (enter, leave) = (parameter(p[k], q[k], near), parameter(p[k], q[k], far));
        if enter > t[0] {
            (t[0], onto[0]) = (enter, Some((k, near)));
        }
        if leave < t[1] {
            (t[1], onto[1]) = (leave, Some((k, far)));
        }
    }
    let mut ends = [p, q];
    for e in 0..2 {
        if let Some((k, border)) = onto[e] {
            ends[e] = at(p, q, t[e].clamp01());
            ends[e][k] = border;
        }
    }
    (ends, t)
}

#[inline(never)]
pub fn clip_segment<T: Real, const N: usize>(
    method: Method,
    p: [T; N],
    q: [T; N],
    b: [[T; N]; 2],
) -> Clipped<T, N> {
    let mut proper = true;
    for k in 0..N {
        proper &= p[k].is_finite() & q[k].is_finite() & (b[0][k] <= b[1][k]);
        proper &= b[0][k].is_finite() & b[1][k].is_finite();
    }
    let codes = [region(p, b), region(q, b)];
    if !proper || !meets([p, q], b) {
        return Clipped { hit: false, ends: [[T::NAN; N]; 2], t: [T::NAN; 2], codes };
    }
    let (mut ends, mut t) = match method {
        Method::CohenSutherland => cohen_sutherland(p, q, b),
        Method::LiangBarsky => liang_barsky(p, q, b),
    };
    // At a corner that is barely met rounding may swap the ends: they are one point.
    if t[0] > t[1] {
        let middle = (t[0] + t[1]) * T::of(0.5);
        (t, ends) = ([middle; 2], [at(p, q, middle); 2]);
    }
    for end in &mut ends {
        for k in 0..N {
            end[k] = Lanes::min(Lanes::max(end[k], b[0][k]), b[1][k]);
        }
    }
    Clipped { hit: true, ends, t, codes }
}

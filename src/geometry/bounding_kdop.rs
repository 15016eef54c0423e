//! The smallest discrete-orientation polytope around points: least and greatest heights along fixed directions, whose
//! components are -1, 0, 1. Heights are sums of coordinates; where rounding would move one inwards it is moved outwards, so
//! that no point is excluded, neither exactly nor by its rounded sum; sums that are exact stay as they are.
//!
//! J. Klosowski et al., *Efficient Collision Detection Using Bounding Volume Hierarchies of k-DOPs*, IEEE Transactions on
//! Visualization and Computer Graphics 4(1), 1998.

use crate::math::exact::two_sum;
use crate::real::Real;

/// Axes (3), diagonals of the cube (4), diagonals of its faces (6).
pub const DIRECTIONS: [[i8; 3]; 13] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 1, 1],
    [1, 1, -1],
    [1, -1, 1],
    [1, -1, -1],
    [1, 1, 0],
    [1, -1, 0],
    [1, 0, 1],
    [1, 0, -1],
    [0, 1, 1],
    [0, 1, -1],
];

/// The directions of a polytope of `k` sides, as places in [`DIRECTIONS`].
pub fn directions(k: usize) -> Option<&'static [usize]> {
    match k {
        6 => Some(&[0, 1, 2]),
        14 => Some(&[0, 1, 2, 3, 4, 5, 6]),
        18 => Some(&[0, 1, 2, 7, 8, 9, 10, 11, 12]),
        26 => Some(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]),
        _ => None,
    }
}

/// The height of a point, rounded down and up, and no farther in than its sum as the precision has it.
#[inline(always)]
fn height<T: Real>(p: [T; 3], d: [i8; 3]) -> [T; 2] {
    let part = |k: usize| {
        if d[k] == 0 {
            T::zero()
        } else if d[k] > 0 {
            p[k]
        } else {
            -p[k]
        }
    };
    let (sum, e) = two_sum(part(0), part(1));
    let (own, f) = two_sum(sum, part(2));
    // Where much cancels, what rounding lost is more than a unit of what is left.
    let (lost, rest) = two_sum(e, f);
    let (exact, more) = two_sum(own, lost);
    let rest = rest + more;
    let down = if rest < T::zero() { exact.next_down() } else { exact };
    let up = if rest > T::zero() { exact.next_up() } else { exact };
    [if own < down { own } else { down }, if own > up { own } else { up }]
}

/// Least and greatest heights along one direction; NaN where a point is.
#[inline(always)]
pub fn extent<T: Real>(points: &[[T; 3]], direction: [i8; 3]) -> [T; 2] {
    let (mut low, mut high, mut nan) = (T::INFINITY, -T::INFINITY, false);
    for &p in points {
        let [down, up] = height(p, direction);
        low = if down < low { down } else { low };
        high = if up > high { up } else { high };
        nan |= p[0].is_nan() | p[1].is_nan() | p[2].is_nan();
    }
    if nan { [T::NAN; 2] } else { [low, high] }
}

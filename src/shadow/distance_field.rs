//! Soft shadows from a distance field: a ray to the light's centre, and how closely it passes by things.
//!
//! A surface d beside the ray, t along it, covers the part of the light that d / (t tan α) tells, where α is half the
//! angle that the light spans: −1 hides it, 1 leaves it whole. The least of these along the ray decides. Steps are as
//! long as the field allows. Between two of them, Δ apart, lies the nearest point of what both spheres touch, a distance
//! y = (Δ² + h² − h₀²) / 2Δ back from the second: there the surface is √(h² − y²) beside the ray.
//!
//! I. Quilez, *Free penumbra shadows for raymarching distance fields*, 2007 and 2018; S. Aaltonen, *GPU-based clay
//! simulation and ray-tracing tech in Claybook*, GDC 2018 (the point between steps).

use crate::dispatch;
use crate::math;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::shadow::lookup::at;
use crate::vec::Vec3;

/// Distances at the nodes of a grid of cubes, x slowest.
#[derive(Clone, Copy)]
pub struct Field<'a, T> {
    values: &'a [T],
    size: [usize; 3],
    low: Vec3<T>,
    cell: T,
    per_cell: T,
}

impl<'a, T: Real> Field<'a, T> {
    /// `None` unless there are at least two nodes each way and the values fill them.
    pub fn new(values: &'a [T], size: [usize; 3], low: [T; 3], cell: T) -> Option<Self> {
        let count = size[0].checked_mul(size[1]).and_then(|n| n.checked_mul(size[2]));
        let fits = size.iter().all(|&n| (2..1 << 22).contains(&n)) && count == Some(values.len());
        (fits && cell > T::zero()).then(|| Field {
            values,
            size,
            low: low.into(),
            cell,
            per_cell: T::one() / cell,
        })
    }

    /// Between the eight nodes about a point; beyond the border as on it.
    #[inline(always)]
    pub fn distance(&self, p: Vec3<T>) -> T {
        let q = (p - self.low) * self.per_cell;
        let (x, fx) = cell_of(q.x, self.size[0]);
        let (y, fy) = cell_of(q.y, self.size[1]);
        let (z, fz) = cell_of(q.z, self.size[2]);
        let (row, slice) = (self.size[2], self.size[1] * self.size[2]);
        let first = x * slice + y * row + z;
        let near = self.face(first, row, fy, fz);
        let far = self.face(first + slice, row, fy, fz);
        near + (far - near) * fx
    }

    #[inline(always)]
    fn face(&self, first: usize, row: usize, fy: T, fz: T) -> T {
        let v = self.values;
        let low = v[first] + (v[first + 1] - v[first]) * fz;
        let high = v[first + row] + (v[first + row + 1] - v[first + row]) * fz;
        low + (high - low) * fy
    }

    /// Where a ray is within the grid: from and to.
    #[inline(always)]
    fn within(&self, origin: Vec3<T>, direction: Vec3<T>) -> (T, T) {
        let (o, d, low) = (origin.to_array(), direction.to_array(), self.low.to_array());
        let (mut from, mut to) = (T::zero(), T::INFINITY);
        for i in 0..3 {
            let high = low[i] + self.cell * T::of((self.size[i] - 1) as f64);
            let per = T::one() / d[i];
            let (a, b) = ((low[i] - o[i]) * per, (high - o[i]) * per);
            let (a, b) = if a < b { (a, b) } else { (b, a) };
            if d[i] == T::zero() {
                if o[i] < low[i] || o[i] > high {
                    return (T::zero(), -T::one());
                }
            } else {
                from = Lanes::max(from, a);
                to = Lanes::min(to, b);
            }
        }
        (from, to)
    }
}

/// The node before a place, with one after it, and how far it is between them.
#[inline(always)]
fn cell_of<T: Real>(x: T, n: usize) -> (usize, T) {
    let last = T::of((n - 1) as f64);
    let x = Lanes::min(Lanes::max(x, T::zero()), last);
    let i = (x.floor().to_f64() as usize).min(n - 2);
    (i, x - T::of(i as f64))
}

/// Where the light's centre is.
#[derive(Clone, Copy, Debug)]
pub enum Towards<T> {
    Position(Vec3<T>),
    /// Unit.
    Direction(Vec3<T>),
}

/// How wide the light is.
#[derive(Clone, Copy, Debug)]
pub enum Spread<T> {
    /// Half the side, or the radius, in world units.
    Half(T),
    /// The tangent of half the angle that it spans: the reciprocal of k.
    Tangent(T),
}

/// What lies between steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimate {
    /// Each step's own distance.
    Step,
    /// The nearest point between the last two.
    Between,
}

/// What share of the light is seen past an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// None once the ray touches, all of it at the penumbra's outer end.
    Outer,
    /// Of a square whose side is parallel to the edge.
    Box,
    Disk,
}

#[derive(Clone, Copy, Debug)]
pub struct Knobs<T> {
    pub towards: Towards<T>,
    pub spread: Spread<T>,
    pub estimate: Estimate,
    pub profile: Profile,
    pub max_steps: usize,
    /// Of the distance that a step could take.
    pub step: T,
    /// Cells: how far rays start off the surface along its normal, and from where on things count.
    pub offset: T,
}

/// What one ray found.
#[derive(Clone, Copy)]
struct Passed<T> {
    lit: T,
    /// The least share d / (t tan α), and where.
    closest: T,
    at: T,
    steps: T,
}

/// Closest approach, its distance along the ray, steps.
pub type Intermediates<'a, T> = (&'a mut [T], &'a mut [T], &'a mut [T]);

/// The lit fraction of every receiver.
pub fn distance_field<T: Real>(
    watch: &mut dyn Watch,
    field: &Field<'_, T>,
    receivers: &[[T; 3]],
    normals: Option<&[[T; 3]]>,
    knobs: &Knobs<T>,
    out: &mut [T],
    more: Option<Intermediates<'_, T>>,
) -> Result<(), Interrupted> {
    let piece = ((1 << 17) / knobs.max_steps).clamp(1, 1 << 11);
    parallel::for_each(watch, (receivers, normals, out, more), piece, |_, (p, n, out, mut more)| {
        dispatch!(_s => for i in 0..out.len() {
            let found = one(field, p[i].into(), at(n, i), knobs);
            out[i] = found.lit;
            if let Some((closest, along, steps)) = &mut more {
                (closest[i], along[i], steps[i]) = (found.closest, found.at, found.steps);
            }
        })
    })
}

#[inline(always)]
fn one<T: Real>(field: &Field<'_, T>, point: Vec3<T>, normal: Option<[T; 3]>, knobs: &Knobs<T>) -> Passed<T> {
    let (zero, one) = (T::zero(), T::one());
    let gap = knobs.offset * field.cell;
    let mut origin = point;
    if let Some(n) = normal {
        origin = origin + Vec3::from(n) * gap;
    }
    let (direction, reach) = match knobs.towards {
        Towards::Direction(d) => (d, T::INFINITY),
        Towards::Position(p) => {
            let away = p - origin;
            let reach = away.length();
            (away * (one / reach), reach)
        }
    };
    let check = origin.x + origin.y + origin.z;
    if !check.is_finite() || reach.is_nan() {
        return Passed { lit: T::NAN, closest: T::NAN, at: T::NAN, steps: zero };
    }
    let nothing = Passed { lit: one, closest: one, at: zero, steps: zero };
    if !(reach > zero) {
        return nothing;
    }
    let tangent = match knobs.spread {
        Spread::Half(half) => half / reach,
        Spread::Tangent(t) => t,
    };
    // A light without extent: an edge hides it or not.
    let per = one / Lanes::max(tangent, T::of(1e-6));
    let (from, to) = field.within(origin, direction);
    let to = Lanes::min(to, reach);
    let mut t = Lanes::max(from, gap);

    // What grows as the receiver's own plane does is that plane: of the light below it nothing is sent anyway.
    let rise = if let Some(n) = normal { Vec3::from(n).dot(direction) } else { -one };
    let own = T::of(1.0 - 1e-3);
    let least = T::of(0.25) * field.cell;
    let floor = if knobs.profile == Profile::Outer { zero } else { -one };
    let (mut closest, mut along) = (one, zero);
    let (mut before, mut moved) = (-one, zero);
    let mut steps = 0;
    while steps < knobs.max_steps && t < to {
        steps += 1;
        let h = field.distance(origin + direction * t);
        let (mut d, mut place) = (h, t);
        if knobs.estimate == Estimate::Between && before > zero && h > zero {
            let back = (moved * moved + h * h - before * before) / (moved + moved);
            if back > zero && back < moved {
                d = Lanes::max(h * h - back * back, zero).sqrt();
                place = t - back;
            }
        }
        let of_own = rise > zero && h >= own * (gap + t * rise);
        let share = d * per / place;
        if share < closest && !of_own {
            (closest, along) = (share, place);
            if closest <= floor {
                break;
            }
        }
        before = h;
        moved = Lanes::max(knobs.step * h.abs(), least);
        t += moved;
    }
    closest = Lanes::max(closest, floor);
    let half = T::of(0.5);
    let lit = match knobs.profile {
        Profile::Outer => closest,
        Profile::Box => half + half * closest,
        Profile::Disk => {
            let chord = Lanes::max(one - closest * closest, zero).sqrt();
            half + (math::atan2(closest, chord) + closest * chord) * T::of(1.0 / std::f64::consts::PI)
        }
    };
    Passed { lit, closest, at: along, steps: T::of(steps as f64) }
}

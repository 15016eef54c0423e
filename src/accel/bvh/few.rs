//! Few triangles: no tree, but every triangle against eight rays at a time. Each vertex is brought into the rays' frame
//! once, however many triangles share it; so rays of one dominant axis go together, whatever else sets them apart. The
//! rule by which hits are decided is that of all structures (see [`crate::accel::block`]).

use super::single::splat8;
use crate::accel::batch::{Sink, Source};
use crate::accel::ray::{Eight, Heading, Ready, load8, prepare, proper, slabs};
use crate::accel::{Hit, Ray};
use crate::geometry::ray_triangle::{dominant_axis, permutation, watertight};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use std::mem::MaybeUninit;

/// Meshes up to so many faces and different vertices are traced so: beyond, a tree is faster.
const FACES: usize = 96;
const VERTICES: usize = 96;

/// The triangles: empty if they are not few.
#[derive(Clone, Debug, Default)]
pub struct Few<T> {
    vertices: Vec<[T; 3]>,
    faces: Vec<Face<T>>,
}

#[derive(Clone, Copy, Debug)]
struct Face<T> {
    /// Below [`VERTICES`].
    corners: [u32; 3],
    /// The triangle's own box.
    lower: [T; 3],
    upper: [T; 3],
}

/// A vertex in the frames of eight rays: where it lies across, and along the dominant axis.
type Seen<T> = [[T; 8]; 3];

impl<T: Real> Few<T> {
    pub fn new(positions: &[[T; 3]], faces: &[[i32; 3]]) -> Self {
        let mut few = Few::default();
        if faces.len() > FACES {
            return few;
        }
        for face in faces {
            let [a, b, c] = face.map(|v| positions[v as usize]);
            let corners = [a, b, c].map(|p| few.number(p));
            let mut made = Face { corners, lower: a, upper: a };
            for k in 0..3 {
                made.lower[k] = a[k].min(b[k]).min(c[k]);
                made.upper[k] = a[k].max(b[k]).max(c[k]);
            }
            few.faces.push(made);
        }
        if few.vertices.len() > VERTICES { Few::default() } else { few }
    }

    /// The number of a vertex: equal ones share it.
    fn number(&mut self, p: [T; 3]) -> u32 {
        let found = self.vertices.iter().position(|&q| q == p);
        found.unwrap_or_else(|| {
            self.vertices.push(p);
            self.vertices.len() - 1
        }) as u32
    }

    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    pub fn bytes(&self) -> usize {
        size_of_val(&*self.vertices) + size_of_val(&*self.faces)
    }

    /// Traces the `chosen` rays and hands each answer, with its ray's index, to `answer`.
    #[inline(always)]
    pub fn trace<const ANY: bool, S: Simd>(
        &self,
        s: S,
        bounds: &[[T; 3]; 2],
        rays: &impl Source<T>,
        chosen: &[u32],
        answer: &mut impl Sink<T>,
    ) {
        // The rays that wait, by dominant axis. What remains at the end is brought up to eight by repetition.
        let mut waiting = [([0usize; 8], 0usize); 3];
        for i in 0..chosen.len() + 3 {
            let ray = chosen.get(i).copied();
            let axis = match ray {
                Some(ray) => dominant_axis(rays.ray(ray as usize).direction),
                None => i - chosen.len(),
            };
            let (eight, filled) = &mut waiting[axis];
            if let Some(ray) = ray {
                eight[*filled & 7] = ray as usize;
                *filled += 1;
                if *filled < 8 {
                    continue;
                }
            }
            let lanes = std::mem::take(filled);
            if lanes == 0 {
                continue;
            }
            let eight = *eight;
            let mut group = [rays.ray(eight[0]); 8];
            for l in 1..lanes {
                group[l] = rays.ray(eight[l & 7]);
            }
            let hits = self.eight::<ANY, S>(s, bounds, axis, &group);
            for l in 0..lanes {
                answer.put(eight[l & 7], hits.get(l));
            }
        }
    }

    /// Eight rays of one dominant axis. Enters the level anew: compiled once for all that gather rays.
    #[inline(never)]
    fn eight<const ANY: bool, S: Simd>(
        &self,
        s: S,
        bounds: &[[T; 3]; 2],
        axis: usize,
        rays: &[Ray<T>; 8],
    ) -> Hits<T> {
        s.vectorize(
            #[inline(always)]
            || self.eight_here::<ANY, S>(s, bounds, axis, rays),
        )
    }

    #[inline(always)]
    fn eight_here<const ANY: bool, S: Simd>(
        &self,
        s: S,
        bounds: &[[T; 3]; 2],
        axis: usize,
        rays: &[Ray<T>; 8],
    ) -> Hits<T> {
        let zero = splat8::<T, S>(s, T::zero());
        let mut ignored = [T::zero(); 8];
        for l in 0..8 {
            ignored[l] = T::of(rays[l].ignore_face as f64);
        }
        let ignored = load8(s, &ignored);
        let Eight { origin, direction, t_min, t_max } = Eight::load(
            s,
            #[inline(always)]
            |l| rays[l],
        );
        let proper = proper(origin, direction, t_min, t_max);
        let heading = Heading { order: permutation(axis), negative: [0; 3] };
        let ray = prepare(bounds, origin, direction, t_min, t_max).ready(heading);
        let mut seen = [MaybeUninit::<Seen<T>>::uninit(); VERTICES];
        for (p, seen) in self.vertices.iter().zip(&mut seen) {
            seen.write(look(s, p, &ray, heading));
        }
        // The end itself is excluded, as with every structure.
        let (mut best, mut best_u, mut best_v) = (ray.t_max, zero, zero);
        let mut best_face = splat8::<T, S>(s, -T::one());
        for (i, face) in self.faces.iter().enumerate() {
            let [a, b, c] = corners(&seen, face);
            let (ax, ay, bx, by) = (load8(s, &a[0]), load8(s, &a[1]), load8(s, &b[0]), load8(s, &b[1]));
            let (cx, cy) = (load8(s, &c[0]), load8(s, &c[1]));
            // As in `watertight`, which is asked where an edge function is zero.
            let (ea, eb, ec) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
            // Negative if two have opposite signs, and zero if one is: also by underflow, which does no harm there.
            let sides = SimdBase::min(SimdBase::min(ea, eb), ec) * SimdBase::max(SimdBase::max(ea, eb), ec);
            let mut inside = Lanes::less_eq(zero, sides);
            if T::V8::<S>::bits(inside) == 0 {
                continue;
            }
            let det = ea + eb + ec;
            let (w, mut u, mut v) = (ea / det, eb / det, ec / det);
            let mut t = (w * load8(s, &a[2]) + u * load8(s, &b[2]) + v * load8(s, &c[2])) * ray.shear.z;
            if T::V8::<S>::bits(sides.equal(zero)) != 0 {
                (inside, t, u, v) = self.exact(s, face, &ray, heading);
            }
            let inside = inside & Lanes::less(ray.t_min, t) & Lanes::less(t, best);
            if T::V8::<S>::bits(inside) == 0 {
                continue;
            }
            let (entry, exit) = own_box(s, face, &ray);
            let t = Lanes::max(t, entry);
            let number = splat8::<T, S>(s, T::of(i as f64));
            let passed = Lanes::less_eq(entry, exit) & Lanes::less_eq(ray.t_min, exit);
            // Faces come in rising order, so that the first of equals stays.
            let better = inside & passed & Lanes::less(t, best) & !number.equal(ignored);
            best_face = T::V8::<S>::select(better, number, best_face);
            if ANY {
                // One hit is enough: nothing comes before this end.
                best = T::V8::<S>::select(better, splat8(s, -T::INFINITY), best);
                if T::V8::<S>::bits(Lanes::less_eq(zero, best_face)) == 0xff {
                    break;
                }
            } else {
                best = T::V8::<S>::select(better, t, best);
                best_u = T::V8::<S>::select(better, u, best_u);
                best_v = T::V8::<S>::select(better, v, best_v);
            }
        }
        Hits {
            proper: T::V8::<S>::bits(proper),
            // As in `Ready::finish`.
            t: (best * ray.scale + zero).to_array(),
            u: best_u.to_array(),
            v: best_v.to_array(),
            face: best_face.to_array(),
        }
    }

    /// Edge functions that round to zero need their exact values.
    #[cold]
    #[inline(never)]
    fn exact<S: Simd>(
        &self,
        s: S,
        face: &Face<T>,
        ray: &Ready<T::V8<S>>,
        heading: Heading,
    ) -> (<T::V8<S> as Lanes>::Mask, T::V8<S>, T::V8<S>, T::V8<S>) {
        s.vectorize(
            #[inline(always)]
            || {
                let [x, y, z] = heading.order;
                let mut corners = [[splat8::<T, S>(s, T::zero()); 3]; 3];
                for i in 0..3 {
                    let p = &self.vertices[face.corners[i] as usize];
                    corners[i] = [splat8(s, p[x]), splat8(s, p[y]), splat8(s, p[z])];
                }
                let [a, b, c] = corners;
                let zero = splat8::<T, S>(s, T::zero());
                match watertight(ray.origin, ray.shear, a.into(), b.into(), c.into()) {
                    Some((inside, x)) => (inside, x.t, x.u, x.v),
                    None => (Lanes::less(zero, zero), zero, zero, zero),
                }
            },
        )
    }
}

/// The corners of a triangle as the rays see them.
#[inline(always)]
fn corners<'a, T>(seen: &'a [MaybeUninit<Seen<T>>; VERTICES], face: &Face<T>) -> [&'a Seen<T>; 3] {
    let [a, b, c] = face.corners;
    // Sound: corners are numbers of vertices, all of which were looked at.
    unsafe {
        [
            seen.get_unchecked(a as usize).assume_init_ref(),
            seen.get_unchecked(b as usize).assume_init_ref(),
            seen.get_unchecked(c as usize).assume_init_ref(),
        ]
    }
}

/// What eight rays hit.
struct Hits<T> {
    proper: u32,
    t: [T; 8],
    u: [T; 8],
    v: [T; 8],
    /// Negative for a miss.
    face: [T; 8],
}

impl<T: Real> Hits<T> {
    #[inline(always)]
    fn get(&self, l: usize) -> Hit<T> {
        if self.proper >> l & 1 == 0 {
            return Hit::no_ray();
        }
        let face = self.face[l].to_f64() as i32;
        if face < 0 { Hit::miss() } else { Hit { t: self.t[l], u: self.u[l], v: self.v[l], face } }
    }
}

/// A vertex in the rays' frame, by the arithmetic of [`watertight`].
#[inline(always)]
fn look<T: Real, S: Simd>(s: S, p: &[T; 3], ray: &Ready<T::V8<S>>, heading: Heading) -> Seen<T> {
    let [x, y, z] = heading.order;
    let depth = splat8::<T, S>(s, p[z]) - ray.origin.z;
    let across = splat8::<T, S>(s, p[x]) - ray.origin.x - ray.shear.x * depth;
    let up = splat8::<T, S>(s, p[y]) - ray.origin.y - ray.shear.y * depth;
    [across.to_array(), up.to_array(), depth.to_array()]
}

/// Where rays of different signs enter and leave a triangle's own box.
#[inline(always)]
fn own_box<T: Real, S: Simd>(s: S, face: &Face<T>, ray: &Ready<T::V8<S>>) -> (T::V8<S>, T::V8<S>) {
    let zero = splat8::<T, S>(s, T::zero());
    let (mut near, mut far) = (ray.near, ray.far);
    for k in 0..3 {
        let (lower, upper) = (splat8::<T, S>(s, face.lower[k]), splat8::<T, S>(s, face.upper[k]));
        let negative = Lanes::less(ray.inverse[k], zero);
        near[k] = T::V8::<S>::select(negative, upper, lower);
        far[k] = T::V8::<S>::select(negative, lower, upper);
    }
    slabs(near, far, ray.near, ray.far, ray.inverse)
}

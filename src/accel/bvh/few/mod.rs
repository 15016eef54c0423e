//! Few triangles: no tree, but every triangle against eight rays at a time. Each vertex is brought into the rays' frame
//! once, however many triangles share it; so rays of one dominant axis go together, whatever else sets them apart. The
//! rule by which hits are decided is that of all structures (see [`crate::accel::block`]). Guesses that fail would cost
//! more than arithmetic: what no ray's line meets is left out without a branch, and the rest is compared without one;
//! where that leaves a doubt, triangles are gone through one by one.

mod crossing;

use super::single::splat8;
use crate::accel::batch::{Sink, Source};
use crate::accel::ray::{Eight, Heading, Ready, load8, prepare, proper};
use crate::accel::{Hit, Ray};
use crate::geometry::ray_triangle::{dominant_axis, permutation, watertight};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use crossing::{Seen, crossing, edges, look, slabs_of};
use std::mem::MaybeUninit;

/// Meshes up to so many faces and different vertices are traced so: beyond, a tree is faster.
const FACES: usize = 96;
const VERTICES: usize = 96;
/// Faces after which rays are asked whether all have met one, where any will do.
const PART: usize = 12;

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
        let best = match self.nearest::<ANY, S>(s, &seen, &ray, ignored) {
            Some(best) => best,
            None => self.decided(s, &seen, &ray, ignored, heading),
        };
        Hits {
            proper: T::V8::<S>::bits(proper),
            // As in `Ready::finish`.
            t: (best.t * ray.scale + zero).to_array(),
            u: best.u.to_array(),
            v: best.v.to_array(),
            face: best.face.to_array(),
        }
    }

    /// Without a branch that rays could decide: all triangles whose edges some ray's line passes between, then of these
    /// the first along each ray, then its own box. None where that is not the rule's hit beyond doubt: a ray meets an
    /// edge, or its hit leaves its box, or is raised to another's.
    #[inline(always)]
    fn nearest<const ANY: bool, S: Simd>(
        &self,
        s: S,
        seen: &[MaybeUninit<Seen<T>>; VERTICES],
        ray: &Ready<T::V8<S>>,
        ignored: T::V8<S>,
    ) -> Option<Best<T::V8<S>>> {
        let (zero, end) = (splat8::<T, S>(s, T::zero()), splat8::<T, S>(s, T::INFINITY));
        let mut passed = [MaybeUninit::<Passed<T>>::uninit(); FACES];
        let mut best = Best { t: ray.t_max, u: zero, v: zero, face: splat8::<T, S>(s, -T::one()) };
        let (mut second, mut on_edge, mut first) = (end, Lanes::less(end, zero), 0);
        for part in self.faces.chunks(if ANY { PART } else { FACES }) {
            let mut count = 0;
            for (i, face) in (first..).zip(part) {
                let (edges, sides) = edges(s, corners(seen, face));
                // Sound: at most as many as faces before this one, which are at most `FACES`.
                unsafe { passed.get_unchecked_mut(count) }.write(Passed {
                    edges: [edges[0].to_array(), edges[1].to_array(), edges[2].to_array()],
                    sides: sides.to_array(),
                    face: i,
                });
                on_edge = on_edge | sides.equal(zero);
                count += usize::from(T::V8::<S>::bits(Lanes::less_eq(zero, sides)) != 0);
            }
            for passed in &passed[..count] {
                // Sound: written above.
                let passed = unsafe { passed.assume_init_ref() };
                let [a, b, c] = corners(seen, &self.faces[passed.face as usize]);
                let [ea, eb, ec] =
                    [load8(s, &passed.edges[0]), load8(s, &passed.edges[1]), load8(s, &passed.edges[2])];
                let (t, u, v) = crossing(s, [ea, eb, ec], [&a[2], &b[2], &c[2]], ray);
                let number = splat8::<T, S>(s, T::of(f64::from(passed.face)));
                let met = Lanes::less_eq(zero, load8(s, &passed.sides))
                    & Lanes::less(ray.t_min, t)
                    & !number.equal(ignored);
                let t = T::V8::<S>::select(met, t, end);
                let better = Lanes::less(t, best.t);
                second = SimdBase::min(second, SimdBase::max(t, best.t));
                best.t = T::V8::<S>::select(better, t, best.t);
                best.face = T::V8::<S>::select(better, number, best.face);
                if !ANY {
                    best.u = T::V8::<S>::select(better, u, best.u);
                    best.v = T::V8::<S>::select(better, v, best.v);
                }
            }
            if ANY && T::V8::<S>::bits(Lanes::less_eq(zero, best.face)) == 0xff {
                break;
            }
            first += part.len() as u32;
        }
        if T::V8::<S>::bits(on_edge) != 0 {
            return None;
        }
        let found = Lanes::less_eq(zero, best.face);
        let (entry, exit) = self.own_boxes(s, best.face, ray);
        let t = Lanes::max(best.t, entry);
        let sure = Lanes::less_eq(entry, exit) & Lanes::less_eq(ray.t_min, exit) & Lanes::less(t, second);
        best.t = T::V8::<S>::select(found, t, best.t);
        (T::V8::<S>::bits(found & !sure) == 0).then_some(best)
    }

    /// The boxes of the faces that the rays met, of no matter which where there is none.
    #[inline(always)]
    fn own_boxes<S: Simd>(&self, s: S, faces: T::V8<S>, ray: &Ready<T::V8<S>>) -> (T::V8<S>, T::V8<S>) {
        let faces = faces.to_array();
        let (mut lower, mut upper) = ([[T::zero(); 8]; 3], [[T::zero(); 8]; 3]);
        for l in 0..8 {
            let face = &self.faces[faces[l].to_f64().max(0.0) as usize];
            for k in 0..3 {
                (lower[k][l], upper[k][l]) = (face.lower[k], face.upper[k]);
            }
        }
        let [x, y, z] = [0, 1, 2];
        slabs_of::<T, S>(
            s,
            [load8(s, &lower[x]), load8(s, &lower[y]), load8(s, &lower[z])],
            [load8(s, &upper[x]), load8(s, &upper[y]), load8(s, &upper[z])],
            ray,
        )
    }

    /// The rule, triangle by triangle.
    #[cold]
    #[inline(never)]
    fn decided<S: Simd>(
        &self,
        s: S,
        seen: &[MaybeUninit<Seen<T>>; VERTICES],
        ray: &Ready<T::V8<S>>,
        ignored: T::V8<S>,
        heading: Heading,
    ) -> Best<T::V8<S>> {
        s.vectorize(
            #[inline(always)]
            || self.decided_here(s, seen, ray, ignored, heading),
        )
    }

    #[inline(always)]
    fn decided_here<S: Simd>(
        &self,
        s: S,
        seen: &[MaybeUninit<Seen<T>>; VERTICES],
        ray: &Ready<T::V8<S>>,
        ignored: T::V8<S>,
        heading: Heading,
    ) -> Best<T::V8<S>> {
        let (zero, none) = (splat8::<T, S>(s, T::zero()), splat8::<T, S>(s, -T::one()));
        // The end itself is excluded, as with every structure.
        let mut best = Best { t: ray.t_max, u: zero, v: zero, face: none };
        for (i, face) in self.faces.iter().enumerate() {
            let [a, b, c] = corners(seen, face);
            let (edges, sides) = edges(s, [a, b, c]);
            let mut inside = Lanes::less_eq(zero, sides);
            if T::V8::<S>::bits(inside) == 0 {
                continue;
            }
            let (mut t, mut u, mut v) = crossing(s, edges, [&a[2], &b[2], &c[2]], ray);
            if T::V8::<S>::bits(sides.equal(zero)) != 0 {
                (inside, t, u, v) = self.exact(s, face, ray, heading);
            }
            let inside = inside & Lanes::less(ray.t_min, t) & Lanes::less(t, best.t);
            if T::V8::<S>::bits(inside) == 0 {
                continue;
            }
            let [lower, upper] = [face.lower, face.upper].map(
                #[inline(always)]
                |p| [splat8::<T, S>(s, p[0]), splat8(s, p[1]), splat8(s, p[2])],
            );
            let (entry, exit) = slabs_of::<T, S>(s, lower, upper, ray);
            let t = Lanes::max(t, entry);
            let number = splat8::<T, S>(s, T::of(i as f64));
            let passed = Lanes::less_eq(entry, exit) & Lanes::less_eq(ray.t_min, exit);
            // Faces come in rising order, so that the first of equals stays.
            let better = inside & passed & Lanes::less(t, best.t) & !number.equal(ignored);
            best.face = T::V8::<S>::select(better, number, best.face);
            best.t = T::V8::<S>::select(better, t, best.t);
            best.u = T::V8::<S>::select(better, u, best.u);
            best.v = T::V8::<S>::select(better, v, best.v);
        }
        best
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

/// A triangle between whose edges some ray passes: edge functions, their [`edges`] number, its own.
#[derive(Clone, Copy)]
struct Passed<T> {
    edges: [[T; 8]; 3],
    sides: [T; 8],
    face: u32,
}

/// The nearest hit of each ray until now. Faces are negative where there is none.
#[derive(Clone, Copy)]
struct Best<V> {
    t: V,
    u: V,
    v: V,
    face: V,
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

//! Many rays that have little in common: sixteen are traced in turns, a node each, and the node that a ray needs next
//! is fetched while the others work. In large trees rays would otherwise wait for memory, and in small ones for branches
//! that were guessed wrong and for results that the next step needs.

use super::Bvh;
use super::node::{Child, Stack, key};
use super::single::{self, Sides, splat8};
use crate::accel::Hit;
use crate::accel::batch::{Sink, Source};
use crate::accel::block::leaf;
use crate::accel::ray::{Eight, Heading, Prepared, Ready, prepare, proper};
use crate::geometry::ray_triangle::{along, permutation};
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};

/// Rays under way at a time.
const ROWS: usize = 16;

/// A ray under way.
struct Row<T> {
    ray: Ready<T>,
    heading: Heading,
    sides: Sides,
    ignore: i32,
    hit: Hit<T>,
    /// What it visits in its next turn.
    child: Child,
    index: usize,
    stack: Stack,
}

impl<T: Real> Row<T> {
    #[inline(always)]
    fn new(index: usize, ignore: i32, (ray, heading): (Ready<T>, Heading)) -> Self {
        let stack = Stack::new();
        let sides = Sides::of(heading);
        Row { hit: ray.unhit(), ray, heading, sides, ignore, child: Child::ROOT, index, stack }
    }

    /// [`Row::new`] in place: the stack is large, and need not be moved.
    #[inline(always)]
    fn restart(&mut self, index: usize, ignore: i32, (ray, heading): (Ready<T>, Heading)) {
        self.hit = ray.unhit();
        (self.ray, self.heading, self.sides, self.ignore) = (ray, heading, Sides::of(heading), ignore);
        (self.child, self.index) = (Child::ROOT, index);
        self.stack.clear();
    }

    /// Visits one child; false if none is left.
    #[inline(always)]
    fn turn<const ANY: bool, S: Simd>(&mut self, s: S, tree: &Bvh<T>) -> bool {
        if self.child.is_leaf() {
            let run = tree.run(self.child);
            if leaf::<ANY, T, S>(s, run, &self.ray, &self.heading, self.ignore, &mut self.hit) {
                return false;
            }
        } else {
            let node = tree.node(self.child);
            single::add_children(s, node, &self.ray, &self.sides, self.hit.t, &mut self.stack);
        }
        let end = key(self.hit.t);
        while let Some(entry) = self.stack.pop() {
            if !entry.after(end) {
                self.child = entry.child();
                tree.prefetch(self.child);
                return true;
            }
        }
        false
    }
}

/// The rays that wait, of which eight at a time are made ready.
struct Queue<'a, T: Real, R> {
    bounds: &'a [[T; 3]; 2],
    rays: &'a R,
    chosen: &'a [u32],
    /// The next ray to take, the lanes of those that were made ready with it, and those that are no rays.
    next: usize,
    lanes: Prepared<[T; 8]>,
    proper: u32,
    /// The lanes that go mostly along x and along y, and those that go down each axis.
    along: [u32; 2],
    down: [u32; 3],
    ignoring: bool,
}

impl<'a, T: Real, R: Source<T>> Queue<'a, T, R> {
    #[inline(always)]
    fn new<S: Simd>(s: S, bounds: &'a [[T; 3]; 2], rays: &'a R, chosen: &'a [u32]) -> Self {
        let zero = [T::zero(); 8];
        let lanes = Prepared::all(zero);
        let (along, down, ignoring) = ([0; 2], [0; 3], rays.ignoring());
        let mut queue = Queue { bounds, rays, chosen, next: 0, lanes, proper: 0, along, down, ignoring };
        queue.fill(s);
        queue
    }

    #[inline(always)]
    fn fill<S: Simd>(&mut self, s: S) {
        let last = self.chosen.len() - 1;
        let first = self.chosen[self.next] as usize;
        // Where all rays go their own way, they come in runs.
        let run = first.is_multiple_of(8)
            && self.chosen.get(self.next + 7).is_some_and(|&c| c as usize == first + 7);
        let Eight { origin, direction, t_min, t_max } = if run {
            self.rays.eight(s, first)
        } else {
            Eight::load(
                s,
                #[inline(always)]
                |l| self.rays.ray(self.chosen[(self.next + l).min(last)] as usize),
            )
        };
        self.proper = T::V8::<S>::bits(proper(origin, direction, t_min, t_max));
        self.along = [T::V8::<S>::bits(along(0, direction)), T::V8::<S>::bits(along(1, direction))];
        for k in 0..3 {
            self.down[k] = T::V8::<S>::bits(Lanes::less(direction[k], splat8(s, T::zero())));
        }
        self.lanes = prepare(self.bounds, origin, direction, t_min, t_max).each(
            #[inline(always)]
            |v| v.to_array(),
        );
    }

    /// The next of the rays that is one; those that are none are answered at once.
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        s: S,
        answer: &mut impl Sink<T>,
    ) -> Option<(usize, i32, (Ready<T>, Heading))> {
        while let Some(&index) = self.chosen.get(self.next) {
            let l = self.next % 8;
            if l == 0 && self.next > 0 {
                self.fill(s);
            }
            self.next += 1;
            if self.proper >> l & 1 == 0 {
                answer.put(index as usize, Hit::no_ray());
                continue;
            }
            let bit = |lanes: u32| (lanes >> l & 1) as usize;
            let axis = 2 - 2 * bit(self.along[0]) - bit(self.along[1]);
            let down = [bit(self.down[0]), bit(self.down[1]), bit(self.down[2])];
            let heading = Heading { order: permutation(axis), negative: down };
            let ignore = if self.ignoring { self.rays.ray(index as usize).ignore_face } else { -1 };
            let ready = self.lanes.map(
                heading,
                #[inline(always)]
                |v| v[l],
            );
            return Some((index as usize, ignore, (ready, heading)));
        }
        None
    }
}

/// Traces the `chosen` rays and hands each answer, with its ray's index, to `answer`.
#[inline(always)]
pub fn trace<const ANY: bool, T: Real, S: Simd, R: Source<T>, F: Sink<T>>(
    s: S,
    tree: &Bvh<T>,
    rays: &R,
    chosen: &[u32],
    answer: &mut F,
) {
    if chosen.is_empty() {
        return;
    }
    let mut queue = Queue::new(s, &tree.bounds, rays, chosen);
    let mut rows: Vec<Row<T>> = Vec::with_capacity(ROWS.min(chosen.len()));
    while rows.len() < ROWS
        && let Some((index, ignore, made)) = queue.take(s, answer)
    {
        rows.push(Row::new(index, ignore, made));
    }
    while !rows.is_empty() {
        let mut i = 0;
        while i < rows.len() {
            let row = &mut rows[i];
            if row.turn::<ANY, S>(s, tree) {
                i += 1;
                continue;
            }
            answer.put(row.index, row.ray.finish(row.hit));
            match queue.take(s, answer) {
                Some((index, ignore, made)) => row.restart(index, ignore, made),
                None => {
                    rows.swap_remove(i);
                }
            }
        }
    }
}

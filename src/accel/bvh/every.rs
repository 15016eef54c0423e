//! Every hit of many rays. Nothing ends such a search early, so nothing need be visited in order: what is left to visit,
//! pairs of a ray and a child, stands in one list for a crowd of rays. Passed children are appended without a branch, since
//! none could be guessed, and are fetched while others are visited; leaves wait in a list of their own.
//!
//! Runs of rays that go alike are traced as packets (see [`super::packet`]).

use super::node::{Child, WIDTH};
use super::packet;
use super::single::{self, Sides};
use super::{Bvh, fetch};
use crate::accel::batch::Source;
use crate::accel::block::{self, BLOCK};
use crate::accel::lists::OutOfMemory;
use crate::accel::met::Met;
use crate::accel::ray::{self, Heading, Ready};
use crate::real::Real;
use crate::simd::Simd;

/// Rays that share a list.
const CROWD: usize = 64;
/// What is fetched is visited after as many others.
const AHEAD: usize = 16;
/// Children that are appended at least, passed or not.
const FEW: usize = 3;
/// Leaves that wait before they are tested.
const LEAVES: usize = 128;
/// Trees smaller than this lie in the processor's caches: rays have nothing to wait for, and go one after the other.
const CACHED: usize = 1 << 20;

/// A ray of a crowd.
struct Member<T> {
    ray: Ready<T>,
    heading: Heading,
    sides: Sides,
    ignore: i32,
    number: u32,
}

/// A child that a member of the crowd passes.
#[derive(Clone, Copy)]
struct Visit(u64);

impl Visit {
    #[inline(always)]
    fn new(member: usize, child: Child) -> Self {
        Visit((member as u64) << 32 | child.0 as u64)
    }
    #[inline(always)]
    fn member(self) -> usize {
        (self.0 >> 32) as usize
    }
    #[inline(always)]
    fn child(self) -> Child {
        Child(self.0 as u32)
    }
}

/// Rays, and what is left to visit.
pub struct Crowd<T> {
    members: Vec<Member<T>>,
    nodes: List,
    leaves: List,
}

impl<T: Real> Crowd<T> {
    pub fn new() -> Self {
        Crowd { members: Vec::with_capacity(CROWD), nodes: List::new(), leaves: List::new() }
    }

    /// Adds the hits of the rays of these numbers.
    #[inline(always)]
    pub fn trace<S: Simd>(
        &mut self,
        s: S,
        tree: &Bvh<T>,
        rays: &impl Source<T>,
        numbers: &[u32],
        met: &mut Met<T>,
    ) -> Result<(), OutOfMemory> {
        let alone = size_of_val(&*tree.nodes) + size_of_val(&*tree.blocks) < CACHED;
        for numbers in numbers.chunks(if alone { 1 } else { CROWD }) {
            self.members.clear();
            for &number in numbers {
                let ray = rays.ray(number as usize);
                if let Some((ready, heading)) = ray::ready(&tree.bounds, &ray) {
                    let (sides, ignore) = (Sides::of(heading), ray.ignore_face);
                    self.members.push(Member { ray: ready, heading, sides, ignore, number });
                }
            }
            if alone {
                self.nodes_of_one(s, tree, met)?;
            } else {
                self.nodes_of_all(s, tree, met)?;
            }
            self.test(s, tree, met)?;
        }
        Ok(())
    }

    /// Visits all nodes, for the only member.
    #[inline(always)]
    fn nodes_of_one<S: Simd>(&mut self, s: S, tree: &Bvh<T>, met: &mut Met<T>) -> Result<(), OutOfMemory> {
        let Some(of) = self.members.first() else { return Ok(()) };
        let (ray, sides) = (of.ray, of.sides);
        let mut child = Child::ROOT;
        loop {
            self.nodes.reserve()?;
            self.leaves.reserve()?;
            let node = tree.node(child);
            let (bits, _) = single::children(s, node, &ray, &sides, ray.t_max);
            self.nodes.append(0, &node.children, bits & !node.leaves);
            self.leaves.append(0, &node.children, bits & node.leaves);
            match self.nodes.0.pop() {
                Some(next) => child = next.child(),
                None => return Ok(()),
            }
            if self.leaves.0.len() >= LEAVES {
                self.test(s, tree, met)?;
            }
        }
    }

    /// Visits all nodes.
    #[inline(always)]
    fn nodes_of_all<S: Simd>(&mut self, s: S, tree: &Bvh<T>, met: &mut Met<T>) -> Result<(), OutOfMemory> {
        for member in 0..self.members.len() {
            self.nodes.reserve()?;
            self.nodes.0.push(Visit::new(member, Child::ROOT));
        }
        let mut fetched = [None; AHEAD];
        let (mut turn, mut waiting) = (0, 0);
        while waiting > 0 || !self.nodes.0.is_empty() {
            let place = &mut fetched[turn % AHEAD];
            turn += 1;
            if let Some(visit) = place.take() {
                let visit: Visit = visit;
                waiting -= 1;
                self.nodes.reserve()?;
                self.leaves.reserve()?;
                let (node, of) = (tree.node(visit.child()), &self.members[visit.member()]);
                let (bits, _) = single::children(s, node, &of.ray, &of.sides, of.ray.t_max);
                self.nodes.append(visit.member(), &node.children, bits & !node.leaves);
                self.leaves.append(visit.member(), &node.children, bits & node.leaves);
            }
            if let Some(next) = self.nodes.0.pop() {
                fetch(tree.node(next.child()));
                *place = Some(next);
                waiting += 1;
            }
            if self.leaves.0.len() >= LEAVES {
                self.test(s, tree, met)?;
            }
        }
        Ok(())
    }

    /// Tests the leaves that wait.
    #[inline(always)]
    fn test<S: Simd>(&mut self, s: S, tree: &Bvh<T>, met: &mut Met<T>) -> Result<(), OutOfMemory> {
        for (i, leaf) in self.leaves.0.iter().enumerate() {
            if let Some(later) = self.leaves.0.get(i + AHEAD) {
                fetch(&tree.run(later.child())[0]);
            }
            let (of, blocks) = (&self.members[leaf.member()], tree.run(leaf.child()));
            met.reserve(blocks.len() * BLOCK)?;
            block::all::<T, S>(
                s,
                blocks,
                &of.ray,
                &of.heading,
                of.ignore,
                #[inline(always)]
                |hit| met.put(of.number, of.ray.finish(hit)),
            );
        }
        self.leaves.0.clear();
        Ok(())
    }
}

/// What is left to visit.
struct List(Vec<Visit>);

impl List {
    fn new() -> Self {
        List(Vec::with_capacity(2 * LEAVES))
    }

    /// Makes room for the children of a node.
    #[inline(always)]
    fn reserve(&mut self) -> Result<(), OutOfMemory> {
        if self.0.capacity() - self.0.len() < WIDTH { self.grow() } else { Ok(()) }
    }

    #[cold]
    #[inline(never)]
    fn grow(&mut self) -> Result<(), OutOfMemory> {
        Ok(self.0.try_reserve(WIDTH)?)
    }

    /// Appends the children of these bits; there must be room for all of a node's.
    #[inline(always)]
    fn append(&mut self, member: usize, children: &[Child; WIDTH], bits: u32) {
        let (mut slots, len) = (SLOTS[bits as usize & 0xff], self.0.len());
        let number = (bits & 0xff).count_ones() as usize;
        assert!(self.0.capacity() - len >= WIDTH);
        let spare = &mut self.0.spare_capacity_mut()[..WIDTH];
        // Rarely more are passed.
        let mut k = 0;
        while k < FEW || (number > FEW && k < WIDTH) {
            spare[k].write(Visit::new(member, children[slots as usize & (WIDTH - 1)]));
            slots >>= 4;
            k += 1;
        }
        // Sound: as many places behind the list were written.
        unsafe { self.0.set_len(len + number) };
    }
}

/// The places of the set bits of each number, in rising order, four bits each.
static SLOTS: [u32; 256] = {
    let mut slots = [0; 256];
    let mut bits = 0;
    while bits < 256 {
        let (mut slot, mut k) = (0, 0);
        while slot < WIDTH {
            if bits >> slot & 1 == 1 {
                slots[bits] |= (slot as u32) << (4 * k);
                k += 1;
            }
            slot += 1;
        }
        bits += 1;
    }
    slots
};

impl<T: Real> Bvh<T> {
    /// Adds every hit of `count` rays from `first` on.
    #[inline(always)]
    pub(super) fn every_hit<S: Simd>(
        &self,
        s: S,
        (first, count): (usize, usize),
        rays: &impl Source<T>,
        met: &mut Met<T>,
    ) -> Result<(), OutOfMemory> {
        let mut apart: Vec<u32> = Vec::new();
        let whole = first + count / packet::SIZE * packet::SIZE;
        for at in (first..whole).step_by(packet::SIZE) {
            match packet::gather(s, self, rays, at) {
                Some(mut packet) => packet.every(s, self, at as u32, met)?,
                None => apart.extend((at..at + packet::SIZE).map(|i| i as u32)),
            }
        }
        apart.extend((whole..first + count).map(|i| i as u32));
        Crowd::new().trace(s, self, rays, &apart, met)
    }
}

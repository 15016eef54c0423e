//! The octree: cells parted in the middle into eight, as long as they hold more than some triangles.
//!
//! D. Meagher, *Geometric Modeling Using Octree Encoding*, 1982. A. Glassner, *Space Subdivision for Fast Ray Tracing*,
//! 1984. The walk orders octants by the signs of the direction, as J. Revelles, C. Ureña, M. Lastra, *An Efficient
//! Parametric Algorithm for Octree Traversal*, 2000, with planes crossed twice (see [`super::cells`]).

use super::bounds;
use super::cells::{
    Corners, FORK, GROWTH, Mailbox, Stack, Triangles, crossing, rays_a_task, scene_interval, share, sides,
    visit_faces,
};
use super::ray::{Heading, Ready};
use super::structure::{Chances, Ordered, Stats, Structure, Visit};
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::simd::Simd;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Deepest level of a tree.
pub const MAX_DEPTH: usize = 32;

/// What an octant holds.
#[derive(Clone, Copy)]
enum Child {
    Empty,
    Node(u32),
    Leaf { first: u32, count: u32 },
}

/// Bit `k` of an octant's number says that it lies above the centre on axis `k`.
struct Node<T> {
    centre: [T; 3],
    children: [Child; 8],
}

/// A tree of cells over triangles.
pub struct Octree<T> {
    triangles: Triangles<T>,
    bounds: Corners<T>,
    root: Child,
    nodes: Vec<Node<T>>,
    faces: Vec<u32>,
    stats: Stats,
}

enum Part {
    Leaf(Vec<u32>),
    Node(Box<[Part; 8]>),
}

struct Builder<'a, T> {
    boxes: &'a [Corners<T>],
    leaf_size: usize,
    max_depth: usize,
    stop: &'a AtomicBool,
}

fn centre_of<T: Real>(cell: &Corners<T>) -> [T; 3] {
    let half = T::of(0.5);
    std::array::from_fn(|k| cell[0][k] * half + cell[1][k] * half)
}

fn octant<T: Real>(cell: &Corners<T>, centre: [T; 3], i: usize) -> Corners<T> {
    let mut part = *cell;
    for k in 0..3 {
        part[1 - (i >> k & 1)][k] = centre[k];
    }
    part
}

impl<T: Real> Octree<T> {
    /// Leaves hold at most `leaf_size` triangles, unless they are `max_depth` deep or parting them does not help.
    pub fn build(
        watch: &mut dyn Watch,
        positions: &[[T; 3]],
        faces: &[[i32; 3]],
        leaf_size: usize,
        max_depth: usize,
    ) -> Result<Self, Interrupted> {
        parallel::run_forking(watch, |stop| {
            let bounds = bounds::scene_bounds(positions, faces);
            let triangles = Triangles::new(positions, faces);
            let boxes = triangles.boxes();
            let builder = Builder { boxes: &boxes, leaf_size, max_depth: max_depth.min(MAX_DEPTH), stop };
            let root = builder.part((0..faces.len() as u32).collect(), &bounds, 0, GROWTH * faces.len());
            let (nodes, stats) = (vec![], Stats::default());
            let mut tree = Octree { triangles, bounds, root: Child::Empty, nodes, faces: vec![], stats };
            let mut blocks = 0;
            tree.root = tree.emit(&root, &bounds, 0, &Chances::new(bounds), &mut blocks);
            let (references, nodes) = (tree.faces.len(), tree.nodes.len());
            let full = |c: &&Child| !matches!(c, Child::Empty);
            let filled = tree.nodes.iter().flat_map(|n| &n.children).filter(full).count();
            tree.stats.faces = faces.len();
            tree.stats.nodes = nodes;
            tree.stats.references = references;
            tree.stats.bytes = tree.triangles.bytes() + nodes * size_of::<Node<T>>() + 4 * references;
            tree.stats.children_per_node = filled as f64 / (nodes as f64).max(1.0);
            tree.stats.triangles_per_block = references as f64 / (blocks as f64).max(1.0);
            tree
        })
    }

    /// Writes a part and what is below it, and adds to the stats.
    fn emit(
        &mut self,
        part: &Part,
        cell: &Corners<T>,
        depth: usize,
        chances: &Chances,
        blocks: &mut usize,
    ) -> Child {
        match part {
            Part::Leaf(faces) if faces.is_empty() => Child::Empty,
            Part::Leaf(faces) => {
                let first = self.faces.len() as u32;
                self.faces.extend(faces);
                self.stats.leaves += 1;
                self.stats.depth = self.stats.depth.max(depth);
                self.stats.sah_cost += chances.of(*cell) * faces.len() as f64;
                *blocks += faces.len().div_ceil(4);
                Child::Leaf { first, count: faces.len() as u32 }
            }
            Part::Node(parts) => {
                let (me, centre) = (self.nodes.len(), centre_of(cell));
                self.nodes.push(Node { centre, children: [Child::Empty; 8] });
                self.stats.sah_cost += chances.of(*cell);
                for (i, part) in parts.iter().enumerate() {
                    let cell = octant(cell, centre, i);
                    self.nodes[me].children[i] = self.emit(part, &cell, depth + 1, chances, blocks);
                }
                Child::Node(me as u32)
            }
        }
    }
}

impl<T: Real> Builder<'_, T> {
    /// Parts the faces of a cell, which may grow to `allowed` references.
    fn part(&self, faces: Vec<u32>, cell: &Corners<T>, depth: usize, allowed: usize) -> Part {
        let n = faces.len();
        if n <= self.leaf_size || depth >= self.max_depth || (n > 64 && self.stop.load(Ordering::Relaxed)) {
            return Part::Leaf(faces);
        }
        let centre = centre_of(cell);
        let mut lists: [Vec<u32>; 8] = std::array::from_fn(|_| Vec::new());
        for &face in &faces {
            let stands: [[bool; 2]; 3] =
                std::array::from_fn(|k| sides(&self.boxes[face as usize], k, centre[k]));
            for (i, list) in lists.iter_mut().enumerate() {
                if (0..3).all(|k| stands[k][i >> k & 1]) {
                    list.push(face);
                }
            }
        }
        let sizes: Vec<usize> = lists.iter().map(Vec::len).collect();
        // Parting is of no use where every triangle stands in all octants that are filled.
        let useless =
            sizes.iter().all(|&m| m == n || m == 0) && sizes.iter().filter(|&&m| m == n).count() > 1;
        if useless || sizes.iter().sum::<usize>() > allowed {
            return Part::Leaf(faces);
        }
        drop(faces);
        let allowed = share(allowed, &sizes);
        let part = |(i, list)| self.part(list, &octant(cell, centre, i), depth + 1, allowed[i]);
        let parts: Vec<Part> = if n > FORK {
            lists.into_par_iter().enumerate().map(part).collect()
        } else {
            lists.into_iter().enumerate().map(part).collect()
        };
        match parts.try_into() {
            Ok(parts) => Part::Node(Box::new(parts)),
            Err(_) => unreachable!("eight lists give eight parts"),
        }
    }
}

impl<T: Real> Structure<T> for Octree<T> {
    fn bounds(&self) -> Corners<T> {
        self.bounds
    }

    fn stats(&self) -> Stats {
        self.stats
    }

    fn rays_a_task(&self) -> usize {
        rays_a_task(self.stats.sah_cost)
    }

    /// Boxes counted are the octants of nodes visited, empty ones left out.
    #[inline(always)]
    fn walk<S: Simd, V: Visit<T>>(&self, s: S, ray: &Ready<T>, heading: Heading, visit: &mut V) {
        let Some((entry, exit)) = scene_interval(&self.bounds, ray, heading, visit) else { return };
        let mut mailbox = Mailbox::new(true);
        let nearest = (0..3).map(|k| heading.negative[k] << k).sum::<usize>();
        // At each level seven octants wait.
        let mut stack = Stack::<_, { 7 * MAX_DEPTH + 2 }>::of((self.root, entry, exit));
        while let Some((child, entry, exit)) = stack.pop() {
            if entry > visit.end() {
                continue;
            }
            match child {
                Child::Empty => {}
                Child::Leaf { first, count } => {
                    let faces = &self.faces[first as usize..][..count as usize];
                    if visit_faces(s, &self.triangles, faces, &mut mailbox, visit) {
                        return;
                    }
                }
                Child::Node(i) => {
                    let node = &self.nodes[i as usize];
                    let crossings: [(T, T); 3] = std::array::from_fn(|k| crossing(ray, k, node.centre[k]));
                    // Bit `k` of `far`: beyond the plane on axis `k`. Subsets of bits come first, being nearer.
                    for far in (0..8).rev() {
                        let child = node.children[far ^ nearest];
                        if matches!(child, Child::Empty) {
                            continue;
                        }
                        visit.boxes(1);
                        let (mut from, mut to) = (entry, exit);
                        for (k, &(enter, leave)) in crossings.iter().enumerate() {
                            if far >> k & 1 == 1 {
                                from = Lanes::max(from, enter);
                            } else {
                                to = Lanes::min(to, leave);
                            }
                        }
                        if from <= to {
                            stack.push((child, from, to));
                        }
                    }
                }
            }
        }
    }

    /// From the eye's octant on, each face where it is met first.
    fn order(&self, eye: [T; 3]) -> Option<Ordered<T>> {
        let mut ordered = Ordered::new(self.triangles.len());
        let mut stack = vec![self.root];
        while let Some(child) = stack.pop() {
            match child {
                Child::Empty => {}
                Child::Leaf { first, count } => {
                    for &face in &self.faces[first as usize..][..count as usize] {
                        ordered.whole(face, self.triangles.corners(face));
                    }
                }
                Child::Node(i) => {
                    let node = &self.nodes[i as usize];
                    let nearest = (0..3).map(|k| ((eye[k] > node.centre[k]) as usize) << k).sum::<usize>();
                    stack.extend((0..8).rev().map(|far| node.children[far ^ nearest]));
                }
            }
        }
        Some(ordered)
    }
}

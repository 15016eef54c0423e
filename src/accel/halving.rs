//! Trees of planes across axes, each of which parts a cell into two: what kd-trees and axis-aligned BSP trees are, which
//! differ in where they put the planes.

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
use std::sync::atomic::{AtomicBool, Ordering};

/// Deepest level of a tree.
pub const MAX_DEPTH: usize = 96;

/// The inner nodes and the leaves of a tree, those below a node's plane first, right behind it.
#[derive(Clone, Copy)]
enum Node<T> {
    Plane { axis: u32, at: T, above: u32 },
    Leaf { first: u32, count: u32 },
}

/// Where a cell is parted: by faces that stand in it, the boxes of all, the cell, and its depth. None makes a leaf.
pub trait Rule<T>: Sync {
    fn plane(
        &self,
        faces: &[u32],
        boxes: &[Corners<T>],
        cell: &Corners<T>,
        depth: usize,
    ) -> Option<(usize, T)>;
}

/// A tree of planes across axes, over triangles.
pub struct Halving<T> {
    triangles: Triangles<T>,
    bounds: Corners<T>,
    nodes: Vec<Node<T>>,
    faces: Vec<u32>,
    stats: Stats,
}

enum Part<T> {
    Leaf(Vec<u32>),
    Plane(usize, T, Box<[Part<T>; 2]>),
}

struct Builder<'a, T, R> {
    boxes: &'a [Corners<T>],
    rule: &'a R,
    max_depth: usize,
    stop: &'a AtomicBool,
}

impl<T: Real> Halving<T> {
    pub fn build<R: Rule<T>>(
        watch: &mut dyn Watch,
        positions: &[[T; 3]],
        faces: &[[i32; 3]],
        rule: &R,
        max_depth: usize,
    ) -> Result<Self, Interrupted> {
        parallel::run_forking(watch, |stop| {
            let bounds = bounds::scene_bounds(positions, faces);
            let triangles = Triangles::new(positions, faces);
            let boxes = triangles.boxes();
            let builder = Builder { boxes: &boxes, rule, max_depth: max_depth.min(MAX_DEPTH), stop };
            let all = (0..faces.len() as u32).collect();
            let root = builder.part(all, &bounds, 0, GROWTH * faces.len());
            let mut tree =
                Halving { triangles, bounds, nodes: vec![], faces: vec![], stats: Stats::default() };
            let mut blocks = 0;
            tree.emit(&root, &bounds, 0, &Chances::new(bounds), &mut blocks);
            let references = tree.faces.len();
            tree.stats.faces = faces.len();
            tree.stats.references = references;
            tree.stats.bytes =
                tree.triangles.bytes() + tree.nodes.len() * size_of::<Node<T>>() + 4 * references;
            tree.stats.children_per_node = if tree.stats.nodes > 0 { 2.0 } else { 0.0 };
            tree.stats.triangles_per_block = references as f64 / (blocks as f64).max(1.0);
            tree
        })
    }

    /// Writes a part and what is below it, and adds to the stats.
    fn emit(
        &mut self,
        part: &Part<T>,
        cell: &Corners<T>,
        depth: usize,
        chances: &Chances,
        blocks: &mut usize,
    ) {
        let chance = chances.of(*cell);
        match part {
            Part::Leaf(faces) => {
                let first = self.faces.len() as u32;
                self.faces.extend(faces);
                self.nodes.push(Node::Leaf { first, count: faces.len() as u32 });
                self.stats.leaves += faces.len().min(1);
                self.stats.depth = self.stats.depth.max(depth);
                self.stats.sah_cost += chance * faces.len() as f64;
                *blocks += faces.len().div_ceil(4);
            }
            Part::Plane(axis, at, halves) => {
                let me = self.nodes.len();
                self.nodes.push(Node::Plane { axis: *axis as u32, at: *at, above: 0 });
                self.stats.nodes += 1;
                self.stats.sah_cost += chance;
                let [below, above] = parted(cell, *axis, *at);
                self.emit(&halves[0], &below, depth + 1, chances, blocks);
                self.nodes[me] = Node::Plane { axis: *axis as u32, at: *at, above: self.nodes.len() as u32 };
                self.emit(&halves[1], &above, depth + 1, chances, blocks);
            }
        }
    }

    /// Faces from the eye's cell on, each where it is met first: a true order for faces that stand in one cell each.
    pub fn order(&self, eye: [T; 3]) -> Ordered<T> {
        let mut ordered = Ordered::new(self.triangles.len());
        let mut stack = if self.nodes.is_empty() { vec![] } else { vec![0] };
        while let Some(i) = stack.pop() {
            match self.nodes[i] {
                Node::Leaf { first, count } => {
                    for &face in &self.faces[first as usize..][..count as usize] {
                        ordered.whole(face, self.triangles.corners(face));
                    }
                }
                Node::Plane { axis, at, above } => {
                    let (below, above) = (i + 1, above as usize);
                    let eye_above = eye[axis as usize] > at;
                    stack.extend(if eye_above { [below, above] } else { [above, below] });
                }
            }
        }
        ordered
    }
}

/// The halves of a cell.
pub fn parted<T: Copy>(cell: &Corners<T>, axis: usize, at: T) -> [Corners<T>; 2] {
    let (mut below, mut above) = (*cell, *cell);
    (below[1][axis], above[0][axis]) = (at, at);
    [below, above]
}

impl<T: Real, R: Rule<T>> Builder<'_, T, R> {
    /// Parts the faces of a cell, which may grow to `allowed` references.
    fn part(&self, faces: Vec<u32>, cell: &Corners<T>, depth: usize, allowed: usize) -> Part<T> {
        let n = faces.len();
        if n == 0 || depth >= self.max_depth || (n > 64 && self.stop.load(Ordering::Relaxed)) {
            return Part::Leaf(faces);
        }
        let Some((axis, at)) = self.rule.plane(&faces, self.boxes, cell, depth) else {
            return Part::Leaf(faces);
        };
        let (mut below, mut above) = (Vec::new(), Vec::new());
        for &face in &faces {
            let [b, a] = sides(&self.boxes[face as usize], axis, at);
            if b {
                below.push(face);
            }
            if a {
                above.push(face);
            }
        }
        if below.len() + above.len() > allowed {
            return Part::Leaf(faces);
        }
        drop(faces);
        let allowed = share(allowed, &[below.len(), above.len()]);
        let [cell_below, cell_above] = parted(cell, axis, at);
        let below = || self.part(below, &cell_below, depth + 1, allowed[0]);
        let above = || self.part(above, &cell_above, depth + 1, allowed[1]);
        let (below, above) = if n > FORK { rayon::join(below, above) } else { (below(), above()) };
        Part::Plane(axis, at, Box::new([below, above]))
    }
}

impl<T: Real> Structure<T> for Halving<T> {
    fn bounds(&self) -> Corners<T> {
        self.bounds
    }

    fn stats(&self) -> Stats {
        self.stats
    }

    fn rays_a_task(&self) -> usize {
        rays_a_task(self.stats.sah_cost)
    }

    /// Boxes counted are planes tested, one an inner node.
    #[inline(always)]
    fn walk<S: Simd, V: Visit<T>>(&self, s: S, ray: &Ready<T>, heading: Heading, visit: &mut V) {
        let Some((entry, exit)) = scene_interval(&self.bounds, ray, heading, visit) else { return };
        let mut mailbox = Mailbox::new(true);
        // At each level one half waits.
        let mut stack = Stack::<_, { MAX_DEPTH + 1 }>::of((0usize, entry, exit));
        while let Some((mut i, mut entry, mut exit)) = stack.pop() {
            while entry <= exit && entry <= visit.end() {
                match self.nodes[i] {
                    Node::Leaf { first, count } => {
                        let faces = &self.faces[first as usize..][..count as usize];
                        if visit_faces(s, &self.triangles, faces, &mut mailbox, visit) {
                            return;
                        }
                        break;
                    }
                    Node::Plane { axis, at, above } => {
                        visit.boxes(1);
                        let axis = axis as usize;
                        let (enter, leave) = crossing(ray, axis, at);
                        let (near, far) = if heading.negative[axis] == 1 {
                            (above as usize, i + 1)
                        } else {
                            (i + 1, above as usize)
                        };
                        let later = Lanes::max(entry, enter);
                        let ends = Lanes::min(exit, leave);
                        if entry <= ends {
                            if later <= exit {
                                stack.push((far, later, exit));
                            }
                            (i, exit) = (near, ends);
                        } else {
                            (i, entry) = (far, later);
                        }
                    }
                }
            }
        }
    }

    fn order(&self, eye: [T; 3]) -> Option<Ordered<T>> {
        Some(Halving::order(self, eye))
    }
}

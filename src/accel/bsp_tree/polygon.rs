//! The polygon-aligned tree: space is parted by the planes of the triangles themselves, which are cut where they cross
//! them. From any eye its fragments then come in a true order, as painters need it.
//!
//! Among some triangles, the plane that cuts fewest and halves best is taken. Where none parts the cell well (all the
//! rest of a convex mesh lies behind each of its faces), a plane across an axis is.
//!
//! **Rays.** The watertight test accepts a ray that passes its triangle within some round-offs (see [`crate::accel::ray`]):
//! within `tolerance` of the fragment there, all errors of cuts and planes included. So the half-spaces of the line's walk
//! are widened by it. They say where the line may pass fragments, not where a hit is, whose `t` may be off on triangles
//! seen edge-on. What lies behind the nearest hit is culled by boxes around the triangles below a node instead, which is
//! exact as in every tree of boxes.
//!
//! H. Fuchs, Z. Kedem, B. Naylor, *On Visible Surface Generation by A Priori Tree Structures*, SIGGRAPH 1980.

use super::fragment::{Builder, Fragment, NOISE, NONE, Part, Plane, Point, dot, exact_side};
use crate::accel::bounds;
use crate::accel::cells::{Corners, Mailbox, Stack, Triangles, rays_a_task, visit_faces};
use crate::accel::ray::{Heading, Ready, slabs};
use crate::accel::structure::{Chances, Ordered, Stats, Structure, Visit};
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::simd::Simd;

/// Deepest level of a tree.
pub const MAX_DEPTH: usize = 128;
/// Fragments for each face at most, and for small scenes beside; then cells stay whole.
const GROWTH: usize = 8;
const SMALL: usize = 1 << 12;

/// A node, or a leaf without children. `first` and `count` are what lies in the plane, or all that a leaf holds.
struct Node<T> {
    plane: Plane,
    children: [u32; 2],
    first: u32,
    count: u32,
    /// Around the whole triangles of all fragments here and below.
    bounds: Corners<T>,
}

/// A tree of planes of triangles.
pub struct PolygonTree<T> {
    triangles: Triangles<T>,
    bounds: Corners<T>,
    nodes: Vec<Node<T>>,
    /// The face of every fragment, and its points if it is cut.
    faces: Vec<u32>,
    points: Vec<Option<Vec<Point>>>,
    /// The sum of the largest coordinates.
    size: f64,
    stats: Stats,
}

impl<T: Real> PolygonTree<T> {
    /// Leaves hold at most `leaf_size` fragments, unless they are `max_depth` deep or parting them does not help.
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
            let size =
                (0..3).map(|k| Lanes::max(bounds[0][k].abs(), bounds[1][k].abs()).to_f64()).sum::<f64>();
            let max_depth = max_depth.min(MAX_DEPTH);
            let builder = Builder { triangles: &triangles, noise: NOISE * size, leaf_size, max_depth, stop };
            let all = (0..faces.len() as u32).map(|face| Fragment { face, points: None }).collect();
            let root = builder.part(all, 0, GROWTH * faces.len() + SMALL);
            let stats = Stats { faces: faces.len(), ..Stats::default() };
            let mut tree =
                PolygonTree { triangles, bounds, nodes: vec![], faces: vec![], points: vec![], size, stats };
            tree.emit(root, &boxes, 0);
            tree.measure();
            tree
        })
    }

    /// Writes a part and what is below it.
    fn emit(&mut self, part: Part, boxes: &[Corners<T>], depth: usize) -> u32 {
        let (plane, fragments, halves) = match part {
            Part::Leaf(fragments) => (Plane::across(0, 0.0), fragments, None),
            Part::Node(node) => {
                let (plane, within, halves) = *node;
                (plane, within, Some(halves))
            }
        };
        let (me, first, count) = (self.nodes.len(), self.faces.len() as u32, fragments.len() as u32);
        self.stats.depth = self.stats.depth.max(depth);
        let mut bounds = [[T::INFINITY; 3], [-T::INFINITY; 3]];
        for fragment in fragments {
            bounds = around(bounds, boxes[fragment.face as usize]);
            self.faces.push(fragment.face);
            self.points.push(fragment.points);
        }
        self.nodes.push(Node { plane, children: [NONE; 2], first, count, bounds });
        for (i, half) in halves.into_iter().flatten().enumerate() {
            // Nothing lies there.
            if matches!(&half, Part::Leaf(list) if list.is_empty()) {
                continue;
            }
            let child = self.emit(half, boxes, depth + 1);
            self.nodes[me].children[i] = child;
            self.nodes[me].bounds = around(self.nodes[me].bounds, self.nodes[child as usize].bounds);
        }
        me as u32
    }

    fn measure(&mut self) {
        let chances = Chances::new(self.bounds);
        let references = self.faces.len();
        let mut stats = Stats { references, ..self.stats };
        let (mut blocks, mut children) = (0, 0);
        for node in &self.nodes {
            let below = node.children.iter().filter(|&&c| c != NONE).count();
            stats.nodes += below.min(1);
            stats.leaves += (node.count > 0) as usize;
            children += below;
            blocks += node.count.div_ceil(4);
            // A fragment is tested where its plane is met, at most as often as its node.
            stats.sah_cost += chances.of(node.bounds) * (1.0 + node.count as f64);
        }
        let points = self.points.iter().flatten().map(|p| p.len() * size_of::<Point>()).sum::<usize>();
        let each = size_of::<u32>() + size_of::<Option<Vec<Point>>>();
        stats.bytes =
            self.triangles.bytes() + self.nodes.len() * size_of::<Node<T>>() + references * each + points;
        stats.children_per_node = children as f64 / (stats.nodes as f64).max(1.0);
        stats.triangles_per_block = references as f64 / (blocks as f64).max(1.0);
        self.stats = stats;
    }

    fn list(&self, node: &Node<T>) -> std::ops::Range<usize> {
        node.first as usize..(node.first + node.count) as usize
    }

    /// Appends the fragments of a node, as triangles.
    fn write(&self, node: &Node<T>, ordered: &mut Ordered<T>) {
        for i in self.list(node) {
            match &self.points[i] {
                None => ordered.part(self.faces[i], self.triangles.corners(self.faces[i])),
                Some(points) => {
                    let rounded: Vec<[T; 3]> = points.iter().map(|p| p.map(T::of)).collect();
                    for w in rounded[1..].windows(2) {
                        ordered.part(self.faces[i], [rounded[0], w[0], w[1]]);
                    }
                }
            }
        }
    }
}

fn around<T: Real>(a: Corners<T>, b: Corners<T>) -> Corners<T> {
    let low = std::array::from_fn(|k| Lanes::min(a[0][k], b[0][k]));
    [low, std::array::from_fn(|k| Lanes::max(a[1][k], b[1][k]))]
}

/// A line in double precision, and how far off its triangles it may be.
struct Line {
    origin: Point,
    direction: Point,
    tolerance: f64,
}

impl Line {
    #[inline(always)]
    fn new<T: Real>(ray: &Ready<T>, heading: Heading, bounds: &Corners<T>, size: f64) -> Self {
        let (o, shear) =
            (ray.origin.to_array().map(|x| x.to_f64()), ray.shear.to_array().map(|x| x.to_f64()));
        let (mut origin, mut direction) = ([0.0; 3], [0.0; 3]);
        let along = [shear[0] / shear[2], shear[1] / shear[2], 1.0 / shear[2]];
        for (i, &k) in heading.order.iter().enumerate() {
            (origin[k], direction[k]) = (o[i], along[i]);
        }
        let reach = (0..3).map(|k| {
            let [low, high] = [bounds[0][k], bounds[1][k]].map(|x| (x.to_f64() - origin[k]).abs());
            low.max(high)
        });
        let reach = reach.sum::<f64>();
        // The test's own error is 5 epsilons at most, and the direction was rounded; then cuts and planes.
        let tolerance = 16.0 * T::EPSILON.to_f64() * reach + 200.0 * NOISE * (reach + size);
        Line { origin, direction, tolerance }
    }

    /// The parts of `[from, to]` behind and before a plane, widened.
    #[inline(always)]
    fn parts(&self, plane: &Plane, from: f64, to: f64) -> [(f64, f64); 2] {
        let (s, d) = (plane.distance(self.origin), dot(plane.normal, self.direction));
        let (behind, before) = ((self.tolerance - s) / d, (-self.tolerance - s) / d);
        if d > 0.0 {
            [(from, to.min(behind)), (from.max(before), to)]
        } else if d < 0.0 {
            [(from.max(behind), to), (from, to.min(before))]
        } else {
            let none = (f64::INFINITY, f64::NEG_INFINITY);
            let (behind, before) = (s <= self.tolerance, s >= -self.tolerance);
            [if behind { (from, to) } else { none }, if before { (from, to) } else { none }]
        }
    }
}

impl<T: Real> Structure<T> for PolygonTree<T> {
    fn bounds(&self) -> Corners<T> {
        self.bounds
    }

    fn stats(&self) -> Stats {
        self.stats
    }

    fn rays_a_task(&self) -> usize {
        rays_a_task(self.stats.sah_cost)
    }

    /// Boxes counted are those of children, tested where the line reaches their side of the plane.
    #[inline(always)]
    fn walk<S: Simd, V: Visit<T>>(&self, s: S, ray: &Ready<T>, heading: Heading, visit: &mut V) {
        let passes = |bounds: &Corners<T>| {
            let side = |flip: usize| std::array::from_fn(|k| bounds[heading.negative[k] ^ flip][k]);
            slabs(side(0), side(1), ray.near, ray.far, ray.inverse)
        };
        let (entry, exit) = passes(&self.bounds);
        if !(entry <= exit) || self.nodes.is_empty() {
            return;
        }
        let line = Line::new(ray, heading, &self.bounds, self.size);
        let mut mailbox = Mailbox::new(true);
        // At each level one half waits.
        let mut stack = Stack::<_, { MAX_DEPTH + 2 }>::of((0u32, entry, entry.to_f64(), exit.to_f64()));
        while let Some((i, entry, from, to)) = stack.pop() {
            if entry > visit.end() {
                continue;
            }
            let node = &self.nodes[i as usize];
            let leaf = node.children == [NONE; 2];
            let parts = if leaf { [(from, to); 2] } else { line.parts(&node.plane, from, to) };
            // What lies in the plane is met where the widened halves overlap.
            let within = parts[0].0.max(parts[1].0) <= parts[0].1.min(parts[1].1);
            if within && visit_faces(s, &self.triangles, &self.faces[self.list(node)], &mut mailbox, visit) {
                return;
            }
            // The half where the line comes from is visited first.
            let first =
                (parts[1].0 < parts[0].0 || (parts[1].0 == parts[0].0 && parts[1].1 < parts[0].1)) as usize;
            for half in [1 - first, first] {
                let (child, (from, to)) = (node.children[half], parts[half]);
                if child == NONE || !(from <= to) {
                    continue;
                }
                visit.boxes(1);
                let (entry, exit) = passes(&self.nodes[child as usize].bounds);
                if entry <= exit && ray.t_min <= exit && entry <= visit.end() {
                    stack.push((child, entry, from, to));
                }
            }
        }
    }

    fn order(&self, eye: [T; 3]) -> Option<Ordered<T>> {
        let eye = eye.map(|x| x.to_f64());
        let mut ordered = Ordered::new(self.triangles.len());
        // Nodes to go through, and, with true, those whose own fragments come next.
        let mut stack = vec![(0u32, false)];
        while let Some((i, own)) = stack.pop() {
            let Some(node) = self.nodes.get(i as usize) else { continue };
            if own || node.children == [NONE; 2] {
                self.write(node, &mut ordered);
                continue;
            }
            let near = (exact_side(&self.triangles, &node.plane, eye) > 0.0) as usize;
            stack.extend([(node.children[1 - near], false), (i, true), (node.children[near], false)]);
        }
        Some(ordered)
    }
}

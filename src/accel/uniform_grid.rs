//! A grid of equal cells, walked from cell to cell along the ray.
//!
//! The walk of Amanatides and Woo steps over the nearest plane next. Here each plane is crossed twice: entered where the
//! ray, by its rounding, may first reach it, and left where it must have. So each axis has a leading cell and a
//! trailing one, the cells between them are active together, and stepping ahead on one axis visits the cells that
//! become active: mostly one. With that no hit is lost to rounding (see [`super::cells`]).
//!
//! J. Amanatides, A. Woo, *A Fast Voxel Traversal Algorithm for Ray Tracing*, Eurographics 1987.

use super::bounds;
use super::cells::{Corners, Mailbox, Triangles, crossing, rays_a_task, scene_interval, visit_faces};
use super::ray::{Heading, Ready};
use super::structure::{Chances, Stats, Structure, Visit};
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use crate::simd::Simd;
use std::sync::atomic::{AtomicBool, Ordering};

/// A grid of equal cells over triangles.
pub struct UniformGrid<T> {
    triangles: Triangles<T>,
    bounds: Corners<T>,
    cells: Cells<T>,
    /// Faces of cell `i`: from `starts[i]` to `starts[i + 1]`.
    starts: Vec<u32>,
    faces: Vec<u32>,
    mailbox: bool,
    stats: Stats,
}

/// How space is cut.
#[derive(Clone, Copy)]
struct Cells<T> {
    low: [T; 3],
    size: [T; 3],
    count: [usize; 3],
}

impl<T: Real> Cells<T> {
    fn new(bounds: &Corners<T>, count: [usize; 3]) -> Self {
        let size = std::array::from_fn(|k| (bounds[1][k] - bounds[0][k]) / T::of(count[k] as f64));
        Cells { low: bounds[0], size, count }
    }
    fn total(&self) -> usize {
        self.count.iter().product()
    }
    /// The plane below cell `i > 0`; monotone in `i`. Outermost planes do not exist.
    #[inline(always)]
    fn plane(&self, axis: usize, i: usize) -> T {
        self.low[axis] + T::of(i as f64) * self.size[axis]
    }
    /// The cell of a coordinate: as many planes are not above it.
    fn of(&self, axis: usize, x: T) -> usize {
        partition_point(self.count[axis] - 1, |i| self.plane(axis, i + 1) <= x)
    }
    /// The cells of a box, first and last on each axis.
    fn range(&self, b: &Corners<T>) -> [[usize; 3]; 2] {
        b.map(|corner| std::array::from_fn(|k| self.of(k, corner[k])))
    }
    #[inline(always)]
    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.count[1] + y) * self.count[0] + x
    }
}

/// How many of the numbers below `n` come before a condition ceases to hold.
#[inline(always)]
fn partition_point(n: usize, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, n);
    while low < high {
        let middle = (low + high) / 2;
        if holds(middle) { low = middle + 1 } else { high = middle }
    }
    low
}

fn cells_in([first, last]: &[[usize; 3]; 2]) -> usize {
    (0..3).map(|k| last[k] - first[k] + 1).product()
}

/// Calls `f` with the index of each cell of a range, until it returns true.
#[inline(always)]
fn each_cell(first: [usize; 3], last: [usize; 3], mut f: impl FnMut([usize; 3]) -> bool) -> bool {
    for z in first[2]..=last[2] {
        for y in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                if f([x, y, z]) {
                    return true;
                }
            }
        }
    }
    false
}

impl<T: Real> UniformGrid<T> {
    /// Cells on an axis, and in all.
    pub const MAX_COUNT: usize = 1 << 11;
    const MAX_CELLS: usize = 1 << 27;
    /// Cells that a triangle may stand in, on average.
    const MAX_GROWTH: usize = 32;

    /// `count` cells, or half as many on each axis as often as it takes to keep within bounds of memory.
    pub fn build(
        watch: &mut dyn Watch,
        positions: &[[T; 3]],
        faces: &[[i32; 3]],
        count: [usize; 3],
        mailbox: bool,
    ) -> Result<Self, Interrupted> {
        parallel::run_forking(watch, |stop| {
            let bounds = bounds::scene_bounds(positions, faces);
            let triangles = Triangles::new(positions, faces);
            let boxes = triangles.boxes();
            let count = count.map(|n| n.clamp(1, Self::MAX_COUNT));
            let cells = Self::affordable(&boxes, &bounds, count, stop);
            let (starts, faces) = fill(&boxes, &cells, stop);
            let stats = Stats::default();
            let mut grid = UniformGrid { triangles, bounds, cells, starts, faces, mailbox, stats };
            grid.stats = grid.measure();
            grid
        })
    }

    fn affordable(
        boxes: &[Corners<T>],
        bounds: &Corners<T>,
        mut count: [usize; 3],
        stop: &AtomicBool,
    ) -> Cells<T> {
        loop {
            let cells = Cells::new(bounds, count);
            let most = Self::MAX_GROWTH * boxes.len() + 64;
            let mut references = 0;
            for (i, b) in boxes.iter().enumerate() {
                references += cells_in(&cells.range(b));
                if references > most || (i.is_multiple_of(4096) && stop.load(Ordering::Relaxed)) {
                    break;
                }
            }
            if cells.total() == 1 || (references <= most && cells.total() <= Self::MAX_CELLS) {
                return cells;
            }
            count = count.map(|n| n.div_ceil(2));
        }
    }

    fn measure(&self) -> Stats {
        let chances = Chances::new(self.bounds);
        let size = self.cells.size;
        // All cells are alike, but for rounding.
        let chance = chances.of([[T::zero(); 3], size]);
        let (cells, references) = (self.cells.total(), self.faces.len());
        let sizes = self.starts.windows(2).map(|w| (w[1] - w[0]) as usize);
        let (leaves, blocks) = sizes.fold((0, 0), |(l, b), n| (l + n.min(1), b + n.div_ceil(4)));
        Stats {
            faces: self.triangles.len(),
            nodes: 1,
            leaves,
            depth: 1,
            references,
            sah_cost: chance * (cells + references) as f64,
            bytes: self.triangles.bytes() + 4 * (self.starts.len() + references),
            children_per_node: cells as f64,
            triangles_per_block: references as f64 / (blocks as f64).max(1.0),
        }
    }

    /// Cells on each axis.
    pub fn count(&self) -> [usize; 3] {
        self.cells.count
    }

    #[inline(always)]
    fn list(&self, cell: usize) -> &[u32] {
        &self.faces[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}

/// Counts each cell's faces, then writes them, in the order of faces.
fn fill<T: Real>(boxes: &[Corners<T>], cells: &Cells<T>, stop: &AtomicBool) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; cells.total() + 1];
    let stopped = |i: usize| i.is_multiple_of(4096) && stop.load(Ordering::Relaxed);
    for (i, b) in boxes.iter().enumerate() {
        if stopped(i) {
            return (vec![], vec![]);
        }
        let [first, last] = cells.range(b);
        each_cell(first, last, |c| {
            starts[cells.index(c)] += 1;
            false
        });
    }
    let mut total = 0;
    for start in &mut starts {
        total += std::mem::replace(start, total);
    }
    let mut faces = vec![0u32; total as usize];
    for (i, b) in boxes.iter().enumerate() {
        if stopped(i) {
            break;
        }
        let [first, last] = cells.range(b);
        each_cell(first, last, |c| {
            let next = &mut starts[cells.index(c)];
            faces[*next as usize] = i as u32;
            *next += 1;
            false
        });
    }
    // Each start has moved to the next cell's.
    starts.rotate_right(1);
    starts[0] = 0;
    (starts, faces)
}

impl<T: Real> Structure<T> for UniformGrid<T> {
    fn bounds(&self) -> Corners<T> {
        self.bounds
    }

    fn stats(&self) -> Stats {
        self.stats
    }

    fn rays_a_task(&self) -> usize {
        rays_a_task(self.stats.sah_cost)
    }

    /// Boxes counted are cells visited, those without triangles too.
    #[inline(always)]
    fn walk<S: Simd, V: Visit<T>>(&self, s: S, ray: &Ready<T>, heading: Heading, visit: &mut V) {
        let Some((start, exit)) = scene_interval(&self.bounds, ray, heading, visit) else { return };
        let mut mailbox = Mailbox::new(self.mailbox);
        // Cells are numbered in the ray's order on each axis, and so are the planes between them.
        let last: [usize; 3] = std::array::from_fn(|k| self.cells.count[k] - 1);
        let crossing = |k: usize, border: usize| {
            let plane = if heading.negative[k] == 1 { last[k] - border } else { border + 1 };
            crossing(ray, k, self.cells.plane(k, plane))
        };
        let enter = |k: usize, lead: usize| if lead < last[k] { crossing(k, lead).0 } else { T::INFINITY };
        let leave = |k: usize, trail: usize| if trail < last[k] { crossing(k, trail).1 } else { T::INFINITY };

        let mut lead: [usize; 3] =
            std::array::from_fn(|k| partition_point(last[k], |b| crossing(k, b).0 <= start));
        let mut trail: [usize; 3] =
            std::array::from_fn(|k| partition_point(last[k], |b| crossing(k, b).1 < start));
        let mut entry: [T; 3] = std::array::from_fn(|k| enter(k, lead[k]));
        let mut leaving: [T; 3] = std::array::from_fn(|k| leave(k, trail[k]));
        let mut from = trail;
        loop {
            let stopped = each_cell(from, lead, |c| {
                visit.boxes(1);
                let cell =
                    std::array::from_fn(|k| if heading.negative[k] == 1 { last[k] - c[k] } else { c[k] });
                visit_faces(s, &self.triangles, self.list(self.cells.index(cell)), &mut mailbox, visit)
            });
            if stopped {
                return;
            }
            // Leave planes behind until the next is entered; at equal places, cells on both sides are active.
            let axis = loop {
                let (a, b) = (least(entry), least(leaving));
                if Lanes::min(entry[a], leaving[b]) > Lanes::min(exit, visit.end()) {
                    return;
                }
                if entry[a] <= leaving[b] {
                    break a;
                }
                trail[b] += 1;
                leaving[b] = leave(b, trail[b]);
            };
            lead[axis] += 1;
            entry[axis] = enter(axis, lead[axis]);
            from = trail;
            from[axis] = lead[axis];
        }
    }
}

#[inline(always)]
fn least<T: Real>(t: [T; 3]) -> usize {
    if t[0] <= t[1] && t[0] <= t[2] {
        0
    } else if t[1] <= t[2] {
        1
    } else {
        2
    }
}

//! What the structures that part space share: triangles by face, lists of faces in cells, and the mailbox.
//!
//! A triangle stands in every cell that its own box reaches into, by exact comparisons with the planes between cells; one
//! that ends in a plane need not stand beyond it. Let a ray hit it at `t`, and `t'` be `t`, or the exit from the
//! triangle's own box if that is earlier. A plane is entered no later than it is left (see [`super::ray`]), and both are
//! monotone in the plane, so `t'` lies between entry and exit of one cell at least in which the triangle stands: a walk
//! over all cells whose entry is not after their exit, nor after the nearest hit yet, meets the triangle.

use super::block::{BLOCK, Block};
use super::bounds::LARGE;
use super::ray::{Heading, Ready, slabs};
use super::structure::Visit;
use crate::real::{Lanes, Real};
use crate::simd::Simd;
use rayon::prelude::*;
use std::mem::MaybeUninit;

/// A box: its lower and its upper corner.
pub type Corners<T> = [[T; 3]; 2];

/// The corners of every face.
pub struct Triangles<T>(Vec<[[T; 3]; 3]>);

impl<T: Real> Triangles<T> {
    pub fn new(positions: &[[T; 3]], faces: &[[i32; 3]]) -> Self {
        Triangles(faces.iter().map(|f| f.map(|v| positions[v as usize])).collect())
    }
    pub fn len(&self) -> usize {
        self.0.len()
    }
    pub fn bytes(&self) -> usize {
        self.0.len() * size_of::<[[T; 3]; 3]>()
    }
    pub fn corners(&self, face: u32) -> [[T; 3]; 3] {
        self.0[face as usize]
    }
    /// The exact box of every face.
    pub fn boxes(&self) -> Vec<Corners<T>> {
        self.0.par_iter().with_min_len(LARGE).map(box_of).collect()
    }
}

fn box_of<T: Real>([a, b, c]: &[[T; 3]; 3]) -> Corners<T> {
    let low = std::array::from_fn(|k| Lanes::min(a[k], Lanes::min(b[k], c[k])));
    [low, std::array::from_fn(|k| Lanes::max(a[k], Lanes::max(b[k], c[k])))]
}

/// Whether a box stands below a plane across `axis`, and whether above: one of them at least.
#[inline(always)]
pub fn sides<T: Real>([low, high]: &Corners<T>, axis: usize, plane: T) -> [bool; 2] {
    [low[axis] < plane || high[axis] <= plane, high[axis] > plane]
}

/// Faces that a ray met lately, so that one that stands in several cells is tested once (or seldom more).
///
/// J. Amanatides, A. Woo, *A Fast Voxel Traversal Algorithm for Ray Tracing*, 1987; M. Shevtsov et al., *Ray-Triangle
/// Intersection Algorithm for Modern CPU Architectures*, 2007, for the small table instead of a mark on every triangle.
pub struct Mailbox {
    slots: [u32; Mailbox::SIZE],
    used: bool,
}

impl Mailbox {
    const SIZE: usize = 64;

    #[inline(always)]
    pub fn new(used: bool) -> Self {
        Mailbox { slots: [u32::MAX; Self::SIZE], used }
    }
    /// Whether the face was not met lately; it is now.
    #[inline(always)]
    fn is_new(&mut self, face: u32) -> bool {
        let slot = &mut self.slots[face as usize % Self::SIZE];
        !self.used || std::mem::replace(slot, face) != face
    }
}

/// Hands the faces of a cell to `visit`, four at a time; true if nothing more need be visited.
#[inline(always)]
pub fn visit_faces<T: Real, S: Simd, V: Visit<T>>(
    s: S,
    triangles: &Triangles<T>,
    faces: &[u32],
    mailbox: &mut Mailbox,
    visit: &mut V,
) -> bool {
    let mut rest = faces.iter();
    loop {
        let (mut four, mut n) = ([0u32; BLOCK], 0);
        for &face in rest.by_ref() {
            if mailbox.is_new(face) {
                four[n] = face;
                n += 1;
                if n == BLOCK {
                    break;
                }
            }
        }
        if n == 0 {
            return false;
        }
        let block = Block::new(four[..n].iter().map(|&face| (face as i32, triangles.corners(face))));
        if leaf(s, &block, visit) {
            return true;
        }
    }
}

/// Enters the level anew rather than being inlined, so that it is compiled once for all structures.
#[inline(never)]
fn leaf<T: Real, S: Simd, V: Visit<T>>(s: S, block: &Block<T>, visit: &mut V) -> bool {
    s.vectorize(
        #[inline(always)]
        || visit.leaf(s, std::slice::from_ref(block)),
    )
}

/// Where a ray enters and leaves the scene's box, within its interval.
#[inline(always)]
pub fn scene_interval<T: Real, V: Visit<T>>(
    bounds: &Corners<T>,
    ray: &Ready<T>,
    heading: Heading,
    visit: &V,
) -> Option<(T, T)> {
    let side = |flip: usize| std::array::from_fn(|k| bounds[heading.negative[k] ^ flip][k]);
    let (entry, exit) = slabs(side(0), side(1), ray.near, ray.far, ray.inverse);
    let (entry, exit) = (Lanes::max(entry, ray.t_min), Lanes::min(exit, visit.end()));
    (entry <= exit).then_some((entry, exit))
}

/// Where a ray may first reach a plane across `axis`, and where it must have left it behind.
#[inline(always)]
pub fn crossing<T: Real>(ray: &Ready<T>, axis: usize, plane: T) -> (T, T) {
    let inverse = ray.inverse[axis];
    ((plane - ray.near[axis]) * inverse, (plane - ray.far[axis]) * inverse)
}

/// Rays a task, so that it takes some milliseconds, from the structure's expected cost.
pub fn rays_a_task(sah_cost: f64) -> usize {
    ((1 << 21) as f64 / sah_cost.max(1.0)).clamp(8.0, 2048.0) as usize
}

/// How many references the halves of a cell may grow to, from how many they have and the whole may.
pub fn share(allowed: usize, parts: &[usize]) -> Vec<usize> {
    let total: usize = parts.iter().sum();
    let spare = allowed.saturating_sub(total) as u128;
    parts.iter().map(|&n| n + (spare * n as u128 / total.max(1) as u128) as usize).collect()
}

/// Lists shorter than this are not worth another thread.
pub const FORK: usize = 1 << 12;
/// References that a tree may hold for each face.
pub const GROWTH: usize = 16;

/// What waits to be visited. Not initialised, since it is large and made for every ray.
pub struct Stack<E, const N: usize> {
    entries: [MaybeUninit<E>; N],
    len: usize,
}

impl<E: Copy, const N: usize> Stack<E, N> {
    #[inline(always)]
    pub fn of(first: E) -> Self {
        let mut stack = Stack { entries: [MaybeUninit::uninit(); N], len: 0 };
        stack.push(first);
        stack
    }
    #[inline(always)]
    pub fn push(&mut self, e: E) {
        self.entries[self.len].write(e);
        self.len += 1;
    }
    #[inline(always)]
    pub fn pop(&mut self) -> Option<E> {
        self.len = self.len.checked_sub(1)?;
        // Sound: every entry below `len` was written by `push`.
        Some(unsafe { self.entries[self.len].assume_init() })
    }
}

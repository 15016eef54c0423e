//! Every ray against every triangle, by the rule that structures keep: a hit passes its triangle's own box, `t` is raised
//! to the entry, the lowest face wins a tie. What a structure returns must equal this to the bit.

use super::block::{BLOCK, Block};
use super::bounds;
use super::ray::{Heading, Ready};
use super::structure::{Stats, Structure, Visit};
use crate::real::Real;
use crate::simd::Simd;

/// Triangles, so that a task of some rays takes a few milliseconds.
const WORK: usize = 1 << 21;

/// All triangles of a mesh, in one leaf.
pub struct BruteForce<T> {
    blocks: Vec<Block<T>>,
    bounds: [[T; 3]; 2],
    faces: usize,
}

impl<T: Real> BruteForce<T> {
    pub fn new(positions: &[[T; 3]], faces: &[[i32; 3]]) -> Self {
        let corners = |face: &[i32; 3]| face.map(|v| positions[v as usize]);
        let block = |(i, four): (usize, &[[i32; 3]])| {
            Block::new(four.iter().enumerate().map(|(l, face)| ((BLOCK * i + l) as i32, corners(face))))
        };
        BruteForce {
            blocks: faces.chunks(BLOCK).enumerate().map(block).collect(),
            bounds: bounds::scene_bounds(positions, faces),
            faces: faces.len(),
        }
    }
}

impl<T: Real> Structure<T> for BruteForce<T> {
    fn bounds(&self) -> [[T; 3]; 2] {
        self.bounds
    }

    fn stats(&self) -> Stats {
        let (faces, blocks) = (self.faces, self.blocks.len());
        Stats {
            faces,
            leaves: faces.min(1),
            references: faces,
            sah_cost: faces as f64,
            bytes: blocks * size_of::<Block<T>>(),
            triangles_per_block: faces as f64 / (blocks as f64).max(1.0),
            ..Stats::default()
        }
    }

    #[inline(always)]
    fn walk<S: Simd, V: Visit<T>>(&self, s: S, _: &Ready<T>, _: Heading, visit: &mut V) {
        visit.leaf(s, &self.blocks);
    }

    fn rays_a_task(&self) -> usize {
        (WORK / self.faces.max(1)).clamp(1, 1024)
    }
}

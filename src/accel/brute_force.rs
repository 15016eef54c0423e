//! Every ray against every triangle, by the rule that structures keep: a hit passes its triangle's own box, `t` is raised
//! to the entry, the lowest face wins a tie. What a structure returns must equal this to the bit.

use super::block::{BLOCK, Block, leaf};
use super::query::{Found, Rays};
use super::{Hit, bounds, ray};
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;

/// Triangles, so that a task of some rays takes a few milliseconds.
const WORK: usize = 1 << 21;

/// The nearest hits of arrays of rays. Costs rays times faces.
pub fn closest_hits<T: Real>(
    watch: &mut dyn Watch,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    rays: &Rays<T>,
    found: Found<T>,
) -> Result<(), Interrupted> {
    let scene = bounds::scene_bounds(positions, faces);
    let blocks: Vec<Block<T>> = faces
        .chunks(BLOCK)
        .enumerate()
        .map(|(i, four)| {
            Block::new(
                four.iter()
                    .enumerate()
                    .map(|(l, &face)| ((BLOCK * i + l) as i32, face.map(|v| positions[v as usize]))),
            )
        })
        .collect();
    let rays_a_task = (WORK / faces.len().max(1)).clamp(1, 1024);
    parallel::for_each(watch, found, rays_a_task, |first, mut found| {
        dispatch!(s => for i in 0..found.len() {
            let ray = rays.get(first + i);
            let hit = match ray::ready(&scene, &ray) {
                None => Hit::no_ray(),
                Some((ready, heading)) => {
                    let mut hit = ready.unhit();
                    leaf::<false, T, _>(s, &blocks, &ready, heading, ray.ignore_face, &mut hit);
                    ready.finish(hit)
                }
            };
            found.put(i, hit);
        })
    })
}

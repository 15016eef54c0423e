//! The axis-aligned tree: each cell is halved in the middle, across x, y and z in turn.
//!
//! T. Akenine-Möller, E. Haines, N. Hoffman, *Real-Time Rendering*, 4th edition, 2018, section 19.1.2.

use crate::accel::cells::{Corners, sides};
use crate::accel::halving::{Halving, Rule};
use crate::parallel::{Interrupted, Watch};
use crate::real::Real;

struct Middle {
    leaf_size: usize,
}

/// A tree whose leaves hold at most `leaf_size` triangles, unless it is `max_depth` deep or halving does not help.
pub fn build<T: Real>(
    watch: &mut dyn Watch,
    positions: &[[T; 3]],
    faces: &[[i32; 3]],
    leaf_size: usize,
    max_depth: usize,
) -> Result<Halving<T>, Interrupted> {
    Halving::build(watch, positions, faces, &Middle { leaf_size }, max_depth)
}

impl<T: Real> Rule<T> for Middle {
    /// The next axis in turn, but one across which nothing is parted.
    fn plane(
        &self,
        faces: &[u32],
        boxes: &[Corners<T>],
        cell: &Corners<T>,
        depth: usize,
    ) -> Option<(usize, T)> {
        if faces.len() <= self.leaf_size {
            return None;
        }
        (0..3).map(|i| (depth + i) % 3).find_map(|axis| {
            let half = T::of(0.5);
            let at = cell[0][axis] * half + cell[1][axis] * half;
            let all_straddle = || faces.iter().all(|&f| sides(&boxes[f as usize], axis, at) == [true, true]);
            (cell[0][axis] < at && at < cell[1][axis] && !all_straddle()).then_some((axis, at))
        })
    }
}

//! Model, view, projection, viewport: matrices that act on column vectors, and their work on points.
//!
//! Right-handed, y up; cameras look down -z. Every function works on batches; matrices are stored by rows as NumPy
//! has them.
//!
//! - [`affine`]: translation, scaling, rotation about an axis
//! - [`view`]: the view matrix of an eye that looks at a target
//! - [`projection`]: perspective and orthographic projections, viewport, linear depth
//! - [`normal_matrix`]: the matrix that carries normals
//! - [`points`]: points, vectors and normals through matrices; pixels and back

pub mod affine;
pub mod normal_matrix;
pub mod points;
pub mod projection;
pub mod view;

use crate::parallel::{self, Interrupted, Watch};

/// A matrix by rows.
pub type Rows4<T> = [[T; 4]; 4];

/// `out[i] = f(i)` in parallel; for matrices, where one element is tens of operations.
fn fill<T: Send>(
    watch: &mut dyn Watch,
    out: &mut [T],
    f: impl Fn(usize) -> T + Sync,
) -> Result<(), Interrupted> {
    parallel::for_each(watch, out, 1 << 12, |first, out: &mut [T]| {
        for (i, out) in out.iter_mut().enumerate() {
            *out = f(first + i);
        }
    })
}

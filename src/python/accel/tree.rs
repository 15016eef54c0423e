//! The hierarchy as Python holds it.

use crate::accel::Bvh;
use crate::real::Real;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::sync::Arc;

/// A tree in the precision of its mesh, shared with the kernels that trace rays.
#[pyclass(frozen)]
pub struct Tree(Precision);

enum Precision {
    Single(Arc<Bvh<f32>>),
    Double(Arc<Bvh<f64>>),
}

impl Tree {
    /// The tree, if it is of this precision.
    pub fn of<T: Held>(&self) -> PyResult<&Arc<Bvh<T>>> {
        T::pick(self).ok_or_else(|| PyTypeError::new_err("the tree is of another precision"))
    }
}

/// A precision that trees are held in.
pub trait Held: Real {
    fn wrap(tree: Bvh<Self>) -> Tree;
    fn pick(tree: &Tree) -> Option<&Arc<Bvh<Self>>>;
}

impl Held for f32 {
    fn wrap(tree: Bvh<f32>) -> Tree {
        Tree(Precision::Single(Arc::new(tree)))
    }
    fn pick(tree: &Tree) -> Option<&Arc<Bvh<f32>>> {
        if let Precision::Single(t) = &tree.0 { Some(t) } else { None }
    }
}

impl Held for f64 {
    fn wrap(tree: Bvh<f64>) -> Tree {
        Tree(Precision::Double(Arc::new(tree)))
    }
    fn pick(tree: &Tree) -> Option<&Arc<Bvh<f64>>> {
        if let Precision::Double(t) = &tree.0 { Some(t) } else { None }
    }
}

#[pymethods]
impl Tree {
    /// Faces, nodes, blocks, bytes, children a node, triangles a block.
    fn stats(&self) -> (usize, usize, usize, usize, f64, f64) {
        let s = match &self.0 {
            Precision::Single(t) => t.stats(),
            Precision::Double(t) => t.stats(),
        };
        (s.faces, s.nodes, s.blocks, s.bytes, s.children_per_node, s.triangles_per_block)
    }
}

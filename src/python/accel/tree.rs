//! Structures as Python holds them.

use crate::accel::Bvh;
use crate::accel::brute_force::BruteForce;
use crate::accel::query::Queries;
use crate::accel::structure::Stats;
use crate::real::Real;
use pyo3::exceptions::{PyMemoryError, PyTypeError};
use pyo3::prelude::*;
use std::sync::Arc;

/// The hierarchy in the precision of its mesh, shared with the kernels that trace rays.
#[pyclass(frozen)]
pub struct Tree(Precision);

enum Precision {
    Single(Arc<Bvh<f32>>),
    Double(Arc<Bvh<f64>>),
}

impl Tree {
    /// The tree, if it is of this precision.
    pub fn of<T: Held>(&self) -> PyResult<&Arc<Bvh<T>>> {
        T::pick(self).ok_or_else(other_precision)
    }
}

/// Any other structure.
#[pyclass(frozen)]
pub struct Other(Dynamic);

enum Dynamic {
    Single(Arc<dyn Queries<f32>>),
    Double(Arc<dyn Queries<f64>>),
}

/// A precision that structures are held in.
pub trait Held: Real {
    fn wrap(tree: Bvh<Self>) -> Tree;
    fn pick(tree: &Tree) -> Option<&Arc<Bvh<Self>>>;
    fn wrap_other(structure: Arc<dyn Queries<Self>>) -> Other;
    fn pick_other(other: &Other) -> Option<&Arc<dyn Queries<Self>>>;
}

macro_rules! held {
    ($t:ty, $variant:ident) => {
        impl Held for $t {
            fn wrap(tree: Bvh<$t>) -> Tree {
                Tree(Precision::$variant(Arc::new(tree)))
            }
            fn pick(tree: &Tree) -> Option<&Arc<Bvh<$t>>> {
                if let Precision::$variant(t) = &tree.0 { Some(t) } else { None }
            }
            fn wrap_other(structure: Arc<dyn Queries<$t>>) -> Other {
                Other(Dynamic::$variant(structure))
            }
            fn pick_other(other: &Other) -> Option<&Arc<dyn Queries<$t>>> {
                if let Dynamic::$variant(t) = &other.0 { Some(t) } else { None }
            }
        }
    };
}
held!(f32, Single);
held!(f64, Double);

/// What answers arrays of rays behind a Python object of this chapter.
pub fn queries<T: Held>(object: &Bound<'_, PyAny>) -> PyResult<Arc<dyn Queries<T>>> {
    if let Ok(tree) = object.cast::<Tree>() {
        return Ok(tree.get().of::<T>()?.clone());
    }
    let other = object.cast::<Other>().map_err(|_| PyTypeError::new_err("expected a structure"))?;
    T::pick_other(other.get()).cloned().ok_or_else(other_precision)
}

/// Answers that were too many.
pub fn no_memory(what: &str) -> PyErr {
    PyMemoryError::new_err(format!("no memory for all {what}: ask for fewer at a time"))
}

fn other_precision() -> PyErr {
    PyTypeError::new_err("the structure is of another precision")
}

/// All but the time of the build, in the order of the face's `Stats`.
pub type StatsTuple = (usize, usize, usize, usize, usize, f64, usize, f64, f64);

pub fn tuple(s: Stats) -> StatsTuple {
    (
        s.faces,
        s.nodes,
        s.leaves,
        s.depth,
        s.references,
        s.sah_cost,
        s.bytes,
        s.children_per_node,
        s.triangles_per_block,
    )
}

#[pymethods]
impl Tree {
    fn stats(&self) -> StatsTuple {
        match &self.0 {
            Precision::Single(t) => tuple(t.make()),
            Precision::Double(t) => tuple(t.make()),
        }
    }
}

#[pymethods]
impl Other {
    fn stats(&self) -> StatsTuple {
        match &self.0 {
            Dynamic::Single(t) => tuple(t.make()),
            Dynamic::Double(t) => tuple(t.make()),
        }
    }
}

impl Other {
    /// Behind Python, from a structure of either precision.
    pub fn new<T: Held>(structure: impl Queries<T> + 'static) -> Self {
        T::wrap_other(Arc::new(structure))
    }
}

/// Every triangle, as a structure.
pub fn brute_force<T: Held>(positions: &[[T; 3]], faces: &[[i32; 3]]) -> Other {
    Other::new(BruteForce::new(positions, faces))
}

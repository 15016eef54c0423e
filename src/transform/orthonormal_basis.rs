//! An orthonormal frame about a normal, without a branch and without a pole.
//!
//! T. Duff and others, *Building an orthonormal basis, revisited*, 2017.

use crate::real::Lanes;
use crate::vec::Vec3;

#[derive(Clone, Copy, Debug)]
pub struct Frame<T> {
    pub x: Vec3<T>,
    pub y: Vec3<T>,
    pub z: Vec3<T>,
}

impl<V: Lanes> Frame<V> {
    /// About a unit normal, or lanes of them.
    #[inline(always)]
    pub fn about(z: Vec3<V>) -> Self {
        let one = z.x.num(1.0);
        let sign = one.copysign(z.z);
        let a = -one / (sign + z.z);
        let b = z.x * z.y * a;
        Frame {
            x: Vec3::new(one + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: Vec3::new(b, sign + z.y * z.y * a, -z.y),
            z,
        }
    }
    #[inline(always)]
    pub fn local(&self, w: Vec3<V>) -> Vec3<V> {
        Vec3::new(self.x.dot(w), self.y.dot(w), self.z.dot(w))
    }
    #[inline(always)]
    pub fn world(&self, w: Vec3<V>) -> Vec3<V> {
        self.x * w.x + self.y * w.y + self.z * w.z
    }
}

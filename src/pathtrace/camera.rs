//! The eye: rays through points of the picture, of a lens, at times of the shutter.
//!
//! A thin lens is a disk about the eye. Rays from all of it through one point of the picture meet on the plane of focus, so
//! from the lens point `l` they go along `d − l / f`, where `d` is the pinhole's direction with length one along the
//! axis, and `f` the distance of that plane: one formula from a pinhole (`l` zero) to a focus at infinity (`1 / f`
//! zero). A point at distance `z` is seen as a disk of `aperture · |z − f| / (z f)` on the plane at distance one.
//!
//! A camera that moves goes straight from where it is at time 0 to where it is at time 1.
//!
//! R. L. Cook, T. Porter, L. Carpenter, *Distributed ray tracing*, 1984; C. Kolb, D. Mitchell, P. Hanrahan, *A realistic
//! camera model for computer graphics*, 1995, section 3.

use super::Pinhole;
use crate::accel::Ray;
use crate::real::Real;
use crate::sampling::disk::{Method, square_to_disk};
use crate::vec::Vec3;

/// How a camera stands at one moment.
#[derive(Clone, Copy, Debug)]
pub struct Pose<T> {
    /// `right` and `down` are steps of a pixel, `corner` the picture's top left, all on the plane at distance one.
    pub pinhole: Pinhole<T>,
    /// Radii of the lens to the right and upwards; zero for a pinhole.
    pub lens: [Vec3<T>; 2],
    /// One over the distance of the plane of focus along the axis; zero for infinity.
    pub inverse_focus: T,
}

#[derive(Clone, Copy, Debug)]
pub struct Camera<T> {
    pub start: Pose<T>,
    /// At time 1, if the camera moves.
    pub end: Option<Pose<T>>,
    /// When the shutter opens and closes.
    pub shutter: [T; 2],
}

#[inline(always)]
fn mix<T: Real>(a: Vec3<T>, b: Vec3<T>, x: T) -> Vec3<T> {
    a * (T::one() - x) + b * x
}

impl<T: Real> Pose<T> {
    /// The eye and nothing else: no lens.
    pub fn of(pinhole: Pinhole<T>) -> Self {
        Pose { pinhole, lens: [Vec3::splat(T::zero()); 2], inverse_focus: T::zero() }
    }
    #[inline(always)]
    pub fn has_lens(&self) -> bool {
        self.lens[0] != Vec3::splat(T::zero())
    }
    /// Part `x` of the way to another.
    #[inline(always)]
    fn towards(&self, end: &Self, x: T) -> Self {
        let (a, b) = (&self.pinhole, &end.pinhole);
        Pose {
            pinhole: Pinhole {
                eye: mix(a.eye, b.eye, x),
                corner: mix(a.corner, b.corner, x),
                right: mix(a.right, b.right, x),
                down: mix(a.down, b.down, x),
            },
            lens: [mix(self.lens[0], end.lens[0], x), mix(self.lens[1], end.lens[1], x)],
            inverse_focus: self.inverse_focus * (T::one() - x) + end.inverse_focus * x,
        }
    }
    /// The ray through the point (x, y) of the picture, in pixels, from the lens' point at `lens` in the unit square.
    #[inline(always)]
    pub fn ray(&self, x: T, y: T, lens: [T; 2]) -> Ray<T> {
        let p = &self.pinhole;
        let through = p.corner + p.right * x + p.down * y;
        if !self.has_lens() {
            return Ray::new(p.eye.to_array(), through.normalize().to_array());
        }
        let [a, b] = square_to_disk(lens, Method::Concentric);
        let off = self.lens[0] * a + self.lens[1] * b;
        let direction = (through - off * self.inverse_focus).normalize();
        Ray::new((p.eye + off).to_array(), direction.to_array())
    }
    /// The distance of a point along the axis.
    #[inline(always)]
    pub fn depth(&self, point: Vec3<T>) -> T {
        let axis = self.pinhole.right.cross(self.pinhole.down);
        (point - self.pinhole.eye).dot(axis) / self.pinhole.corner.dot(axis)
    }
    /// Where in the picture a direction from the eye is seen, in pixels to the right and down; not finite in the eye's plane.
    #[inline(always)]
    pub fn seen(&self, direction: Vec3<T>) -> [T; 2] {
        // direction = w (corner + x right + y down), by Cramer's rule.
        let Pinhole { corner, right, down, .. } = self.pinhole;
        let w = direction.dot(right.cross(down));
        [direction.dot(down.cross(corner)) / w, direction.dot(corner.cross(right)) / w]
    }
}

impl<T: Real> Camera<T> {
    /// Stands still, sees all sharp, all at once.
    pub fn of(pinhole: Pinhole<T>) -> Self {
        Camera { start: Pose::of(pinhole), end: None, shutter: [T::zero(); 2] }
    }
    /// Whether rays need numbers for the lens.
    #[inline(always)]
    pub fn has_lens(&self) -> bool {
        self.start.has_lens() || self.end.is_some_and(|e| e.has_lens())
    }
    /// The moment at `u` of the shutter's time.
    #[inline(always)]
    pub fn moment(&self, u: T) -> T {
        let [open, close] = self.shutter;
        open + (close - open) * u
    }
    #[inline(always)]
    pub fn pose(&self, time: T) -> Pose<T> {
        match &self.end {
            Some(end) => self.start.towards(end, time),
            None => self.start,
        }
    }
    /// The ray through the point (x, y) of the picture, in pixels from its top left corner; `lens` and `time` are numbers in
    /// [0, 1).
    #[inline(always)]
    pub fn ray(&self, x: T, y: T, lens: [T; 2], time: T) -> Ray<T> {
        match &self.end {
            None => self.start.ray(x, y, lens),
            Some(end) => self.start.towards(end, self.moment(time)).ray(x, y, lens),
        }
    }
}

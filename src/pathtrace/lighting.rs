//! What shines in a scene, and how paths look for it: lights, emitting faces, the sky, drawn by their power.
//!
//! Many are drawn from by the tree of [`crate::light::tree`], asked where rays start.
//!
//! P. Shirley, C. Wang, K. Zimmerman, *Monte Carlo techniques for direct lighting calculations*, 1996.

use super::emitters::brightness;
use super::standing::Standing;
use super::{Emitters, Surfaces};
use crate::accel::Ray;
use crate::light::tree::{self, Source};
use crate::light::{Arrival, Light};
use crate::real::{Lanes, Real};
use crate::sampling::triangle::{Method, square_to_triangle};
use crate::vec::Vec3;

/// Which lights a surface asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selection {
    /// Every one.
    All,
    /// One, in proportion to power.
    Power,
    /// One, by the tree of bounds.
    Tree,
    /// All at the first surface if they are few, later one; of many, one by the tree.
    Auto,
}

/// So many sources are few.
const FEW: usize = 4;

/// The sources of light, numbered: lights, then emitting faces (each, or all as one), then the panorama of the sky.
pub struct Lighting<T> {
    chooser: tree::Selection<T>,
    /// Sources asked one and all at the first surface and at later ones.
    all: [bool; 2],
    lights: usize,
    faces: usize,
    count: usize,
    sky: bool,
    /// What rays may meet.
    pub standing: Standing<T>,
    /// Light that comes evenly from everywhere.
    ambient: Vec<u32>,
}

impl<T: Real> Lighting<T> {
    pub fn new(scene: &Surfaces<'_, T>, selection: Selection) -> Self {
        let emitters = scene.emitters;
        let groups = scene.lights.len() + usize::from(!emitters.is_empty());
        let groups = groups + usize::from(scene.environment.is_some());
        let single = emitters.len() > FEW || groups > FEW;
        let by_tree = selection == Selection::Tree || (selection == Selection::Auto && single);
        let radius = T::of(scene.radius());
        let mut sources: Vec<Source<T>> = scene.lights.iter().map(|l| Source::of(l, radius)).collect();
        let mut faces = 0;
        if by_tree {
            faces = emitters.len();
            sources.extend((0..faces).map(|i| {
                let face = emitters.face(i);
                let power = T::of(emitters.power(i) * std::f64::consts::PI * 2.0);
                Source::of_flat(&scene.corners(face), scene.face_normal(face), true, power)
            }));
        } else if !emitters.is_empty() {
            faces = 1;
            let power = T::of(emitters.total() * std::f64::consts::PI * 2.0);
            let normal = Vec3::new(T::zero(), T::zero(), T::one());
            sources.push(Source::of_flat(&scene.corners(emitters.face(0)), normal, true, power));
        }
        if let Some(sky) = scene.environment {
            let radiance = Vec3::splat(sky.power() / (T::of(4.0) * T::PI));
            sources.push(Source::of(&Light::Ambient { radiance }, radius));
        }
        let method = if by_tree { tree::Method::Tree } else { tree::Method::Power };
        let few = sources.len() <= FEW && !by_tree;
        let alone = sources.len() <= 1;
        Lighting {
            chooser: tree::Selection::new(method, &sources),
            all: match selection {
                Selection::All => [true; 2],
                Selection::Auto => [alone || few, alone],
                Selection::Power | Selection::Tree => [alone; 2],
            },
            lights: scene.lights.len(),
            faces,
            count: sources.len(),
            sky: scene.environment.is_some(),
            standing: Standing::new(scene.lights),
            ambient: (0..scene.lights.len() as u32)
                .filter(|&k| matches!(scene.lights[k as usize], Light::Ambient { .. }))
                .collect(),
        }
    }

    /// The lights that shine evenly from everywhere.
    #[inline(always)]
    pub fn ambient(&self) -> &[u32] {
        &self.ambient
    }

    #[inline(always)]
    pub fn sources(&self) -> usize {
        self.count
    }

    /// Whether every source is asked at a surface.
    #[inline(always)]
    pub fn asks_all(&self, depth: u32) -> bool {
        self.all[usize::from(depth > 0)]
    }

    /// How many sources are asked at a surface, at most.
    pub fn asked(&self) -> u32 {
        if self.all[0] || self.all[1] { self.count as u32 } else { 1 }
    }

    /// Whether a random number is needed to choose a source, one of its faces, or one of several directions.
    #[inline(always)]
    pub fn chooses(&self, depth: u32) -> bool {
        !self.asks_all(depth) || self.faces > 0 || self.sky
    }

    /// How many times a source is asked from where a path left a surface, on average.
    ///
    /// `normal` is the shading one; zero where light may come from both sides.
    #[inline(always)]
    pub fn chance(&self, source: usize, from: Vec3<T>, normal: Vec3<T>, depth: u32) -> T {
        if self.asks_all(depth) { T::one() } else { self.chooser.chance(from, side(normal), source) }
    }

    /// The source at `u` in [0, 1), and its chance; none if none may shine here.
    #[inline(always)]
    pub fn draw(&self, from: Vec3<T>, normal: Vec3<T>, u: T) -> Option<(usize, T)> {
        match self.chooser.draw(from, side(normal), u) {
            Some(choice) => Some((choice.light, choice.chance)),
            None => None,
        }
    }

    /// The source that a face belongs to.
    #[inline(always)]
    fn of_face(&self, emitters: &Emitters, face: usize) -> usize {
        self.lights + if self.faces > 1 { emitters.place(face) } else { 0 }
    }

    /// The source of the panorama.
    #[inline(always)]
    pub fn sky(&self) -> usize {
        self.count - 1
    }
}

impl<T: Real> Surfaces<'_, T> {
    /// Of the ball around everything.
    fn radius(&self) -> f64 {
        let [mut low, mut high] = self.bvh.bounds();
        if let Some(copies) = self.copies {
            let [l, h] = copies.tree.bounds();
            if self.bvh.faces() == 0 {
                (low, high) = (l, h);
            }
            for k in 0..3 {
                (low[k], high[k]) = (Lanes::min(low[k], l[k]), Lanes::max(high[k], h[k]));
            }
        }
        let side = |k: usize| high[k].to_f64() - low[k].to_f64();
        0.5 * (0..3).map(|k| side(k) * side(k)).sum::<f64>().sqrt()
    }

    /// One draw from a source, of whose faces `pick` chooses one; the density does not count the chance of asking it.
    #[inline(always)]
    pub fn arrival(
        &self,
        lighting: &Lighting<T>,
        source: usize,
        point: Vec3<T>,
        pick: T,
        u: [T; 2],
    ) -> Option<Arrival<T>> {
        if let Some(light) = self.lights.get(source) {
            return light.sample(point, u);
        }
        let face = source - lighting.lights;
        if face < lighting.faces {
            let face =
                if lighting.faces > 1 { self.emitters.face(face) } else { self.emitters.draw(pick.to_f64()) };
            return self.on_face(lighting, face, point, u);
        }
        let draw = self.environment?.sample(u);
        let value = draw.radiance * (T::one() / draw.pdf);
        let arrival = Arrival { wi: draw.wi, distance: T::INFINITY, value, pdf: draw.pdf };
        (draw.pdf > T::zero()).then_some(arrival)
    }

    /// Light from one emitting face.
    #[inline(always)]
    fn on_face(&self, lighting: &Lighting<T>, face: usize, from: Vec3<T>, u: [T; 2]) -> Option<Arrival<T>> {
        let [a, b, c] = self.corners(face);
        let [v, w] = square_to_triangle(u, Method::Fold);
        let point = a * (T::one() - v - w) + b * v + c * w;
        let emission = self.emission[self.material_ids[face] as usize];
        let to = point - from;
        let wi = to.normalize();
        let distance = to.dot(wi);
        let cos_light = (b - a).cross(c - a).normalize().dot(wi).abs();
        let pdf = self.face_pdf(lighting, face, cos_light, distance);
        // The ray ends before the emitter by as much as it starts above the surface, seen at the emitter's angle.
        let end = distance - (self.offset + self.offset) / cos_light;
        let value = Vec3::from(emission) * (T::one() / pdf);
        let seen = pdf > T::zero() && pdf.is_finite() && end > T::zero();
        seen.then_some(Arrival { wi, distance: end, value, pdf })
    }

    /// The density per solid angle with which a point of a face is drawn from `distance` away, once its source is.
    #[inline(always)]
    fn face_pdf(&self, lighting: &Lighting<T>, face: usize, cos_light: T, distance: T) -> T {
        let emission = self.emission[self.material_ids[face] as usize];
        let of_all = T::of(brightness(emission) / self.emitters.total());
        let per_area = if lighting.faces > 1 {
            T::of(brightness(emission) / self.emitters.power(self.emitters.place(face)))
        } else {
            of_all
        };
        distance * (distance * per_area / cos_light.abs())
    }

    /// The emission of a face that a ray meets, and the density with which lights would have been asked for it.
    #[inline(always)]
    pub fn glow(
        &self,
        lighting: &Lighting<T>,
        face: usize,
        ray: &Ray<T>,
        normal: Vec3<T>,
        distance: T,
        depth: u32,
    ) -> Option<(Vec3<T>, T)> {
        let emission = self.emission[self.material_ids[face] as usize];
        if brightness(emission) == 0.0 {
            return None;
        }
        let cos_light = self.face_normal(face).dot(ray.direction.into());
        // NaN on a face without area, which gives no light.
        if !(cos_light.abs() > T::zero()) {
            return None;
        }
        let source = lighting.of_face(self.emitters, face);
        let chance = lighting.chance(source, ray.origin.into(), normal, depth);
        Some((emission.into(), self.face_pdf(lighting, face, cos_light, distance) * chance))
    }
}

/// The side from which light comes, if it comes from one.
#[inline(always)]
fn side<T: Real>(normal: Vec3<T>) -> Option<Vec3<T>> {
    if normal == Vec3::splat(T::zero()) { None } else { Some(normal) }
}

/// The weight of the strategy whose density is `own`, against the `other`'s (power heuristic).
#[inline(always)]
pub fn weight<V: Lanes>(own: V, other: V) -> V {
    // By the quotient: squares of large densities overflow.
    let (one, ratio) = (own.num(1.0), other / own);
    one / (one + ratio * ratio)
}

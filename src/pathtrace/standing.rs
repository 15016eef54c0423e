//! Lights of some size, as rays meet them: those that paths see, and that stand in the way of other lights.
//!
//! Of many, a tree of boxes tells which a ray may meet. It is cut at the middle of the longest side, and gone through
//! front to end without a stack: a box that is missed names the one behind all that it holds.
//!
//! B. Smits, *Efficiency issues for ray tracing*, 1998 (the skipping).

use crate::accel::Ray;
use crate::light::tree::Source;
use crate::light::{Light, Sighting};
use crate::real::Real;

/// So many are asked without a tree.
const FEW: usize = 4;
/// Rounding units by which the distances of lights in one place may differ.
const ROUNDING: f64 = 32.0;
/// Rounding units of the largest coordinate by which boxes are wider than lights.
const MARGIN: f64 = 64.0;

/// A box of the tree.
struct Box3<T> {
    low: [T; 3],
    high: [T; 3],
    /// The first box that this one does not hold.
    skip: u32,
    /// The light, if it is alone in here.
    light: u32,
}

const SEVERAL: u32 = u32::MAX;

/// Which of the lights rays may meet.
pub struct Standing<T> {
    /// Their numbers, rising.
    numbers: Vec<u32>,
    /// Empty if they are few.
    boxes: Vec<Box3<T>>,
}

impl<T: Real> Standing<T> {
    pub fn new(lights: &[Light<T>]) -> Self {
        let numbers: Vec<u32> = (0..lights.len() as u32).filter(|&k| lights[k as usize].stands()).collect();
        let mut boxes = Vec::new();
        if numbers.len() > FEW {
            let mut placed = Vec::with_capacity(numbers.len());
            let mut largest = 0.0;
            for &k in &numbers {
                let Source { low, high, .. } = Source::of(&lights[k as usize], T::one());
                for c in low.to_array().into_iter().chain(high.to_array()) {
                    largest = f64::max(largest, c.to_f64().abs());
                }
                placed.push((k, [low.to_array(), high.to_array()]));
            }
            let margin = T::of(MARGIN * T::EPSILON.to_f64() * largest);
            boxes.reserve(2 * placed.len());
            grow(&mut boxes, &mut placed, margin);
        }
        Standing { numbers, boxes }
    }

    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// Shows the lights that a ray may meet to `visit`, which says how far the ray goes on; not beyond `end`.
    #[inline(always)]
    fn each(&self, ray: &Ray<T>, mut end: T, mut visit: impl FnMut(usize, T) -> T) {
        if self.boxes.is_empty() {
            for &k in &self.numbers {
                end = visit(k as usize, end);
            }
            return;
        }
        let one = T::one();
        let [x, y, z] = ray.direction;
        let inverse = [one / x, one / y, one / z];
        let mut i = 0;
        while i < self.boxes.len() {
            let here = &self.boxes[i];
            if !passes(here, &ray.origin, &inverse, end) {
                i = here.skip as usize;
                continue;
            }
            if here.light != SEVERAL {
                end = visit(here.light as usize, end);
            }
            i += 1;
        }
    }

    /// The nearest light that shines against a ray before `t`, and how it is seen.
    ///
    /// Of lights in one place the first is met, as by [`Standing::hides`].
    #[inline(always)]
    pub fn nearest(&self, lights: &[Light<T>], ray: &Ray<T>, t: T) -> Option<(usize, Sighting<T>)> {
        if self.numbers.is_empty() {
            return None;
        }
        self.nearest_of(lights, ray, t)
    }

    #[inline(never)]
    fn nearest_of(&self, lights: &[Light<T>], ray: &Ray<T>, t: T) -> Option<(usize, Sighting<T>)> {
        let mut nearest: Option<(usize, Sighting<T>)> = None;
        self.each(
            ray,
            t,
            #[inline(always)]
            |k, end| {
                let Some(sighting) = lights[k].meet(ray.origin.into(), ray.direction.into()) else {
                    return end;
                };
                let mut limit = t;
                if let Some((other, met)) = &nearest {
                    let slack = T::of(ROUNDING) * T::EPSILON * met.distance;
                    limit = if k < *other { met.distance + slack } else { met.distance - slack };
                }
                if !(sighting.distance < limit && sighting.distance < t) {
                    return end;
                }
                nearest = Some((k, sighting));
                // As far as lights in the same place may be.
                sighting.distance * T::of(1.0 + 2.0 * ROUNDING * T::EPSILON.to_f64())
            },
        );
        nearest
    }

    /// Whether a light stands in the way of a shadow ray to the source, which starts `offset` above a surface.
    ///
    /// Lights in one place do not put each other out: there the first of those that stand stops the others.
    #[inline(always)]
    pub fn hides(&self, lights: &[Light<T>], ray: &Ray<T>, source: usize, offset: T) -> bool {
        match self.numbers[..] {
            [] => false,
            [only] if only as usize == source => false,
            _ => self.hides_from(lights, ray, source, offset),
        }
    }

    #[inline(never)]
    fn hides_from(&self, lights: &[Light<T>], ray: &Ray<T>, source: usize, offset: T) -> bool {
        let asked = lights.get(source);
        // Where the ray meets the source itself, since distances drawn and met differ at the rim of a sphere.
        let (mut end, mut slack) = (ray.t_max, offset + offset);
        if let Some(met) = asked.and_then(
            #[inline(always)]
            |light| light.meet(ray.origin.into(), ray.direction.into()),
        ) {
            (end, slack) = (met.distance, T::zero());
        }
        // In front of the source, or in its place.
        let (mut front, mut place) = (end, end);
        if end.is_finite() {
            slack += T::of(ROUNDING) * T::EPSILON * end;
            (front, place) = (end - slack, end + slack);
        }
        let stands = asked.is_none_or(Light::stands);
        let mut hidden = false;
        self.each(
            ray,
            place,
            #[inline(always)]
            |k, end| {
                if hidden || k == source {
                    return end;
                }
                let limit = if k < source && stands { place } else { front };
                if let Some(sighting) = lights[k].meet(ray.origin.into(), ray.direction.into())
                    && sighting.distance < limit
                {
                    hidden = true;
                    // Nothing is left to visit.
                    return -T::INFINITY;
                }
                end
            },
        );
        hidden
    }
}

/// Adds the tree over some lights.
fn grow<T: Real>(boxes: &mut Vec<Box3<T>>, lights: &mut [(u32, [[T; 3]; 2])], margin: T) {
    let (mut low, mut high) = (lights[0].1[0], lights[0].1[1]);
    for (_, [l, h]) in lights.iter() {
        for c in 0..3 {
            low[c] = if l[c] < low[c] { l[c] } else { low[c] };
            high[c] = if h[c] > high[c] { h[c] } else { high[c] };
        }
    }
    let at = boxes.len();
    let mut light = SEVERAL;
    if let [(alone, _)] = lights {
        light = *alone;
    }
    boxes.push(Box3 { low: low.map(|c| c - margin), high: high.map(|c| c + margin), skip: 0, light });
    if light == SEVERAL {
        let side = |k: usize| (high[k] - low[k]).to_f64();
        let axis = (0..3).max_by(|&a, &b| side(a).total_cmp(&side(b))).unwrap_or(0);
        let middle = |l: &(u32, [[T; 3]; 2])| 0.5 * l.1[0][axis].to_f64() + 0.5 * l.1[1][axis].to_f64();
        let half = lights.len() / 2;
        lights.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
        let (first, second) = lights.split_at_mut(half);
        grow(boxes, first, margin);
        grow(boxes, second, margin);
    }
    boxes[at].skip = boxes.len() as u32;
}

/// Whether a ray passes a box before `end`; where arithmetic gives NaN, it may.
#[inline(always)]
fn passes<T: Real>(of: &Box3<T>, origin: &[T; 3], inverse: &[T; 3], end: T) -> bool {
    let (mut entry, mut exit) = (T::zero(), end);
    for c in 0..3 {
        let (a, b) = ((of.low[c] - origin[c]) * inverse[c], (of.high[c] - origin[c]) * inverse[c]);
        let (near, far) = if a < b { (a, b) } else { (b, a) };
        entry = if near > entry { near } else { entry };
        exit = if far < exit { far } else { exit };
    }
    // Wider by the rounding of the planes' distances.
    let wide = T::of(1.0 + 8.0 * T::EPSILON.to_f64());
    !(entry > exit * wide)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::rect::Rect;
    use crate::light::sphere::Sphere;
    use crate::sampling::hash::mix32;
    use crate::vec::Vec3;

    /// Even in [-1, 1).
    fn number(i: u32) -> f32 {
        mix32(i) as f32 / 2f32.powi(31) - 1.0
    }

    fn vector(i: u32) -> Vec3<f32> {
        Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2))
    }

    /// Rectangles (along the axes or not, some in one place) and spheres, among lights that do not stand.
    fn lights() -> Vec<Light<f32>> {
        let one = Vec3::splat(1.0);
        (0..60)
            .map(|i| match i % 5 {
                0 => Light::Point { position: vector(i), intensity: one },
                1 => Light::Sphere(Sphere { center: vector(i), radius: 0.1, radiance: one }),
                2 => {
                    let (u, v) = (Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.0, 0.0, 0.5));
                    Light::Rect(Rect::new(vector(i / 20 * 20), u, v, one, true))
                }
                _ => {
                    let u = vector(i + 100) * 0.4;
                    let v = u.cross(vector(i + 200)).normalize() * 0.3;
                    Light::Rect(Rect::new(vector(i), u, v, one, true))
                }
            })
            .collect()
    }

    #[test]
    fn a_tree_tells_what_asking_all_tells() {
        let lights = lights();
        let tree = Standing::new(&lights);
        let all = Standing { numbers: tree.numbers.clone(), boxes: Vec::new() };
        assert!(!tree.boxes.is_empty());
        let (mut met, mut hidden) = (0, 0);
        for i in 0..20_000 {
            let mut direction = vector(2 * i + 5000).normalize();
            if i % 7 == 0 {
                direction.x = 0.0;
                direction = direction.normalize();
            }
            let mut ray = Ray::new((vector(2 * i + 5001) * 1.5).to_array(), direction.to_array());
            let t = if i % 2 == 0 { f32::INFINITY } else { 1.0 };
            let [a, b] = [&tree, &all].map(|s| s.nearest(&lights, &ray, t).map(|(k, s)| (k, s.distance)));
            assert_eq!(a, b, "{i}");
            met += u32::from(a.is_some());
            ray.t_max = t;
            let source = i as usize % lights.len();
            let [a, b] = [&tree, &all].map(|s| s.hides(&lights, &ray, source, 1e-5));
            assert_eq!(a, b, "{i}");
            hidden += u32::from(a);
        }
        assert!(met > 1000 && hidden > 1000, "{met} {hidden}");
    }
}

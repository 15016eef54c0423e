//! Faces that emit light, to draw points on them in proportion to area and brightness.

use crate::real::Real;
use crate::vec::Vec3;

pub struct Emitters {
    faces: Vec<u32>,
    /// Sums of area · brightness up to and with each face.
    cumulative: Vec<f64>,
}

/// What a face's emission counts.
#[inline(always)]
pub fn brightness<T: Real>(emission: [T; 3]) -> f64 {
    emission.iter().fold(0.0, |m, &c| f64::max(m, c.to_f64()))
}

impl Emitters {
    pub fn find<T: Real>(
        positions: &[[T; 3]],
        faces: &[[i32; 3]],
        material_ids: &[i32],
        emission: &[[T; 3]],
    ) -> Self {
        let (mut found, mut sum) = (Emitters { faces: Vec::new(), cumulative: Vec::new() }, 0.0);
        if emission.iter().all(|&e| brightness(e) == 0.0) {
            return found;
        }
        for (i, face) in faces.iter().enumerate() {
            let bright = brightness(emission[material_ids[i] as usize]);
            if bright > 0.0 {
                let [a, b, c] = face.map(|v| Vec3::from(positions[v as usize].map(T::to_f64)));
                let area = 0.5 * (b - a).cross(c - a).length();
                if area > 0.0 {
                    sum += area * bright;
                    found.faces.push(i as u32);
                    found.cumulative.push(sum);
                }
            }
        }
        found
    }
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }
    /// The face at `u` in [0, 1) of all light.
    #[inline(always)]
    pub fn draw(&self, u: f64) -> usize {
        let at = self.cumulative.partition_point(|&c| c <= u * self.total());
        self.faces[at.min(self.faces.len() - 1)] as usize
    }
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.faces.len()
    }
    /// The `i`-th emitting face.
    #[inline(always)]
    pub fn face(&self, i: usize) -> usize {
        self.faces[i] as usize
    }
    /// Which of the emitting faces this is.
    #[inline(always)]
    pub fn place(&self, face: usize) -> usize {
        self.faces.partition_point(|&f| (f as usize) < face)
    }
    /// Area times brightness of the `i`-th.
    #[inline(always)]
    pub fn power(&self, i: usize) -> f64 {
        self.cumulative[i] - if i == 0 { 0.0 } else { self.cumulative[i - 1] }
    }
    #[inline(always)]
    pub fn total(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }
}

//! Boxes of triangles and of the scene, in single precision relative to the scene: what builders decide by.

use crate::real::Real;

/// Lists longer than this are worth more than one thread.
pub const LARGE: usize = 1 << 14;

/// A box in single precision; the fourth component makes it a SIMD register.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub low: [f32; 4],
    pub high: [f32; 4],
}

impl Bounds {
    pub const EMPTY: Bounds = Bounds { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };

    #[inline(always)]
    pub fn grow(&mut self, o: &Bounds) {
        for k in 0..4 {
            self.low[k] = if o.low[k] < self.low[k] { o.low[k] } else { self.low[k] };
            self.high[k] = if o.high[k] > self.high[k] { o.high[k] } else { self.high[k] };
        }
    }
    /// Half the surface.
    #[inline(always)]
    pub fn area(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|k| (self.high[k] - self.low[k]).max(0.0));
        x * y + y * z + z * x
    }
}

/// A triangle's box. The face's number stands in the fourth component of `high`, as the bits of a normal number.
#[derive(Clone, Copy)]
pub struct Item(pub Bounds);

impl Item {
    const NORMAL: u32 = 1 << 23;

    fn new(low: [f32; 3], high: [f32; 3], face: usize) -> Self {
        let ([a, b, c], [x, y, z]) = (low, high);
        Item(Bounds { low: [a, b, c, 0.0], high: [x, y, z, f32::from_bits(face as u32 + Self::NORMAL)] })
    }
    #[inline(always)]
    pub fn face(&self) -> usize {
        (self.0.high[3].to_bits() - Self::NORMAL) as usize
    }
    /// Twice the centre.
    #[inline(always)]
    pub fn centre(&self) -> [f32; 4] {
        std::array::from_fn(|k| self.0.low[k] + self.0.high[k])
    }
}

/// The exact bounds of all triangles; zeros if there are none.
pub fn scene_bounds<T: Real>(positions: &[[T; 3]], faces: &[[i32; 3]]) -> [[T; 3]; 2] {
    if faces.is_empty() {
        return [[T::zero(); 3]; 2];
    }
    let merge = |a: [[T; 3]; 2], b: [[T; 3]; 2]| {
        let low = std::array::from_fn(|k| a[0][k].min(b[0][k]));
        [low, std::array::from_fn(|k| a[1][k].max(b[1][k]))]
    };
    let of = |faces: &[[i32; 3]]| {
        let corners = faces.iter().flatten().map(|&i| positions[i as usize]);
        corners.fold([[T::INFINITY; 3], [-T::INFINITY; 3]], |b, p| merge(b, [p, p]))
    };
    reduce(faces, &of, &merge)
}

/// Items in single precision, the longest side of the scene being one.
pub fn items<T: Real>(positions: &[[T; 3]], faces: &[[i32; 3]], bounds: &[[T; 3]; 2]) -> Vec<Item> {
    let low = bounds[0].map(|x| x.to_f64());
    let extent = (0..3).map(|k| bounds[1][k].to_f64() - low[k]).fold(0.0, f64::max);
    let scale = if extent > 0.0 { 1.0 / extent } else { 0.0 };
    let item = |face: usize| {
        let corner = |j: usize| {
            let p = positions[faces[face][j] as usize];
            std::array::from_fn::<f32, 3, _>(|k| ((p[k].to_f64() - low[k]) * scale) as f32)
        };
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let low = std::array::from_fn(|k| a[k].min(b[k]).min(c[k]));
        Item::new(low, std::array::from_fn(|k| a[k].max(b[k]).max(c[k])), face)
    };
    use rayon::prelude::*;
    (0..faces.len()).into_par_iter().with_min_len(LARGE).map(item).collect()
}

/// Folds a long list in halves, side by side; `merge` must not care for order.
pub fn reduce<I: Sync, R: Send>(
    list: &[I],
    of: &(impl Fn(&[I]) -> R + Sync),
    merge: &(impl Fn(R, R) -> R + Sync),
) -> R {
    if list.len() <= LARGE {
        return of(list);
    }
    let (a, b) = list.split_at(list.len() / 2);
    let (a, b) = rayon::join(|| reduce(a, of, merge), || reduce(b, of, merge));
    merge(a, b)
}

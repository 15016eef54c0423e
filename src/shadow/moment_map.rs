//! Maps of moments: powers or exponentials of depth, which may be averaged, as depths may not.
//!
//! Depth is brought to [-1, 1], which keeps the most bits of its powers, and texels without anything lie at 1. A texel
//! of the moment map is the mean over a square of the depth map's texels.
//!
//! W. Donnelly, A. Lauritzen, *Variance Shadow Maps*, I3D 2006. A. Lauritzen, M. McCool, *Layered Variance Shadow
//! Maps*, GI 2008 (exponentials). C. Peters, R. Klein, *Moment Shadow Mapping*, I3D 2015. C. Peters et al., *Improved
//! Moment Shadow Maps for Translucent Occluders, Soft Shadows and Single Scattering*, JCGT 2017 (signed depth,
//! quantisation).

use crate::dispatch;
use crate::math;
use crate::parallel::{self, Interrupted, Rows, Watch};
use crate::real::{Lanes, Real};
use crate::shadow::anchor::all;
use crate::simd::*;

/// What is averaged, of a depth z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Basis<T> {
    /// z, z².
    Powers2,
    /// z, z², z³, z⁴.
    Powers4,
    /// e^(az) and its square.
    Exponential(T),
    /// e^(az), −e^(−bz), each with its square.
    Exponentials(T, T),
}

impl<T: Real> Basis<T> {
    pub fn channels(self) -> usize {
        match self {
            Basis::Powers2 | Basis::Exponential(_) => 2,
            Basis::Powers4 | Basis::Exponentials(..) => 4,
        }
    }

    #[inline(always)]
    pub fn of<V: Lanes<Elem = T>>(self, z: V) -> [V; 4] {
        let zero = z.num(0.0);
        match self {
            Basis::Powers2 => [z, z * z, zero, zero],
            Basis::Powers4 => [z, z * z, z * z * z, (z * z) * (z * z)],
            Basis::Exponential(a) => {
                let e = math::exp(z * z.like(a));
                [e, e * e, zero, zero]
            }
            Basis::Exponentials(a, b) => {
                let (e, f) = (math::exp(z * z.like(a)), -math::exp(z * z.like(-b)));
                [e, e * e, f, f * f]
            }
        }
    }
}

/// From depth to [-1, 1]: less `middle`, times `per`.
#[derive(Clone, Copy, Debug)]
pub struct Warp<T> {
    pub middle: T,
    pub per: T,
}

impl<T: Real> Warp<T> {
    #[inline(always)]
    pub fn of<V: Lanes<Elem = T>>(self, depth: V) -> V {
        let (z, one) = ((depth - depth.like(self.middle)) * depth.like(self.per), depth.num(1.0));
        V::select(z.equal(z), z.min(one).max(-one), z)
    }

    #[inline(always)]
    pub fn back<V: Lanes<Elem = T>>(self, z: V) -> V {
        z.like(self.middle) + z / z.like(self.per)
    }
}

/// Means of the basis over squares of `reduce`² texels (fewer at the right and at the bottom): `out` has
/// ⌈width / reduce⌉ × ⌈height / reduce⌉ texels.
pub fn moment_map<T: Real>(
    watch: &mut dyn Watch,
    depth: &[T],
    [width, height]: [usize; 2],
    reduce: usize,
    warp: Warp<T>,
    basis: Basis<T>,
    out: &mut [T],
) -> Result<(), Interrupted> {
    let channels = basis.channels();
    let row = width.div_ceil(reduce) * channels;
    assert!(depth.len() == width * height && out.len() == row * height.div_ceil(reduce), "sizes");
    let band = ((1 << 17) / (width * reduce)).max(1);
    parallel::for_each(watch, Rows { data: out, width: row }, band, |first, out| {
        let mut columns = vec![T::zero(); channels * width];
        dispatch!(s => for (i, out) in out.data.chunks_exact_mut(row).enumerate() {
            let y = (first + i) * reduce;
            let rows = &depth[y * width..(y + reduce).min(height) * width];
            if channels == 2 {
                means::<T, _, 2>(s, rows, width, reduce, warp, basis, &mut columns, out);
            } else {
                means::<T, _, 4>(s, rows, width, reduce, warp, basis, &mut columns, out);
            }
        });
    })
}

/// One row of the result from the rows that it covers: sums of each column, in a plane of `columns` a channel, then of
/// each square.
#[inline(always)]
fn means<T: Real, S: Simd, const C: usize>(
    s: S,
    rows: &[T],
    width: usize,
    reduce: usize,
    warp: Warp<T>,
    basis: Basis<T>,
    columns: &mut [T],
    out: &mut [T],
) {
    let high = rows.len() / width;
    let whole = width / 8 * 8;
    for x in (0..whole).step_by(8) {
        let mut sums = [all::<T, S>(s, T::zero()); C];
        for y in 0..high {
            let at = y * width + x;
            let b = basis.of(warp.of(<T::V8<S> as SimdBase<S>>::from_slice(s, &rows[at..at + 8])));
            for c in 0..C {
                sums[c] += b[c];
            }
        }
        for c in 0..C {
            sums[c].store_slice(&mut columns[c * width + x..][..8]);
        }
    }
    for x in whole..width {
        let mut sums = [T::zero(); C];
        for y in 0..high {
            let b = basis.of(warp.of(rows[y * width + x]));
            for c in 0..C {
                sums[c] += b[c];
            }
        }
        for c in 0..C {
            columns[c * width + x] = sums[c];
        }
    }
    for x in 0..out.len() / C {
        let (first, end) = (x * reduce, (x * reduce + reduce).min(width));
        let share = T::one() / T::of((high * (end - first)) as f64);
        for c in 0..C {
            let mut sum = T::zero();
            for i in first..end {
                sum += columns[c * width + i];
            }
            out[x * C + c] = sum * share;
        }
    }
}

/// √3.
const ROOT_3: f64 = 1.732_050_807_568_877_2;

/// Four powers to four numbers in [0, 1] that rounding harms least, and which may be averaged as well.
#[inline(always)]
pub fn quantizable<T: Real>([b1, b2, b3, b4]: [T; 4]) -> [T; 4] {
    let (half, four) = (T::of(0.5), T::of(4.0));
    [
        T::of(1.5) * b1 - T::of(2.0) * b3 + half,
        four * b2 - four * b4,
        T::of(ROOT_3 / 2.0) * b1 - T::of(2.0 * ROOT_3 / 9.0) * b3 + half,
        half * b2 + half * b4,
    ]
}

/// The inverse of [`quantizable`].
#[inline(always)]
pub fn powers<T: Real>([q1, q2, q3, q4]: [T; 4]) -> [T; 4] {
    let (o1, o3) = (q1 - T::of(0.5), q3 - T::of(0.5));
    [
        T::of(ROOT_3) * o3 - T::of(1.0 / 3.0) * o1,
        q4 + T::of(0.125) * q2,
        T::of(0.75 * ROOT_3) * o3 - T::of(0.75) * o1,
        q4 - T::of(0.125) * q2,
    ]
}

/// Largest number of 16 bits.
const WHOLE: f64 = 65535.0;

/// Four powers a texel in 16 bits each.
pub fn quantize<T: Real>(watch: &mut dyn Watch, moments: &[T], out: &mut [u16]) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (moments.as_chunks::<4>().0, out.as_chunks_mut::<4>().0),
        1 << 15,
        |_, (m, out)| {
            dispatch!(_s => for i in 0..out.len() {
                let q = quantizable(m[i]);
                for c in 0..4 {
                    let scaled = Lanes::max(Lanes::min(q[c], T::one()), T::zero()) * T::of(WHOLE);
                    out[i][c] = (scaled + T::of(0.5)).floor().to_f64() as u16;
                }
            });
        },
    )
}

/// What a texel is stored as.
pub trait Stored: Copy + Send + Sync {
    /// Whether what is stored is [`quantizable`].
    const QUANTIZED: bool = false;
    fn real<T: Real>(self) -> T;
}

impl Stored for f32 {
    #[inline(always)]
    fn real<T: Real>(self) -> T {
        T::of(f64::from(self))
    }
}

impl Stored for f64 {
    #[inline(always)]
    fn real<T: Real>(self) -> T {
        T::of(self)
    }
}

impl Stored for u16 {
    const QUANTIZED: bool = true;
    #[inline(always)]
    fn real<T: Real>(self) -> T {
        T::of(f64::from(self)) * T::of(1.0 / WHOLE)
    }
}

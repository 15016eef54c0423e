//! The numbers that kernels are generic over.
//!
//! [`Lanes`] is one number or a SIMD vector of numbers: straight-line arithmetic written against it serves a
//! scalar loop (which the compiler vectorises inside the dispatch of [`crate::simd`]) and explicit lanes alike,
//! with the same bits, since nothing here is fused. [`Real`] is the scalar itself: `f32` or `f64`.

use fearless_simd::{Bytes, Select, Simd, SimdBase, SimdFloat, SimdFloatElement, SimdMask};
use fearless_simd::{f32x4, f32x8, f32x16, f64x2, f64x4, f64x8};
use num_traits::NumAssign;
use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// One number, or a vector of numbers on which every operation acts lane by lane.
///
/// Comparisons are false where either side is NaN; [`Lanes::min`] and [`Lanes::max`] return `other` then.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    type Elem: Real;
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask> + Not<Output = Self::Mask>;

    /// `x` in every lane. The receiver only lends its SIMD token.
    fn like(self, x: Self::Elem) -> Self;
    /// Its first lane.
    fn first(self) -> Self::Elem;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn less(self, other: Self) -> Self::Mask;
    fn less_eq(self, other: Self) -> Self::Mask;
    fn equal(self, other: Self) -> Self::Mask;
    /// `a` where the mask holds, `b` elsewhere.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// The lanes in which the mask holds, as bits; lane 0 is the lowest.
    fn bits(mask: Self::Mask) -> u32;
    fn copysign(self, sign: Self) -> Self;
    /// `2^n` for integral `n` in the range of normal exponents, by placing the exponent bits.
    fn exp2i(n: Self) -> Self;
    /// `(m, e)` with `self = m · 2^e` and `m` in `[√½, √2)`, for positive normal numbers.
    fn split_exponent(self) -> (Self, Self);

    #[inline(always)]
    fn num(self, x: f64) -> Self {
        self.like(<Self::Elem as Real>::of(x))
    }
    /// The nearest integer, ties to even, where `|self| < 2^(mantissa bits - 1)`.
    #[inline(always)]
    fn round(self) -> Self {
        let magic = self.like(Self::Elem::ROUND_MAGIC);
        (self + magic) - magic
    }
}

/// `f32` or `f64`: the precision that a kernel is compiled for.
pub trait Real:
    Lanes<Elem = Self, Mask = bool>
    + NumAssign
    + SimdFloatElement
    + PartialOrd
    + Default
    + Debug
    + Send
    + Sync
    + bytemuck::Pod
    + 'static
{
    type V4<S: Simd>: SimdFloat<S, Element = Self, Array = [Self; 4]> + Lanes<Elem = Self>;
    type V8<S: Simd>: SimdFloat<S, Element = Self, Array = [Self; 8]> + Lanes<Elem = Self>;
    /// The one matrix of a camera, a node, a light.
    type Mat4: Copy + Send + Sync;

    /// f64, else f32: chooses among constants, never among methods.
    const DOUBLE: bool;
    const INFINITY: Self;
    const NAN: Self;
    /// Distance from 1 to the next larger number: twice the unit round-off.
    const EPSILON: Self;
    const MAX: Self;
    const MIN_POSITIVE: Self;
    const PI: Self;
    /// Adding and subtracting this rounds to an integer: 1.5 · 2^(mantissa bits).
    const ROUND_MAGIC: Self;

    fn of(x: f64) -> Self;
    fn to_f64(self) -> f64;
    /// The low bits of the representation: after adding [`Real::ROUND_MAGIC`], the nearest integer.
    fn low_bits(self) -> i32;
    /// The representation whose low bits are `i`: a lane that carries an integer.
    fn of_low_bits(i: i32) -> Self;
    fn floor(self) -> Self;
    /// Lanes that hold integers in [0, 2^22], as integers.
    fn indices<S: Simd>(v: Self::V8<S>) -> [u32; 8];
    /// y · width + x of such lanes, where the result has 32 bits.
    fn places<S: Simd>(x: Self::V8<S>, y: Self::V8<S>, width: u32) -> [u32; 8];
    /// The nearest number towards +infinity.
    fn next_up(self) -> Self;
    /// The nearest number towards -infinity.
    fn next_down(self) -> Self;
    fn is_nan(self) -> bool;
    fn is_finite(self) -> bool;
    fn clamp01(self) -> Self {
        // `max` first: NaN becomes 0 only through the caller's own choice, so it is let through here.
        if self.is_nan() { self } else { Lanes::min(Lanes::max(self, Self::zero()), Self::one()) }
    }
}

/// Implements [`Lanes`] and [`Real`] for a scalar from its name, bits and format.
macro_rules! scalar {
    ($t:ident, $bits:ident, $mantissa:literal, $bias:literal, $v4:ident, $v8:ident, $mat4:ty) => {
        impl Lanes for $t {
            type Elem = $t;
            type Mask = bool;
            #[inline(always)]
            fn like(self, x: $t) -> $t {
                x
            }
            #[inline(always)]
            fn first(self) -> $t {
                self
            }
            #[inline(always)]
            fn abs(self) -> $t {
                <$t>::abs(self)
            }
            #[inline(always)]
            fn sqrt(self) -> $t {
                <$t>::sqrt(self)
            }
            #[inline(always)]
            fn min(self, other: $t) -> $t {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: $t) -> $t {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn less(self, other: $t) -> bool {
                self < other
            }
            #[inline(always)]
            fn less_eq(self, other: $t) -> bool {
                self <= other
            }
            #[inline(always)]
            fn equal(self, other: $t) -> bool {
                self == other
            }
            #[inline(always)]
            fn select(mask: bool, a: $t, b: $t) -> $t {
                if mask { a } else { b }
            }
            #[inline(always)]
            fn bits(mask: bool) -> u32 {
                mask as u32
            }
            #[inline(always)]
            fn copysign(self, sign: $t) -> $t {
                <$t>::copysign(self, sign)
            }
            #[inline(always)]
            fn exp2i(n: $t) -> $t {
                // n + bias + 2^mantissa has the wanted exponent in its lowest mantissa bits.
                let shifted = n + ($bias as $t + (1u64 << $mantissa) as $t);
                <$t>::from_bits(shifted.to_bits() << $mantissa)
            }
            #[inline(always)]
            fn split_exponent(self) -> ($t, $t) {
                let half = (0.5 as $t).sqrt().to_bits();
                let one = (1.0 as $t).to_bits();
                let x = self.to_bits().wrapping_add(one.wrapping_sub(half));
                // The biased exponent as a float, through the mantissa of 2^mantissa again.
                let magic = (1u64 << $mantissa) as $t;
                let e = <$t>::from_bits((x >> $mantissa) | magic.to_bits()) - magic - $bias as $t;
                let m = <$t>::from_bits((x & ((1 << $mantissa) - 1)).wrapping_add(half));
                (m, e)
            }
        }
        impl Real for $t {
            type V4<S: Simd> = $v4<S>;
            type V8<S: Simd> = $v8<S>;
            type Mat4 = $mat4;
            const DOUBLE: bool = $mantissa == 52;
            const INFINITY: $t = <$t>::INFINITY;
            const NAN: $t = <$t>::NAN;
            const EPSILON: $t = <$t>::EPSILON;
            const MAX: $t = <$t>::MAX;
            const MIN_POSITIVE: $t = <$t>::MIN_POSITIVE;
            const PI: $t = std::f64::consts::PI as $t;
            const ROUND_MAGIC: $t = 1.5 * (1u64 << $mantissa) as $t;
            #[inline(always)]
            fn of(x: f64) -> $t {
                x as $t
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn low_bits(self) -> i32 {
                self.to_bits() as i32
            }
            #[inline(always)]
            fn of_low_bits(i: i32) -> $t {
                <$t>::from_bits(i as u32 as $bits)
            }
            #[inline(always)]
            fn floor(self) -> $t {
                <$t>::floor(self)
            }
            #[inline(always)]
            fn indices<S: Simd>(v: Self::V8<S>) -> [u32; 8] {
                // Beside 2^mantissa the integer stands in the lowest bits.
                let bits = v + (1u64 << $mantissa) as $t;
                let bits: <$v8<S> as SimdFloat<S>>::Bits = bits.bitcast();
                let bits = bits & ((1 << $mantissa) - 1);
                let bits = bits.as_slice();
                let mut out = [0; 8];
                for k in 0..8 {
                    out[k] = bits[k] as u32;
                }
                out
            }
            #[inline(always)]
            fn places<S: Simd>(x: Self::V8<S>, y: Self::V8<S>, width: u32) -> [u32; 8] {
                // As in `indices`.
                let (x, y) = (x + (1u64 << $mantissa) as $t, y + (1u64 << $mantissa) as $t);
                let (x, y): (<$v8<S> as SimdFloat<S>>::Bits, <$v8<S> as SimdFloat<S>>::Bits) =
                    (x.bitcast(), y.bitcast());
                let (x, y) = (x & ((1 << $mantissa) - 1), y & ((1 << $mantissa) - 1));
                let place = y * $bits::from(width) + x;
                let place = place.as_slice();
                let mut out = [0; 8];
                for k in 0..8 {
                    out[k] = place[k] as u32;
                }
                out
            }
            #[inline(always)]
            fn next_up(self) -> $t {
                <$t>::next_up(self)
            }
            #[inline(always)]
            fn next_down(self) -> $t {
                <$t>::next_down(self)
            }
            #[inline(always)]
            fn is_nan(self) -> bool {
                <$t>::is_nan(self)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                <$t>::is_finite(self)
            }
        }
    };
}
scalar!(f32, u32, 23, 127, f32x4, f32x8, glam::Mat4);
scalar!(f64, u64, 52, 1023, f64x4, f64x8, glam::DMat4);

/// Implements [`Lanes`] for a SIMD vector over the operations of `fearless_simd`.
macro_rules! vector {
    ($v:ident, $t:ident, $mantissa:literal, $bias:literal) => {
        impl<S: Simd> Lanes for $v<S> {
            type Elem = $t;
            type Mask = <$v<S> as SimdBase<S>>::Mask;
            #[inline(always)]
            fn like(self, x: $t) -> Self {
                SimdBase::splat(self.simd, x)
            }
            #[inline(always)]
            fn first(self) -> $t {
                self.as_slice()[0]
            }
            #[inline(always)]
            fn abs(self) -> Self {
                SimdBase::abs(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                self.simd_lt(other).select(self, other)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                self.simd_gt(other).select(self, other)
            }
            #[inline(always)]
            fn less(self, other: Self) -> Self::Mask {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn less_eq(self, other: Self) -> Self::Mask {
                self.simd_le(other)
            }
            #[inline(always)]
            fn equal(self, other: Self) -> Self::Mask {
                self.simd_eq(other)
            }
            #[inline(always)]
            fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
                mask.select(a, b)
            }
            #[inline(always)]
            fn bits(mask: Self::Mask) -> u32 {
                mask.to_bitmask() as u32
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                SimdFloat::copysign(self, sign)
            }
            #[inline(always)]
            fn exp2i(n: Self) -> Self {
                // `bitcast`, since `to_bits` and `from_bits` are not inlined into the dispatch.
                let shifted = n + ($bias as $t + (1u64 << $mantissa) as $t);
                let bits: <$v<S> as SimdFloat<S>>::Bits = shifted.bitcast();
                (bits << $mantissa).bitcast()
            }
            #[inline(always)]
            fn split_exponent(self) -> (Self, Self) {
                let half = (0.5 as $t).sqrt().to_bits();
                let one = (1.0 as $t).to_bits();
                let bits: <$v<S> as SimdFloat<S>>::Bits = self.bitcast();
                let x = bits + one.wrapping_sub(half);
                let magic = (1u64 << $mantissa) as $t;
                let e: Self = ((x >> $mantissa) | magic.to_bits()).bitcast();
                let m: Self = ((x & ((1 << $mantissa) - 1)) + half).bitcast();
                (m, e - magic - $bias as $t)
            }
        }
    };
}
vector!(f32x4, f32, 23, 127);
vector!(f32x8, f32, 23, 127);
vector!(f32x16, f32, 23, 127);
vector!(f64x2, f64, 52, 1023);
vector!(f64x4, f64, 52, 1023);
vector!(f64x8, f64, 52, 1023);

//! Which instructions a kernel runs on, chosen at run time.
//!
//! Each kernel is compiled twice on x86-64: for the baseline (SSE2) and for AVX2; once on arm64 (NEON). Wider
//! levels gained too little to pay for their compile time. [`dispatch!`] stands inside the parallel task and calls
//! an `#[inline(always)]` body. No kernel fuses a multiplication with an addition, so levels agree to the bit.
//!
//! `SHADELAB_SIMD=baseline|avx2` and [`force`] choose a level; a level that the machine lacks is refused.

pub mod columns;

use crate::real::Real;
use std::sync::atomic::{AtomicU8, Ordering};

pub use fearless_simd::prelude::*;
pub use fearless_simd::{Level as Machine, f32x4, f32x8, f32x16, f64x4, f64x8};

/// A set of instructions that kernels were compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Level {
    Baseline = 1,
    Avx2 = 2,
}

impl Level {
    pub const ALL: [Level; 2] = [Level::Baseline, Level::Avx2];

    pub fn name(self) -> &'static str {
        match self {
            Level::Baseline => "baseline",
            Level::Avx2 => "avx2",
        }
    }
    pub fn from_name(name: &str) -> Option<Level> {
        Level::ALL.into_iter().find(|l| l.name() == name)
    }
    pub fn available(self) -> bool {
        match self {
            Level::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => Machine::new().as_avx2().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            Level::Avx2 => false,
        }
    }
}

/// 0: not yet asked.
static CURRENT: AtomicU8 = AtomicU8::new(0);

fn best() -> Level {
    if Level::Avx2.available() { Level::Avx2 } else { Level::Baseline }
}

/// The level in force.
#[inline]
pub fn level() -> Level {
    match CURRENT.load(Ordering::Relaxed) {
        1 => Level::Baseline,
        2 => Level::Avx2,
        _ => {
            let asked = std::env::var("SHADELAB_SIMD").ok().and_then(|s| Level::from_name(&s));
            let level = asked.filter(|l| l.available()).unwrap_or_else(best);
            CURRENT.store(level as u8, Ordering::Relaxed);
            level
        }
    }
}

/// Sets the level, or the best one for `None`; false if the machine lacks it.
pub fn force(level: Option<Level>) -> bool {
    let level = level.unwrap_or_else(best);
    if level.available() {
        CURRENT.store(level as u8, Ordering::Relaxed);
    }
    level.available()
}

/// `out[i] = f(x[i])`, eight explicit lanes at a time: for functions too long for the compiler to vectorise a scalar
/// loop of them. A last, shorter group is padded with ones.
#[inline(always)]
pub fn map_lanes<T: Real, S: Simd>(s: S, x: &[T], out: &mut [T], f: impl Fn(T::V8<S>) -> T::V8<S>) {
    // A closure that were not inlined would leave the dispatch, and with it its instructions.
    zip_lanes(
        s,
        x,
        x,
        out,
        #[inline(always)]
        |x, _| f(x),
    );
}

/// `out[i] = f(a[i], b[i])`, as [`map_lanes`].
#[inline(always)]
pub fn zip_lanes<T: Real, S: Simd>(
    s: S,
    a: &[T],
    b: &[T],
    out: &mut [T],
    f: impl Fn(T::V8<S>, T::V8<S>) -> T::V8<S>,
) {
    let ((a, a_rest), (b, b_rest), (out, tail)) = (a.as_chunks(), b.as_chunks(), out.as_chunks_mut());
    for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
        *out = f(T::V8::load_array_ref(s, a), T::V8::load_array_ref(s, b)).to_array();
    }
    if !tail.is_empty() {
        let (mut a, mut b) = ([T::one(); 8], [T::one(); 8]);
        a[..a_rest.len()].copy_from_slice(a_rest);
        b[..b_rest.len()].copy_from_slice(b_rest);
        let last = f(T::V8::load_array(s, a), T::V8::load_array(s, b)).to_array();
        tail.copy_from_slice(&last[..tail.len()]);
    }
}

/// `dispatch!(s => body)` runs `body` with the SIMD token `s` of the level in force. `body` should be one call of
/// an `#[inline(always)]` function.
#[macro_export]
macro_rules! dispatch {
    ($s:ident => $body:expr) => {{
        #[allow(unused_imports)]
        use fearless_simd::Simd as _;
        let machine = $crate::simd::Machine::new();
        #[cfg(target_arch = "x86_64")]
        {
            match (machine.as_avx2(), $crate::simd::level()) {
                (Some($s), $crate::simd::Level::Avx2) => $s.vectorize(
                    #[inline(always)]
                    || $body,
                ),
                _ => {
                    // Sound to unwrap: SSE2 is part of x86-64.
                    let $s = machine.as_sse2().expect("x86-64 has SSE2");
                    $s.vectorize(
                        #[inline(always)]
                        || $body,
                    )
                }
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            fearless_simd::dispatch!(machine, $s => $body)
        }
    }};
}

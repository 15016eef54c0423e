//! Eight items at a time over arrays of items: blocks of them become columns, columns are read in lanes, and back.
//!
//! An array of vectors interleaves its components, which lanes cannot read. A block is taken apart by a loop of fixed
//! length that the compiler turns into wide loads and shuffles, at a fraction of the cost of gathering lane by lane;
//! it stays in the nearest cache.

use super::{Simd, SimdBase};
use crate::real::Real;

/// The lanes of a vector.
pub const LANES: usize = 8;
/// Vectors of a block.
pub const GROUPS: usize = 8;
/// Items of a block.
pub const BLOCK: usize = LANES * GROUPS;

type Column<T> = [[T; LANES]; GROUPS];

/// Items that are read: one for all, or one each.
pub struct Source<'a, T, const N: usize> {
    items: &'a [[T; N]],
    columns: [Column<T>; N],
}

impl<'a, T: Real, const N: usize> Source<'a, T, N> {
    /// Of `items` those from `first` on, unless there is but one.
    #[inline(always)]
    pub fn over(items: &'a [[T; N]], first: usize) -> Self {
        let mut columns = [[[T::zero(); LANES]; GROUPS]; N];
        if items.len() != 1 {
            return Source { items: &items[first..], columns };
        }
        for c in 0..N {
            columns[c] = [[items[0][c]; LANES]; GROUPS];
        }
        Source { items: &[], columns }
    }

    /// Makes the block from `at` on ready; a last, shorter one is filled up with what was there.
    #[inline(always)]
    pub fn load(&mut self, at: usize) {
        if self.items.is_empty() {
            return;
        }
        match self.items[at..].first_chunk::<BLOCK>() {
            Some(block) => apart(block, &mut self.columns),
            None => {
                for (i, item) in self.items[at..].iter().enumerate() {
                    for c in 0..N {
                        self.columns[c][i / LANES][i % LANES] = item[c];
                    }
                }
            }
        }
    }

    /// The components of a group of the block.
    #[inline(always)]
    pub fn lanes<S: Simd>(&self, s: S, group: usize) -> [T::V8<S>; N] {
        let mut lanes = [<T::V8<S> as SimdBase<S>>::splat(s, T::zero()); N];
        for c in 0..N {
            lanes[c] = SimdBase::load_array_ref(s, &self.columns[c][group]);
        }
        lanes
    }
}

/// Items that are written.
pub struct Sink<'a, V, T, const N: usize> {
    items: &'a mut [[T; N]],
    columns: [Column<T>; N],
    /// Of the group under way.
    pub given: [V; N],
}

impl<'a, T: Real, const N: usize> Sink<'a, (), T, N> {
    #[inline(always)]
    pub fn over<S: Simd>(s: S, items: &'a mut [[T; N]]) -> Sink<'a, T::V8<S>, T, N> {
        let zero = T::zero();
        let given = [<T::V8<S> as SimdBase<S>>::splat(s, zero); N];
        Sink { items, columns: [[[zero; LANES]; GROUPS]; N], given }
    }
}

impl<V, T: Real, const N: usize> Sink<'_, V, T, N> {
    /// Keeps what was given as a group of the block.
    #[inline(always)]
    pub fn keep<S: Simd>(&mut self, _: S, group: usize)
    where
        T: Real<V8<S> = V>,
        V: SimdBase<S, Element = T, Array = [T; LANES]>,
    {
        for c in 0..N {
            self.columns[c][group] = self.given[c].to_array();
        }
    }

    /// Keeps one component of a group of the block.
    #[inline(always)]
    pub fn put<S: Simd>(&mut self, _: S, component: usize, group: usize, x: V)
    where
        T: Real<V8<S> = V>,
        V: SimdBase<S, Element = T, Array = [T; LANES]>,
    {
        self.columns[component][group] = x.to_array();
    }

    /// Writes the block from `at` on.
    #[inline(always)]
    pub fn store(&mut self, at: usize) {
        match self.items[at..].first_chunk_mut::<BLOCK>() {
            Some(block) => together(&self.columns, block),
            None => {
                for (i, item) in self.items[at..].iter_mut().enumerate() {
                    for c in 0..N {
                        item[c] = self.columns[c][i / LANES][i % LANES];
                    }
                }
            }
        }
    }
}

/// The standard library's `as_flattened` would be called outside the dispatch.
#[inline(always)]
fn flat<T>(column: &Column<T>) -> &[T; BLOCK] {
    // SAFETY: arrays of arrays lie without gaps, BLOCK = LANES * GROUPS of one element type.
    unsafe { &*(column as *const Column<T> as *const [T; BLOCK]) }
}

#[inline(always)]
fn flat_mut<T>(column: &mut Column<T>) -> &mut [T; BLOCK] {
    // SAFETY: as of `flat`.
    unsafe { &mut *(column as *mut Column<T> as *mut [T; BLOCK]) }
}

#[inline(always)]
fn apart<T: Copy, const N: usize>(items: &[[T; N]; BLOCK], columns: &mut [Column<T>; N]) {
    for i in 0..BLOCK {
        for c in 0..N {
            flat_mut(&mut columns[c])[i] = items[i][c];
        }
    }
}

#[inline(always)]
fn together<T: Copy, const N: usize>(columns: &[Column<T>; N], items: &mut [[T; N]; BLOCK]) {
    for i in 0..BLOCK {
        for c in 0..N {
            items[i][c] = flat(&columns[c])[i];
        }
    }
}

/// The body of a loop in lanes: `in_lanes!(s, n, |a, b| -> (x, y) { … })`, where `a` and `b` are [`Source`]s, `x` and
/// `y` [`Sink`]s of `n` items; in the block `a` and `b` are the components of a group, and it gives those of `x` and `y`.
#[macro_export]
macro_rules! in_lanes {
    ($s:ident, $n:expr, |$($x:ident),+ $(,)?| -> ($($y:ident),+ $(,)?) $body:block) => {{
        let (n, mut at) = ($n, 0);
        while at < n {
            $($x.load(at);)+
            let groups = (n - at).min($crate::simd::columns::BLOCK).div_ceil($crate::simd::columns::LANES);
            for group in 0..groups {
                $(let $x = $x.lanes($s, group);)+
                ($($y.given),+) = $body;
                $($y.keep($s, group);)+
            }
            $($y.store(at);)+
            at += $crate::simd::columns::BLOCK;
        }
    }};
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispatch;

    #[test]
    fn items_come_back_whatever_their_number() {
        for n in [0usize, 1, 2, 7, 8, 63, 64, 65, 130] {
            let a: Vec<[f32; 3]> = (0..n).map(|i| [i as f32, 2.0 * i as f32, -(i as f32)]).collect();
            let b = [[10.0f32]];
            let (mut sum, mut last) = (vec![[0.0f32; 3]; n], vec![[0.0f32]; n]);
            let (x, y) = (&mut sum[..], &mut last[..]);
            dispatch!(s => {
                let (mut a, mut b) = (Source::over(&a[..], 0), Source::over(&b[..], 0));
                let (mut x, mut y) = (Sink::over(s, x), Sink::over(s, y));
                in_lanes!(s, n, |a, b| -> (x, y) { ([a[0] + b[0], a[1] + b[0], a[2] + b[0]], [a[2]]) });
            });
            for i in 0..n {
                let t = i as f32;
                assert_eq!((sum[i], last[i]), ([t + 10.0, 2.0 * t + 10.0, 10.0 - t], [-t]));
            }
        }
    }
}

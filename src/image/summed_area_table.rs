//! Sums over all rectangles at once: entry (i, j) is the sum of the picture's rows above i and columns left of j.
//!
//! The picture is read once and the table written once, in blocks of a few rows and columns: a block waits for what
//! lies left of it and above. Sums have one order, whatever the threads.
//!
//! F. Crow, *Summed-Area Tables for Texture Mapping*, SIGGRAPH 1984.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use std::cell::UnsafeCell;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Rows in a block.
const BAND: usize = 32;
/// Values of a row in a block.
const STRIP: usize = 512;

/// The table of a picture of `width` × `height` × `channels`: `(height + 1) × (width + 1) × channels` entries, the
/// first row and column zero. Sums run in `A` and are stored in `O`.
pub fn summed_area_table<T: Real, A: Real, O: Real>(
    watch: &mut dyn Watch,
    image: &[T],
    [width, height]: [usize; 2],
    channels: usize,
    table: &mut [O],
) -> Result<(), Interrupted> {
    let (row, entries) = (width * channels, (width + 1) * channels);
    assert!(image.len() == row * height && table.len() == entries * (height + 1), "sizes");
    if entries == 0 {
        return Ok(());
    }
    let (first, rest) = table.split_at_mut(entries);
    first.fill(O::zero());
    if row == 0 {
        rest.fill(O::zero());
        return Ok(());
    }
    let strip = (STRIP / channels).max(1) * channels;
    let strips = row.div_ceil(strip);
    let (mut above, mut left) = (vec![A::zero(); row], vec![A::zero(); height * channels]);
    let blocks = Blocks {
        image,
        row,
        channels,
        strip,
        table: Shared::of(rest),
        above: Shared::of(&mut above),
        left: Shared::of(&mut left),
    };
    let bands = height.div_ceil(BAND);
    // How many blocks of each band are done, from the left.
    let done: Vec<AtomicUsize> = (0..bands).map(|_| AtomicUsize::new(0)).collect();
    // By diagonals: what a block waits for has been claimed before it.
    let order = diagonals(bands, strips);
    parallel::run(watch, order.len(), |i| {
        let (band, strip) = order[i];
        while done[band].load(Ordering::Acquire) < strip
            || (band > 0 && done[band - 1].load(Ordering::Acquire) <= strip)
        {
            std::thread::yield_now();
        }
        // SAFETY: blocks left of and above this one are done, and what they wrote is seen; no other runs that shares a
        // column or a row with it.
        unsafe { blocks.fill(band, strip) };
        done[band].store(strip + 1, Ordering::Release);
    })
}

/// Blocks (band, strip) such that those left of and above one come before it.
fn diagonals(bands: usize, strips: usize) -> Vec<(usize, usize)> {
    let mut order = Vec::with_capacity(bands * strips);
    for sum in 0..bands + strips - 1 {
        for strip in sum.saturating_sub(bands - 1)..strips.min(sum + 1) {
            order.push((sum - strip, strip));
        }
    }
    order
}

/// Memory that blocks write into at places of their own.
struct Shared<'a, V>(&'a [UnsafeCell<V>]);

// SAFETY: `part` is where it is used, under its own promise.
unsafe impl<V: Send> Sync for Shared<'_, V> {}

impl<'a, V> Shared<'a, V> {
    fn of(values: &'a mut [V]) -> Self {
        // SAFETY: a cell has the layout of what it holds, and the exclusive borrow lasts as long.
        Shared(unsafe { &*(std::ptr::from_mut(values) as *const [UnsafeCell<V>]) })
    }

    /// # Safety
    /// Nobody else may use the part meanwhile.
    #[inline(always)]
    #[allow(clippy::mut_from_ref)]
    unsafe fn part(&self, from: usize, len: usize) -> &mut [V] {
        let cells = &self.0[from..from + len];
        // SAFETY: the caller's promise; cells lie as their values do.
        unsafe { std::slice::from_raw_parts_mut(UnsafeCell::raw_get(cells.as_ptr()), len) }
    }
}

struct Blocks<'a, T, A, O> {
    image: &'a [T],
    row: usize,
    channels: usize,
    strip: usize,
    table: Shared<'a, O>,
    /// The table's last row so far, without its first pixel.
    above: Shared<'a, A>,
    /// Sums along each row so far, of each channel.
    left: Shared<'a, A>,
}

impl<T: Real, A: Real, O: Real> Blocks<'_, T, A, O> {
    /// # Safety
    /// No other block that shares a row or a column may run meanwhile.
    unsafe fn fill(&self, band: usize, strip: usize) {
        dispatch!(_s => {
            // SAFETY: the caller's promise.
            unsafe {
                match self.channels {
                    1 => self.fill_of::<1, 4>(band, strip),
                    2 => self.fill_of::<2, 2>(band, strip),
                    3 => self.fill_of::<3, 1>(band, strip),
                    4 => self.fill_of::<4, 1>(band, strip),
                    _ => self.fill_any(band, strip),
                }
            }
        });
    }

    /// First value of the strip and their number; rows of the band.
    #[inline(always)]
    fn extent(&self, band: usize, strip: usize) -> (usize, usize, std::ops::Range<usize>) {
        let height = self.image.len() / self.row;
        let from = strip * self.strip;
        (from, self.strip.min(self.row - from), band * BAND..((band + 1) * BAND).min(height))
    }

    /// `C` channels, `R` rows at a time: their prefix sums do not wait for each other.
    ///
    /// # Safety
    /// As [`Blocks::fill`].
    #[inline(always)]
    unsafe fn fill_of<const C: usize, const R: usize>(&self, band: usize, strip: usize) {
        let (from, wide, rows) = self.extent(band, strip);
        let mut y = rows.start;
        while y + R <= rows.end {
            // SAFETY: the caller's promise.
            unsafe { self.some_rows::<C, R>(y, from, wide) };
            y += R;
        }
        while y < rows.end {
            // SAFETY: the caller's promise.
            unsafe { self.some_rows::<C, 1>(y, from, wide) };
            y += 1;
        }
    }

    /// # Safety
    /// As [`Blocks::fill`].
    #[inline(always)]
    unsafe fn some_rows<const C: usize, const R: usize>(&self, y: usize, from: usize, wide: usize) {
        let entries = self.row + C;
        let image = &self.image[y * self.row + from..(y + R - 1) * self.row + from + wide];
        // SAFETY: the caller's promise.
        let (above, sums) = unsafe { (self.above.part(from, wide), self.left.part(y * C, R * C)) };
        let mut left = [[A::zero(); C]; R];
        let mut table = [std::ptr::null_mut::<O>(); R];
        for r in 0..R {
            // SAFETY: the caller's promise: rows of this block alone, which do not overlap.
            table[r] = unsafe { self.table.part((y + r) * entries + C + from, wide) }.as_mut_ptr();
            if from == 0 {
                // SAFETY: as above; the first pixel belongs to the first strip.
                unsafe { self.table.part((y + r) * entries, C) }.fill(O::zero());
            }
            for c in 0..C {
                left[r][c] = sums[r * C + c];
            }
        }
        let mut x = 0;
        while x + C <= wide {
            for c in 0..C {
                // SAFETY: x + c < wide, the length of each row of the table and of `above`, and of the picture's last.
                unsafe {
                    let mut up = *above.get_unchecked(x + c);
                    for r in 0..R {
                        left[r][c] += cast::<T, A>(*image.get_unchecked(r * self.row + x + c));
                        up += left[r][c];
                        *table[r].add(x + c) = cast::<A, O>(up);
                    }
                    *above.get_unchecked_mut(x + c) = up;
                }
            }
            x += C;
        }
        for r in 0..R {
            for c in 0..C {
                sums[r * C + c] = left[r][c];
            }
        }
    }

    /// # Safety
    /// As [`Blocks::fill`].
    #[inline(always)]
    unsafe fn fill_any(&self, band: usize, strip: usize) {
        let (from, wide, rows) = self.extent(band, strip);
        let channels = self.channels;
        // SAFETY: the caller's promise.
        let above = unsafe { self.above.part(from, wide) };
        for y in rows {
            let image = &self.image[y * self.row + from..y * self.row + from + wide];
            let at = y * (self.row + channels);
            // SAFETY: the caller's promise; the first pixel belongs to the first strip.
            let (left, table) = unsafe {
                (self.left.part(y * channels, channels), self.table.part(at + channels + from, wide))
            };
            if from == 0 {
                // SAFETY: as above.
                unsafe { self.table.part(at, channels) }.fill(O::zero());
            }
            let mut c = 0;
            for x in 0..wide {
                left[c] += cast::<T, A>(image[x]);
                above[x] += left[c];
                table[x] = cast::<A, O>(above[x]);
                c = if c + 1 == channels { 0 } else { c + 1 };
            }
        }
    }
}

#[inline(always)]
fn cast<T: Real, A: Real>(x: T) -> A {
    A::of(x.to_f64())
}

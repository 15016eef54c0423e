//! Sums over all rectangles at once: entry (i, j) is the sum of the picture's rows above i and columns left of j.
//!
//! Bands of rows are summed down their columns first, which tells each band what lies above it; then every band is done
//! for itself, while it is still in the cache. Sums have one order, whatever the threads.
//!
//! F. Crow, *Summed-Area Tables for Texture Mapping*, SIGGRAPH 1984.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Rows, Watch};
use crate::real::Real;

/// Rows in a band.
const BAND: usize = 32;
/// Values in a slab of bands.
const SLAB: usize = 1 << 19;

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
    let mut carry = vec![A::zero(); row];
    let slab = (SLAB / row).next_multiple_of(BAND);
    let mut above = vec![A::zero(); row * (slab / BAND)];
    let rest = rest.chunks_mut(slab * entries);
    for (image, table) in image.chunks(slab * row).zip(rest) {
        slab_of::<T, A, O>(watch, image, &mut carry, &mut above, table, [row, channels])?;
    }
    Ok(())
}

/// Rows enough to share among threads, few enough to stay in the cache between the two passes. `carry` holds the sums
/// down each column so far.
fn slab_of<T: Real, A: Real, O: Real>(
    watch: &mut dyn Watch,
    image: &[T],
    carry: &mut [A],
    above: &mut [A],
    table: &mut [O],
    [row, channels]: [usize; 2],
) -> Result<(), Interrupted> {
    let (rows, entries) = (image.len() / row, row + channels);
    let above = &mut above[..rows.div_ceil(BAND) * row];
    above.fill(A::zero());
    parallel::for_each(watch, Rows { data: above, width: row }, 1, |band, sums| {
        let rows = band * BAND..((band + 1) * BAND).min(rows);
        dispatch!(_s => down(&image[rows.start * row..rows.end * row], sums.data));
    })?;
    for band in above.chunks_exact_mut(row) {
        for (c, b) in carry.iter_mut().zip(band) {
            let own = *b;
            *b = *c;
            *c += own;
        }
    }
    let above = Rows { data: above, width: row };
    let table = Bands { data: table, size: BAND * entries };
    parallel::for_each(watch, (above, table), 1, |band, (above, table)| {
        let rows = band * BAND..((band + 1) * BAND).min(rows);
        let (above, image) = (above.data, &image[rows.start * row..rows.end * row]);
        dispatch!(_s => match channels {
            1 => band_of::<T, A, O, 1, 4>(image, above, table.data, row),
            2 => band_of::<T, A, O, 2, 2>(image, above, table.data, row),
            3 => band_of::<T, A, O, 3, 1>(image, above, table.data, row),
            4 => band_of::<T, A, O, 4, 1>(image, above, table.data, row),
            _ => any_channels(image, above, table.data, row, channels),
        });
    })
}

/// Pieces of one size, the last one perhaps shorter.
struct Bands<'a, O> {
    data: &'a mut [O],
    size: usize,
}

impl<O: Send> parallel::Pieces for Bands<'_, O> {
    fn items(&self) -> usize {
        self.data.len().div_ceil(self.size)
    }
    fn cut(self, at: usize) -> (Self, Self) {
        let (a, b) = self.data.split_at_mut((at * self.size).min(self.data.len()));
        (Bands { data: a, size: self.size }, Bands { data: b, size: self.size })
    }
}

/// Adds up the rows of a band.
#[inline(always)]
fn down<T: Real, A: Real>(image: &[T], sums: &mut [A]) {
    let n = sums.len();
    let mut at = 0;
    while at < image.len() {
        let row = &image[at..at + n];
        for i in 0..n {
            sums[i] += cast::<T, A>(row[i]);
        }
        at += n;
    }
}

#[inline(always)]
fn cast<T: Real, A: Real>(x: T) -> A {
    A::of(x.to_f64())
}

/// A band of `C` channels, `R` rows at a time: their prefix sums do not wait for each other. `above` holds the sums
/// down each column before the band, and then the table's last row.
#[inline(always)]
fn band_of<T: Real, A: Real, O: Real, const C: usize, const R: usize>(
    image: &[T],
    above: &mut [A],
    table: &mut [O],
    row: usize,
) {
    along::<A, C>(above);
    let (rows, entries) = (image.len() / row, row + C);
    let mut y = 0;
    while y + R <= rows {
        some_rows::<T, A, O, C, R>(&image[y * row..], above, &mut table[y * entries..], row);
        y += R;
    }
    while y < rows {
        some_rows::<T, A, O, C, 1>(&image[y * row..], above, &mut table[y * entries..], row);
        y += 1;
    }
}

/// Prefix sums of the one row that is above.
#[inline(always)]
fn along<A: Real, const C: usize>(row: &mut [A]) {
    for i in C..row.len() {
        row[i] = row[i - C] + row[i];
    }
}

#[inline(always)]
fn some_rows<T: Real, A: Real, O: Real, const C: usize, const R: usize>(
    image: &[T],
    above: &mut [A],
    table: &mut [O],
    row: usize,
) {
    let entries = row + C;
    assert!(image.len() >= R * row && table.len() >= R * entries && above.len() >= row, "sizes");
    for r in 0..R {
        for c in 0..C {
            table[r * entries + c] = O::zero();
        }
    }
    let mut left = [[A::zero(); C]; R];
    let mut x = 0;
    while x + C <= row {
        for c in 0..C {
            // SAFETY: x + c < row; the lengths of all three were checked above.
            unsafe {
                let mut up = *above.get_unchecked(x + c);
                for r in 0..R {
                    left[r][c] += cast::<T, A>(*image.get_unchecked(r * row + x + c));
                    up += left[r][c];
                    *table.get_unchecked_mut(r * entries + C + x + c) = cast::<A, O>(up);
                }
                *above.get_unchecked_mut(x + c) = up;
            }
        }
        x += C;
    }
}

#[inline(always)]
fn any_channels<T: Real, A: Real, O: Real>(
    image: &[T],
    above: &mut [A],
    table: &mut [O],
    row: usize,
    channels: usize,
) {
    for i in channels..row {
        above[i] = above[i - channels] + above[i];
    }
    let mut left = vec![A::zero(); channels];
    for y in 0..image.len() / row {
        let (image, table) = (&image[y * row..(y + 1) * row], &mut table[y * (row + channels)..]);
        left.fill(A::zero());
        table[..channels].fill(O::zero());
        let mut c = 0;
        for x in 0..row {
            left[c] += cast::<T, A>(image[x]);
            above[x] += left[c];
            table[channels + x] = cast::<A, O>(above[x]);
            c = if c + 1 == channels { 0 } else { c + 1 };
        }
    }
}

//! The power of a point set's frequencies on the torus: |Σ exp(-2πi k·x)|² / n, one for each on average of random points.
//!
//! R. A. Ulichney, *Dithering with blue noise*, 1988 (radial averages). D. Heck, T. Schlömer, O. Deussen, *Blue noise
//! sampling with controlled aliasing*, 2013.

use crate::dispatch;
use crate::math::sin_cos;
use crate::parallel::{self, Interrupted, Rows, Watch};

/// Frequencies from -`reach` to `reach` along both axes, the second axis by rows: (2 reach + 1)² numbers.
pub fn power_spectrum(
    watch: &mut dyn Watch,
    points: &[[f64; 2]],
    reach: usize,
    out: &mut [f64],
) -> Result<(), Interrupted> {
    let width = 2 * reach + 1;
    // Opposite frequencies have equal power: rows from -reach to 0 are computed, the others mirrored.
    let (half, mirror) = out.split_at_mut((reach + 1) * width);
    parallel::for_each(watch, Rows { data: &mut half[..], width }, 1, |first, rows| {
        for (row, out) in rows.data.chunks_exact_mut(width).enumerate() {
            dispatch!(_s => body(points, reach, (first + row) as f64 - reach as f64, out));
        }
    })?;
    for (row, out) in mirror.chunks_exact_mut(width).enumerate() {
        for (k, x) in out.iter_mut().enumerate() {
            *x = half[(reach - 1 - row) * width + width - 1 - k];
        }
    }
    Ok(())
}

const LANES: usize = 8;

#[inline(always)]
fn body(points: &[[f64; 2]], reach: usize, ky: f64, out: &mut [f64]) {
    let mut sums = vec![[0.0f64; 2]; out.len()];
    for points in points.chunks(LANES) {
        let count = points.len();
        let (mut re, mut im) = ([0.0; LANES], [0.0; LANES]);
        let (mut step_re, mut step_im) = ([0.0; LANES], [0.0; LANES]);
        for j in 0..count {
            let p = points[j];
            (im[j], re[j]) = wave(ky * p[1] - reach as f64 * p[0]);
            (step_im[j], step_re[j]) = wave(p[0]);
        }
        for j in count..LANES {
            (re[j], im[j]) = (0.0, 0.0);
        }
        // Each wave is the last one turned by the point's own angle.
        for k in 0..sums.len() {
            let (mut a, mut b) = (0.0, 0.0);
            for j in 0..LANES {
                (a, b) = (a + re[j], b + im[j]);
            }
            sums[k] = [sums[k][0] + a, sums[k][1] + b];
            for j in 0..LANES {
                let next = re[j] * step_re[j] - im[j] * step_im[j];
                im[j] = re[j] * step_im[j] + im[j] * step_re[j];
                re[j] = next;
            }
        }
    }
    let scale = 1.0 / points.len().max(1) as f64;
    for (out, sum) in out.iter_mut().zip(&sums) {
        *out = (sum[0] * sum[0] + sum[1] * sum[1]) * scale;
    }
}

/// sin and cos of -2π x, reduced to half a turn first.
#[inline(always)]
fn wave(x: f64) -> (f64, f64) {
    let x = x - (x + 0.5).floor();
    sin_cos(-2.0 * std::f64::consts::PI * x)
}

//! What points span as a light sees them: the bounds that a map's window is fitted to. In double, whatever the points.

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::{Lanes, Real};
use std::sync::{Mutex, PoisonError};

/// Where a light stands and looks: unit vectors in rows, the last one along its axis.
#[derive(Clone, Copy, Debug)]
pub struct Eye {
    pub origin: [f64; 3],
    pub frame: [[f64; 3]; 3],
    /// Points are seen divided by their depth, and only from this depth on.
    pub perspective: Option<f64>,
}

/// Least and greatest of the two window coordinates and of the depth; least above greatest where nothing is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Span {
    const EMPTY: Span = Span { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    #[inline(always)]
    fn grow(&mut self, low: [f64; 3], high: [f64; 3]) {
        for k in 0..3 {
            // The stored value second: a NaN loses.
            self.low[k] = Lanes::min(low[k], self.low[k]);
            self.high[k] = Lanes::max(high[k], self.high[k]);
        }
    }
}

/// The span of all points that the eye sees. Points with NaN count for nothing.
pub fn span<T: Real>(watch: &mut dyn Watch, points: &[[T; 3]], eye: &Eye) -> Result<Span, Interrupted> {
    let whole = Mutex::new(Span::EMPTY);
    parallel::for_each(watch, points, 1 << 14, |_, points| {
        let part = dispatch!(_s => body(points, eye));
        // Least and greatest do not depend on the order of the parts.
        whole.lock().unwrap_or_else(PoisonError::into_inner).grow(part.low, part.high);
    })?;
    Ok(whole.into_inner().unwrap_or_else(PoisonError::into_inner))
}

#[inline(always)]
fn body<T: Real>(points: &[[T; 3]], eye: &Eye) -> Span {
    let mut span = Span::EMPTY;
    for p in points {
        let d = [p[0].to_f64() - eye.origin[0], p[1].to_f64() - eye.origin[1], p[2].to_f64() - eye.origin[2]];
        let mut seen = [0.0; 3];
        for k in 0..3 {
            let f = eye.frame[k];
            seen[k] = f[0] * d[0] + f[1] * d[1] + f[2] * d[2];
        }
        if let Some(near) = eye.perspective {
            if !(seen[2] >= near) {
                continue;
            }
            seen = [seen[0] / seen[2], seen[1] / seen[2], seen[2]];
        }
        span.grow(seen, seen);
    }
    span
}

//! Metropolis' walk over a picture: points of the unit square in proportion to the pixels' weights, from ratios of these
//! alone. Steps are symmetric on the torus, Gaussian of a given width, or, now and then, a leap to anywhere.
//!
//! Accepting by min(1, π(y) / π(x)) leaves π as it is; so does accepting by π(y) over its largest value, the plain rule,
//! which only rests more.
//!
//! N. Metropolis and others, *Equation of state calculations by fast computing machines*, 1953; W. K. Hastings, *Monte
//! Carlo sampling methods using Markov chains and their applications*, 1970; C. Kelemen, L. Szirmay-Kalos and others, *A
//! simple and robust mutation strategy for the Metropolis light transport algorithm*, 2002 (leaps).

use super::generator::Generator;
use crate::math;
use crate::parallel::{self, Interrupted, Rows, Watch};
use crate::real::Real;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acceptance {
    Hastings,
    Plain,
}

#[derive(Clone, Copy, Debug)]
pub struct Walk {
    /// The standard deviation of a small step, and how often a leap is made instead.
    pub scale: f64,
    pub leap: f64,
    pub acceptance: Acceptance,
}

/// How chains are recorded: every `thin`-th of the states after the first `burn_in`.
#[derive(Clone, Copy, Debug)]
pub struct Record {
    pub seed: u64,
    pub burn_in: usize,
    pub thin: usize,
}

/// A picture of weights, row by row.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a, T> {
    pub weights: &'a [T],
    pub width: usize,
}

impl<T: Real> Picture<'_, T> {
    #[inline(always)]
    pub fn at(&self, [x, y]: [T; 2]) -> T {
        let (w, h) = (self.width, self.weights.len() / self.width);
        let cell = |x: T, n: usize| ((x.to_f64() * n as f64) as usize).min(n - 1);
        self.weights[cell(y, h) * w + cell(x, w)]
    }
}

/// Steps between looks at the watch, so that one takes milliseconds.
const STRIDE: usize = 1 << 15;

/// Runs chains from their `state`: `step(chain, number, state)` makes one step and says whether it moved; `samples` holds
/// as many states a chain as are kept, and `moved` counts the steps after the burn-in that moved.
pub(super) fn run<T: Real>(
    watch: &mut dyn Watch,
    record: Record,
    state: &mut [[T; 2]],
    samples: &mut [[T; 2]],
    moved: &mut [u64],
    step: impl Fn(usize, usize, &mut [T; 2]) -> bool + Sync,
) -> Result<(), Interrupted> {
    let kept = samples.len().checked_div(state.len()).unwrap_or(0);
    let steps = record.burn_in + kept * record.thin;
    for from in (0..steps).step_by(STRIDE) {
        let rows = Rows { data: &mut *samples, width: kept };
        parallel::for_each(watch, (&mut *state, rows, &mut *moved), 1, |chain, (state, rows, moved)| {
            for number in from..steps.min(from + STRIDE) {
                let went = step(chain, number, &mut state[0]);
                if number >= record.burn_in {
                    let after = number - record.burn_in + 1;
                    moved[0] += u64::from(went);
                    if after.is_multiple_of(record.thin) {
                        rows.data[after / record.thin - 1] = state[0];
                    }
                }
            }
        })?;
    }
    Ok(())
}

pub fn metropolis_hastings<T: Real>(
    watch: &mut dyn Watch,
    picture: Picture<'_, T>,
    walk: Walk,
    record: Record,
    state: &mut [[T; 2]],
    samples: &mut [[T; 2]],
    moved: &mut [u64],
) -> Result<(), Interrupted> {
    let generator = Generator::new(record.seed);
    let largest = picture.weights.iter().fold(T::zero(), |a, &b| if b > a { b } else { a });
    run(watch, record, state, samples, moved, |chain, number, state| {
        let [choice, a, b, accept] =
            generator.quad::<f64>(chain as u64, number as u32, (number >> 32) as u32);
        let to = if choice < walk.leap { [T::of(a), T::of(b)] } else { small_step(*state, walk.scale, a, b) };
        let (here, there) = (picture.at(*state), picture.at(to));
        let bound = if walk.acceptance == Acceptance::Plain { largest } else { here };
        // From where the target is zero any step is welcome.
        let accepted = T::of(accept) * bound < there || (here == T::zero() && there == T::zero());
        if accepted {
            *state = to;
        }
        accepted
    })
}

/// A Gaussian step, wrapped around the square's ends.
fn small_step<T: Real>([x, y]: [T; 2], scale: f64, a: f64, b: f64) -> [T; 2] {
    let r = scale * (-2.0 * math::ln(1.0 - a)).sqrt();
    let (sin, cos) = math::sin_cos(2.0 * std::f64::consts::PI * b);
    [x.to_f64() + r * cos, y.to_f64() + r * sin].map(|x| {
        let wrapped = T::of(x - x.floor());
        if wrapped < T::one() { wrapped } else { T::zero() }
    })
}

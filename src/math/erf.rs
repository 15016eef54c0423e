//! The bell e^(−x²) and the area under it.

use super::{either, exp, minimax, poly};
use crate::real::{Lanes, Real};

/// 1 + erf x, also where that is small, and e^(−x²): within 4 + x² units of round-off of themselves.
#[inline(always)]
pub fn bell<V: Lanes>(x: V) -> (V, V) {
    let (two, most) = (x.num(2.0), x.num(12.0));
    let height = exp(-(x * x));
    let y = x.abs();
    // NaN stays in the height.
    let near = V::select(y.less(most), y, most);
    let s = two / (two + near);
    let w = (s * x.num(7.0) - x.num(4.0)) / x.num(3.0);
    let rest = height * (s * poly(w, minimax::ERFC));
    (V::select(x.less(x.num(0.0)), rest, two - rest), height)
}

/// The x below `end` at which a (1 + erf x) + b e^(−x²) / √π is the share `u` in [0, 1) of `total`, which it is at `end`.
/// `a` and `b` are not negative, and a = b `end`: up to there the sum rises. The sum there is u of the total within some
/// units of round-off.
///
/// Newton's steps from a first guess, four in the mean: by the larger term alone, or by the parabola at the end. Lanes
/// that have arrived stay, so that none depends on its neighbours.
#[inline(always)]
pub fn inverse_bell<V: Lanes>(a: V, b: V, end: V, total: V, u: V) -> V {
    let share = u * total;
    let (zero, one, half) = (share.num(0.0), share.num(1.0), share.num(0.5));
    let root_pi = share.num(1.772_453_850_905_516);
    let tiny = either(share, 1e-36, 1e-300);
    // 1 + erf x = m.
    let m = (share / a).min(share.num(2.0) - share.like(<V::Elem as Real>::EPSILON)).max(tiny);
    let first = (m - one) * centre(-super::ln(m * (share.num(2.0) - m)));
    // e^(−x²) = m, x below zero.
    let m = (share * root_pi / b).max(tiny);
    let small = m.less(one);
    let mut second = end;
    if V::bits(small) != 0 {
        second = V::select(small, -(-super::ln(m.min(one))).sqrt(), end);
    }
    let parabola = (total - share) * root_pi / (b * exp(-(end * end)) + tiny);
    let before = end - parabola.max(zero).sqrt().min(half);
    // Beyond lies less than rounding of the share: 1e-17, 1e-142. Densities there are numbers, and so is one over two.
    let low = either(share, -6.0, -18.0);
    let mut x = first.min(second).min(before).max(low);
    // Steps so short leave their square.
    let near = either(share, 2e-4, 1e-7);
    let mut there = x.less(low);
    for _ in 0..STEPS {
        let (area, height) = bell(x);
        let value = a * area + b * height / root_pi - share;
        let slope = height * (a - b * x) * (share.num(2.0) / root_pi);
        let step = V::select(zero.less(slope), value / slope, zero).max(-one).min(one);
        x = V::select(there, x, (x - step).max(low).min(end));
        there = there | step.abs().less(near);
        if V::bits(!there) == 0 {
            break;
        }
    }
    x
}

/// erf⁻¹(z) / z of w = −ln(1 − z²), within 4e-7 where z is known to single precision: M. Giles, *Approximating the erfinv
/// function*, GPU Computing Gems 2, 2011, its table.
#[inline(always)]
fn centre<V: Lanes>(w: V) -> V {
    let wide = w.num(5.0).less_eq(w);
    let middle = polynomial(w - w.num(2.5), &MIDDLE);
    if V::bits(wide) == 0 {
        return middle;
    }
    V::select(wide, polynomial(w.max(w.num(0.0)).sqrt() - w.num(3.0), &TAIL), middle)
}

#[inline(always)]
fn polynomial<V: Lanes>(x: V, c: &[f64; 9]) -> V {
    let mut sum = x.num(c[0]);
    for k in 1..9 {
        sum = sum * x + x.num(c[k]);
    }
    sum
}

const MIDDLE: [f64; 9] = [
    2.81022636e-8,
    3.43273939e-7,
    -3.5233877e-6,
    -4.39150654e-6,
    2.1858087e-4,
    -1.25372503e-3,
    -4.17768164e-3,
    0.246640727,
    1.50140941,
];
const TAIL: [f64; 9] = [
    -2.00214257e-4,
    1.00950558e-4,
    1.34934322e-3,
    -3.67342844e-3,
    5.73950773e-3,
    -7.6224613e-3,
    9.43887047e-3,
    1.00167406,
    2.83297682,
];

/// Steps at most: the last share or first, of which rounding leaves little, would take more.
const STEPS: usize = 24;

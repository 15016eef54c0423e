//! A ray against an algebraic surface `f(x, y, z) = 0`, f a polynomial: along the ray f is a polynomial of one variable,
//! whose real roots are all found. Between neighbouring roots of its derivative a polynomial is monotone, so each
//! derivative's roots bracket those of the one before; brackets shrink by Newton's step where that stays inside, else by
//! halves. Roots beyond the unit interval come as inverses of roots of the reversed polynomial.
//!
//! The variable starts at the line's point nearest to the origin, so that distant rays lose no digits. All is computed in
//! double precision.
//!
//! Compare G. Collins, R. Loos, *Polynomial Real Root Isolation by Differentiation*, SYMSAC 1976; P. Hanrahan, *Ray
//! Tracing Algebraic Surfaces*, SIGGRAPH 1983.

use crate::math::exact::two_sum;
use crate::vec::Vec3;

/// The highest degree.
pub const DEGREE: usize = 24;
type Coefficients = [f64; DEGREE + 1];

/// A polynomial in three variables: `c[(i m + j) n + k]` belongs to `x^i y^j z^k`.
#[derive(Clone, Copy)]
pub struct Surface<'a> {
    coefficients: &'a [f64],
    shape: [usize; 3],
    degree: usize,
}

/// `c[0] + c[1] t + …` with its slope, and the sum of the magnitudes of its terms.
#[inline(always)]
fn evaluate(c: &[f64], t: f64) -> (f64, f64, f64) {
    let (mut value, mut slope, mut size) = (0.0, 0.0, 0.0);
    for &c in c.iter().rev() {
        slope = slope * t + value;
        value = value * t + c;
        size = size * t.abs() + c.abs();
    }
    (value, slope, size)
}

/// The root of a monotone polynomial between `a` and `b`, at which it has values of opposite signs.
fn root_between(c: &[f64], mut a: f64, mut b: f64, rising: bool) -> f64 {
    let mut t = 0.5 * (a + b);
    for _ in 0..200 {
        let (value, slope, _) = evaluate(c, t);
        if value == 0.0 {
            return t;
        }
        if (value > 0.0) == rising {
            b = t
        } else {
            a = t
        }
        let step = t - value / slope;
        let next = if step > a && step < b { step } else { 0.5 * (a + b) };
        // Newton creeps up from one side: a bracket hardly shrunk is of no account once the step is below rounding.
        if (next - t).abs() <= f64::EPSILON * t.abs() || next <= a || next >= b {
            return next;
        }
        t = next;
    }
    t
}

/// All roots in `[a, b]`, ascending, into `roots`; their number. Where the polynomial touches zero within the rounding of
/// its terms, that is a root.
fn roots_within(c: &[f64], a: f64, b: f64, roots: &mut Coefficients) -> usize {
    let degree = c.len() - 1;
    let (mut found, mut count) = ([0.0; DEGREE + 1], 0);
    for order in (0..degree).rev() {
        let mut derivative = [0.0; DEGREE + 1];
        for i in order..=degree {
            // i! / (i - order)!, over order! so that it stays small: binomials.
            let mut factor = 1.0;
            for k in 0..order {
                factor = factor * (i - k) as f64 / (k + 1) as f64;
            }
            derivative[i - order] = factor * c[i];
        }
        let p = &derivative[..=degree - order];
        let (marks, n) = (found, count);
        count = 0;
        let (mut from, mut before) = (a, evaluate(p, a).0);
        if before == 0.0 {
            (found[0], count) = (a, 1);
        }
        for i in 0..=n {
            let to = if i < n { marks[i] } else { b };
            let (mut value, _, size) = evaluate(p, to);
            if value.abs() <= 4.0 * f64::EPSILON * size {
                value = 0.0;
            }
            let root = if value == 0.0 {
                Some(to)
            } else if value * before < 0.0 {
                Some(root_between(p, from, to, value > 0.0))
            } else {
                None
            };
            if let Some(root) = root
                && count <= DEGREE
                && (count == 0 || root > found[count - 1])
            {
                (found[count], count) = (root, count + 1);
            }
            (from, before) = (to, value);
        }
    }
    roots[..count].copy_from_slice(&found[..count]);
    count
}

impl<'a> Surface<'a> {
    /// None if the degree is too high, or there is nothing but a constant.
    pub fn new(coefficients: &'a [f64], shape: [usize; 3]) -> Option<Self> {
        let mut degree = 0;
        for (at, &c) in coefficients.iter().enumerate() {
            let (i, j, k) = (at / (shape[1] * shape[2]), at / shape[2] % shape[1], at % shape[2]);
            if c != 0.0 {
                degree = degree.max(i + j + k);
            }
        }
        let fits = coefficients.len() == shape[0] * shape[1] * shape[2];
        (fits && degree > 0 && degree <= DEGREE).then_some(Self { coefficients, shape, degree })
    }
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The polynomial along `q + t d`.
    fn along(&self, q: Vec3<f64>, d: Vec3<f64>) -> Coefficients {
        let (l, m, n) = (self.shape[0], self.shape[1], self.shape[2]);
        let mut whole = [0.0; DEGREE + 1];
        for i in (0..l).rev() {
            let mut plane = [0.0; DEGREE + 1];
            for j in (0..m).rev() {
                let mut line = [0.0; DEGREE + 1];
                for k in (0..n).rev() {
                    line = self.times(line, q.z, d.z);
                    line[0] += self.coefficients[(i * m + j) * n + k];
                }
                plane = self.times(plane, q.y, d.y);
                (0..=self.degree).for_each(|e| plane[e] += line[e]);
            }
            whole = self.times(whole, q.x, d.x);
            (0..=self.degree).for_each(|e| whole[e] += plane[e]);
        }
        whole
    }
    /// Times `a + b t`; terms beyond the degree are zero.
    #[inline(always)]
    fn times(&self, p: Coefficients, a: f64, b: f64) -> Coefficients {
        let mut product = [0.0; DEGREE + 1];
        product[0] = p[0] * a;
        for e in 1..=self.degree {
            product[e] = p[e] * a + p[e - 1] * b;
        }
        product
    }

    /// All parameters at which a line meets the surface, ascending, into `roots`; their number. A line within the surface
    /// meets it nowhere.
    pub fn meet(&self, origin: Vec3<f64>, direction: Vec3<f64>, roots: &mut Coefficients) -> usize {
        let (d, length) = (direction.normalize(), direction.normalize().dot(direction));
        let nearest = -origin.dot(d);
        let q = origin.zip(d, |o, d| {
            let (sum, lost) = two_sum(o, nearest * d);
            sum + lost
        });
        let c = self.along(q, d);
        let c = &c[..=self.degree];
        let largest = c.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
        if !(largest > 0.0 && largest.is_finite()) {
            return 0;
        }
        let mut reversed = [0.0; DEGREE + 1];
        (0..=self.degree).for_each(|e| reversed[e] = c[self.degree - e]);
        let reversed = &reversed[..=self.degree];

        let (mut count, mut part) = (0, [0.0; DEGREE + 1]);
        let mut take = |t: f64| {
            let t = (nearest + t) / length;
            if count <= DEGREE && t.is_finite() && (count == 0 || t > roots[count - 1]) {
                (roots[count], count) = (t, count + 1);
            }
        };
        // Before -1, where inverses descend as the parameter ascends.
        let n = roots_within(reversed, -1.0, 0.0, &mut part);
        part[..n].iter().rev().filter(|&&s| s != 0.0).for_each(|s| take(1.0 / s));
        let n = roots_within(c, -1.0, 1.0, &mut part);
        part[..n].iter().for_each(|&t| take(t));
        let n = roots_within(reversed, 0.0, 1.0, &mut part);
        part[..n].iter().rev().filter(|&&s| s != 0.0).for_each(|s| take(1.0 / s));
        count
    }

    /// The value and the gradient at a point.
    pub fn gradient(&self, p: Vec3<f64>) -> (f64, Vec3<f64>) {
        let along = |d: Vec3<f64>| {
            let c = self.along(p, d);
            (c[0], c[1])
        };
        let (value, x) = along(Vec3::new(1.0, 0.0, 0.0));
        let (_, y) = along(Vec3::new(0.0, 1.0, 0.0));
        let (_, z) = along(Vec3::new(0.0, 0.0, 1.0));
        (value, Vec3::new(x, y, z))
    }
}

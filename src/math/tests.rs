//! f32 against std's double precision, f64 against std (itself within an ulp), lanes against the scalar, and C99's
//! special cases. `cargo test --release -- --ignored math` goes through every float.

use super::*;
use crate::dispatch;
use crate::real::Real;
use crate::simd::{self, SimdBase};
use std::f64::consts::PI;

/// Distance in units of the last place of `exact` in single precision, subnormal results included.
fn ulps32(got: f32, exact: f64) -> f64 {
    let e = exact as f32;
    if got.is_nan() || exact.is_nan() || e.is_infinite() || got.is_infinite() {
        let same = got.is_nan() && exact.is_nan()
            || got == e
            || (got.is_infinite() && exact.abs() >= f32::MAX as f64);
        return if same { 0.0 } else { f64::INFINITY };
    }
    let place = (e.abs().next_up() as f64 - e.abs() as f64).abs();
    (got as f64 - exact).abs() / place
}

fn ulps64(got: f64, expected: f64) -> f64 {
    if got == expected || got.is_nan() && expected.is_nan() {
        return 0.0;
    }
    (got - expected).abs() / (expected.abs().next_up() - expected.abs())
}

/// A seeded generator, enough for arguments.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e3779b97f4a7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58476d1ce4e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d049bb133111eb);
        z ^ (z >> 31)
    }
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
}

type Case = (&'static str, fn(f32) -> f32, fn(f64) -> f64, fn(f64) -> f64, f64, f64);

/// Name, f32, f64, oracle in f64, domain.
const UNARY: [Case; 7] = [
    ("sin", sin::<f32>, sin::<f64>, f64::sin, -1e5, 1e5),
    ("cos", cos::<f32>, cos::<f64>, f64::cos, -1e5, 1e5),
    ("tan", tan::<f32>, tan::<f64>, f64::tan, -1e5, 1e5),
    ("asin", asin::<f32>, asin::<f64>, f64::asin, -1.0, 1.0),
    ("acos", acos::<f32>, acos::<f64>, f64::acos, -1.0, 1.0),
    ("exp", exp::<f32>, exp::<f64>, f64::exp, -110.0, 95.0),
    ("ln", ln::<f32>, ln::<f64>, f64::ln, 0.0, 3e38),
];

/// What the module's table states for f32.
fn claim32(name: &str) -> f64 {
    match name {
        "sin" | "cos" => 1.57,
        "tan" => 3.28,
        "asin" => 1.70,
        "acos" => 1.20,
        "exp" => 0.78,
        _ => 0.84,
    }
}

#[test]
fn single_precision_keeps_its_ulps() {
    let mut random = Random(1);
    for (name, f, _, oracle, low, high) in UNARY {
        for _ in 0..200_000 {
            let x = random.between(low, high) as f32;
            let u = ulps32(f(x), oracle(x as f64));
            assert!(u <= claim32(name), "{name}({x:e}): {u} ulps");
            // Small arguments too, in every binade.
            let x = x / (1u64 << (random.bits() % 60)) as f32;
            let u = ulps32(f(x), oracle(x as f64));
            assert!(u <= claim32(name), "{name}({x:e}): {u} ulps");
        }
    }
}

#[test]
#[ignore = "half an hour on one core: every float"]
fn single_precision_keeps_its_ulps_on_every_float() {
    for (name, f, _, oracle, low, high) in UNARY {
        let mut worst = (0.0, 0.0);
        for bits in 0..=u32::MAX {
            let x = f32::from_bits(bits);
            if x as f64 >= low && x as f64 <= high {
                let u = ulps32(f(x), oracle(x as f64));
                if u > worst.0 {
                    worst = (u, x);
                }
            }
        }
        println!("{name}: {:.4} ulps at {:e}", worst.0, worst.1);
        assert!(worst.0 <= claim32(name), "{name}({:e}): {} ulps", worst.1, worst.0);
    }
}

#[test]
fn double_precision_agrees_with_std() {
    let mut random = Random(2);
    for (name, _, f, oracle, low, high) in UNARY {
        for _ in 0..200_000 {
            let x = random.between(low, high) / (1u64 << (random.bits() % 40)) as f64;
            // Our own two ulps (three of tan), and at most one of std.
            let u = ulps64(f(x), oracle(x));
            assert!(u <= if name == "tan" { 4.0 } else { 3.0 }, "{name}({x:e}): {u} ulps");
        }
    }
}

/// Sine and cosine of turns in double precision, and what their rounding lost.
fn of_turns(x: f64) -> [f64; 2] {
    let n = (4.0 * x).round();
    let r = x - n / 4.0;
    let angle = r * (2.0 * PI);
    // What the product lost, and what π did: 2π is 2.4e-16 longer than its double.
    let lost = r.mul_add(2.0 * PI, -angle) + r * 2.4492935982947064e-16;
    let (s, c) = (angle.sin(), angle.cos());
    let (s, c) = (s + c * lost, c - s * lost);
    [[s, c], [c, -s], [-s, -c], [-c, s]][n.rem_euclid(4.0) as usize]
}

#[test]
fn turns_keep_their_ulps_and_quarters_are_exact() {
    let (mut random, mut worst) = (Random(5), [0f64; 2]);
    for _ in 0..1_000_000 {
        let x = random.between(-1.0, 1.0) / (1u64 << (random.bits() % 8)) as f64;
        let x = if random.bits() % 3 == 0 { x * 1e5 } else { x };
        let (single, exact) = (sin_cos_turns(x as f32), of_turns(f64::from(x as f32)));
        worst[0] = worst[0].max(ulps32(single.0, exact[0])).max(ulps32(single.1, exact[1]));
        let (double, exact) = (sin_cos_turns(x), of_turns(x));
        worst[1] = worst[1].max(ulps64(double.0, exact[0])).max(ulps64(double.1, exact[1]));
    }
    assert!(worst[0] <= 2.0 && worst[1] <= 3.0, "{worst:?}");
    for n in -8..=8 {
        let (s, c) = sin_cos_turns(f64::from(n) / 4.0);
        assert_eq!([s, c], [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]][(n + 8) as usize % 4]);
    }
    assert!(sin_cos_turns(-0.0f32).0.is_sign_negative());
}

#[test]
fn the_octant_is_that_of_the_circle() {
    let mut random = Random(6);
    for _ in 0..100_000 {
        let x = random.between(-PI / 4.0, PI / 4.0);
        assert_eq!(sin_cos_octant(x), sin_cos(x));
        let x = (0.999 * x) as f32;
        assert_eq!(sin_cos_octant(x), sin_cos(x));
    }
}

#[test]
fn pow_and_atan2_keep_their_ulps() {
    let mut random = Random(3);
    for _ in 0..1_000_000 {
        let x = f32::from_bits(random.bits() as u32 & 0x7fff_ffff);
        let y = (random.between(-160.0, 160.0) / (x as f64).log2()) as f32;
        let u = ulps32(pow(x, y), (x as f64).powf(y as f64));
        assert!(u <= 1.0, "pow({x:e}, {y:e}): {u} ulps");
        let (a, b) = (f32::from_bits(random.bits() as u32), f32::from_bits(random.bits() as u32));
        let u = ulps32(atan2(a, b), (a as f64).atan2(b as f64));
        assert!(u <= 2.0, "atan2({a:e}, {b:e}): {u} ulps");
        let (a, b) = (random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        assert!(ulps64(atan2(a, b), a.atan2(b)) <= 3.0, "atan2({a:e}, {b:e})");
        let (x, y) = (random.between(0.0, 10.0), random.between(-300.0, 300.0));
        assert!(ulps64(pow(x, y), x.powf(y)) <= 3.0, "pow({x:e}, {y:e})");
    }
}

#[test]
fn angle_is_atan2_of_the_upper_half_plane() {
    let mut random = Random(4);
    for _ in 0..500_000 {
        let scale = 2f64.powi((random.bits() % 120) as i32 - 60);
        let (y, x) = (random.between(0.0, scale), random.between(-1.0, 1.0) * random.between(0.0, scale));
        // Our own two ulps, and at most one of std.
        let u = ulps64(angle(y, x), y.atan2(x));
        assert!(u <= 3.0, "angle({y:e}, {x:e}): {u} ulps");
        let (y, x) = (y as f32, x as f32);
        let u = ulps32(angle(y, x), (y as f64).atan2(x as f64));
        assert!(u <= 2.0, "angle({y:e}, {x:e}): {u} ulps");
    }
    assert_eq!(
        [angle(0.0, 1.0), angle(0.0, -1.0), angle(2.0, 0.0), angle(2.0, -0.0)],
        [0.0, PI, PI / 2.0, PI / 2.0]
    );
    assert!(angle(0.0f64, 0.0).is_nan() && angle(f64::NAN, 1.0).is_nan() && angle(1.0, f64::NAN).is_nan());
}

#[test]
fn bells_are_the_integrals_of_their_height() {
    // 1 + erf x by mpmath, 40 digits.
    let known = [
        (-5.0, 1.5374597944280349e-12),
        (-2.0, 0.0046777349810472658),
        (-0.5, 0.47950012218695346),
        (0.0, 1.0),
        (0.75, 1.7111556336535151),
        (3.0, 1.9999779095030014),
    ];
    for (x, area) in known {
        let (got, height) = bell(x);
        assert!(ulps64(got, area) <= 4.0 + x * x && ulps64(height, f64::exp(-x * x)) <= 2.0, "bell({x})");
        let got = bell(x as f32).0;
        assert!(ulps32(got, area) <= 4.0 + x * x, "bell({x}) in single: {got:e}");
    }
    assert_eq!((bell(f64::INFINITY), bell(f64::NEG_INFINITY)), ((2.0, 0.0), (0.0, 0.0)));
    assert!(bell(f64::NAN).0.is_nan());
}

#[test]
fn bells_are_turned_round() {
    let mut random = Random(5);
    for _ in 0..20_000 {
        let end = 10f64.powf(random.between(-6.0, 9.0));
        let (b, u) = (1.0 / (1.0 + end), random.between(0.0, 1.0));
        let a = end * b;
        let sum = |x: f64| {
            let (area, height) = bell(x);
            a * area + b * height / PI.sqrt()
        };
        let x = inverse_bell(a, b, end, sum(end), u);
        assert!((sum(x) / sum(end) - u).abs() < 1e-13, "{end:e} {u}: {x}");
        let (a, b, end, u) = (a as f32, b as f32, end as f32, u as f32);
        let (area, height) = bell(end);
        let total = a * area + b * height / std::f32::consts::PI.sqrt();
        let x = inverse_bell(a, b, end, total, u);
        let (area, height) = bell(x);
        let found = (a * area + b * height / std::f32::consts::PI.sqrt()) / total;
        assert!((found - u).abs() < 1e-6, "{end:e} {u}: {x}, {found} in single");
    }
}

fn special_cases<T: Real>() {
    let of = T::of;
    let (zero, inf, nan) = (of(0.0), T::INFINITY, T::NAN);
    let same = |a: T, b: T| a == b && (T::one() / a) == (T::one() / b) || a.is_nan() && b.is_nan();
    // (x, y, pow(x, y)), as C99 F.9.4.4 has it.
    let m = -zero;
    let table = [
        (zero, of(-3.0), inf),
        (m, of(-3.0), -inf),
        (m, of(-2.0), inf),
        (zero, of(3.0), zero),
        (m, of(3.0), m),
        (m, of(2.0), zero),
        (m, of(0.5), zero),
        (of(-1.0), inf, of(1.0)),
        (of(-1.0), -inf, of(1.0)),
        (of(1.0), nan, of(1.0)),
        (nan, zero, of(1.0)),
        (nan, m, of(1.0)),
        (of(0.5), -inf, inf),
        (of(0.5), inf, zero),
        (of(-0.5), inf, zero),
        (of(2.0), inf, inf),
        (of(2.0), -inf, zero),
        (-inf, of(-3.0), m),
        (-inf, of(-2.0), zero),
        (-inf, of(3.0), -inf),
        (-inf, of(2.0), inf),
        (-inf, of(0.5), inf),
        (inf, of(-1.0), zero),
        (inf, of(1.0), inf),
        (of(-8.0), of(0.5), nan),
        (of(-2.0), of(3.0), of(-8.0)),
        (of(-2.0), of(4.0), of(16.0)),
        (nan, of(1.0), nan),
        (of(2.0), nan, nan),
        (of(-1.0), of(1.0) / T::EPSILON, of(1.0)),
        (of(-1.0), of(2.0) / T::EPSILON - of(1.0), of(-1.0)),
        (of(-1.0), of(1.0) / T::EPSILON - of(1.0), of(-1.0)),
    ];
    for (x, y, expected) in table {
        let got = pow(x, y);
        assert!(same(got, expected), "pow({x:?}, {y:?}) = {got:?}, not {expected:?}");
    }
    for (y, x, expected) in [(0.0, 1.0, 0.0), (-0.0, 1.0, -0.0)] {
        assert!(same(atan2(of(y), of(x)), of(expected)));
    }
    let quarter = T::PI / of(4.0);
    for (y, x, k) in [
        (zero, m, 4.0),
        (m, m, -4.0),
        (zero, -inf, 4.0),
        (m, of(-1.0), -4.0),
        (of(1.0), zero, 2.0),
        (of(-1.0), m, -2.0),
        (inf, inf, 1.0),
        (inf, of(5.0), 2.0),
        (of(5.0), -inf, 4.0),
        (T::MAX, T::MAX, 1.0),
        (T::MIN_POSITIVE, T::MIN_POSITIVE, 1.0),
        (zero, zero, 0.0),
    ] {
        assert_eq!(atan2(y, x), quarter * of(k), "atan2({y:?}, {x:?})");
    }
    assert!((atan2(inf, -inf) - of(3.0) * quarter).abs() <= of(2.0) * T::EPSILON);
    assert!(same(atan2(of(5.0), inf), zero) && same(atan2(of(-5.0), inf), m));
    for f in [sin, cos, tan] {
        assert!(f(nan).is_nan() && f(inf).is_nan() && f(-inf).is_nan() && f(of(2e6)).is_nan());
    }
    assert!(same(sin(m), m) && same(tan(m), m) && same(asin(m), m) && same(cos(m), of(1.0)));
    assert!(same(exp(-inf), zero) && same(exp(inf), inf) && exp(nan).is_nan() && same(exp(m), of(1.0)));
    assert!(same(ln(zero), -inf) && same(ln(m), -inf) && ln(of(-1.0)).is_nan() && ln(nan).is_nan());
    assert!(same(ln(inf), inf) && same(ln(of(1.0)), zero) && same(acos(of(1.0)), zero));
    assert!(acos(of(1.5)).is_nan() && asin(of(-1.5)).is_nan() && acos(nan).is_nan() && asin(nan).is_nan());
    assert_eq!(acos(of(-1.0)), T::PI);
    assert_eq!(pow(of(-0.0), of(0.0)), of(1.0));
    assert_eq!(atan2(zero, of(-1.0)), T::PI);
}

#[test]
fn special_cases_are_those_of_c99() {
    special_cases::<f32>();
    special_cases::<f64>();
}

/// All functions on eight lanes at once, as bits.
#[inline(always)]
fn in_lanes<V: crate::real::Lanes>(x: V, y: V) -> [V; 9] {
    [sin(x), cos(x), tan(x), asin(x), acos(x), exp(x), ln(x), atan2(x, y), pow(x, y)]
}

#[test]
fn lanes_give_the_bits_of_the_scalar_at_each_level() {
    let mut random = Random(4);
    for round in 0..2000 {
        let scale = (2f64).powi((round % 40) - 20);
        let x: [f64; 8] = std::array::from_fn(|_| random.between(-scale, scale));
        let y: [f64; 8] = std::array::from_fn(|_| random.between(-9.0, 9.0));
        let (x32, y32) = (x.map(|v| v as f32), y.map(|v| v as f32));
        for level in simd::Level::ALL.into_iter().filter(|l| l.available()) {
            simd::force(Some(level));
            let wide: [[f64; 8]; 9] = dispatch!(s => in_lanes(simd::f64x8::from_slice(s, &x), simd::f64x8::from_slice(s, &y)).map(|v| v.into()));
            let wide32: [[f32; 8]; 9] = dispatch!(s => in_lanes(simd::f32x8::from_slice(s, &x32), simd::f32x8::from_slice(s, &y32)).map(|v| v.into()));
            for i in 0..8 {
                for (k, v) in in_lanes(x[i], y[i]).into_iter().enumerate() {
                    assert!(
                        v.to_bits() == wide[k][i].to_bits() || v.is_nan() && wide[k][i].is_nan(),
                        "{k} of {}",
                        x[i]
                    );
                }
                for (k, v) in in_lanes(x32[i], y32[i]).into_iter().enumerate() {
                    assert!(
                        v.to_bits() == wide32[k][i].to_bits() || v.is_nan() && wide32[k][i].is_nan(),
                        "{k} of {}",
                        x32[i]
                    );
                }
            }
        }
        simd::force(None);
    }
}

//! Direction numbers of Sobol' sequences.
//!
//! The table is that of S. Joe, F. Y. Kuo, *Constructing Sobol sequences with better two-dimensional projections*,
//! 2008 (new-joe-kuo-6.21201), for all primitive polynomials over GF(2) of degree up to 13: a line for each dimension
//! after the first, in their order. A line is a string of bits, six a character (base 64, A is 0), the highest first:
//! the polynomial's s − 1 inner coefficients from the highest power down, then of m₂ … mₛ (m₁ is 1) all but the last
//! digit, which is 1: one bit of m₂ up to s − 1 bits of mₛ.

/// The initial numbers of one dimension: the polynomial's coefficients as bits, from the highest power to the constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Initial {
    pub polynomial: u32,
    pub degree: usize,
    pub m: [u32; DEGREE],
}

pub const DEGREE: usize = 13;

/// How many primitive polynomials of degree 1, 2 … there are: φ(2ˢ − 1) / s.
const POLYNOMIALS: [usize; DEGREE] = [1, 1, 2, 2, 6, 6, 18, 16, 48, 60, 176, 144, 630];

/// How many dimensions there are direction numbers for.
pub const DIMENSIONS: usize = {
    let (mut n, mut s) = (1, 0);
    while s < DEGREE {
        n += POLYNOMIALS[s];
        s += 1;
    }
    n
};

static TABLE: &str = include_str!("joe_kuo_data.txt");

/// Dimensions 1, 2 …; dimension 0 is van der Corput's sequence and needs none.
pub fn initials() -> impl Iterator<Item = Initial> {
    let degrees = POLYNOMIALS.iter().enumerate().flat_map(|(s, &n)| std::iter::repeat_n(s + 1, n));
    TABLE.lines().zip(degrees).map(|(line, degree)| {
        let mut bits = line.bytes().flat_map(|c| (0..6).rev().map(move |k| u32::from(digit(c) >> k & 1)));
        let mut read = |n: usize| (0..n).fold(0, |x, _| x << 1 | bits.next().unwrap_or(0));
        let polynomial = 1 << degree | read(degree - 1) << 1 | 1;
        let mut m = [0; DEGREE];
        for k in 0..degree {
            m[k] = read(k) << 1 | 1;
        }
        Initial { polynomial, degree, m }
    })
}

fn digit(c: u8) -> u8 {
    match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    }
}

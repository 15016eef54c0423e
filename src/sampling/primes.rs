//! The bases of Halton's sequence.

use super::joe_kuo::DIMENSIONS;

/// The first primes, one for each dimension.
pub static PRIMES: [u32; DIMENSIONS] = primes();

const fn primes() -> [u32; DIMENSIONS] {
    let mut found = [2; DIMENSIONS];
    let (mut n, mut candidate) = (1, 3);
    while n < DIMENSIONS {
        let mut i = 0;
        while found[i] * found[i] <= candidate && candidate % found[i] != 0 {
            i += 1;
        }
        if found[i] * found[i] > candidate {
            found[n] = candidate;
            n += 1;
        }
        candidate += 2;
    }
    found
}

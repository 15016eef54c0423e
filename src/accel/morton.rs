//! Morton order, and the binary radix tree over it.
//!
//! A code interleaves the bits of three cell numbers, x lowest: ten bits each make thirty, twenty-one make sixty-three.
//!
//! G. M. Morton, *A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing*, 1966; T. Karras,
//! *Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees*, 2012.

/// The code of a cell; its numbers are below 2^21.
#[inline(always)]
pub fn encode([x, y, z]: [u64; 3]) -> u64 {
    spread(x) | spread(y) << 1 | spread(z) << 2
}

/// The cell of a point in a box whose sides are `side` cells long: along each axis the place between `lower` and `upper`,
/// halved so that no extent overflows. An axis without extent has one cell.
#[inline(always)]
pub fn cell(p: [f64; 3], lower: [f64; 3], half: [f64; 3], side: u64) -> [u64; 3] {
    let last = (side - 1) as f64;
    let mut cell = [0; 3];
    for k in 0..3 {
        let place = if half[k] > 0.0 { (p[k] * 0.5 - lower[k] * 0.5) / half[k] } else { 0.0 };
        // Through 32 bits, which lanes can convert to.
        cell[k] = (place * side as f64).min(last) as u32 as u64;
    }
    cell
}

/// Whether a point is finite and in the box.
#[inline(always)]
pub fn within(p: [f64; 3], lower: [f64; 3], upper: [f64; 3]) -> bool {
    let mut inside = true;
    for k in 0..3 {
        inside &= (lower[k] <= p[k]) & (p[k] <= upper[k]);
    }
    inside
}

/// The cell of a code.
#[inline(always)]
pub fn decode(code: u64) -> [u64; 3] {
    [gather(code), gather(code >> 1), gather(code >> 2)]
}

/// Two zeros after every bit.
#[inline(always)]
fn spread(x: u64) -> u64 {
    let x = x & 0x1f_ffff;
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// Every third bit, from the lowest.
#[inline(always)]
fn gather(x: u64) -> u64 {
    let x = x & 0x1249_2492_4924_9249;
    let x = (x | x >> 2) & 0x10c3_0c30_c30c_30c3;
    let x = (x | x >> 4) & 0x100f_00f0_0f00_f00f;
    let x = (x | x >> 8) & 0x001f_0000_ff00_00ff;
    let x = (x | x >> 16) & 0x001f_0000_0000_ffff;
    (x | x >> 32) & 0x1f_ffff
}

/// Where a sorted list of at least two codes is cut in two: before the first code that has the highest bit in which they
/// differ; in the middle if they are all the same.
#[inline(always)]
pub fn split(len: usize, code: impl Fn(usize) -> u64) -> usize {
    let (first, last) = (code(0), code(len - 1));
    if first == last {
        return len / 2;
    }
    let bit = 1u64 << (63 - (first ^ last).leading_zeros());
    // The first has the bit clear, the last has it set.
    let (mut clear, mut set) = (0, len - 1);
    while set - clear > 1 {
        let middle = clear + (set - clear) / 2;
        if code(middle) & bit == 0 { clear = middle } else { set = middle }
    }
    set
}

/// An inner node of the radix tree: its interval of codes and its children; leaves follow the inner nodes in number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RadixNode {
    pub first: u32,
    pub last: u32,
    pub left: u32,
    pub right: u32,
}

/// Inner node `i` of the radix tree over sorted codes, found without the others (Karras, figure 4): it begins or ends at
/// code `i`. Equal codes are told apart by their places.
#[inline(always)]
pub fn radix_node(codes: &[u64], i: usize) -> RadixNode {
    let n = codes.len() as i64;
    let i = i as i64;
    // The length of the common prefix of two codes; -1 outside the list.
    let prefix = |j: i64| -> i64 {
        if j < 0 || j >= n {
            return -1;
        }
        let x = codes[i as usize] ^ codes[j as usize];
        if x != 0 { x.leading_zeros() as i64 } else { 64 + ((i ^ j) as u64).leading_zeros() as i64 }
    };
    let d = if prefix(i + 1) > prefix(i - 1) { 1 } else { -1 };
    let outside = prefix(i - d);
    let mut most = 2;
    while prefix(i + most * d) > outside {
        most *= 2;
    }
    let mut length = 0;
    let mut step = most / 2;
    while step >= 1 {
        if prefix(i + (length + step) * d) > outside {
            length += step;
        }
        step /= 2;
    }
    let j = i + length * d;
    let inside = prefix(j);
    let (mut cut, mut step) = (0, length);
    while step > 1 {
        step = (step + 1) / 2;
        if prefix(i + (cut + step) * d) > inside {
            cut += step;
        }
    }
    let cut = i + cut * d + d.min(0);
    let (first, last) = (i.min(j), i.max(j));
    let leaves = n - 1;
    let left = if first == cut { leaves + cut } else { cut };
    let right = if last == cut + 1 { leaves + cut + 1 } else { cut + 1 };
    RadixNode { first: first as u32, last: last as u32, left: left as u32, right: right as u32 }
}

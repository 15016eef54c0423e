//! Where the samples of a pixel lie: its centre, or the standard rotated grids of 2, 4 and 8 samples, no two of which
//! share a row or a column.
//!
//! Microsoft, *Direct3D 11.3 Functional Specification*, 2015, section 19.2 (standard multisample patterns).

/// Subpixel steps to a pixel: positions are fixed-point numbers of 8 fractional bits.
pub const SUBPIXELS: i32 = 1 << SUBPIXEL_BITS;
pub const SUBPIXEL_BITS: u32 = 8;

/// In subpixel steps from the pixel's top left corner, from offsets to the centre in sixteenths of a pixel.
const fn from_sixteenths<const N: usize>(offsets: [[i32; 2]; N]) -> [[i32; 2]; N] {
    let mut out = offsets;
    let mut i = 0;
    while i < N {
        out[i] = [(8 + offsets[i][0]) * SUBPIXELS / 16, (8 + offsets[i][1]) * SUBPIXELS / 16];
        i += 1;
    }
    out
}

static ONE: [[i32; 2]; 1] = from_sixteenths([[0, 0]]);
static TWO: [[i32; 2]; 2] = from_sixteenths([[4, 4], [-4, -4]]);
static FOUR: [[i32; 2]; 4] = from_sixteenths([[-2, -6], [6, -2], [-6, 2], [2, 6]]);
static EIGHT: [[i32; 2]; 8] =
    from_sixteenths([[1, -3], [-1, 3], [5, 1], [-3, -5], [-5, 5], [-7, -1], [3, 7], [7, -7]]);

/// The samples of a pixel `(x, y)`, in subpixel steps from its top left corner; `None` for an unknown count.
pub fn positions(count: usize) -> Option<&'static [[i32; 2]]> {
    match count {
        1 => Some(&ONE),
        2 => Some(&TWO),
        4 => Some(&FOUR),
        8 => Some(&EIGHT),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_samples_share_a_row_or_a_column_and_their_mean_is_near_the_centre() {
        for n in [1, 2, 4, 8] {
            let p = positions(n).unwrap();
            for axis in 0..2 {
                let mut seen: Vec<_> = p.iter().map(|s| s[axis]).collect();
                seen.sort();
                seen.dedup();
                assert_eq!(seen.len(), n);
                assert!(seen.iter().all(|&s| (0..SUBPIXELS).contains(&s)));
                let mean = seen.iter().sum::<i32>() as f64 / n as f64;
                assert!((mean - 128.0).abs() <= 16.0, "{n}: {mean}");
            }
        }
    }
}

//! Every hit of many rays: kept as they are met, ray by ray in disorder, and brought in order in the end.

use super::Hit;
use super::lists::OutOfMemory;
use crate::real::Real;
use std::cmp::Ordering;

/// Hits in the order in which they were met, each with the number of its ray.
pub struct Met<T> {
    hits: Vec<(u32, Hit<T>)>,
}

impl<T: Real> Met<T> {
    pub fn new() -> Self {
        Met { hits: Vec::new() }
    }

    /// Makes room for `n` hits more.
    #[inline(always)]
    pub fn reserve(&mut self, n: usize) -> Result<(), OutOfMemory> {
        Ok(self.hits.try_reserve(n)?)
    }

    /// Adds a hit, with the user's `t`.
    #[inline(always)]
    pub fn put(&mut self, ray: u32, hit: Hit<T>) {
        self.hits.push((ray, hit));
    }

    /// Appends all to `found`, ray by ray, each ray's by `t`, then by face, none twice, and forgets them; gives the number
    /// of hits of each ray. `place` says where among the rays one stands.
    pub fn bring(
        &mut self,
        place: impl Fn(usize) -> usize,
        numbers: &mut [i64],
        found: &mut Vec<Hit<T>>,
    ) -> Result<(), OutOfMemory> {
        found.try_reserve(self.hits.len())?;
        numbers.fill(0);
        for &(ray, _) in &self.hits {
            numbers[place(ray as usize)] += 1;
        }
        // Where the hits of each ray end, which moves back to where they begin.
        let first = found.len();
        let mut end = first as i64;
        for number in &mut *numbers {
            end += *number;
            *number = end;
        }
        found.resize(end as usize, Hit::miss());
        for (ray, hit) in self.hits.drain(..).rev() {
            let at = &mut numbers[place(ray as usize)];
            *at -= 1;
            found[*at as usize] = hit;
        }
        let mut kept = first;
        for i in 0..numbers.len() {
            let from = numbers[i] as usize;
            let to = numbers.get(i + 1).map_or(end, |&next| next) as usize;
            let n = settle(&mut found[from..to]);
            if kept < from {
                found.copy_within(from..from + n, kept);
            }
            numbers[i] = n as i64;
            kept += n;
        }
        found.truncate(kept);
        Ok(())
    }
}

/// Orders a ray's hits by `t` and face, and says how many are left without repetitions, which then stand first.
pub fn settle<T: Real>(hits: &mut [Hit<T>]) -> usize {
    // No `t` is NaN, and no zero negative.
    hits.sort_unstable_by(|a, b| a.t.partial_cmp(&b.t).unwrap_or(Ordering::Equal).then(a.face.cmp(&b.face)));
    // A triangle in several cells is hit at the same `t` in each.
    let mut kept = 0;
    for i in 0..hits.len() {
        let hit = hits[i];
        if kept == 0 || hits[kept - 1].face != hit.face || hits[kept - 1].t != hit.t {
            hits[kept] = hit;
            kept += 1;
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hits_come_ray_by_ray_nearest_first_and_once() {
        let hit = |t: f32, face| Hit { t, u: 0.0, v: 0.0, face };
        let mut met = Met::new();
        for (ray, h) in [
            (2, hit(3.0, 1)),
            (0, hit(2.0, 9)),
            (2, hit(1.0, 5)),
            (0, hit(2.0, 4)),
            (2, hit(3.0, 1)),
            (3, hit(0.5, 0)),
        ] {
            met.reserve(1).unwrap();
            met.put(ray, h);
        }
        let (mut numbers, mut found) = ([7; 4], vec![hit(8.0, 8)]);
        // Ray 0 stands last.
        met.bring(|ray| 3 - ray, &mut numbers, &mut found).unwrap();
        assert_eq!(numbers, [1, 2, 0, 2]);
        let faces: Vec<i32> = found.iter().map(|h| h.face).collect();
        assert_eq!(faces, [8, 0, 5, 1, 4, 9]);
    }
}

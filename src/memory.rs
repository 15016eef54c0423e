//! Large lists in large pages: fewer page faults while they are written, fewer misses of the translation buffer while they
//! are read in no order.

use bytemuck::Zeroable;
use rayon::prelude::*;
use std::mem::MaybeUninit;
use std::sync::atomic::{AtomicBool, Ordering};

/// An empty list with room for `capacity` items, in huge pages where the system grants them to those who ask.
pub fn list<T>(capacity: usize) -> Vec<T> {
    let mut list = Vec::with_capacity(capacity);
    advise(list.spare_capacity_mut());
    list
}

/// `n` zeros, in huge pages as well. The system clears a page when it is first touched: here, on all threads, rather than
/// one by one in the middle of other work. Once `stop` is set, no more are touched.
pub fn zeros<T: Zeroable + Send>(n: usize, stop: &AtomicBool) -> Vec<T> {
    let mut list = bytemuck::zeroed_vec(n);
    let items: &mut [T] = &mut list;
    // Sound: what is initialised may be looked at as if it might not be, and nothing is written.
    advise(unsafe { &mut *(items as *mut [T] as *mut [MaybeUninit<T>]) });
    let chunk = ((2 << 20) / size_of::<T>().max(1)).max(1);
    if n > chunk {
        items.par_chunks_mut(chunk).filter(|_| !stop.load(Ordering::Relaxed)).for_each(|chunk| {
            for item in chunk.iter_mut().step_by((4096 / size_of::<T>().max(1)).max(1)) {
                // Volatile, or nothing would be written where zeros are.
                // Sound: the place is an item's own.
                unsafe { std::ptr::write_volatile(item, T::zeroed()) };
            }
        });
    }
    list
}

/// Asks for huge pages where memory spans some of them. A hint: contents and addresses stay as they are.
fn advise<T>(memory: &mut [MaybeUninit<T>]) {
    #[cfg(target_os = "linux")]
    {
        const HUGE: usize = 2 << 20;
        let range = memory.as_mut_ptr_range();
        let (start, end) = ((range.start as usize).next_multiple_of(HUGE), range.end as usize / HUGE * HUGE);
        if start < end {
            // Sound: the pages belong to the list, and the advice changes neither what they hold nor where they are.
            unsafe { libc::madvise(start as *mut libc::c_void, end - start, libc::MADV_HUGEPAGE) };
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = memory;
}

#[cfg(test)]
mod tests {
    #[test]
    fn lists_of_all_sizes_hold_what_they_are_given() {
        for n in [0, 1, 1000, 3 << 20] {
            let mut list = super::list(n);
            assert!(list.capacity() >= n);
            list.extend((0..n).map(|i| i as u64));
            assert!(list.iter().enumerate().all(|(i, &x)| x == i as u64));
        }
    }
}

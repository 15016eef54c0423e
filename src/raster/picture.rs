//! A picture that tiles write into from many threads.

use std::marker::PhantomData;

/// A row-major array of items, of which every task writes its own, disjoint parts.
pub struct Picture<'a, T> {
    data: *mut T,
    width: usize,
    height: usize,
    borrow: PhantomData<&'a mut [T]>,
}

// Sound: a `Picture` hands out parts only through `row`, whose caller promises that they do not overlap.
unsafe impl<T: Send> Sync for Picture<'_, T> {}

impl<'a, T> Picture<'a, T> {
    /// `data` holds `height` rows of `width` items.
    pub fn new(data: &'a mut [T], width: usize, height: usize) -> Self {
        assert_eq!(data.len(), width * height, "a picture of {width} x {height} items");
        Picture { data: data.as_mut_ptr(), width, height, borrow: PhantomData }
    }

    /// Items `x..x + n` of row `y`.
    ///
    /// # Safety
    /// No other part of the picture in use may overlap this one. Tiles fulfil this by writing their own pixels alone.
    #[inline(always)]
    #[allow(clippy::mut_from_ref)]
    pub unsafe fn row(&self, x: usize, y: usize, n: usize) -> &mut [T] {
        assert!(y < self.height && n <= self.width && x <= self.width - n);
        // Sound: the range lies within the slice borrowed by `new`, and the caller has it to itself.
        unsafe { std::slice::from_raw_parts_mut(self.data.add(y * self.width + x), n) }
    }
}

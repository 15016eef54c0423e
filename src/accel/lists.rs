//! Answers of unknown length: each query gives a list, and the lists stand one after the other in the end. What does
//! not fit into memory is reported, rather than that the process ends.

use crate::parallel::{self, Interrupted, Pieces, Watch};
use std::collections::TryReserveError;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// There is no memory for the answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfMemory;

impl From<TryReserveError> for OutOfMemory {
    fn from(_: TryReserveError) -> Self {
        OutOfMemory
    }
}

/// `n` zeros, if there is memory for them.
pub fn zeros<X: Clone + Default>(n: usize) -> Result<Vec<X>, OutOfMemory> {
    let mut list = Vec::new();
    list.try_reserve_exact(n)?;
    list.resize(n, X::default());
    Ok(list)
}

/// The lists of all queries, those of some queries together.
pub struct Lists<X> {
    /// List `i` stands from `offsets[i]` to `offsets[i + 1]`, counted through all parts.
    pub offsets: Vec<i64>,
    parts: Vec<Mutex<Vec<X>>>,
}

/// Asks `count` queries, `piece` of them a task. `list` appends the answers of query `i`; where one may take `long`, it
/// looks at its flag now and then, and returns soon once it is set.
pub fn lists<X: Send>(
    watch: &mut dyn Watch,
    count: usize,
    piece: usize,
    long: bool,
    list: impl Fn(usize, &mut Vec<X>, &AtomicBool) -> Result<(), OutOfMemory> + Sync,
) -> Result<Result<Lists<X>, OutOfMemory>, Interrupted> {
    batches(watch, count, piece, long, |first, numbers, found, stop| {
        for (i, number) in numbers.iter_mut().enumerate() {
            let before = found.len();
            list(first + i, found, stop)?;
            *number = (found.len() - before) as i64;
        }
        Ok(())
    })
}

/// Asks `count` queries, `piece` of them a task. `list` appends the answers of those from a first one on, one query after
/// the other, and says how many each has; the rest is as of [`lists`].
pub fn batches<X: Send>(
    watch: &mut dyn Watch,
    count: usize,
    piece: usize,
    long: bool,
    list: impl Fn(usize, &mut [i64], &mut Vec<X>, &AtomicBool) -> Result<(), OutOfMemory> + Sync,
) -> Result<Result<Lists<X>, OutOfMemory>, Interrupted> {
    // The number of each query's answers, in the place of its end.
    let Ok(mut offsets) = zeros::<i64>(count + 1) else { return Ok(Err(OutOfMemory)) };
    let parts: Vec<Mutex<Vec<X>>> = (0..count.div_ceil(piece)).map(|_| Mutex::default()).collect();
    let full = AtomicBool::new(false);
    parallel::for_each_stoppable(watch, &mut offsets[1..], piece, long, |first, ends: &mut [i64], stop| {
        let mut found = Vec::new();
        if full.load(Ordering::Relaxed) {
            return;
        }
        if list(first, ends, &mut found, stop).is_err() {
            full.store(true, Ordering::Relaxed);
        }
        *parts[first / piece].lock().unwrap_or_else(PoisonError::into_inner) = found;
    })?;
    if full.into_inner() {
        return Ok(Err(OutOfMemory));
    }
    for i in 0..count {
        offsets[i + 1] += offsets[i];
    }
    Ok(Ok(Lists { offsets, parts }))
}

impl<X: Copy + Send> Lists<X> {
    /// How many answers there are.
    pub fn total(&self) -> usize {
        self.offsets.last().map_or(0, |&n| n as usize)
    }

    /// Brings all answers into arrays of that length, and frees each part as it goes; gives the offsets.
    pub fn bring<P: Pieces>(
        self,
        watch: &mut dyn Watch,
        into: P,
        put: impl Fn(&mut P, usize, X) + Sync,
    ) -> Result<Vec<i64>, Interrupted> {
        let mut rest = into;
        let mut tasks = Vec::with_capacity(self.parts.len());
        for part in self.parts {
            let part = part.into_inner().unwrap_or_else(PoisonError::into_inner);
            let (place, tail) = rest.cut(part.len());
            tasks.push(Mutex::new(Some((part, place))));
            rest = tail;
        }
        parallel::run(watch, tasks.len(), |i| {
            let task = tasks[i].lock().unwrap_or_else(PoisonError::into_inner).take();
            if let Some((part, mut place)) = task {
                part.iter().enumerate().for_each(|(i, &x)| put(&mut place, i, x));
            }
        })?;
        Ok(self.offsets)
    }
}

//! Our own thread pool, and the one way in which kernels use it.
//!
//! A computation is cut into pieces whose bounds do not depend on the number of threads, so neither do its results.
//! Workers claim pieces in order; the calling thread waits, and every few milliseconds lets its [`Watch`] show
//! progress or stop the work (Ctrl-C). The pool is built at first use, in each process anew (a forked child has
//! none of its parent's threads), and can be resized at any time.
//!
//! A closure is compiled in every unit that makes a pointer of it. So what takes a kernel's closure here is `#[inline]`:
//! it becomes a pointer in the kernel's own unit, and what schedules it is compiled once. Without that all kernels land
//! in one unit, which then keeps one core busy for most of the build.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// How often the calling thread looks up from waiting.
const TICK: Duration = Duration::from_millis(50);

/// What the caller of a long computation does meanwhile, on its own thread.
pub trait Watch {
    /// Told how many of `total` pieces are done; `Break` stops the work.
    fn tick(&mut self, done: usize, total: usize) -> ControlFlow<()>;
}

/// Waits to the end.
pub struct Quiet;

impl Watch for Quiet {
    fn tick(&mut self, _: usize, _: usize) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// The watch stopped the work; outputs hold a part of the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interrupted;

struct Pool {
    process: u32,
    threads: usize,
    pool: Arc<ThreadPool>,
}

static POOL: Mutex<Option<Pool>> = Mutex::new(None);
/// The number asked for; 0 means one a core.
static THREADS: AtomicUsize = AtomicUsize::new(0);

/// The number of threads that work is spread over.
pub fn threads() -> usize {
    match THREADS.load(Ordering::Relaxed) {
        0 => {
            let asked =
                std::env::var("SHADELAB_THREADS").ok().and_then(|s| s.parse().ok()).filter(|&n| n > 0);
            asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, |n| n.get()))
        }
        n => n,
    }
}

/// Sets the number of threads; 0 returns to one a core. Work under way keeps the threads it has.
pub fn set_threads(n: usize) {
    THREADS.store(n, Ordering::Relaxed);
}

/// Runs `f` on the pool's threads, where `rayon::join` and the like then find it.
pub fn pool() -> Arc<ThreadPool> {
    let (process, threads) = (std::process::id(), threads());
    let mut slot = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match slot.as_ref() {
        Some(p) if p.process == process && p.threads == threads => return p.pool.clone(),
        // The parent's threads do not exist in a forked child: joining them would hang, so the handle is leaked.
        Some(p) if p.process != process => std::mem::forget(slot.take()),
        _ => {}
    }
    let built =
        ThreadPoolBuilder::new().num_threads(threads).thread_name(|i| format!("shadelab-{i}")).build();
    let pool = Arc::new(built.expect("the system gives threads"));
    *slot = Some(Pool { process, threads, pool: pool.clone() });
    pool
}

/// Runs `task(0) … task(tasks - 1)` on the pool, each once. Results must not depend on which thread takes a task.
#[inline]
pub fn run(watch: &mut dyn Watch, tasks: usize, task: impl Fn(usize) + Sync) -> Result<(), Interrupted> {
    // One piece is not worth waking a thread for.
    let here = tasks <= 1;
    run_tasks(watch, tasks, here, &|i, _| task(i))
}

/// A task, and the flag that tells it to stop.
type Task<'a> = &'a (dyn Fn(usize, &AtomicBool) + Sync);

fn run_tasks(watch: &mut dyn Watch, tasks: usize, here: bool, task: Task) -> Result<(), Interrupted> {
    let (next, done, stop) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicBool::new(false));
    // On a thread of the pool, waiting for the others could wait for itself.
    if here || rayon::current_thread_index().is_some() {
        (0..tasks).for_each(|i| task(i, &stop));
        return finish(watch.tick(tasks, tasks));
    }
    let left = Mutex::new(0usize);
    let finished = Condvar::new();
    let pool = pool();
    let workers = pool.current_num_threads().min(tasks);
    *left.lock().expect("not poisoned yet") = workers;
    let mut verdict = ControlFlow::Continue(());
    pool.in_place_scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|_| {
                // Counts this worker out even if a task panics, so that the caller wakes and the panic travels on.
                let _out = CountOut(&left, &finished);
                while !stop.load(Ordering::Relaxed) {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    if i >= tasks {
                        break;
                    }
                    task(i, &stop);
                    done.fetch_add(1, Ordering::Relaxed);
                }
            });
        }
        let mut busy = left.lock().unwrap_or_else(PoisonError::into_inner);
        while *busy > 0 {
            let (guard, wait) = finished.wait_timeout(busy, TICK).unwrap_or_else(PoisonError::into_inner);
            busy = guard;
            if wait.timed_out() && *busy > 0 && verdict.is_continue() {
                drop(busy);
                verdict = watch.tick(done.load(Ordering::Relaxed), tasks);
                stop.store(verdict.is_break(), Ordering::Relaxed);
                busy = left.lock().unwrap_or_else(PoisonError::into_inner);
            }
        }
    });
    if verdict.is_continue() {
        verdict = watch.tick(tasks, tasks);
    }
    finish(verdict)
}

/// Runs `work` on the pool, where it may fork (`rayon::join`), while the calling thread watches. `work` should look
/// at its flag now and then, and return soon once it is set; its result is dropped then.
#[inline]
pub fn run_forking<R: Send>(
    watch: &mut dyn Watch,
    work: impl FnOnce(&AtomicBool) -> R + Send,
) -> Result<R, Interrupted> {
    let (mut work, mut result) = (Some(work), None);
    run_watched(watch, &mut |stop| result = work.take().map(|work| work(stop)))?;
    result.ok_or(Interrupted)
}

fn run_watched(watch: &mut dyn Watch, work: &mut (dyn FnMut(&AtomicBool) + Send)) -> Result<(), Interrupted> {
    let stop = AtomicBool::new(false);
    // As in `run`: a thread of the pool that waited could wait for itself.
    if rayon::current_thread_index().is_some() {
        work(&stop);
        return finish(watch.tick(1, 1));
    }
    let (busy, finished) = (Mutex::new(1usize), Condvar::new());
    let mut verdict = ControlFlow::Continue(());
    pool().in_place_scope(|scope| {
        scope.spawn(|_| {
            let _out = CountOut(&busy, &finished);
            work(&stop);
        });
        let mut left = busy.lock().unwrap_or_else(PoisonError::into_inner);
        while *left > 0 {
            let (guard, wait) = finished.wait_timeout(left, TICK).unwrap_or_else(PoisonError::into_inner);
            left = guard;
            if wait.timed_out() && *left > 0 && verdict.is_continue() {
                drop(left);
                verdict = watch.tick(0, 1);
                stop.store(verdict.is_break(), Ordering::Relaxed);
                left = busy.lock().unwrap_or_else(PoisonError::into_inner);
            }
        }
    });
    if verdict.is_continue() {
        verdict = watch.tick(1, 1);
    }
    finish(verdict)
}

fn finish(verdict: ControlFlow<()>) -> Result<(), Interrupted> {
    if verdict.is_break() { Err(Interrupted) } else { Ok(()) }
}

struct CountOut<'a>(&'a Mutex<usize>, &'a Condvar);

impl Drop for CountOut<'_> {
    fn drop(&mut self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) -= 1;
        self.1.notify_one();
    }
}

/// Data that can be cut into pieces along its first axis: slices, [`Rows`], and tuples of them.
pub trait Pieces: Sized + Send {
    /// The number of items along the axis that is cut.
    fn items(&self) -> usize;
    fn cut(self, at: usize) -> (Self, Self);
}

impl<T: Sync> Pieces for &[T] {
    fn items(&self) -> usize {
        self.len()
    }
    fn cut(self, at: usize) -> (Self, Self) {
        self.split_at(at)
    }
}

impl<T: Send> Pieces for &mut [T] {
    fn items(&self) -> usize {
        self.len()
    }
    fn cut(self, at: usize) -> (Self, Self) {
        self.split_at_mut(at)
    }
}

/// A row-major array whose items are rows of `width` elements.
pub struct Rows<'a, T> {
    pub data: &'a mut [T],
    pub width: usize,
}

impl<T: Send> Pieces for Rows<'_, T> {
    fn items(&self) -> usize {
        self.data.len().checked_div(self.width).unwrap_or(0)
    }
    fn cut(self, at: usize) -> (Self, Self) {
        let (a, b) = self.data.split_at_mut(at * self.width);
        (Rows { data: a, width: self.width }, Rows { data: b, width: self.width })
    }
}

/// An output that the caller may not want.
impl<P: Pieces> Pieces for Option<P> {
    fn items(&self) -> usize {
        self.as_ref().map_or(usize::MAX, P::items)
    }
    fn cut(self, at: usize) -> (Self, Self) {
        match self {
            Some(p) => {
                let (a, b) = p.cut(at);
                (Some(a), Some(b))
            }
            None => (None, None),
        }
    }
}

macro_rules! tuple {
    ($($p:ident $i:tt),+) => {
        impl<$($p: Pieces),+> Pieces for ($($p,)+) {
            fn items(&self) -> usize {
                let mut least = usize::MAX;
                $(least = least.min(self.$i.items());)+
                least
            }
            fn cut(self, at: usize) -> (Self, Self) {
                let halves = ($(self.$i.cut(at),)+);
                (($(halves.$i.0,)+), ($(halves.$i.1,)+))
            }
        }
    };
}
tuple!(A 0);
tuple!(A 0, B 1);
tuple!(A 0, B 1, C 2);
tuple!(A 0, B 1, C 2, D 3);
tuple!(A 0, B 1, C 2, D 3, E 4);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7, I 8);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7, I 8, J 9);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7, I 8, J 9, K 10);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7, I 8, J 9, K 10, L 11);

/// Calls `f(first, piece)` for every piece of at most `size` items; `first` is the index of its first item.
#[inline]
pub fn for_each<P: Pieces>(
    watch: &mut dyn Watch,
    data: P,
    size: usize,
    f: impl Fn(usize, P) + Sync,
) -> Result<(), Interrupted> {
    // One piece is not worth waking a thread for.
    let here = data.items() <= size;
    for_each_piece(watch, data, size, here, &|i, piece, _| f(i, piece))
}

/// [`for_each`] over pieces of which one may take long: the flag tells it to return soon. `long` wakes a thread even for a
/// single piece, so that the caller can watch it.
#[inline]
pub fn for_each_stoppable<P: Pieces>(
    watch: &mut dyn Watch,
    data: P,
    size: usize,
    long: bool,
    f: impl Fn(usize, P, &AtomicBool) + Sync,
) -> Result<(), Interrupted> {
    let here = !long && data.items() <= size;
    for_each_piece(watch, data, size, here, &f)
}

fn for_each_piece<P: Pieces>(
    watch: &mut dyn Watch,
    data: P,
    size: usize,
    here: bool,
    f: &(dyn Fn(usize, P, &AtomicBool) + Sync),
) -> Result<(), Interrupted> {
    let (n, size) = (data.items(), size.max(1));
    let mut pieces = Vec::with_capacity(n.div_ceil(size));
    let (mut rest, mut left) = (data, n);
    while left > size {
        let (piece, tail) = rest.cut(size);
        pieces.push(Mutex::new(Some(piece)));
        (rest, left) = (tail, left - size);
    }
    if left > 0 {
        pieces.push(Mutex::new(Some(rest.cut(left).0)));
    }
    run_tasks(watch, pieces.len(), here, &|i, stop| {
        let piece = pieces[i].lock().unwrap_or_else(PoisonError::into_inner).take();
        f(i * size, piece.expect("each piece is claimed once"), stop);
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    struct StopAt(usize);
    impl Watch for StopAt {
        fn tick(&mut self, done: usize, _: usize) -> ControlFlow<()> {
            if done >= self.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
    }

    #[test]
    fn every_item_is_visited_once_whatever_the_threads() {
        for threads in [1, 2, 5] {
            set_threads(threads);
            for n in [0usize, 1, 7, 1000] {
                let input: Vec<usize> = (0..n).collect();
                let mut out = vec![0usize; n];
                for_each(&mut Quiet, (&input[..], &mut out[..]), 13, |first, (a, b)| {
                    assert_eq!(a.first(), Some(&first));
                    b.iter_mut().zip(a).for_each(|(b, a)| *b += a + 1);
                })
                .unwrap();
                assert!(out.iter().enumerate().all(|(i, &v)| v == i + 1));
            }
        }
        set_threads(0);
    }

    #[test]
    fn work_inside_work_runs_where_it_is() {
        let total = AtomicUsize::new(0);
        run(&mut Quiet, 50, |_| {
            run(&mut Quiet, 20, |_| {
                total.fetch_add(1, Ordering::Relaxed);
            })
            .unwrap();
        })
        .unwrap();
        assert_eq!(total.into_inner(), 1000);
    }

    #[test]
    fn a_watch_stops_the_work() {
        let visited = AtomicUsize::new(0);
        let r = run(&mut StopAt(0), 1000, |_| {
            std::thread::sleep(Duration::from_millis(2));
            visited.fetch_add(1, Ordering::Relaxed);
        });
        assert_eq!(r, Err(Interrupted));
        assert!(visited.into_inner() < 1000);
    }
}

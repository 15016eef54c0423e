//! The layout of the tree: nodes of eight boxes, leaves that are runs of blocks, and the traversal stack.

use crate::real::{Lanes, Real};
use std::mem::MaybeUninit;

/// The width of a node.
pub const WIDTH: usize = 8;
/// Deepest level of a tree; the builder keeps to it.
pub const MAX_DEPTH: usize = 72;
/// At each level all children but one wait.
const STACK: usize = MAX_DEPTH * (WIDTH - 1) + 1 + WIDTH;

/// What a child slot refers to: a node, a run of blocks, or nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Child(pub u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const COUNT_SHIFT: u32 = 27;
    pub const EMPTY: Child = Child(u32::MAX);
    pub const ROOT: Child = Child(0);
    /// Blocks that a tree can hold, and that a leaf can.
    pub const MAX_BLOCKS: usize = 1 << Self::COUNT_SHIFT;
    pub const MAX_RUN: usize = 15;

    pub fn node(index: usize) -> Self {
        Child(index as u32)
    }
    pub fn leaf(first: usize, blocks: usize) -> Self {
        debug_assert!((1..=Self::MAX_RUN).contains(&blocks) && first + blocks <= Self::MAX_BLOCKS);
        Child(Self::LEAF | (blocks as u32) << Self::COUNT_SHIFT | first as u32)
    }
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }
    #[inline(always)]
    pub fn index(self) -> usize {
        self.0 as usize
    }
    /// First block and number of blocks.
    #[inline(always)]
    pub fn run(self) -> (usize, usize) {
        ((self.0 & ((1 << Self::COUNT_SHIFT) - 1)) as usize, (self.0 >> Self::COUNT_SHIFT & 15) as usize)
    }
}

/// Eight boxes. Empty slots have their planes at infinity the wrong way round, which no ray passes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Node<T> {
    /// `[lower, upper][axis][child]`.
    pub planes: [[[T; WIDTH]; 3]; 2],
    pub children: [Child; WIDTH],
    /// The slots that hold leaves, as bits: where the node's size leaves room.
    pub leaves: u32,
}

impl<T: Real> Node<T> {
    pub fn empty() -> Self {
        Node {
            planes: [[[T::INFINITY; WIDTH]; 3], [[-T::INFINITY; WIDTH]; 3]],
            children: [Child::EMPTY; WIDTH],
            leaves: 0,
        }
    }
    /// Eight planes by their place: the lower ones of the three axes, then the upper.
    ///
    /// # Safety
    /// `place` must be a multiple of [`WIDTH`] below six times it.
    #[inline(always)]
    pub unsafe fn planes_at(&self, place: usize) -> &[T; WIDTH] {
        debug_assert!(place.is_multiple_of(WIDTH) && place < 6 * WIDTH);
        // Sound: by the contract it lies within the planes.
        unsafe { &*(&raw const self.planes).cast::<T>().add(place).cast::<[T; WIDTH]>() }
    }
    pub fn set_child(&mut self, slot: usize, child: Child) {
        self.children[slot] = child;
        self.leaves |= (child.is_leaf() as u32) << slot;
    }
}

/// A waiting child with the place where the ray enters it, as one number: nearest is least.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(transparent)]
pub struct Entry(u64);

impl Entry {
    #[inline(always)]
    pub fn new<T: Real>(t: T, child: Child) -> Self {
        Entry((key(t) as u64) << 32 | child.0 as u64)
    }
    /// The `k`th of the children of a node in the order of [`SLOTS`], with entries that are not before zero.
    #[inline(always)]
    fn of<T: Real>(slots: u32, k: u32, node: &Node<T>, entries: &[T; WIDTH]) -> Self {
        let slot = (slots >> (3 * k)) as usize & (WIDTH - 1);
        Entry(((entries[slot].to_f64() as f32).to_bits() as u64) << 32 | node.children[slot].0 as u64)
    }
    #[inline(always)]
    pub fn child(self) -> Child {
        Child(self.0 as u32)
    }
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Entry(self.0.min(other.0))
    }
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Entry(self.0.max(other.0))
    }
    /// Whether it is entered after a `t` of this [`key`].
    #[inline(always)]
    pub fn after(self, key: u32) -> bool {
        (self.0 >> 32) as u32 > key
    }
}

/// An integer in the order of `t`, from zero on. Rounding to single precision keeps the order, as ties.
#[inline(always)]
pub fn key<T: Real>(t: T) -> u32 {
    // Clamped first, so that single precision never leaves its registers for double.
    (Lanes::max(t, T::zero()).to_f64() as f32).to_bits()
}

/// The places of the set bits of each number in rising order and then those of the others, three bits each; the number
/// of the set ones above.
static SLOTS: [u32; 256] = {
    let mut slots = [0; 256];
    let mut bits = 0;
    while bits < 256 {
        let mut k = 0;
        let mut set = 2;
        while set > 0 {
            set -= 1;
            let mut slot = 0;
            while slot < WIDTH {
                if bits >> slot & 1 == set {
                    slots[bits] |= (slot as u32) << (3 * k);
                    k += 1;
                }
                slot += 1;
            }
        }
        slots[bits] |= bits.count_ones() << 24;
        bits += 1;
    }
    slots
};

/// Children that wait, the nearest on top.
pub struct Stack {
    entries: [MaybeUninit<Entry>; STACK],
    len: usize,
}

impl Stack {
    #[inline(always)]
    #[allow(clippy::new_without_default)]
    pub fn new() -> Self {
        Stack { entries: [MaybeUninit::uninit(); STACK], len: 0 }
    }
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }
    #[inline(always)]
    pub fn clear(&mut self) {
        self.len = 0;
    }
    #[inline(always)]
    pub fn push(&mut self, e: Entry) {
        debug_assert!(self.len < STACK);
        // Sound: traversal replaces one entry by at most WIDTH children a level, and no tree is deeper than MAX_DEPTH.
        unsafe { self.entries.get_unchecked_mut(self.len).write(e) };
        self.len += 1;
    }
    #[inline(always)]
    pub fn pop(&mut self) -> Option<Entry> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        // Sound: every entry below `len` was written by `push` or `insert`.
        Some(unsafe { self.entries.get_unchecked(self.len).assume_init() })
    }
    /// Adds the children of a node that a ray passes, the nearest on top. Up to three of them, which is the rule,
    /// without a branch: how many there are and in which order could not be guessed. No entry is before zero, and those
    /// of the other children are infinite.
    #[inline(always)]
    pub fn add<T: Real>(&mut self, node: &Node<T>, bits: u32, entries: &[T; WIDTH]) {
        let (slots, base) = (SLOTS[bits as usize & 0xff], self.len);
        let number = slots >> 24;
        let first = Entry::of(slots, 0, node, entries);
        let second = Entry::of(slots, 1, node, entries);
        let third = Entry::of(slots, 2, node, entries);
        let (near, far) = (first.min(second), first.max(second));
        let (middle, last) = (far.min(third), far.max(third));
        let (near, middle) = (near.min(middle), near.max(middle));
        debug_assert!(base + WIDTH <= STACK);
        // Sound: as `push`; what is written beyond the length is within the room of a node.
        unsafe {
            let mut len = base;
            self.entries.get_unchecked_mut(len).write(last);
            len += (number > 2) as usize;
            self.entries.get_unchecked_mut(len).write(middle);
            len += (number > 1) as usize;
            self.entries.get_unchecked_mut(len).write(near);
            self.len = len + (number > 0) as usize;
        }
        for k in 3..number {
            self.insert(base, Entry::of(slots, k, node, entries));
        }
    }
    /// Puts `e` among the entries from `base` on, which are in falling order.
    #[inline(always)]
    pub fn insert(&mut self, base: usize, e: Entry) {
        let mut at = self.len;
        self.push(e);
        while at > base {
            // Sound: `at` is within what was pushed.
            let below = unsafe { self.entries.get_unchecked(at - 1).assume_init() };
            if below >= e {
                break;
            }
            // Sound: as above.
            unsafe { self.entries.get_unchecked_mut(at).write(below) };
            at -= 1;
        }
        // Sound: as above.
        unsafe { self.entries.get_unchecked_mut(at).write(e) };
    }
}

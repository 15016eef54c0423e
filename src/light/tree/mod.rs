//! Which of many lights to draw from at a point: evenly, by power, or by a tree of bounds of what each may bring.
//!
//! A node of the tree bounds where its lights are, the cone of their normals (half angle θo), how far from these they
//! shine (θe), and sums their power. At a point its importance is Φ cos θi' cos θ' / d², with each angle as small as the
//! bounds allow; a draw goes down by importance, so that lights that turn away, lie below the horizon or are far and
//! faint are hardly drawn, and those that cannot be seen are never. Lights without a place (sun, sky) stand beside the
//! tree, each as likely as all of the tree.
//!
//! A. Conty Estevez, C. Kulla, *Importance sampling of many lights with adaptive tree splitting*, 2018.

mod source;
mod split;

use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use crate::vec::Vec3;
pub use source::Source;
use source::{least, most};
use split::split;

#[derive(Clone, Copy, Debug)]
struct Node<T> {
    source: Source<T>,
    /// The second child (the first comes next), or the light itself.
    next: u32,
    leaf: bool,
}

/// A light and how likely it was.
#[derive(Clone, Copy, Debug)]
pub struct Choice<T> {
    pub light: usize,
    pub chance: T,
    /// What is left of the random number, again even in [0, 1).
    pub u: T,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Uniform,
    Power,
    Tree,
}

/// How lights are chosen at a point.
#[derive(Clone, Debug)]
pub struct Selection<T> {
    method: Method,
    count: usize,
    /// Sums of chances up to and with each light; in double, since differences of sums are chances.
    cumulative: Vec<f64>,
    nodes: Vec<Node<T>>,
    /// For each light the turns from the root to its leaf, lowest bit first; NOWHERE beside the tree.
    trails: Vec<u64>,
    /// The lights without a place.
    infinite: Vec<u32>,
}

const NOWHERE: u64 = u64::MAX;
/// The least share of lights that may shine: of one branch of two, or of all lights together.
const FAINTEST: f64 = 1.0 / 4096.0;

impl<T: Real> Selection<T> {
    /// Over sources in the order of their lights. Sources without power are never chosen, but evenly.
    pub fn new(method: Method, sources: &[Source<T>]) -> Self {
        let mut made = Selection {
            method,
            count: sources.len(),
            cumulative: Vec::new(),
            nodes: Vec::new(),
            trails: Vec::new(),
            infinite: Vec::new(),
        };
        match method {
            Method::Uniform => {}
            Method::Power => {
                let most = sources.iter().fold(0.0, |most, s| f64::max(most, s.power.to_f64()));
                let total: f64 = sources.iter().map(|s| s.power.to_f64() / most).sum();
                let floor = FAINTEST / sources.len() as f64;
                let mut sum = 0.0;
                for source in sources {
                    let share = source.power.to_f64() / most / total;
                    sum += if share > 0.0 { f64::max(share, floor) } else { 0.0 };
                    made.cumulative.push(sum);
                }
            }
            Method::Tree => {
                made.trails = vec![NOWHERE; sources.len()];
                let (mut placed, mut middles) = (Vec::new(), Vec::new());
                for (i, source) in sources.iter().enumerate() {
                    middles.push(source.middle());
                    if source.power > T::zero() {
                        if source.is_placed() { &mut placed } else { &mut made.infinite }.push(i as u32);
                    }
                }
                if !placed.is_empty() {
                    made.grow(sources, &middles, &mut placed, 0, 0);
                }
            }
        }
        made
    }

    /// Adds the tree over some lights; `trail` holds `depth` turns.
    fn grow(
        &mut self,
        sources: &[Source<T>],
        middles: &[Vec3<T>],
        lights: &mut [u32],
        trail: u64,
        depth: u32,
    ) -> Source<T> {
        let at = self.nodes.len();
        if let [light] = *lights {
            let source = sources[light as usize];
            self.nodes.push(Node { source, next: light, leaf: true });
            self.trails[light as usize] = trail;
            return source;
        }
        let cut = split(sources, middles, lights, depth);
        let (first, second) = lights.split_at_mut(cut);
        self.nodes.push(Node { source: sources[first[0] as usize], next: 0, leaf: false });
        let a = self.grow(sources, middles, first, trail, depth + 1);
        self.nodes[at].next = self.nodes.len() as u32;
        let b = self.grow(sources, middles, second, trail | 1 << depth, depth + 1);
        self.nodes[at].source = a.with(&b);
        self.nodes[at].source
    }

    /// The chance of the tree beside the lights without a place.
    #[inline(always)]
    fn chance_of_tree(&self) -> T {
        let choices = self.infinite.len() + usize::from(!self.nodes.is_empty());
        if self.nodes.is_empty() { T::zero() } else { T::one() / T::of(choices as f64) }
    }

    /// The importance of a node's children, as shares; None if neither counts.
    #[inline(always)]
    fn shares(&self, at: usize, point: Vec3<T>, normal: Option<Vec3<T>>) -> Option<(usize, T)> {
        let second = self.nodes[at].next as usize;
        let [a, b] = [at + 1, second].map(|i| self.nodes[i].source.importance(point, normal));
        let mut share = a / (a + b);
        // Bounds say what lights may bring, not what they do: none that may bring something is as good as left out.
        if a > T::zero() && b > T::zero() {
            let floor = T::of(FAINTEST);
            share = least(most(share, floor), T::one() - floor);
        }
        // Neither, or an overflow.
        (share >= T::zero() && share <= T::one()).then_some((second, share))
    }

    /// A light for the point, if any may shine there; `u` in [0, 1).
    #[inline(always)]
    pub fn draw(&self, point: Vec3<T>, normal: Option<Vec3<T>>, u: T) -> Option<Choice<T>> {
        let (one, below_one) = (T::one(), T::one().next_down());
        let even = |count: usize| {
            let n = T::of(count as f64);
            let at = least((u * n).floor(), n - one);
            (at.to_f64() as usize, one / n, least(u * n - at, below_one))
        };
        match self.method {
            Method::Uniform => {
                let (light, chance, u) = (self.count > 0).then(|| even(self.count))?;
                Some(Choice { light, chance, u })
            }
            Method::Power => {
                let total = *self.cumulative.last()?;
                let goal = u.to_f64() * total;
                let light = self.cumulative.partition_point(|&c| c <= goal);
                let end = *self.cumulative.get(light)?;
                let start = if light == 0 { 0.0 } else { self.cumulative[light - 1] };
                let left = least(T::of((goal - start) / (end - start)), below_one);
                Some(Choice { light, chance: T::of((end - start) / total), u: left })
            }
            Method::Tree => {
                let of_tree = self.chance_of_tree();
                let mut u = u;
                if !self.infinite.is_empty() {
                    let (k, chance, rest) = even(self.infinite.len() + usize::from(!self.nodes.is_empty()));
                    if let Some(&light) = self.infinite.get(k) {
                        return Some(Choice { light: light as usize, chance, u: rest });
                    }
                    u = rest;
                }
                let (mut at, mut chance) = (0, of_tree);
                while !self.nodes.get(at)?.leaf {
                    let (second, share) = self.shares(at, point, normal)?;
                    if u < share {
                        (at, chance, u) = (at + 1, chance * share, u / share);
                    } else {
                        (at, chance, u) = (second, chance * (one - share), (u - share) / (one - share));
                    }
                    u = least(u, below_one);
                }
                (chance > T::zero()).then(|| Choice { light: self.nodes[at].next as usize, chance, u })
            }
        }
    }

    /// The chance with which [`Selection::draw`] gives a light.
    #[inline(always)]
    pub fn chance(&self, point: Vec3<T>, normal: Option<Vec3<T>>, light: usize) -> T {
        let (zero, one) = (T::zero(), T::one());
        match self.method {
            Method::Uniform => one / T::of(self.count as f64),
            Method::Power => {
                let start = if light == 0 { 0.0 } else { self.cumulative[light - 1] };
                let total = self.cumulative[self.count - 1];
                if total > 0.0 { T::of((self.cumulative[light] - start) / total) } else { zero }
            }
            Method::Tree => {
                let mut trail = self.trails[light];
                if trail == NOWHERE {
                    let choices = self.infinite.len() + usize::from(!self.nodes.is_empty());
                    let there = self.infinite.binary_search(&(light as u32)).is_ok();
                    return if there { one / T::of(choices as f64) } else { zero };
                }
                let (mut at, mut chance) = (0, self.chance_of_tree());
                while !self.nodes[at].leaf {
                    let Some((second, share)) = self.shares(at, point, normal) else { return zero };
                    if trail & 1 == 0 {
                        (at, chance) = (at + 1, chance * share);
                    } else {
                        (at, chance) = (second, chance * (one - share));
                    }
                    trail >>= 1;
                }
                chance
            }
        }
    }
}

/// [`Selection::draw`] at points with unit normals (zero: no surface): lights and chances; −1 and 0 where none may
/// shine.
pub fn select_many<T: Real>(
    watch: &mut dyn Watch,
    selection: &Selection<T>,
    points: &[[T; 3]],
    normals: &[[T; 3]],
    u: &[T],
    light: &mut [i32],
    chance: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (points, normals, u, light, chance),
        1 << 12,
        |_, (points, normals, u, light, chance)| {
            dispatch!(_s => {
                for i in 0..points.len() {
                    let (point, normal) = (Vec3::from(points[i]), Vec3::from(normals[i]));
                    let inside = u[i] >= T::zero() && u[i] < T::one();
                    let nan = if inside { (point + normal).dot(Vec3::splat(T::zero())) } else { T::NAN };
                    let normal = (normal != Vec3::splat(T::zero())).then_some(normal);
                    let choice = if nan.is_nan() { None } else { selection.draw(point, normal, u[i]) };
                    (light[i], chance[i]) = choice.map_or((-1, nan), |c| (c.light as i32, c.chance));
                }
            })
        },
    )
}

/// [`Selection::chance`] over arrays of equal length; lights are in range.
pub fn chance_many<T: Real>(
    watch: &mut dyn Watch,
    selection: &Selection<T>,
    points: &[[T; 3]],
    normals: &[[T; 3]],
    light: &[i32],
    chance: &mut [T],
) -> Result<(), Interrupted> {
    parallel::for_each(
        watch,
        (points, normals, light, chance),
        1 << 12,
        |_, (points, normals, light, chance)| {
            dispatch!(_s => {
                for i in 0..points.len() {
                    let (point, normal) = (Vec3::from(points[i]), Vec3::from(normals[i]));
                    let nan = (point + normal).dot(Vec3::splat(T::zero()));
                    let normal = (normal != Vec3::splat(T::zero())).then_some(normal);
                    chance[i] = nan + selection.chance(point, normal, light[i] as usize);
                }
            })
        },
    )
}

//! Path tracing: every light path up to a number of reflections, by chance, without bias.
//!
//! At each surface lights are asked directly (next-event estimation), and the path goes on in a direction of the
//! material. Area lights and emitting faces can be reached in both ways, which the power heuristic weighs; or one way
//! alone is taken. Paths that carry little end by Russian roulette. Lights of some size are seen from the side that
//! shines, and stop there paths and the light of others; from behind they are not there. Surfaces have two sides.
//! Random numbers come from pixel, sample and seed alone.
//!
//! Paths of a square of pixels run together as a wave: the camera's rays of a pixel and its neighbours are traced
//! in packets, later ones in one batch a depth, and diffusers are shaded eight at a time.
//!
//! J. T. Kajiya, *The rendering equation*, 1986; E. Veach, *Robust Monte Carlo methods for light transport
//! simulation*, 1997, chapters 9 and 10.

use super::Surfaces;
use super::camera::Camera;
use super::draws::Draws;
use super::eye;
use super::film::Tally;
use super::filter::Filter;
use super::lighting::{Lighting, Selection};
use super::wave::{Tracer, Wave};
use crate::brdf::Bsdf;
use crate::brdf::Row;
use crate::dispatch;
use crate::parallel::{self, Interrupted, Watch};
use crate::raster::picture::Picture;
use crate::real::Real;
use crate::sampling::sampler::Sampler;
use crate::simd::Simd;
use crate::vec::Vec3;

/// How light is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strategy {
    /// Directions evenly over the hemisphere; only beams are asked for directly.
    Uniform,
    /// Directions of the material; only beams are asked for directly.
    Bsdf,
    /// Lights are asked; what directions find counts only where lights could not be asked.
    Light,
    /// Both, weighed.
    Mis,
}

impl Strategy {
    #[inline(always)]
    pub fn asks_lights(self) -> bool {
        matches!(self, Strategy::Light | Strategy::Mis)
    }
}

/// How a picture is sampled.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Of the picture.
    pub width: usize,
    /// Samples `start` … `start + samples` of every pixel.
    pub samples: u32,
    pub start: u32,
    /// The most reflections of a path; 0 shows emission alone, 1 direct light.
    pub max_depth: u32,
    /// Reflections before paths may end by chance.
    pub roulette: u32,
    pub seed: u64,
    pub strategy: Strategy,
    pub sampler: Sampler,
    /// The sample that is the sampler's first.
    pub base: u32,
    pub selection: Selection,
    /// Samples whose largest channel exceeds this are scaled down to it.
    pub clamp: f64,
}

/// Where the samples of a picture, or of some pixels, go.
pub struct Film<'a, T> {
    pub mean: &'a mut [[T; 3]],
    /// Of the mean.
    pub variance: &'a mut [[T; 3]],
    /// How many samples outweighed all before them.
    pub outliers: Option<&'a mut [i32]>,
    /// Mean of what clamping took away.
    pub removed: Option<&'a mut [[T; 3]]>,
}

/// Paths a wave: its queues stay in the processor's own cache.
const WAVE: usize = 1 << 11;
/// Paths a task, if pixels have fewer samples: some milliseconds' worth.
const TASK: usize = 1 << 13;
/// Samples of a pixel that are taken without looking up; more are taken in several passes.
const PASS: u32 = 1 << 14;

/// The squares of pixels that tasks take, of a picture or of a list.
struct Tiles<'a> {
    width: usize,
    height: usize,
    /// Pixels a side.
    side: [usize; 2],
    columns: usize,
    /// The pixels, if they are not those of the picture in their order.
    list: Option<&'a [i32]>,
}

impl<'a> Tiles<'a> {
    fn new(width: usize, count: usize, list: Option<&'a [i32]>, samples: u32) -> Self {
        let (width, height) =
            if list.is_some() { (count.max(1), count.min(1)) } else { (width, count / width.max(1)) };
        let pixels = (TASK / samples.max(1) as usize).clamp(1, TASK);
        let log = pixels.ilog2();
        let side = if list.is_some() { [pixels, 1] } else { [1 << log.div_ceil(2), 1 << (log / 2)] };
        Tiles { width, height, side, columns: width.div_ceil(side[0]), list }
    }
    fn count(&self) -> usize {
        self.columns * self.height.div_ceil(self.side[1])
    }
    /// The first pixel of a tile, and its sides, cut at the border of the picture.
    fn place(&self, i: usize) -> ([usize; 2], [usize; 2]) {
        let first = [i % self.columns * self.side[0], i / self.columns * self.side[1]];
        (first, [self.side[0].min(self.width - first[0]), self.side[1].min(self.height - first[1])])
    }
    /// The number in the picture, the column and the row of the pixel at a place.
    #[inline(always)]
    fn pixel(&self, x: usize, y: usize, width: usize) -> (usize, [u32; 2]) {
        match self.list {
            Some(list) => {
                let pixel = list[x] as usize;
                (pixel, [(pixel % width) as u32, (pixel / width) as u32])
            }
            // The picture's own width.
            None => (y * self.width + x, [x as u32, y as u32]),
        }
    }
}

/// Pictures that tiles write into.
struct Sheets<'a, T> {
    mean: Picture<'a, [T; 3]>,
    variance: Picture<'a, [T; 3]>,
    outliers: Option<Picture<'a, i32>>,
    removed: Option<Picture<'a, [T; 3]>>,
    /// Of all passes so far, if there are several.
    kept: Option<Picture<'a, Tally>>,
}

impl<T: Real> Sheets<'_, T> {
    /// # Safety
    /// The pixel must not be in use elsewhere.
    #[inline(always)]
    unsafe fn put(&self, x: usize, y: usize, tally: &Tally) {
        // Sound: as the caller promises.
        unsafe {
            self.mean.row(x, y, 1)[0] = narrow(tally.mean);
            self.variance.row(x, y, 1)[0] = narrow(tally.variance());
            if let Some(outliers) = &self.outliers {
                outliers.row(x, y, 1)[0] = tally.outliers as i32;
            }
            if let Some(removed) = &self.removed {
                removed.row(x, y, 1)[0] = narrow(tally.removed);
            }
        }
    }
    /// The only sample of a pixel, as [`Sheets::put`] puts its tally.
    ///
    /// # Safety
    /// The pixel must not be in use elsewhere.
    #[inline(always)]
    unsafe fn put_lone(&self, x: usize, y: usize, sum: Vec3<T>) {
        // Sound: as the caller promises.
        unsafe {
            self.mean.row(x, y, 1)[0] = sum.to_array();
            self.variance.row(x, y, 1)[0] = [T::INFINITY; 3];
            if let Some(outliers) = &self.outliers {
                outliers.row(x, y, 1)[0] = 0;
            }
            if let Some(removed) = &self.removed {
                removed.row(x, y, 1)[0] = [T::zero(); 3];
            }
        }
    }
}

#[inline(always)]
fn narrow<T: Real>([a, b, c]: [f64; 3]) -> [T; 3] {
    [T::of(a), T::of(b), T::of(c)]
}

/// Whether a material is Lambert's diffuser, of the albedo with which its row begins.
fn is_diffuse<T: Real>(kind: i32, row: &Row<T>) -> bool {
    match Bsdf::of(kind, row) {
        Some(Bsdf::Diffuse(_)) => true,
        Some(Bsdf::MetallicRoughness(lobes)) => {
            !lobes.is_specular() && lobes.diffuse.to_array() == [row[0], row[1], row[2]]
        }
        _ => false,
    }
}

/// Mean radiance of each pixel of the picture, row by row, or of each in a list, and the variance of that mean.
pub fn path_trace<T: Real>(
    watch: &mut dyn Watch,
    scene: &Surfaces<'_, T>,
    camera: &Camera<T>,
    filter: &Filter,
    options: Options,
    pixels: Option<&[i32]>,
    film: Film<'_, T>,
) -> Result<(), Interrupted> {
    let lighting = Lighting::new(scene, options.selection);
    let diffuse: Vec<bool> =
        scene.kinds.iter().zip(scene.rows).map(|(&kind, row)| is_diffuse(kind, row)).collect();
    let draws = Draws::new(options.sampler, options.seed);
    let count = film.mean.len();
    let passes = options.samples.div_ceil(PASS);
    let mut kept = vec![Tally::EMPTY; if passes > 1 { count } else { 0 }];
    let Tiles { width, height, .. } = Tiles::new(options.width, count, pixels, 1);
    let sheets = Sheets {
        mean: Picture::new(film.mean, width, height),
        variance: Picture::new(film.variance, width, height),
        outliers: film.outliers.map(|o| Picture::new(o, width, height)),
        removed: film.removed.map(|r| Picture::new(r, width, height)),
        kept: (passes > 1).then(|| Picture::new(&mut kept, width, height)),
    };
    for pass in 0..passes {
        let done = pass * PASS;
        let samples = PASS.min(options.samples - done);
        let options = Options { start: options.start + done, samples, ..options };
        let tracer = Tracer { scene, lighting: &lighting, diffuse: &diffuse, draws, options };
        let tiles = Tiles::new(options.width, count, pixels, samples);
        parallel::run(
            watch,
            tiles.count(),
            |i| dispatch!(s => tile(s, &tracer, camera, filter, &tiles, tiles.place(i), &sheets)),
        )?;
    }
    Ok(())
}

/// All samples of the pixels of a tile, in waves.
#[inline(always)]
fn tile<T: Real, S: Simd>(
    s: S,
    tracer: &Tracer<'_, T>,
    camera: &Camera<T>,
    filter: &Filter,
    tiles: &Tiles<'_>,
    (first, side): ([usize; 2], [usize; 2]),
    sheets: &Sheets<'_, T>,
) {
    let options = tracer.options;
    let mut wave = Wave::new(WAVE);
    let mut places: Vec<[u32; 2]> = Vec::with_capacity(WAVE);
    // Of samples so far, where pixels have more than a wave takes.
    let mut tallies: Vec<Tally> = Vec::new();
    let pixels = side[0] * side[1];
    // Samples of each pixel, pixels of each wave.
    let each = (WAVE / pixels).clamp(1, options.samples as usize) as u32;
    let group = (WAVE / each as usize).clamp(1, pixels);
    let order = order(side);
    for some in order.chunks(group) {
        tallies.clear();
        for start in (0..options.samples).step_by(each as usize) {
            let count = each.min(options.samples - start);
            wave.clear();
            places.clear();
            let begin = (options.start + start).wrapping_sub(options.base);
            for &[x, y] in some {
                let (pixel, place) = tiles.pixel(first[0] + x as usize, first[1] + y as usize, options.width);
                let key = tracer.draws.key(pixel as u32);
                for k in 0..count {
                    wave.keys.push(key);
                    wave.samples.push(begin.wrapping_add(k));
                    places.push(place);
                }
            }
            eye::start(s, tracer, camera, filter, &places, &mut wave);
            tracer.trace(s, &mut wave);
            if options.samples == 1 && sheets.kept.is_none() && options.clamp == f64::INFINITY {
                for k in 0..some.len() {
                    let (x, y) = (first[0] + some[k][0] as usize, first[1] + some[k][1] as usize);
                    // Sound: as below.
                    unsafe { sheets.put_lone(x, y, wave.sums[k]) };
                }
                continue;
            }
            for (k, sums) in wave.sums.chunks(count as usize).enumerate() {
                let mut tally = if start == 0 { Tally::EMPTY } else { tallies[k] };
                for &sum in sums {
                    tally.add_clamped(sum, options.clamp);
                }
                if start + count < options.samples {
                    if start == 0 {
                        tallies.push(tally);
                    } else {
                        tallies[k] = tally;
                    }
                    continue;
                }
                let (x, y) = (first[0] + some[k][0] as usize, first[1] + some[k][1] as usize);
                // Sound: tiles do not overlap, nor do the pixels of one.
                unsafe {
                    if let Some(kept) = &sheets.kept {
                        let all = &mut kept.row(x, y, 1)[0];
                        all.merge(&tally);
                        tally = *all;
                    }
                    sheets.put(x, y, &tally);
                }
            }
        }
    }
}

/// The pixels of a tile, neighbours on both axes close together: squares of four by four, in squares of eight, and so
/// on, that a wave sees as little of the scene as it can.
fn order([width, height]: [usize; 2]) -> Vec<[u16; 2]> {
    const LARGEST: usize = 64;
    let mut order = Vec::with_capacity(width * height);
    for y in (0..height).step_by(LARGEST) {
        for x in (0..width).step_by(LARGEST) {
            square(&mut order, [x, y], [width, height], LARGEST);
        }
    }
    order
}

/// Adds the part of a square within the tile, a quarter after the other.
fn square(order: &mut Vec<[u16; 2]>, [x, y]: [usize; 2], within: [usize; 2], size: usize) {
    if x >= within[0] || y >= within[1] {
        return;
    }
    if size > 4 {
        let half = size / 2;
        for [u, v] in [[x, y], [x + half, y], [x, y + half], [x + half, y + half]] {
            square(order, [u, v], within, half);
        }
        return;
    }
    for v in y..within[1].min(y + size) {
        for u in x..within[0].min(x + size) {
            order.push([u as u16, v as u16]);
        }
    }
}

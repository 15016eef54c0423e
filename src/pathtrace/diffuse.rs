//! The commonest surface, Lambert's diffuser, eight at a time.
//!
//! The same arithmetic as for other materials, in lanes.

use super::lighting::weight;
use super::path_trace::Strategy;
use super::sky::CANDIDATES;
use super::surface::{Facing, between};
use super::wave::{Path, Tracer, Wave, purpose, uniform_hemisphere};
use crate::accel::Ray;
use crate::light::rect::Rect;
use crate::light::{Arrival, Light};
use crate::math;
use crate::real::{Lanes, Real};
use crate::simd::{Simd, SimdBase};
use crate::transform::orthonormal_basis::Frame;
use crate::vec::Vec3;

/// Eight vectors, by component.
type Columns<T> = [[T; 8]; 3];

#[inline(always)]
pub fn load<T: Real, S: Simd>(s: S, x: &[T; 8]) -> T::V8<S> {
    SimdBase::load_array_ref(s, x)
}

#[inline(always)]
fn load3<T: Real, S: Simd>(s: S, c: &Columns<T>) -> Vec3<T::V8<S>> {
    Vec3::new(load(s, &c[0]), load(s, &c[1]), load(s, &c[2]))
}

/// Lane by lane, into columns.
#[inline(always)]
fn columns<T: Real>(of: impl Fn(usize) -> [T; 3]) -> Columns<T> {
    let mut out = [[T::zero(); 8]; 3];
    for l in 0..8 {
        let v = of(l);
        (out[0][l], out[1][l], out[2][l]) = (v[0], v[1], v[2]);
    }
    out
}

#[inline(always)]
pub fn gather<T: Real, S: Simd>(s: S, of: impl Fn(usize) -> [T; 3]) -> Vec3<T::V8<S>> {
    load3(s, &columns(of))
}

/// What stands at the corners of eight faces.
#[inline(always)]
fn vertices<T: Real, S: Simd>(s: S, of: impl Fn(usize) -> [[T; 3]; 3]) -> [Vec3<T::V8<S>>; 3] {
    let (mut a, mut b, mut c) = ([[T::zero(); 8]; 3], [[T::zero(); 8]; 3], [[T::zero(); 8]; 3]);
    for l in 0..8 {
        let [x, y, z] = of(l);
        for m in 0..3 {
            (a[m][l], b[m][l], c[m][l]) = (x[m], y[m], z[m]);
        }
    }
    [load3(s, &a), load3(s, &b), load3(s, &c)]
}

#[inline(always)]
fn store<T: Real, S: Simd>(v: Vec3<T::V8<S>>) -> Columns<T> {
    [v.x.to_array(), v.y.to_array(), v.z.to_array()]
}

#[inline(always)]
fn row<T: Copy>(c: &Columns<T>, l: usize) -> [T; 3] {
    [c[0][l], c[1][l], c[2][l]]
}

/// Eight surfaces.
pub struct Group<V> {
    point: Vec3<V>,
    pub normal: Vec3<V>,
    pub frame: Frame<V>,
    albedo: Vec3<V>,
    /// What the paths carry to here.
    carried: Vec3<V>,
    scale: V,
    /// Where rays start, off the surface.
    start: Vec3<V>,
    pub keys: [u32; 8],
    pub samples: [u32; 8],
    slots: [u32; 8],
    /// Lanes that hold a surface, as bits.
    full: u32,
}

/// Light that arrives at eight surfaces.
pub struct Arrivals<V> {
    pub wi: Vec3<V>,
    pub distance: V,
    pub value: Vec3<V>,
    pub pdf: V,
    /// Lanes to which light comes, as bits.
    pub seen: u32,
}

/// Asks lights at all surfaces of the queue, and lets paths go on.
#[inline(always)]
pub fn shade<T: Real, S: Simd>(s: S, tracer: &Tracer<'_, T>, wave: &mut Wave<T>, queue: &[u32], depth: u32) {
    for chunk in queue.chunks(8) {
        let group = meet(s, tracer, wave, chunk);
        ask_lights(s, tracer, wave, &group, depth);
        go_on(s, tracer, wave, &group, depth);
    }
}

/// The surfaces that a group of paths met.
#[inline(always)]
fn meet<T: Real, S: Simd>(s: S, tracer: &Tracer<'_, T>, wave: &Wave<T>, chunk: &[u32]) -> Group<T::V8<S>> {
    let scene = tracer.scene;
    // The last lane fills those that are left over.
    let mut index = [chunk[chunk.len() - 1] as usize; 8];
    for l in 0..chunk.len() {
        index[l] = chunk[l] as usize;
    }
    let (mut faces, mut copies, mut slots) = ([0usize; 8], [-1i32; 8], [0u32; 8]);
    let (mut keys, mut samples) = ([0u32; 8], [0u32; 8]);
    let (mut u, mut v, mut scale) = ([T::zero(); 8], [T::zero(); 8], [T::one(); 8]);
    for l in 0..8 {
        let hit = &wave.hits[index[l]];
        (faces[l], u[l], v[l]) = (hit.face as usize, hit.u, hit.v);
        copies[l] = wave.copy(index[l]);
        (slots[l], scale[l]) = (wave.paths[index[l]].slot, wave.paths[index[l]].scale);
        (keys[l], samples[l]) = (wave.keys[slots[l] as usize], wave.samples[slots[l] as usize]);
    }
    let (u, v) = (load::<T, S>(s, &u), load::<T, S>(s, &v));
    let direction = gather::<T, S>(
        s,
        #[inline(always)]
        |l| wave.rays[index[l]].direction,
    );
    let corners = vertices::<T, S>(
        s,
        #[inline(always)]
        |l| scene.corners_of(faces[l], copies[l]),
    );
    let mut shading = None;
    if let Some(normals) = scene.normals {
        shading = Some(vertices::<T, S>(
            s,
            #[inline(always)]
            |l| scene.normals_of(faces[l], copies[l], normals),
        ));
    }
    let facing = Facing::of(corners, shading, u, v, direction);
    let mut albedo = gather::<T, S>(
        s,
        #[inline(always)]
        |l| {
            let row = &scene.rows[scene.row_of(faces[l], copies[l])];
            [row[0], row[1], row[2]]
        },
    );
    if let Some(colors) = scene.colors {
        let colors = vertices::<T, S>(
            s,
            #[inline(always)]
            |l| scene.colors_of(faces[l], copies[l], colors),
        );
        albedo = albedo.times(between(colors, u, v));
    }
    let carried = gather::<T, S>(
        s,
        #[inline(always)]
        |l| wave.paths[index[l]].carried.to_array(),
    );
    let solid = T::V8::<S>::bits(facing.normal.x.equal(facing.normal.x));
    Group {
        point: facing.point,
        normal: facing.normal,
        frame: Frame::about(facing.shading),
        albedo,
        carried,
        scale: load(s, &scale),
        start: facing.point + facing.normal * u.like(scene.offset),
        keys,
        samples,
        slots,
        full: solid & ((1u32 << chunk.len()) - 1),
    }
}

/// Shadow rays to the lights.
#[inline(always)]
fn ask_lights<T: Real, S: Simd>(
    s: S,
    tracer: &Tracer<'_, T>,
    wave: &mut Wave<T>,
    group: &Group<T::V8<S>>,
    depth: u32,
) {
    let lighting = tracer.lighting;
    let all = lighting.asks_all(depth);
    let (mut sources, mut chances) = ([0usize; 8], [T::one(); 8]);
    let (mut pick, mut asked) = ([T::zero(); 8], 0xff);
    if lighting.chooses(depth) {
        let pair = tracer.draws.pairs::<T>(&group.keys, &group.samples, tracer.pair(depth, purpose::SOURCE));
        pick = pair[1];
        if !all {
            let (from, normal) = (store::<T, S>(group.start), store::<T, S>(group.frame.z));
            for l in 0..8 {
                match lighting.draw(row(&from, l).into(), row(&normal, l).into(), pair[0][l]) {
                    Some(drawn) => (sources[l], chances[l]) = drawn,
                    None => asked &= !(1 << l),
                }
            }
        }
    }
    let count = if all { lighting.sources() } else { 1 };
    for k in 0..count {
        if all {
            sources = [k; 8];
        }
        let pair = tracer.pair(depth, purpose::LIGHT + k as u32);
        let mut light = arrivals(s, tracer, group, &sources, &pick, pair, &chances);
        light.seen &= asked;
        cast::<T, S>(tracer, wave, group, &light, &sources, load(s, &chances));
    }
}

/// One draw from a source for each surface.
#[inline(always)]
fn arrivals<T: Real, S: Simd>(
    s: S,
    tracer: &Tracer<'_, T>,
    group: &Group<T::V8<S>>,
    sources: &[usize; 8],
    pick: &[T; 8],
    pair: u32,
    chances: &[T; 8],
) -> Arrivals<T::V8<S>> {
    let scene = tracer.scene;
    let mut alike = true;
    for l in 1..8 {
        alike &= sources[l] == sources[0];
    }
    if let Some(sky) = scene.environment
        && alike
        && sources[0] == tracer.lighting.sky()
    {
        return tracer.ask_sky(s, sky, group, pair, pick, load::<T, S>(s, chances));
    }
    let u = tracer.draws.pairs::<T>(&group.keys, &group.samples, pair);
    if let Some(Light::Rect(rect)) = scene.lights.get(sources[0])
        && alike
    {
        return of_rect(rect, group, load::<T, S>(s, &u[0]), load::<T, S>(s, &u[1]));
    }
    let zero = T::zero();
    let mut out =
        [Arrival { wi: Vec3::splat(zero), distance: zero, value: Vec3::splat(zero), pdf: T::INFINITY }; 8];
    let mut seen = 0;
    let points = store::<T, S>(group.point);
    for l in 0..8 {
        let light =
            scene.arrival(tracer.lighting, sources[l], row(&points, l).into(), pick[l], [u[0][l], u[1][l]]);
        if group.full >> l & 1 == 1
            && let Some(light) = light
        {
            (out[l], seen) = (light, seen | 1 << l);
            if scene.environment.is_some() && sources[l] == tracer.lighting.sky() {
                // Weighed as one of several, though it is the only one.
                out[l].pdf *= T::of(f64::from(CANDIDATES));
            }
        }
    }
    let (mut distance, mut pdf) = ([zero; 8], [zero; 8]);
    for l in 0..8 {
        (distance[l], pdf[l]) = (out[l].distance, out[l].pdf);
    }
    Arrivals {
        wi: gather::<T, S>(
            s,
            #[inline(always)]
            |l| out[l].wi.to_array(),
        ),
        distance: load::<T, S>(s, &distance),
        value: gather::<T, S>(
            s,
            #[inline(always)]
            |l| out[l].value.to_array(),
        ),
        pdf: load::<T, S>(s, &pdf),
        seen,
    }
}

/// The same vector in every lane.
#[inline(always)]
pub fn splat<V: Lanes>(like: V, x: Vec3<V::Elem>) -> Vec3<V> {
    Vec3::new(like.like(x.x), like.like(x.y), like.like(x.z))
}

/// [`Rect::sample`] in lanes.
#[inline(always)]
fn of_rect<V: Lanes>(rect: &Rect<V::Elem>, group: &Group<V>, u: V, v: V) -> Arrivals<V> {
    let half = u.num(0.5);
    let to = splat(u, rect.center) + splat(u, rect.edge_u) * (u - half) + splat(u, rect.edge_v) * (v - half)
        - group.point;
    let wi = to.normalize();
    let distance = to.dot(wi);
    let cos_light = -wi.dot(splat(u, rect.normal));
    let pdf = distance * (distance / (u.like(rect.area) * cos_light.abs()));
    let zero = u.num(0.0);
    let mut shines = zero.less(cos_light);
    if rect.two_sided {
        shines = shines | cos_light.less(zero);
    }
    let seen = V::bits(shines & zero.less(pdf));
    Arrivals { wi, distance, value: splat(u, rect.radiance) * (u.num(1.0) / pdf), pdf, seen }
}

/// Shadow rays with what they carry.
#[inline(always)]
fn cast<T: Real, S: Simd>(
    tracer: &Tracer<'_, T>,
    wave: &mut Wave<T>,
    group: &Group<T::V8<S>>,
    light: &Arrivals<T::V8<S>>,
    sources: &[usize; 8],
    chance: T::V8<S>,
) {
    let (zero, one) = (light.pdf.num(0.0), light.pdf.num(1.0));
    let cos = light.wi.dot(group.frame.z);
    let above = zero.less(cos) & zero.less(light.wi.dot(group.normal));
    let beam = light.pdf.equal(one.like(T::INFINITY));
    let mut rays = light.seen & group.full & T::V8::<S>::bits(above);
    let strategy = tracer.options.strategy;
    if !strategy.asks_lights() {
        rays &= T::V8::<S>::bits(beam);
    }
    if rays == 0 {
        return;
    }
    let inverse_pi = one / one.like(T::PI);
    let direction_pdf = cos * inverse_pi;
    let mut share = one / chance;
    if strategy == Strategy::Mis {
        share = Lanes::select(beam, share, weight(light.pdf * chance, direction_pdf) / chance);
    }
    let value = group.carried.times(group.albedo).times(light.value) * (direction_pdf * share);
    let (value, wi, start) = (store::<T, S>(value), store::<T, S>(light.wi), store::<T, S>(group.start));
    let distance = light.distance.to_array();
    while rays != 0 {
        let l = rays.trailing_zeros() as usize & 7;
        rays &= rays - 1;
        wave.shadow_rays.push(Ray {
            origin: row(&start, l),
            direction: row(&wi, l),
            t_min: T::zero(),
            t_max: distance[l],
            ignore_face: -1,
        });
        wave.carried.push((row(&value, l).into(), group.slots[l], sources[l] as u32));
    }
}

/// The next directions.
#[inline(always)]
fn go_on<T: Real, S: Simd>(
    s: S,
    tracer: &Tracer<'_, T>,
    wave: &mut Wave<T>,
    group: &Group<T::V8<S>>,
    depth: u32,
) {
    let u = tracer.draws.pairs::<T>(&group.keys, &group.samples, tracer.pair(depth, purpose::DIRECTION));
    let (u, v) = (load::<T, S>(s, &u[0]), load::<T, S>(s, &u[1]));
    let (zero, one) = (u.num(0.0), u.num(1.0));
    let uniform = tracer.options.strategy == Strategy::Uniform;
    let wi = if uniform { uniform_hemisphere(u, v) } else { cosine_hemisphere(u, v) };
    let out = group.frame.world(wi);
    let cosine_pdf = wi.z * (one / u.like(T::PI));
    let (mut carried, mut pdf) = (group.carried.times(group.albedo), cosine_pdf);
    if uniform {
        pdf = u.num(0.5) / u.like(T::PI);
        carried = carried * (cosine_pdf / pdf);
    }
    let survival = tracer.survival(carried * group.scale, depth);
    let mut alive = zero.less(pdf) & zero.less(wi.z) & zero.less(out.dot(group.normal)) & zero.less(survival);
    if depth >= tracer.options.roulette {
        let pair = tracer.pair(depth, purpose::CHOICE);
        let fate = tracer.draws.pairs::<T>(&group.keys, &group.samples, pair);
        alive = alive & load::<T, S>(s, &fate[1]).less(survival);
        carried = carried * (one / survival);
    }
    let mut rays = T::V8::<S>::bits(alive) & group.full;
    let (carried, out) = (store::<T, S>(carried), store::<T, S>(out));
    let normal = store::<T, S>(group.frame.z);
    let (start, pdf, scale) = (store::<T, S>(group.start), pdf.to_array(), group.scale.to_array());
    while rays != 0 {
        let l = rays.trailing_zeros() as usize & 7;
        rays &= rays - 1;
        wave.next_rays.push(Ray::new(row(&start, l), row(&out, l)));
        let carried = row(&carried, l).into();
        let normal = row(&normal, l).into();
        wave.next_paths.push(Path { slot: group.slots[l], carried, pdf: pdf[l], scale: scale[l], normal });
    }
}

/// The concentric disk raised to the hemisphere about z.
#[inline(always)]
fn cosine_hemisphere<V: Lanes>(u: V, v: V) -> Vec3<V> {
    let (zero, one, two) = (u.num(0.0), u.num(1.0), u.num(2.0));
    let (a, b) = (two * u - one, two * v - one);
    let wide = b.abs().less(a.abs());
    let (r, other) = (V::select(wide, a, b), V::select(wide, b, a));
    let ratio = V::select(r.equal(zero), zero, other / r);
    let (sin, cos) = math::sin_cos_octant(u.num(std::f64::consts::FRAC_PI_4) * ratio);
    let (long, short) = (r * cos, r * sin);
    let z = ((one - r) * (one + r)).max(zero).sqrt();
    Vec3::new(V::select(wide, long, short), V::select(wide, short, long), z)
}

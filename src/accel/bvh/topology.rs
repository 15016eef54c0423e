//! A tree without its places: which children nodes have, and which faces blocks hold. Vertices that move keep it
//! ([`Bvh::refit`]), and it is all that need be saved: boxes and blocks follow from the mesh, to the bit.
//!
//! Bytes are little-endian: `shadelab.BVH.` and a version, the numbers of nodes and blocks, a checksum, the children of
//! nodes, the faces of blocks. What is read back is checked in full: nothing that a traversal relies on is left to trust.

use super::Bvh;
use super::few::Few;
use super::node::{Child, MAX_DEPTH, Node, WIDTH};
use crate::accel::block::{BLOCK, Block};
use crate::accel::bounds;
use crate::parallel::{self, Interrupted, Watch};
use crate::real::Real;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

const MAGIC: &[u8; 16] = b"shadelab.BVH.001";
const HEADER: usize = 40;

type Children = [Child; WIDTH];
type Corners<T> = [[T; 3]; 2];

/// Children of nodes and faces of blocks.
pub struct Topology {
    nodes: Vec<Children>,
    blocks: Vec<[i32; BLOCK]>,
}

impl<T: Real> Bvh<T> {
    fn topology(&self) -> Topology {
        Topology {
            nodes: self.nodes.par_iter().map(|n| n.children).collect(),
            blocks: self.blocks.par_iter().map(|b| b.faces).collect(),
        }
    }

    /// The tree after its vertices moved: faces are those that it was built over.
    pub fn refit(
        &self,
        watch: &mut dyn Watch,
        positions: &[[T; 3]],
        faces: &[[i32; 3]],
    ) -> Result<Self, Interrupted> {
        assert_eq!(faces.len(), self.faces);
        parallel::run_forking(watch, |stop| self.topology().place(positions, faces, stop))
    }

    pub fn to_bytes(&self) -> Vec<u8> {
        let topology = self.topology();
        let mut body =
            Vec::with_capacity(topology.nodes.len() * 4 * WIDTH + topology.blocks.len() * 4 * BLOCK);
        topology.nodes.as_flattened().iter().for_each(|c| body.extend(c.0.to_le_bytes()));
        topology.blocks.as_flattened().iter().for_each(|f| body.extend(f.to_le_bytes()));
        let mut bytes = Vec::with_capacity(HEADER + body.len());
        bytes.extend(MAGIC);
        for number in [topology.nodes.len() as u64, topology.blocks.len() as u64, checksum(&body)] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(body);
        bytes
    }

    /// The tree over this mesh, or what is wrong with the bytes.
    pub fn from_bytes(
        watch: &mut dyn Watch,
        bytes: &[u8],
        positions: &[[T; 3]],
        faces: &[[i32; 3]],
    ) -> Result<Result<Self, String>, Interrupted> {
        parallel::run_forking(watch, |stop| {
            let topology = Topology::read(bytes)?;
            topology.check(faces.len())?;
            Ok(topology.place(positions, faces, stop))
        })
    }
}

/// FNV-1a over words: what a flipped bit changes.
fn checksum(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks();
    let mix = |h: u64, w: u64| (h ^ w).wrapping_mul(0x100_0000_01b3).rotate_left(23);
    let h = words.iter().fold(0xcbf2_9ce4_8422_2325, |h, &w| mix(h, u64::from_le_bytes(w)));
    rest.iter().fold(h, |h, &b| mix(h, b as u64))
}

impl Topology {
    fn read(bytes: &[u8]) -> Result<Self, String> {
        let Some((magic, rest)) = bytes.split_first_chunk::<16>() else {
            return Err("too short".into());
        };
        if magic[..13] != MAGIC[..13] {
            return Err("not a saved tree".into());
        }
        if magic != MAGIC {
            let version = |m: &[u8; 16]| String::from_utf8_lossy(&m[13..]).into_owned();
            return Err(format!("of version {:?}, expected {:?}", version(magic), version(MAGIC)));
        }
        let Some((numbers, body)) = rest.split_first_chunk::<24>() else {
            return Err("too short".into());
        };
        let (numbers, _) = numbers.as_chunks();
        let [nodes, blocks, sum] = [0, 1, 2].map(|i| u64::from_le_bytes(numbers[i]));
        let limit = Child::MAX_BLOCKS as u64;
        if nodes > limit || blocks > limit || body.len() as u64 != 4 * (8 * nodes + 4 * blocks) {
            return Err("of the wrong length".into());
        }
        if checksum(body) != sum {
            return Err("damaged: its checksum differs".into());
        }
        let (words, _) = body.as_chunks();
        let (children, faces) = words.split_at(WIDTH * nodes as usize);
        let children: Vec<Child> = children.iter().map(|&w| Child(u32::from_le_bytes(w))).collect();
        let faces: Vec<i32> = faces.iter().map(|&w| i32::from_le_bytes(w)).collect();
        Ok(Topology { nodes: children.as_chunks().0.to_vec(), blocks: faces.as_chunks().0.to_vec() })
    }

    /// Every node but the root has one parent, before it; every block one leaf; every face one place; none lies deep.
    fn check(&self, faces: usize) -> Result<(), String> {
        if self.nodes.is_empty() {
            return Err("without a root".into());
        }
        let (mut depth, mut owned) = (vec![0usize; self.nodes.len()], vec![false; self.blocks.len()]);
        depth[0] = 1;
        for (i, children) in self.nodes.iter().enumerate() {
            if depth[i] == 0 || depth[i] > MAX_DEPTH {
                return Err(format!("bad: node {i} hangs nowhere or too deep"));
            }
            for &child in children.iter().filter(|&&c| c != Child::EMPTY) {
                if child.is_leaf() {
                    let (first, count) = child.run();
                    if count == 0
                        || first + count > owned.len()
                        || owned[first..first + count].contains(&true)
                    {
                        return Err(format!("bad: a leaf of node {i} has blocks that are not its own"));
                    }
                    owned[first..first + count].fill(true);
                } else if child.index() <= i || child.index() >= depth.len() || depth[child.index()] != 0 {
                    return Err(format!("bad: node {i} has a child that cannot be"));
                } else {
                    depth[child.index()] = depth[i] + 1;
                }
            }
        }
        let mut seen = vec![false; faces];
        for &face in self.blocks.as_flattened().iter().filter(|&&f| f != -1) {
            match seen.get_mut(face as usize) {
                Some(seen) if !*seen => *seen = true,
                _ => return Err(format!("bad: face {face} is not there, or twice")),
            }
        }
        let whole = !owned.contains(&false) && !seen.contains(&false);
        if whole { Ok(()) } else { Err("bad: faces are missing".into()) }
    }

    /// The tree over a mesh; of no use once `stop` is set.
    fn place<T: Real>(&self, positions: &[[T; 3]], faces: &[[i32; 3]], stop: &AtomicBool) -> Bvh<T> {
        let going = || !stop.load(Ordering::Relaxed);
        let corners = |face: i32| faces[face as usize].map(|v| positions[v as usize]);
        let block = |four: &[i32; BLOCK]| {
            Block::new(four.iter().filter(|&&f| f >= 0 && going()).map(|&f| (f, corners(f))))
        };
        let blocks: Vec<Block<T>> = self.blocks.par_iter().with_min_len(1024).map(block).collect();
        let leaves = |&children: &Children| {
            let mut node = Node::empty();
            for (slot, child) in children.into_iter().enumerate() {
                node.set_child(slot, child);
                if going() && child != Child::EMPTY && child.is_leaf() {
                    let (first, count) = child.run();
                    set(&mut node, slot, blocks_bounds(&blocks[first..first + count]));
                }
            }
            node
        };
        let mut nodes: Vec<Node<T>> = self.nodes.par_iter().with_min_len(256).map(leaves).collect();
        // Children stand behind their parents.
        for i in (0..nodes.len()).rev().take_while(|_| going()) {
            for slot in 0..WIDTH {
                let child = nodes[i].children[slot];
                if !child.is_leaf() {
                    let corners = node_bounds(&nodes[child.index()]);
                    set(&mut nodes[i], slot, corners);
                }
            }
        }
        let few = Few::new(positions, faces);
        Bvh {
            nodes,
            blocks,
            few,
            bounds: bounds::scene_bounds_until(stop, positions, faces),
            faces: faces.len(),
        }
    }
}

fn set<T: Real>(node: &mut Node<T>, slot: usize, corners: Corners<T>) {
    for (side, axis) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)] {
        node.planes[side][axis][slot] = corners[side][axis];
    }
}

/// Grows a box by lanes of places; NaN, as of empty lanes, is neither less nor more.
#[inline(always)]
fn grow<T: Real, const N: usize>(bounds: &mut [[[T; N]; 3]; 2], low: &[[T; N]; 3], high: &[[T; N]; 3]) {
    for k in 0..3 {
        for l in 0..N {
            bounds[0][k][l] = if low[k][l] < bounds[0][k][l] { low[k][l] } else { bounds[0][k][l] };
            bounds[1][k][l] = if high[k][l] > bounds[1][k][l] { high[k][l] } else { bounds[1][k][l] };
        }
    }
}

/// The box of all lanes.
#[inline(always)]
fn joined<T: Real, const N: usize>(lanes: &[[[T; N]; 3]; 2]) -> Corners<T> {
    let mut all = empty::<T, 1>();
    for l in 0..N {
        let at = |side: usize| std::array::from_fn(|k| [lanes[side][k][l]]);
        grow(&mut all, &at(0), &at(1));
    }
    all.map(|side| side.map(|[x]| x))
}

fn blocks_bounds<T: Real>(blocks: &[Block<T>]) -> Corners<T> {
    let mut lanes = empty::<T, BLOCK>();
    blocks.iter().flat_map(|b| &b.vertices).for_each(|v| grow(&mut lanes, v, v));
    joined(&lanes)
}

/// Empty slots are infinite the wrong way round.
fn node_bounds<T: Real>(node: &Node<T>) -> Corners<T> {
    joined(&node.planes)
}

fn empty<T: Real, const N: usize>() -> [[[T; N]; 3]; 2] {
    [[[T::INFINITY; N]; 3], [[-T::INFINITY; N]; 3]]
}

//! Patches: selected cells without address or place (the paper §4.3: "agnostic to location", Fig. 22).
//!
//! ```text
//!              f                 A walker in the seed looks at its side 2. `f` crosses the side ahead, `l` and `r`
//!            ┌───┐               the sides to the left and right, and then look that way; `b`, back, is a first
//!         l  │   │  r            step only. The walk `fr` leads ahead, then to the right.
//!            └───┘               The seed's corner 0 is behind on the left: round an anchor it is the anchor.
//!              b
//! ```
//! The walk of a cell is the shortest within the selection, among these the first in the order f, l, r, b: breadth
//! first. Its subtree is stored as the walker sees it, who carries the frame along.

use crate::address::Place;
use crate::base_mesh::BaseMesh;
use crate::cell_type::CellTypeId;
use crate::forest::Forest;
use crate::orientation::{Barrier, Frame, Mirrors, Orientation};
use crate::selection::Selection;
use crate::tree::Tree;
use rustc_hash::FxHashMap;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use thiserror::Error;

/// A step of a walk, seen from the way one looks.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Step {
    /// Ahead.
    Forward,
    /// To the left.
    Left,
    /// To the right.
    Right,
    /// Back; the first step only.
    Back,
}

const STEPS: [(Step, char, u8); 4] =
    [(Step::Forward, 'f', 0), (Step::Left, 'l', 1), (Step::Right, 'r', 3), (Step::Back, 'b', 2)];

/// The side of the seed that a walker looks at.
const AHEAD: u8 = 2;

impl Step {
    /// Quarter turns to the left.
    fn turns(self) -> u8 {
        STEPS[self as usize].2
    }

    fn of_turns(turns: u8) -> Step {
        STEPS[[0, 1, 3, 2][usize::from(turns % 4)]].0
    }
}

/// Steps from the seed to a cell; shorter walks come first, then by steps.
#[derive(Clone, PartialEq, Eq, Hash, Debug, Default)]
pub struct Walk(Vec<Step>);

impl Walk {
    /// The steps.
    pub fn steps(&self) -> &[Step] {
        &self.0
    }

    /// The walk `text`, such as `ffr`; `None` if it is none.
    pub fn parse(text: &str) -> Option<Walk> {
        let step = |letter: char| STEPS.iter().find(|known| known.1 == letter).map(|known| known.0);
        let steps = text.chars().map(step).collect::<Option<Vec<Step>>>()?;
        (!steps.iter().skip(1).any(|&step| step == Step::Back)).then_some(Walk(steps))
    }

    /// The sides that are crossed, as the walker's frame numbers them.
    fn sides(&self) -> impl Iterator<Item = u8> + '_ {
        self.0.iter().scan(AHEAD, |heading, step| {
            *heading = (*heading + step.turns()) % 4;
            Some(*heading)
        })
    }

    fn of_sides(sides: impl IntoIterator<Item = u8>) -> Walk {
        let mut heading = AHEAD;
        let step = |side: u8| {
            let step = Step::of_turns(side + 4 - heading);
            heading = side;
            step
        };
        Walk(sides.into_iter().map(step).collect())
    }

    fn oriented(&self, orientation: Orientation) -> Walk {
        Walk::of_sides(self.sides().map(|side| orientation.side(side)))
    }
}

impl Ord for Walk {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.0.len(), &self.0).cmp(&(other.0.len(), &other.0))
    }
}

impl PartialOrd for Walk {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl fmt::Display for Walk {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|&step| write!(formatter, "{}", STEPS[step as usize].1))
    }
}

/// What a patch holds of one top-level cell.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PatchCell {
    /// The way from the seed.
    pub walk: Walk,
    /// Which sides are free edges where the patch comes from.
    pub free: [bool; 4],
    /// Subtrees by their path of children below the top-level cell; the whole cell has an empty one.
    pub trees: BTreeMap<Vec<u8>, Tree>,
}

/// Selected cells without address or place.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Patch {
    /// Corner 0 of the seed is an anchor.
    pub anchored: bool,
    /// Top-level cells, ascending by walk.
    pub cells: Vec<PatchCell>,
}

/// Where a patch is seen from when it is lifted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Viewpoint {
    /// From the cell and turn that give the shortest walks and the least description.
    Anywhere,
    /// The same, but corner 0 of the seed is a base vertex.
    Vertex(u32),
    /// Corner 0 of the seed is a base vertex that is an anchor.
    Anchor(u32),
    /// From a given frame.
    Frame(Frame),
}

/// A selected cell that a patch can't hold.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LeftOut {
    /// The forest does not divide so far, or a subdivision above is off.
    NotThere,
    /// No way from the seed leads there within the selection, across edges with two cells.
    OutOfReach,
    /// It lies mirrored before the walker, and a type in it has no mirror image.
    NoMirror,
}

/// A patch, where it was seen from, and what it does not hold.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Lifted {
    /// The patch.
    pub patch: Patch,
    /// Its seed and orientation.
    pub frame: Frame,
    /// Selected squares that it does not hold.
    pub left_out: Vec<(Place, LeftOut)>,
}

/// Why nothing can be lifted.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum LiftError {
    /// The selection has no cell of the forest at the viewpoint.
    #[error("the selection has no cell that the patch could start from")]
    NoSeed,
}

impl Patch {
    /// The patch as its own frame sees it after an orientation: its first corner becomes corner
    /// `orientation.corner(0)`. Grafting it in a frame is grafting the patch in `frame.orientation` after that.
    ///
    /// # Errors
    /// A type that would be mirrored and has no mirror image.
    pub fn oriented(&self, orientation: Orientation, mirrors: &Mirrors) -> Result<Patch, CellTypeId> {
        let cell = |cell: &PatchCell| -> Result<PatchCell, CellTypeId> {
            let mut free = [false; 4];
            for k in 0..4 {
                free[usize::from(orientation.side(k))] = cell.free[usize::from(k)];
            }
            let tree = |(path, tree): (&Vec<u8>, &Tree)| {
                let path = path.iter().map(|&child| orientation.corner(child)).collect();
                Ok((path, tree.oriented(orientation, mirrors)?))
            };
            let trees = cell.trees.iter().map(tree).collect::<Result<_, _>>()?;
            Ok(PatchCell { walk: cell.walk.oriented(orientation), free, trees })
        };
        let mut cells = self.cells.iter().map(cell).collect::<Result<Vec<_>, _>>()?;
        cells.sort_unstable();
        Ok(Patch { cells, ..*self })
    }

    /// Where the walks lead from a frame, cell by cell; the second way to a cell is [`Miss::Twice`].
    pub fn locate(&self, mesh: &BaseMesh, from: Frame) -> Vec<Result<Frame, Miss>> {
        let mut seen: Vec<u32> = Vec::with_capacity(self.cells.len());
        let mut found = Vec::with_capacity(self.cells.len());
        for cell in &self.cells {
            let reached = cell.walk.sides().try_fold(from, |frame, side| frame.across(mesh, side));
            found.push(match reached {
                Ok(frame) if seen.contains(&frame.face) => Err(Miss::Twice(frame.face)),
                Ok(frame) => {
                    seen.push(frame.face);
                    Ok(frame)
                }
                Err(Barrier::Border) => Err(Miss::Border),
                Err(Barrier::Branching) => Err(Miss::Branching),
            });
        }
        found
    }

    /// Number of cells, divided ones included.
    pub fn stored(&self) -> usize {
        self.cells.iter().flat_map(|cell| cell.trees.values()).map(Tree::cells).sum()
    }

    /// Types that occur, ascending.
    pub fn types(&self) -> BTreeSet<CellTypeId> {
        let mut types = BTreeSet::new();
        for tree in self.cells.iter().flat_map(|cell| cell.trees.values()) {
            tree.visit(&mut |content| {
                types.insert(content.kind);
            });
        }
        types
    }
}

/// Why a walk leads to no cell of its own.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Miss {
    /// It falls off a border.
    Border,
    /// It meets an edge with more than two cells.
    Branching,
    /// Another walk of the patch has led to this cell.
    Twice(u32),
}

/// Lifts the selected cells of a forest as a patch.
///
/// # Errors
/// Nothing is selected that the forest holds, or not at the viewpoint.
pub fn lift(
    mesh: &BaseMesh,
    forest: &Forest,
    selection: &Selection,
    viewpoint: Viewpoint,
    mirrors: &Mirrors,
) -> Result<Lifted, LiftError> {
    let mut left_out = Vec::new();
    let mut held: BTreeMap<u32, Vec<Place>> = BTreeMap::new();
    for place in selection.places() {
        let above = (0..place.level).map(|level| forest.find(place.ancestor(level)));
        let shown =
            above.into_iter().all(|cell| cell.is_some_and(|cell| forest.expressed_children(cell).is_some()));
        if shown && place.face < forest.top_level() {
            held.entry(place.face).or_default().push(place);
        } else {
            left_out.push((place, LeftOut::NotThere));
        }
    }
    let anchored = matches!(viewpoint, Viewpoint::Anchor(_));
    let mut best: Option<(Key, Patch, Frame)> = None;
    for frame in viewpoints(mesh, &held, viewpoint) {
        let walks = walks_within(mesh, &held, frame);
        let cells = describe(mesh, forest, &held, &walks, mirrors);
        let patch = Patch { anchored, cells };
        let key = Key::new(&patch);
        if best.as_ref().is_none_or(|(least, _, _)| key < *least) {
            best = Some((key, patch, frame));
        }
    }
    let (_, patch, frame) = best.filter(|(_, patch, _)| !patch.cells.is_empty()).ok_or(LiftError::NoSeed)?;
    let walks = walks_within(mesh, &held, frame);
    for (&face, places) in &held {
        let why = match walks.iter().find(|(_, frame)| frame.face == face) {
            Some((walk, _)) if patch.cells.iter().any(|cell| cell.walk == *walk) => continue,
            Some(_) => LeftOut::NoMirror,
            None => LeftOut::OutOfReach,
        };
        left_out.extend(places.iter().map(|&place| (place, why)));
    }
    left_out.sort_unstable_by_key(|&(place, _)| place);
    Ok(Lifted { patch, frame, left_out })
}

/// Patches are told apart by how many cells they reach, how far these are, their outline, then their cells.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    missing: std::cmp::Reverse<usize>,
    steps: usize,
    outline: Vec<(Walk, [bool; 4])>,
    cells: Vec<PatchCell>,
}

impl Key {
    fn new(patch: &Patch) -> Key {
        Key {
            missing: std::cmp::Reverse(patch.cells.len()),
            steps: patch.cells.iter().map(|cell| cell.walk.0.len()).sum(),
            // Free sides first: what is behind is outside.
            outline: patch
                .cells
                .iter()
                .map(|cell| (cell.walk.clone(), cell.free.map(|free| !free)))
                .collect(),
            cells: patch.cells.clone(),
        }
    }
}

fn viewpoints(mesh: &BaseMesh, held: &BTreeMap<u32, Vec<Place>>, viewpoint: Viewpoint) -> Vec<Frame> {
    match viewpoint {
        Viewpoint::Frame(frame) => held.contains_key(&frame.face).then_some(frame).into_iter().collect(),
        Viewpoint::Vertex(vertex) | Viewpoint::Anchor(vertex) => {
            let frames = frames_at(mesh, vertex).into_iter().filter(|frame| !frame.orientation.mirrored);
            frames.filter(|frame| held.contains_key(&frame.face)).collect()
        }
        Viewpoint::Anywhere => central(mesh, held)
            .into_iter()
            .flat_map(|face| (0..4).map(move |corner| Frame::at_corner(face, corner, false)))
            .collect(),
    }
}

/// The frames whose corner 0 is a base vertex, ascending; both ways round.
pub fn frames_at(mesh: &BaseMesh, vertex: u32) -> Vec<Frame> {
    let mut frames = Vec::new();
    for &face in mesh.faces_at_vertex(vertex) {
        let corners = mesh.faces()[face as usize];
        let corner = (0..).zip(corners).find(|&(_, corner)| corner == vertex).map_or(0, |(at, _)| at);
        frames.extend([false, true].map(|mirrored| Frame::at_corner(face, corner, mirrored)));
    }
    frames.sort_unstable();
    frames
}

/// Cells from which most others are reached, in the fewest steps altogether.
fn central(mesh: &BaseMesh, held: &BTreeMap<u32, Vec<Place>>) -> Vec<u32> {
    let reach = |face: u32| {
        let walks = walks_within(mesh, held, Frame::at_corner(face, 0, false));
        let steps: usize = walks.iter().map(|(walk, _)| walk.0.len()).sum();
        (std::cmp::Reverse(walks.len()), steps)
    };
    let reaches: Vec<_> = held.keys().map(|&face| (reach(face), face)).collect();
    let least = reaches.iter().map(|&(reach, _)| reach).min();
    reaches.into_iter().filter(|&(reach, _)| Some(reach) == least).map(|(_, face)| face).collect()
}

/// Breadth first from a frame, through selected cells only.
fn walks_within(mesh: &BaseMesh, held: &BTreeMap<u32, Vec<Place>>, from: Frame) -> Vec<(Walk, Frame)> {
    let mut seen: FxHashMap<u32, ()> = FxHashMap::default();
    let mut walks = vec![(Walk::default(), AHEAD, from)];
    seen.insert(from.face, ());
    let mut next = 0;
    while next < walks.len() {
        let (walk, heading, frame) = walks[next].clone();
        next += 1;
        for (step, _, turns) in STEPS {
            if step == Step::Back && !walk.0.is_empty() {
                continue;
            }
            let side = (heading + turns) % 4;
            let Ok(beyond) = frame.across(mesh, side) else { continue };
            if held.contains_key(&beyond.face) && seen.insert(beyond.face, ()).is_none() {
                let mut longer = walk.clone();
                longer.0.push(step);
                walks.push((longer, side, beyond));
            }
        }
    }
    walks.into_iter().map(|(walk, _, frame)| (walk, frame)).collect()
}

/// What the walker sees; without cells that lie mirrored and have a type without image.
fn describe(
    mesh: &BaseMesh,
    forest: &Forest,
    held: &BTreeMap<u32, Vec<Place>>,
    walks: &[(Walk, Frame)],
    mirrors: &Mirrors,
) -> Vec<PatchCell> {
    let seen = |(walk, frame): &(Walk, Frame)| {
        let seen = frame.orientation.inverse();
        let tree = |place: &Place| {
            let path = place.path().map(|child| seen.corner(child)).collect();
            let cell = forest.find(*place)?;
            Some((path, Tree::of(forest, cell).oriented(seen, mirrors).ok()?))
        };
        let trees = held[&frame.face].iter().map(tree).collect::<Option<_>>()?;
        let free = std::array::from_fn(|side| frame.is_free(mesh, side as u8));
        Some(PatchCell { walk: walk.clone(), free, trees })
    };
    walks.iter().filter_map(seen).collect()
}

//! The recursive filter, QrT (the paper §3.2, Fig. 11a): level balance and support springs at hanging nodes.
//!
//! Isaac, Burstedde & Ghattas, "Low-cost parallel algorithms for 2:1 octree balance", 2012, call the same rule
//! face balance; here the forest is small and a frontier of newly expressed cells is enough.

use crate::address::Place;
use crate::base_mesh::BaseMesh;
use crate::edit::{Edit, EditError};
use crate::forest::{CellIndex, Forest};
use crate::sides::across;
use std::collections::BTreeSet;

/// Makes the levels of expressed cells that share an edge differ by one at most, and returns what that took.
///
/// The subdivisions are written into the forest, so they are inherited and can cascade (the paper, Fig. 18).
/// A level that is stored but switched off is switched on, with its children's own subdivisions off.
///
/// # Errors
/// None on a valid forest; an edit that does not fit is passed on.
pub fn close(mesh: &BaseMesh, forest: &mut Forest) -> Result<Vec<Edit>, EditError> {
    let mut edits = Vec::new();
    let mut frontier = Vec::new();
    forest.visit_expressed(|_, place| frontier.push(place));
    // Levels 0 and 1 are balanced with anything above them.
    frontier.retain(|place| place.level >= 2);
    while !frontier.is_empty() {
        let mut coarse = BTreeSet::new();
        // A cell with too coarse a neighbour stays: one refinement may not be enough.
        frontier.retain(|&place| {
            let mut balanced = true;
            for side in 0..4 {
                across(mesh, place, side, |neighbour, _| {
                    if let Some((_, level)) = forest.expressed_over(neighbour)
                        && level + 1 < place.level
                    {
                        coarse.insert(neighbour.ancestor(level));
                        balanced = false;
                    }
                });
            }
            !balanced
        });
        for place in coarse {
            let before = edits.len();
            refine(forest, place, &mut edits);
            Edit::apply_all(&edits[before..], forest)?;
            frontier.extend((0..4).map(|k| place.child(k)).filter(|place| place.level >= 2));
        }
    }
    Ok(edits)
}

/// Support springs of a cell by which of its sides have a hanging node in the middle; `centre` stands for x.
///
/// ```text
/// one: to the opposite corners    two opposite: joined    two adjacent: joined, and each to the far corner
/// three: the opposite pair joined, the third to both      four: all to the centre
/// ```
pub fn support_springs(hanging: [bool; 4]) -> impl Iterator<Item = [Support; 2]> {
    use Support::{Centre, Corner, Hanging};
    let on = |side: u8| hanging[usize::from(side % 4)];
    let turned = |base: u8, by: u8| (base + by) % 4;
    const NOTHING: [Support; 2] = [Centre; 2];
    let first = |holds: &dyn Fn(u8) -> bool| (0..4).find(|&side| holds(side)).unwrap_or(0);
    let (count, springs) = match hanging.iter().filter(|&&hangs| hangs).count() {
        0 => (0, [NOTHING; 4]),
        1 => {
            let side = first(&on);
            let to = |corner: u8| [Hanging(side), Corner(turned(side, corner))];
            (2, [to(2), to(3), NOTHING, NOTHING])
        }
        2 if on(0) == on(2) => {
            let side = first(&on);
            (1, [[Hanging(side), Hanging(turned(side, 2))], NOTHING, NOTHING, NOTHING])
        }
        2 => {
            let side = first(&|side| on(side) && on(side + 1));
            let (next, far) = (Hanging(turned(side, 1)), Corner(turned(side, 3)));
            (3, [[Hanging(side), next], [Hanging(side), far], [next, far], NOTHING])
        }
        3 => {
            let without = first(&|side| !on(side));
            let [right, third, left] = [1, 2, 3].map(|by| Hanging(turned(without, by)));
            (3, [[left, right], [third, left], [third, right], NOTHING])
        }
        _ => (4, [0, 1, 2, 3].map(|side| [Hanging(side), Centre])),
    };
    springs.into_iter().take(count)
}

/// An end of a support spring.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Support {
    /// The hanging node of a side.
    Hanging(u8),
    /// A corner of the cell.
    Corner(u8),
    /// The centre of the cell.
    Centre,
}

fn refine(forest: &Forest, place: Place, edits: &mut Vec<Edit>) {
    let Some(cell) = forest.find(place) else { return };
    let Some(children) = forest.children(cell) else {
        edits.push(Edit::Subdivide { cell: place, children: [forest.content(cell); 4] });
        return;
    };
    edits.push(Edit::Toggle { cell: place, on: true });
    for (k, child) in children.into_iter().enumerate() {
        let divided = |cell: CellIndex| forest.expressed_children(cell).is_some();
        if divided(child) {
            edits.push(Edit::Toggle { cell: place.child(k as u8), on: false });
        }
    }
}

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
pub fn support_springs(hanging: [bool; 4]) -> Vec<[Support; 2]> {
    use Support::{Centre, Corner, Hanging};
    let sides: Vec<u8> = (0..4).filter(|&side| hanging[usize::from(side)]).collect();
    let turned = |base: u8, by: u8| (base + by) % 4;
    match sides.as_slice() {
        [] => Vec::new(),
        &[side] => vec![[Hanging(side), Corner(turned(side, 2))], [Hanging(side), Corner(turned(side, 3))]],
        &[a, b] if b - a == 2 => vec![[Hanging(a), Hanging(b)]],
        &[a, b] => {
            let first = if b - a == 1 { a } else { b };
            let far = Corner(turned(first, 3));
            vec![[Hanging(a), Hanging(b)], [Hanging(a), far], [Hanging(b), far]]
        }
        &[_, _, _] => {
            let without = (0..4).find(|&side| !hanging[usize::from(side)]).unwrap_or(0);
            let (left, right, third) = (turned(without, 3), turned(without, 1), turned(without, 2));
            vec![
                [Hanging(left), Hanging(right)],
                [Hanging(third), Hanging(left)],
                [Hanging(third), Hanging(right)],
            ]
        }
        _ => (0..4).map(|side| [Hanging(side), Centre]).collect(),
    }
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

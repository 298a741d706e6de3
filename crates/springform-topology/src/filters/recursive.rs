//! The recursive filter, QrT (the paper §3.2, Fig. 11a): level balance and support springs at hanging nodes.
//!
//! Isaac, Burstedde & Ghattas, "Low-cost parallel algorithms for 2:1 octree balance", 2012, call the same rule
//! face balance; here the forest is small and a frontier of newly expressed cells is enough.

use crate::address::Place;
use crate::base_mesh::BaseMesh;
use crate::edit::{Edit, EditError};
use crate::forest::{CellIndex, Forest};
use crate::sides::across;

/// Makes the levels of expressed cells that share an edge differ by one at most, and returns what that took.
///
/// The subdivisions are written into the forest, so they are inherited and can cascade (the paper, Fig. 18).
/// A level that is stored but switched off is switched on, with its children's own subdivisions off.
///
/// # Errors
/// None on a valid forest; an edit that does not fit is passed on.
pub fn close(mesh: &BaseMesh, forest: &mut Forest) -> Result<Vec<Edit>, EditError> {
    let mut edits = Vec::new();
    Closure::default().close(mesh, forest, &mut edits)?;
    Ok(edits)
}

/// Closes one forest after the other without asking for new memory, once it has seen one of the size.
#[derive(Clone, Debug, Default)]
pub struct Closure {
    /// Expressed cells that may have too coarse a neighbour.
    frontier: Vec<Place>,
    /// Cells to be refined.
    coarse: Vec<Place>,
}

impl Closure {
    /// Closes a forest as the function [`close`] does; what that took is appended to `edits`.
    ///
    /// # Errors
    /// None on a valid forest; an edit that does not fit is passed on.
    pub fn close(
        &mut self,
        mesh: &BaseMesh,
        forest: &mut Forest,
        edits: &mut Vec<Edit>,
    ) -> Result<(), EditError> {
        self.frontier.clear();
        forest.visit_expressed(|_, place| self.frontier.push(place));
        self.advance(mesh, forest, edits)
    }

    /// Closes a forest that was closed before `edits` were applied to it, with the same outcome as
    /// [`Closure::close`] but no work for what they left alone.
    ///
    /// # Errors
    /// None on a valid forest; an edit that does not fit is passed on.
    pub fn close_after(
        &mut self,
        mesh: &BaseMesh,
        forest: &mut Forest,
        edits: &mut Vec<Edit>,
    ) -> Result<(), EditError> {
        self.frontier.clear();
        for edit in edits.iter() {
            if let Edit::Subdivide { cell, .. } | Edit::Merge { cell, .. } | Edit::Toggle { cell, .. } = *edit
            {
                self.add_changed(mesh, forest, cell);
            }
        }
        self.advance(mesh, forest, edits)
    }

    /// Takes up the expressed cells in a place that was edited, or over it, and the finer ones beside them.
    fn add_changed(&mut self, mesh: &BaseMesh, forest: &Forest, edited: Place) {
        let first = self.frontier.len();
        match (forest.expressed_over(edited), forest.find(edited)) {
            (Some((_, level)), _) => self.frontier.push(edited.ancestor(level)),
            (None, Some(cell)) => {
                forest.visit_expressed_under(cell, edited, &mut |_, place| self.frontier.push(place));
            }
            (None, None) => {}
        }
        for at in first..self.frontier.len() {
            let place = self.frontier[at];
            for side in 0..4 {
                across(mesh, place, side, |neighbour, facing| {
                    // What is stored below a switch that is off does not count.
                    if forest.expressed_over(neighbour).is_none()
                        && let Some(cell) = forest.find(neighbour)
                    {
                        self.add_along(forest, cell, neighbour, facing);
                    }
                });
            }
        }
    }

    /// Takes up the expressed cells under a reachable cell along one of its sides.
    fn add_along(&mut self, forest: &Forest, cell: CellIndex, place: Place, side: u8) {
        let Some(children) = forest.expressed_children(cell) else {
            self.frontier.push(place);
            return;
        };
        // Children k and k + 1 lie on side k.
        for child in [side, (side + 1) % 4] {
            self.add_along(forest, children[usize::from(child)], place.child(child), side);
        }
    }

    fn advance(
        &mut self,
        mesh: &BaseMesh,
        forest: &mut Forest,
        edits: &mut Vec<Edit>,
    ) -> Result<(), EditError> {
        let Closure { frontier, coarse } = self;
        loop {
            coarse.clear();
            // A cell with too coarse a neighbour stays: one refinement may not be enough.
            frontier.retain(|&place| {
                let before = coarse.len();
                // Levels 0 and 1 are balanced with anything above them.
                for side in 0..if place.level < 2 { 0 } else { 4 } {
                    across(mesh, place, side, |neighbour, _| {
                        if let Some((_, level)) = forest.expressed_over(neighbour)
                            && level + 1 < place.level
                        {
                            coarse.push(neighbour.ancestor(level));
                        }
                    });
                }
                coarse.len() > before
            });
            if coarse.is_empty() {
                return Ok(());
            }
            coarse.sort_unstable();
            coarse.dedup();
            for &place in coarse.iter() {
                let before = edits.len();
                refine(forest, place, edits);
                Edit::apply_all(&edits[before..], forest)?;
                frontier.extend((0..4).map(|k| place.child(k)));
            }
        }
    }
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

/// What subdividing an expressed cell takes: new children, or its stored ones switched on, undivided.
pub(crate) fn refine(forest: &Forest, place: Place, edits: &mut Vec<Edit>) {
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

//! Neighbourhood: which cells lie across a side of a cell, within a face and across base edges.

use crate::address::Place;
use crate::base_mesh::BaseMesh;
use crate::forest::Forest;
use std::collections::BTreeSet;

/// The cells of the same level across one side, whether or not they exist: one within a face, and one
/// for each further face on the edge at the border of a face.
pub fn across(mesh: &BaseMesh, place: Place, side: u8, mut visit: impl FnMut(Place, u8)) {
    let last = (1u32 << place.level) - 1;
    let inside = match side {
        0 if place.j > 0 => Some(Place { j: place.j - 1, ..place }),
        1 if place.i < last => Some(Place { i: place.i + 1, ..place }),
        2 if place.j < last => Some(Place { j: place.j + 1, ..place }),
        3 if place.i > 0 => Some(Place { i: place.i - 1, ..place }),
        _ => None,
    };
    if let Some(neighbour) = inside {
        visit(neighbour, (side + 2) % 4);
        return;
    }
    let along = match side {
        0 => place.i,
        1 => place.j,
        2 => last - place.i,
        _ => last - place.j,
    };
    let under = mesh.side_edge(place.face, side);
    let on_edge = if under.reversed { last - along } else { along };
    for other in mesh.faces_at_edge(under.edge) {
        if other.face == place.face {
            continue;
        }
        let along = if other.reversed { last - on_edge } else { on_edge };
        let (i, j) = match other.side {
            0 => (along, 0),
            1 => (last, along),
            2 => (last - along, last),
            _ => (0, last - along),
        };
        visit(Place { face: other.face, level: place.level, i, j }, other.side);
    }
}

/// Expressed cells that share an edge, or part of one, with the cell at a place; ascending.
pub fn expressed_neighbours(mesh: &BaseMesh, forest: &Forest, place: Place) -> Vec<Place> {
    let mut found = BTreeSet::new();
    for side in 0..4 {
        across(mesh, place, side, |neighbour, facing| match forest.expressed_over(neighbour) {
            Some((_, level)) => {
                found.insert(neighbour.ancestor(level));
            }
            None => collect_along(forest, neighbour, facing, &mut found),
        });
    }
    found.into_iter().collect()
}

fn collect_along(forest: &Forest, place: Place, side: u8, found: &mut BTreeSet<Place>) {
    let divided = forest.find(place).is_some_and(|cell| forest.expressed_children(cell).is_some());
    if !divided {
        found.insert(place);
        return;
    }
    // Children k and k + 1 lie on side k.
    for child in [side, (side + 1) % 4] {
        collect_along(forest, place.child(child), side, found);
    }
}

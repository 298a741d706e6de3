//! Choices of cells and springs of a grown net by what they are and where they lie, not by number.

use springform_topology::address::Place;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::CellTypeId;
use springform_topology::expression::{ExpressedCell, Expression};
use springform_topology::forest::NodePair;
use springform_topology::node_key::{NodeKey, NodePlace};

/// Expressed cells that meet every condition that is given.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct CellChoice {
    /// Of one of these parts.
    pub parts: Option<Vec<u32>>,
    /// Of one of these types, as expressed.
    pub types: Option<Vec<CellTypeId>>,
    /// Of one of these levels.
    pub levels: Option<Vec<u8>>,
    /// One of these cells, or below one.
    pub places: Option<Vec<Place>>,
}

/// Springs that meet every condition that is given.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct SpringChoice {
    /// Of a cell that is chosen; springs added by hand belong to no cell.
    pub cells: CellChoice,
    /// Along one of these lines.
    pub along: Option<Along>,
    /// Between one of these pairs of nodes.
    pub pairs: Option<Vec<NodePair>>,
}

/// Lines on the base mesh along which springs run.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Along {
    /// Springs of free rings and rims.
    free: bool,
    /// Which base edges; empty for none.
    edges: Vec<bool>,
}

/// One line on the base mesh, or all of a kind.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Line {
    /// All free rings and rims.
    Free,
    /// All seams: where parts are joined.
    Seams,
    /// A border by its number in the base mesh.
    Border(usize),
}

impl CellChoice {
    /// No condition is given.
    pub fn is_all(&self) -> bool {
        *self == CellChoice::default()
    }

    /// The choice holds a cell.
    pub fn holds(&self, mesh: &BaseMesh, cell: &ExpressedCell) -> bool {
        let place = cell.place;
        let in_part =
            |parts: &Vec<u32>| mesh.map().get(place.face as usize).is_some_and(|at| parts.contains(&at.part));
        self.parts.as_ref().is_none_or(in_part)
            && self.types.as_ref().is_none_or(|types| types.contains(&cell.content.kind))
            && self.levels.as_ref().is_none_or(|levels| levels.contains(&place.level))
            && self.places.as_ref().is_none_or(|places| places.iter().any(|above| above.contains(place)))
    }

    /// Which expressed cells the choice holds.
    pub(super) fn chosen(&self, mesh: &BaseMesh, expression: &Expression) -> Vec<bool> {
        expression.cells.iter().map(|cell| self.holds(mesh, cell)).collect()
    }
}

impl SpringChoice {
    /// Which springs of the net the choice holds.
    pub fn chosen(&self, mesh: &BaseMesh, expression: &Expression) -> Vec<bool> {
        let mut chosen = match &self.pairs {
            None => vec![true; expression.springs.len()],
            Some(pairs) => between(pairs, expression),
        };
        if !self.cells.is_all() {
            let cells = self.cells.chosen(mesh, expression);
            let owned =
                |spring: u32| expression.spring_cells.of(spring).iter().any(|&cell| cells[cell as usize]);
            chosen.iter_mut().zip(0..).for_each(|(chosen, spring)| *chosen &= owned(spring));
        }
        if let Some(along) = &self.along {
            for (chosen, spring) in chosen.iter_mut().zip(&expression.springs) {
                *chosen = *chosen
                    && (along.free && spring.ring
                        || along.has_edge(mesh, spring.nodes.map(|node| expression.nodes[node as usize])));
            }
        }
        chosen
    }
}

impl Along {
    /// Lines of a base mesh; borders are ones that it has.
    pub fn new(mesh: &BaseMesh, lines: &[Line]) -> Along {
        let mut edges = Vec::new();
        let mut add = |border: usize, seams_only: bool| {
            edges.resize(mesh.edges().len(), false);
            let border = &mesh.borders()[border];
            let last = border.path.len() - usize::from(!border.closed);
            for at in 0..last {
                let ends = [border.path[at], border.path[(at + 1) % border.path.len()]];
                if let Some(edge) = mesh.edge_between(ends[0], ends[1]) {
                    edges[edge as usize] |= !(seams_only && mesh.is_free_edge(edge));
                }
            }
        };
        for line in lines {
            match *line {
                Line::Free => {}
                Line::Seams => (0..mesh.borders().len()).for_each(|border| add(border, true)),
                Line::Border(border) => add(border, false),
            }
        }
        Along { free: lines.contains(&Line::Free), edges }
    }

    fn has_edge(&self, mesh: &BaseMesh, ends: [NodeKey; 2]) -> bool {
        !self.edges.is_empty() && base_edge(mesh, ends).is_some_and(|edge| self.edges[edge as usize])
    }
}

/// The base edge that two nodes lie on.
fn base_edge(mesh: &BaseMesh, ends: [NodeKey; 2]) -> Option<u32> {
    let has_end = |edge: u32, vertex: u32| mesh.edges()[edge as usize].contains(&vertex);
    match ends.map(NodeKey::place) {
        [NodePlace::Vertex(a), NodePlace::Vertex(b)] => mesh.edge_between(a, b),
        [NodePlace::Vertex(vertex), NodePlace::Edge { edge, .. }]
        | [NodePlace::Edge { edge, .. }, NodePlace::Vertex(vertex)] => has_end(edge, vertex).then_some(edge),
        [NodePlace::Edge { edge, .. }, NodePlace::Edge { edge: other, .. }] => {
            (edge == other).then_some(edge)
        }
        _ => None,
    }
}

/// Which springs lie between the nodes of a pair; pairs without a spring are passed over.
fn between(pairs: &[NodePair], expression: &Expression) -> Vec<bool> {
    let mut chosen = vec![false; expression.springs.len()];
    pairs
        .iter()
        .filter_map(|&pair| spring_between(pair, expression))
        .for_each(|spring| chosen[spring] = true);
    chosen
}

/// The spring between two nodes; `None` while the net lacks it.
pub(super) fn spring_between(pair: NodePair, expression: &Expression) -> Option<usize> {
    let [a, b] = pair.keys().map(|key| expression.node(key));
    let (a, b) = (a?, b?);
    let ends = [a.min(b), a.max(b)];
    expression.springs.binary_search_by_key(&ends, |spring| spring.nodes).ok()
}

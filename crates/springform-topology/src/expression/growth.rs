//! Growth: expresses one forest after the other in the same memory.

use super::springs::Gathering;
use super::stitching::{NONE, Stitching};
use super::{ExpressedCell, Expression, ExpressionError};
use crate::base_mesh::BaseMesh;
use crate::cell_type::{Catalogue, Point};
use crate::filters::Method;
use crate::filters::continuity::Search;
use crate::filters::recursive::{Support, support_springs};
use crate::forest::{Content, Forest, Override};

/// Expresses forests without asking for new memory, once it has seen one of the size; what it gives depends on
/// nothing that it expressed before.
#[derive(Clone, Default)]
pub struct Growth {
    expression: Expression,
    stitching: Stitching,
    gathering: Gathering,
    /// First spring that a cell gathers beside those along its sides, one more at the end.
    inner: Vec<u32>,
    /// Pairs of nodes whose springs a hand has cut, ascending.
    cut: Vec<[u32; 2]>,
    /// Place of every gathered spring among the sorted ones, or `NONE`; for owners only.
    sorted: Vec<u32>,
    search: Search,
    /// Numbers of nodes and springs after the filter, `NONE` for those that are left out; empty if all stay.
    node_numbers: Vec<u32>,
    spring_numbers: Vec<u32>,
    /// Anchors without springs after the filter.
    loose: Vec<usize>,
}

impl Growth {
    /// Grows nodes and springs as [`super::express`] does, but for `cell_springs` and `spring_cells`.
    ///
    /// # Errors
    /// Those of [`super::express`].
    pub fn express(
        &mut self,
        mesh: &BaseMesh,
        forest: &Forest,
        catalogue: &Catalogue,
        method: Method,
        anchors: &[u32],
    ) -> Result<&Expression, ExpressionError> {
        self.express_observed(mesh, forest, catalogue, method, anchors, || {})
    }

    /// Does the same and calls `grown` whenever nodes and springs are grown and the continuity filter begins.
    ///
    /// # Errors
    /// Those of [`super::express`].
    pub fn express_observed(
        &mut self,
        mesh: &BaseMesh,
        forest: &Forest,
        catalogue: &Catalogue,
        method: Method,
        anchors: &[u32],
        mut grown: impl FnMut(),
    ) -> Result<&Expression, ExpressionError> {
        self.expression.cell_springs.clear();
        self.expression.spring_cells.clear();
        self.expression.cells.clear();
        loop {
            self.stitching.stitch(mesh, forest, catalogue, method, &mut self.expression.cells);
            check_types(&self.expression.cells, catalogue, method)?;
            self.gather(catalogue, method, forest);
            grown();
            self.filter(anchors);
            let Some(&loose) = self.loose.first() else {
                self.finish(anchors);
                return Ok(&self.expression);
            };
            if !self.restore_quads(anchors) {
                let empty = self.node_numbers.iter().all(|&number| number == NONE);
                return Err(if empty { ExpressionError::Empty } else { ExpressionError::LooseAnchor(loose) });
            }
        }
    }

    /// What was expressed last; of no use after an error.
    pub fn expression(&self) -> &Expression {
        &self.expression
    }

    /// What was expressed last, without the memory.
    pub fn into_expression(self) -> Expression {
        self.expression
    }

    /// Adds `cell_springs` and `spring_cells` to what was expressed last.
    pub fn add_owners(&mut self) {
        let Growth { expression, stitching, gathering, inner, sorted, cut, spring_numbers, .. } = self;
        let Expression { cells, springs, cell_springs, spring_cells, .. } = expression;
        gathering.list_sorted(cut, sorted);
        cell_springs.clear();
        for cell in 0..cells.len() {
            cell_springs.add(|items| {
                let first = items.len();
                let mut own = |gathered: u32| {
                    let sorted = sorted[gathered as usize];
                    let number = spring_numbers.get(sorted as usize).copied().unwrap_or(sorted);
                    if number != NONE {
                        insert_sorted(items, first, number);
                    }
                };
                stitching.visit_own_sides(cell, &mut own);
                (inner[cell]..inner[cell + 1]).for_each(own);
            });
        }
        let owned = cell_springs.items().iter().zip(owners(cell_springs.starts()));
        spring_cells.regroup(springs.len(), owned.map(|(&spring, cell)| (spring, cell)));
    }

    fn gather(&mut self, catalogue: &Catalogue, method: Method, forest: &Forest) {
        let Growth { expression, stitching, gathering, inner, cut, .. } = self;
        let Expression { cells, springs, cell_boundaries, .. } = expression;
        gathering.begin(stitching.nodes.len());
        stitching.visit_springs(|nodes, ring| gathering.gather(nodes, ring));
        inner.clear();
        cell_boundaries.clear();
        for (cell, expressed) in cells.iter().enumerate() {
            inner.push(gathering.len());
            let (hanging, boundary) = cell_boundaries.add(|items| stitching.append_boundary(cell, items));
            let kind = catalogue.get(expressed.content.kind);
            if kind.fan {
                let centre = stitching.number(cell, Point::Centre);
                for &node in boundary {
                    gathering.gather([centre, node], false);
                }
            }
            for points in &kind.springs {
                let ends = points.map(|point| stitching.number(cell, point.turned(expressed.content.turn)));
                gathering.gather(ends, false);
            }
            if method == Method::Recursive {
                for ends in support_springs(hanging) {
                    gathering.gather(ends.map(|end| stitching.number(cell, support(end))), false);
                }
            }
        }
        inner.push(gathering.len());
        cut.clear();
        for (pair, what) in forest.overrides() {
            let [Ok(a), Ok(b)] = pair.keys().map(|key| stitching.nodes.binary_search(&key)) else { continue };
            match what {
                Override::Added => drop(gathering.gather([a as u32, b as u32], false)),
                // Keys ascend, and so do the numbers of nodes.
                Override::Cut => cut.push([a as u32, b as u32]),
            }
        }
        gathering.sort(cut, springs);
    }

    /// Numbers what carries force, and lists the anchors at which nothing does.
    fn filter(&mut self, anchors: &[u32]) {
        let Growth { expression, stitching, search, node_numbers, spring_numbers, loose, .. } = self;
        let springs = &expression.springs;
        let nodes = stitching.nodes.len();
        let numbers = anchors.iter().map(|&vertex| stitching.vertex(vertex));
        search.run(nodes, springs.iter().map(|spring| spring.nodes), numbers.clone());
        loose.clear();
        node_numbers.clear();
        spring_numbers.clear();
        if search.all_carry() {
            return;
        }
        node_numbers.resize(nodes, NONE);
        let mut kept = 0;
        spring_numbers.extend(springs.iter().map(|spring| {
            if !search.carries(spring.nodes) {
                return NONE;
            }
            spring.nodes.into_iter().for_each(|node| node_numbers[node as usize] = 0);
            kept += 1;
            kept - 1
        }));
        let present = node_numbers.iter_mut().filter(|number| **number != NONE);
        present.zip(0..).for_each(|(node, number)| *node = number);
        let numbered = numbers.map(|node| node_numbers[node as usize]).enumerate();
        loose.extend(numbered.filter(|&(_, number)| number == NONE).map(|(anchor, _)| anchor));
    }

    /// Leaves out what carries nothing.
    fn finish(&mut self, anchors: &[u32]) {
        let Growth { expression, stitching, node_numbers, spring_numbers, .. } = self;
        let vertices = anchors.iter().map(|&vertex| stitching.vertex(vertex));
        expression.anchors.clear();
        expression.anchors.extend(vertices);
        std::mem::swap(&mut expression.nodes, &mut stitching.nodes);
        if spring_numbers.is_empty() {
            return;
        }
        let number = |node: u32| node_numbers[node as usize];
        expression.anchors.iter_mut().for_each(|anchor| *anchor = number(*anchor));
        let mut at = node_numbers.iter();
        expression.nodes.retain(|_| at.next() != Some(&NONE));
        let mut at = spring_numbers.iter();
        expression.springs.retain_mut(|spring| {
            spring.nodes = spring.nodes.map(number);
            at.next() != Some(&NONE)
        });
        expression.cell_boundaries.filter_map(|node| Some(number(node)).filter(|&number| number != NONE));
    }

    /// Cells at loose anchors become plain quads; false if all of them were.
    fn restore_quads(&mut self, anchors: &[u32]) -> bool {
        let mut changed = false;
        for (cell, expressed) in self.expression.cells.iter_mut().enumerate() {
            let loose = |&anchor: &usize| self.stitching.has_corner(cell, anchors[anchor]);
            if expressed.content != Content::QUAD && self.loose.iter().any(loose) {
                expressed.content = Content::QUAD;
                changed = true;
            }
        }
        changed
    }
}

fn check_types(
    cells: &[ExpressedCell],
    catalogue: &Catalogue,
    method: Method,
) -> Result<(), ExpressionError> {
    if method == Method::Dynamic {
        return Ok(());
    }
    let refused = |cell: &&ExpressedCell| !method.allows(cell.content.kind, catalogue);
    match cells.iter().find(refused) {
        None => Ok(()),
        Some(cell) => Err(ExpressionError::Type {
            place: cell.place,
            word: catalogue.word(cell.content.kind),
            method: method.name(),
            allowed: method.allowed_words(),
        }),
    }
}

fn support(end: Support) -> Point {
    match end {
        Support::Hanging(side) => Point::Middle(side),
        Support::Corner(corner) => Point::Corner(corner),
        Support::Centre => Point::Centre,
    }
}

/// Inserts a number into `items[first..]`, which ascends, unless it is there.
fn insert_sorted(items: &mut Vec<u32>, first: usize, number: u32) {
    // Numbers come in nearly ascending order.
    let at = items[first..].iter().rposition(|&item| item <= number).map_or(first, |at| first + at + 1);
    if at == first || items[at - 1] != number {
        items.insert(at, number);
    }
}

/// The group of every item.
fn owners(starts: &[u32]) -> impl Iterator<Item = u32> + Clone {
    let groups = starts.windows(2).zip(0..);
    groups.flat_map(|(ends, group)| (ends[0]..ends[1]).map(move |_| group))
}

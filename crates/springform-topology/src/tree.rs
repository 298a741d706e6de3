//! Trees: one cell with all that is stored under it, taken out of a forest, turned, mirrored and written back.

use crate::MAX_LEVEL;
use crate::address::Place;
use crate::cell_type::{Catalogue, CellTypeId};
use crate::edit::{Edit, EditError};
use crate::forest::{CellIndex, Content, Forest};
use crate::notation::{NotationError, read_top_cell, write_cell};
use crate::orientation::{Mirrors, Orientation};

/// A cell and its subtree, of no place.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Tree {
    /// Type and turn.
    pub content: Content,
    /// The switch; on without children.
    pub on: bool,
    /// The stored children 0–3.
    pub children: Option<Box<[Tree; 4]>>,
}

impl Tree {
    /// A cell without children.
    pub fn leaf(content: Content) -> Tree {
        Tree { content, on: true, children: None }
    }

    /// What a forest holds in a cell.
    pub fn of(forest: &Forest, cell: CellIndex) -> Tree {
        let children =
            forest.children(cell).map(|children| Box::new(children.map(|child| Tree::of(forest, child))));
        Tree { content: forest.content(cell), on: forest.is_on(cell), children }
    }

    /// Levels below the cell.
    pub fn depth(&self) -> u8 {
        let below = self.children.iter().flat_map(|children| children.iter());
        below.map(|child| child.depth() + 1).max().unwrap_or(0)
    }

    /// Number of cells, the first included.
    pub fn cells(&self) -> usize {
        1 + self.children.iter().flat_map(|children| children.iter()).map(Tree::cells).sum::<usize>()
    }

    /// Calls `visit` with the content of every cell, parents first.
    pub fn visit(&self, visit: &mut impl FnMut(Content)) {
        visit(self.content);
        self.children.iter().flat_map(|children| children.iter()).for_each(|child| child.visit(visit));
    }

    /// The tree as it comes to lie: child k becomes child `orientation.corner(k)`.
    ///
    /// # Errors
    /// A type that would be mirrored and has no mirror image.
    pub fn oriented(&self, orientation: Orientation, mirrors: &Mirrors) -> Result<Tree, CellTypeId> {
        let content = orientation.content(self.content, mirrors)?;
        let children = match &self.children {
            None => None,
            Some(children) => {
                let mut moved = children.clone();
                for (k, child) in (0..).zip(children.iter()) {
                    moved[usize::from(orientation.corner(k))] = child.oriented(orientation, mirrors)?;
                }
                Some(moved)
            }
        };
        Ok(Tree { content, on: self.on, children })
    }

    /// Cell notation.
    pub fn write(&self, catalogue: &Catalogue) -> String {
        let mut forest = Forest::new(1, self.content);
        self.grow(&mut forest, CellIndex(0));
        write_cell(&forest, forest.top(0), catalogue)
    }

    /// Grows the tree in a cell without children.
    pub(crate) fn grow(&self, forest: &mut Forest, cell: CellIndex) {
        forest.set_content(cell, self.content);
        if let Some(children) = &self.children {
            let contents: [Content; 4] = std::array::from_fn(|k| children[k].content);
            let cells = forest.add_children(cell, contents);
            children.iter().zip(cells).for_each(|(child, cell)| child.grow(forest, cell));
            forest.set_on(cell, self.on);
        }
    }

    /// Reads cell notation.
    ///
    /// # Errors
    /// Where and why the text is no cell notation.
    pub fn read(text: &str, catalogue: &Catalogue) -> Result<Tree, NotationError> {
        let mut forest = Forest::new(1, Content::QUAD);
        read_top_cell(&mut forest, 0, text, catalogue)?;
        Ok(Tree::of(&forest, forest.top(0)))
    }

    /// Writes the tree over the cell at a place; only what differs is edited, and appended to `edits`.
    ///
    /// # Errors
    /// There is no cell, or the tree reaches beyond the deepest level.
    pub fn write_over(
        &self,
        forest: &mut Forest,
        place: Place,
        edits: &mut Vec<Edit>,
    ) -> Result<(), EditError> {
        let cell = forest.find(place).ok_or(EditError::NoCell(place))?;
        if place.level + self.depth() > MAX_LEVEL {
            return Err(EditError::Subdivide(place, "what is grafted lies too deep"));
        }
        let from = forest.content(cell);
        if from != self.content {
            perform(Edit::Retype { cell: place, from, to: self.content }, forest, edits)?;
        }
        match (&self.children, forest.children(cell)) {
            (None, None) => return Ok(()),
            (None, Some(_)) => return clear(forest, place, edits),
            (Some(children), None) => {
                let contents = std::array::from_fn(|k| children[k].content);
                perform(Edit::Subdivide { cell: place, children: contents }, forest, edits)?;
            }
            (Some(_), Some(_)) => {}
        }
        for (k, child) in (0..).zip(self.children.iter().flat_map(|children| children.iter())) {
            child.write_over(forest, place.child(k), edits)?;
        }
        if forest.is_on(cell) != self.on {
            perform(Edit::Toggle { cell: place, on: self.on }, forest, edits)?;
        }
        Ok(())
    }
}

/// Takes away everything that is stored under a cell.
fn clear(forest: &mut Forest, place: Place, edits: &mut Vec<Edit>) -> Result<(), EditError> {
    let cell = forest.find(place).ok_or(EditError::NoCell(place))?;
    let Some(children) = forest.children(cell) else { return Ok(()) };
    for k in 0..4 {
        clear(forest, place.child(k), edits)?;
    }
    if !forest.is_on(cell) {
        perform(Edit::Toggle { cell: place, on: true }, forest, edits)?;
    }
    let children = children.map(|child| forest.content(child));
    perform(Edit::Merge { cell: place, children }, forest, edits)
}

/// Applies an edit and keeps it.
pub(crate) fn perform(edit: Edit, forest: &mut Forest, edits: &mut Vec<Edit>) -> Result<(), EditError> {
    edit.apply(forest)?;
    edits.push(edit);
    Ok(())
}

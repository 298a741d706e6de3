//! `Edit`: the one vocabulary of change. A click, a mutation, a filter's closure, an undo are lists of edits.
//!
//! Every edit holds what it replaces, so that it can be inverted and checked against the forest it meets.
//! Written as text, one edit a line:
//!
//! ```text
//! 12.0 subdivide 1 1 6 1       12.0.3 retype 1 3@1       v3 e7:1/2 cut        v1 v17 add
//! 12.0 merge 1 1 6 1           12 off      12 on         v3 e7:1/2 uncut      v1 v17 unadd
//! 12 refer crown@1m            12 release crown@1m
//! ```

use crate::MAX_LEVEL;
use crate::address::{AddressError, Place};
use crate::base_mesh::BaseMesh;
use crate::cell_type::Catalogue;
use crate::forest::{CellIndex, Content, Forest, NodePair, Override};
use crate::gene::Reference;
use crate::node_key::{NodeKey, NodeKeyError};
use crate::notation::{NotationError, parse_content, write_content};
use thiserror::Error;

/// One invertible change of a forest.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Edit {
    /// Gives a cell without children four children, switched on.
    Subdivide {
        /// The cell.
        cell: Place,
        /// Contents of children 0–3.
        children: [Content; 4],
    },
    /// Takes away four childless children, switched on.
    Merge {
        /// The cell.
        cell: Place,
        /// Contents of children 0–3, as they are.
        children: [Content; 4],
    },
    /// Changes type and turn of a cell.
    Retype {
        /// The cell.
        cell: Place,
        /// As it is.
        from: Content,
        /// As it becomes.
        to: Content,
    },
    /// Switches the stored children of a cell on or off.
    Toggle {
        /// The cell.
        cell: Place,
        /// The state that it gets.
        on: bool,
    },
    /// Adds or cuts the spring between two nodes, or takes that back.
    Override {
        /// The nodes.
        pair: NodePair,
        /// What is done to the spring.
        what: Override,
        /// Done, or taken back.
        set: bool,
    },
    /// Holds a gene by reference, or no more; the cells stay as they are.
    Refer {
        /// Top-level cell of the seed.
        seed: u32,
        /// Gene and orientation.
        reference: Reference,
        /// Held, or no more.
        set: bool,
    },
}

/// Why an edit does not fit a forest, or a text is no edit.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum EditError {
    /// There is no cell at the address.
    #[error("cell {0} does not exist")]
    NoCell(Place),
    /// Subdividing a cell that has children, or one at the deepest level.
    #[error("cell {0} can't be subdivided: {1}")]
    Subdivide(Place, &'static str),
    /// Merging a cell whose children are not as said, switched on and childless.
    #[error("cell {0} can't be merged: its children are not as the edit says, on and undivided")]
    Merge(Place),
    /// The content is not what the edit replaces.
    #[error("cell {0} is not of the type that the edit replaces")]
    Retype(Place),
    /// Nothing to switch, or already in that state.
    #[error("cell {0} can't be switched: {1}")]
    Toggle(Place, &'static str),
    /// The spring is already overridden, or not as the edit says.
    #[error("the spring {0} {1} is already overridden, or is not as the edit says")]
    Override(NodeKey, NodeKey),
    /// The cell holds a gene already, or not the one that the edit says.
    #[error("cell {0} already holds a gene, or not the one that the edit says")]
    Refer(u32),
    /// A text with other words.
    #[error(
        "'{0}' is not an edit; write such as '12.0 subdivide 1 1 1 1', '12 retype 1 3@1', '12 off', 'v1 v2 cut'"
    )]
    Malformed(String),
    /// A text with a bad address.
    #[error(transparent)]
    Address(#[from] AddressError),
    /// A text with a bad content.
    #[error(transparent)]
    Notation(#[from] NotationError),
    /// A text with a bad node.
    #[error(transparent)]
    NodeKey(#[from] NodeKeyError),
}

impl Edit {
    /// The edit that undoes this one.
    pub fn inverse(self) -> Edit {
        match self {
            Edit::Subdivide { cell, children } => Edit::Merge { cell, children },
            Edit::Merge { cell, children } => Edit::Subdivide { cell, children },
            Edit::Retype { cell, from, to } => Edit::Retype { cell, from: to, to: from },
            Edit::Toggle { cell, on } => Edit::Toggle { cell, on: !on },
            Edit::Override { pair, what, set } => Edit::Override { pair, what, set: !set },
            Edit::Refer { seed, reference, set } => Edit::Refer { seed, reference, set: !set },
        }
    }

    /// The cell that the edit is about; `None` for a spring between two nodes.
    pub fn cell(&self) -> Option<Place> {
        match self {
            Edit::Subdivide { cell, .. }
            | Edit::Merge { cell, .. }
            | Edit::Retype { cell, .. }
            | Edit::Toggle { cell, .. } => Some(*cell),
            Edit::Override { .. } | Edit::Refer { .. } => None,
        }
    }

    /// Applies the edit; a refused edit leaves the forest as it was.
    ///
    /// # Errors
    /// The edit does not fit the forest.
    pub fn apply(self, forest: &mut Forest) -> Result<(), EditError> {
        let find = |forest: &Forest, cell: Place| forest.find(cell).ok_or(EditError::NoCell(cell));
        match self {
            Edit::Subdivide { cell, children } => {
                let index = find(forest, cell)?;
                if forest.children(index).is_some() {
                    return Err(EditError::Subdivide(cell, "it has children"));
                }
                if cell.level >= MAX_LEVEL {
                    return Err(EditError::Subdivide(cell, "it lies at the deepest level"));
                }
                forest.add_children(index, children);
            }
            Edit::Merge { cell, children } => {
                let index = find(forest, cell)?;
                let stored = forest.expressed_children(index).ok_or(EditError::Merge(cell))?;
                let as_said = |(child, content): (CellIndex, Content)| {
                    forest.children(child).is_none() && forest.content(child) == content
                };
                if !stored.into_iter().zip(children).all(as_said) {
                    return Err(EditError::Merge(cell));
                }
                forest.remove_children(index);
            }
            Edit::Retype { cell, from, to } => {
                let index = find(forest, cell)?;
                if forest.content(index) != from {
                    return Err(EditError::Retype(cell));
                }
                forest.set_content(index, to);
            }
            Edit::Toggle { cell, on } => {
                let index = find(forest, cell)?;
                if forest.children(index).is_none() {
                    return Err(EditError::Toggle(cell, "it has no children"));
                }
                if forest.is_on(index) == on {
                    return Err(EditError::Toggle(cell, "it already is so"));
                }
                forest.set_on(index, on);
            }
            Edit::Override { pair, what, set } => {
                let expected = if set { None } else { Some(what) };
                if forest.overrides().get(&pair).copied() != expected {
                    let [a, b] = pair.keys();
                    return Err(EditError::Override(a, b));
                }
                forest.set_override(pair, set.then_some(what));
            }
            Edit::Refer { seed, reference, set } => {
                if seed >= forest.top_level() {
                    return Err(EditError::NoCell(Place::top(seed)));
                }
                if forest.references().get(&seed).copied() != (!set).then_some(reference) {
                    return Err(EditError::Refer(seed));
                }
                forest.set_reference(seed, set.then_some(reference));
            }
        }
        Ok(())
    }

    /// Applies edits in order; if one is refused, the earlier ones are undone.
    ///
    /// # Errors
    /// The first edit that does not fit.
    pub fn apply_all(edits: &[Edit], forest: &mut Forest) -> Result<(), EditError> {
        for (done, edit) in edits.iter().enumerate() {
            if let Err(error) = edit.apply(forest) {
                for earlier in edits[..done].iter().rev() {
                    earlier.inverse().apply(forest)?;
                }
                return Err(error);
            }
        }
        Ok(())
    }

    /// The edits that undo a list of edits.
    pub fn invert_all(edits: &[Edit]) -> Vec<Edit> {
        edits.iter().rev().map(|edit| edit.inverse()).collect()
    }

    /// One line of text.
    pub fn write(&self, catalogue: &Catalogue) -> String {
        let words = |contents: &[Content]| {
            let words: Vec<_> = contents.iter().map(|&content| write_content(content, catalogue)).collect();
            words.join(" ")
        };
        match self {
            Edit::Subdivide { cell, children } => format!("{cell} subdivide {}", words(children)),
            Edit::Merge { cell, children } => format!("{cell} merge {}", words(children)),
            Edit::Retype { cell, from, to } => format!("{cell} retype {}", words(&[*from, *to])),
            Edit::Toggle { cell, on: true } => format!("{cell} on"),
            Edit::Toggle { cell, on: false } => format!("{cell} off"),
            Edit::Override { pair, what, set } => {
                let [a, b] = pair.keys();
                let verb = match (what, set) {
                    (Override::Added, true) => "add",
                    (Override::Added, false) => "unadd",
                    (Override::Cut, true) => "cut",
                    (Override::Cut, false) => "uncut",
                };
                format!("{a} {b} {verb}")
            }
            Edit::Refer { seed, reference, set } => {
                let verb = if *set { "refer" } else { "release" };
                format!("{seed} {verb} {}", reference.write(catalogue))
            }
        }
    }

    /// Reads one line of text.
    ///
    /// # Errors
    /// Not an edit, or one that names what does not exist.
    pub fn parse(text: &str, mesh: &BaseMesh, catalogue: &Catalogue) -> Result<Edit, EditError> {
        let malformed = || EditError::Malformed(text.to_owned());
        let words: Vec<&str> = text.split_whitespace().collect();
        let contents = |words: &[&str]| -> Result<[Content; 4], EditError> {
            let contents =
                words.iter().map(|word| parse_content(word, catalogue)).collect::<Result<Vec<_>, _>>()?;
            contents.try_into().map_err(|_| malformed())
        };
        match words.as_slice() {
            [cell, "subdivide", children @ ..] => {
                Ok(Edit::Subdivide { cell: Place::parse(cell)?, children: contents(children)? })
            }
            [cell, "merge", children @ ..] => {
                Ok(Edit::Merge { cell: Place::parse(cell)?, children: contents(children)? })
            }
            [cell, "retype", from, to] => Ok(Edit::Retype {
                cell: Place::parse(cell)?,
                from: parse_content(from, catalogue)?,
                to: parse_content(to, catalogue)?,
            }),
            [cell, verb @ ("refer" | "release"), gene] => {
                let place = Place::parse(cell)?;
                let reference = Reference::parse(gene, catalogue).filter(|_| place.level == 0);
                let reference = reference.ok_or_else(malformed)?;
                Ok(Edit::Refer { seed: place.face, reference, set: *verb == "refer" })
            }
            [cell, state @ ("on" | "off")] => {
                Ok(Edit::Toggle { cell: Place::parse(cell)?, on: *state == "on" })
            }
            [a, b, verb @ ("add" | "unadd" | "cut" | "uncut")] => {
                let (a, b) = (NodeKey::parse(a, mesh)?, NodeKey::parse(b, mesh)?);
                let pair = NodePair::new(a, b).ok_or_else(malformed)?;
                let what = if verb.ends_with("add") { Override::Added } else { Override::Cut };
                Ok(Edit::Override { pair, what, set: !verb.starts_with("un") })
            }
            _ => Err(malformed()),
        }
    }
}

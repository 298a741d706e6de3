//! Cell notation: a quadtree as a short line of text (the paper's cell identifier notation made readable).
//!
//! ```text
//! cell     = content [ "(" four cells ")" | "[" four cells "]" ]    (…) on, […] stored but switched off
//! content  = type [ "@" turn ]                                      type: number or name, turn: 1–3
//! 1(1 1 6 3@1[1 1 1 1])
//! ```

use crate::MAX_LEVEL;
use crate::address::Place;
use crate::cell_type::Catalogue;
use crate::forest::{CellIndex, Content, Forest};
use std::fmt::Write;
use thiserror::Error;

/// Why a text is no cell notation; columns count from 1.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum NotationError {
    /// Something else was expected.
    #[error("column {column}: expected {expected}; a cell is written like 1(1 1 6 3@1)")]
    Expected {
        /// Where.
        column: usize,
        /// What.
        expected: &'static str,
    },
    /// The type is not in the catalogue.
    #[error("column {column}: unknown cell type '{word}'; use 0-6 or a name defined under cell_types")]
    UnknownType {
        /// Where.
        column: usize,
        /// The word found.
        word: String,
    },
    /// Deeper than [`MAX_LEVEL`].
    #[error("column {column}: deeper than level {MAX_LEVEL}, the deepest possible")]
    TooDeep {
        /// Where.
        column: usize,
    },
}

/// Writes type and turn.
pub fn write_content(content: Content, catalogue: &Catalogue) -> String {
    let mut text = catalogue.word(content.kind);
    if content.turn > 0 {
        let _ = write!(text, "@{}", content.turn);
    }
    text
}

/// Reads type and turn.
///
/// # Errors
/// Not a content, or an unknown type.
pub fn parse_content(text: &str, catalogue: &Catalogue) -> Result<Content, NotationError> {
    let mut reader = Reader { text, position: 0, catalogue };
    let content = reader.content()?;
    reader.end()?;
    Ok(content)
}

/// Writes a cell with all that is stored under it.
pub fn write_cell(forest: &Forest, cell: CellIndex, catalogue: &Catalogue) -> String {
    let mut text = String::new();
    append(&mut text, forest, cell, catalogue);
    text
}

fn append(text: &mut String, forest: &Forest, cell: CellIndex, catalogue: &Catalogue) {
    text.push_str(&write_content(forest.content(cell), catalogue));
    if let Some(children) = forest.children(cell) {
        let (open, close) = if forest.is_on(cell) { ('(', ')') } else { ('[', ']') };
        text.push(open);
        for (k, child) in children.into_iter().enumerate() {
            if k > 0 {
                text.push(' ');
            }
            append(text, forest, child, catalogue);
        }
        text.push(close);
    }
}

/// Reads a cell into a forest, in place of a top-level cell that has no children.
///
/// # Errors
/// Where and why the text is no cell notation; the forest is then left half read and is to be thrown away.
pub fn read_top_cell(
    forest: &mut Forest,
    face: u32,
    text: &str,
    catalogue: &Catalogue,
) -> Result<(), NotationError> {
    let mut reader = Reader { text, position: 0, catalogue };
    reader.cell(forest, forest.top(face), Place::top(face))?;
    reader.end()
}

struct Reader<'a> {
    text: &'a str,
    position: usize,
    catalogue: &'a Catalogue,
}

impl Reader<'_> {
    fn cell(&mut self, forest: &mut Forest, cell: CellIndex, place: Place) -> Result<(), NotationError> {
        let content = self.content()?;
        forest.set_content(cell, content);
        let close = match self.peek() {
            Some(b'(') => b')',
            Some(b'[') => b']',
            _ => return Ok(()),
        };
        if place.level == MAX_LEVEL {
            return Err(NotationError::TooDeep { column: self.position + 1 });
        }
        self.position += 1;
        let children = forest.add_children(cell, [content; 4]);
        forest.set_on(cell, close == b')');
        for (k, child) in children.into_iter().enumerate() {
            self.skip_spaces();
            self.cell(forest, child, place.child(k as u8))?;
        }
        self.skip_spaces();
        if self.peek() != Some(close) {
            let expected = if close == b')' { "')' after four children" } else { "']' after four children" };
            return Err(NotationError::Expected { column: self.position + 1, expected });
        }
        self.position += 1;
        Ok(())
    }

    fn content(&mut self) -> Result<Content, NotationError> {
        let column = self.position + 1;
        let rest = &self.text[self.position..];
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let word = &rest[..rest.find(|c| !is_word(c)).unwrap_or(rest.len())];
        if word.is_empty() {
            return Err(NotationError::Expected { column, expected: "a cell type" });
        }
        let kind = self
            .catalogue
            .find(word)
            .ok_or_else(|| NotationError::UnknownType { column, word: word.to_owned() })?;
        self.position += word.len();
        let mut turn = 0;
        if self.peek() == Some(b'@') {
            self.position += 1;
            turn = match self.peek() {
                Some(digit @ b'1'..=b'3') => digit - b'0',
                _ => {
                    let expected = "a turn of 1, 2 or 3 quarters";
                    return Err(NotationError::Expected { column: self.position + 1, expected });
                }
            };
            self.position += 1;
        }
        Ok(Content { kind, turn })
    }

    fn end(&mut self) -> Result<(), NotationError> {
        self.skip_spaces();
        let expected = "the end of the cell";
        match self.peek() {
            None => Ok(()),
            Some(_) => Err(NotationError::Expected { column: self.position + 1, expected }),
        }
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.position).copied()
    }

    fn skip_spaces(&mut self) {
        while self.peek() == Some(b' ') {
            self.position += 1;
        }
    }
}

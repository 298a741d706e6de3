//! Cell types: which springs a cell holds, as data (the paper §3.2, Fig. 11).
//!
//! ```text
//!   c3 ── m2 ── c2      corners c0–c3, edge middles m0–m3 (m_k lies between c_k and c_{k+1}),
//!   │           │       centre x. A turn of t quarter turns moves c_k to c_{k+t} and m_k to m_{k+t}.
//!   m3    x     m1
//!   │           │
//!   c0 ── m0 ── c1
//! ```

use crate::address::whole_number;
use crate::gene::{Gene, GeneId, GeneTable};
use thiserror::Error;

/// Number of a cell type in a [`Catalogue`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct CellTypeId(pub u8);

/// The empty type: a void.
pub const NULL: CellTypeId = CellTypeId(0);
/// The plain quad: perimeter only.
pub const QUAD: CellTypeId = CellTypeId(1);
/// The fan of the dynamic method.
pub const DYNAMIC: CellTypeId = CellTypeId(6);

/// A named point of a cell.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Point {
    /// Corner c0–c3.
    Corner(u8),
    /// Middle m0–m3 of the side from c_k to c_{k+1}.
    Middle(u8),
    /// Centre x.
    Centre,
}

impl Point {
    /// The point after `turn` quarter turns.
    pub fn turned(self, turn: u8) -> Point {
        match self {
            Point::Corner(k) => Point::Corner((k + turn) % 4),
            Point::Middle(k) => Point::Middle((k + turn) % 4),
            Point::Centre => Point::Centre,
        }
    }

    fn parse(text: &str) -> Option<Point> {
        match text.as_bytes() {
            [b'x'] => Some(Point::Centre),
            [b'c', k @ b'0'..=b'3'] => Some(Point::Corner(k - b'0')),
            [b'm', k @ b'0'..=b'3'] => Some(Point::Middle(k - b'0')),
            _ => None,
        }
    }
}

/// The springs of one cell type.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CellType {
    /// Name in cell notation; the built-in types are written by number.
    pub name: String,
    /// Springs between named points, before the turn.
    pub springs: Vec<[Point; 2]>,
    /// The four edges, stitched through every node on them.
    pub perimeter: bool,
    /// Springs from the centre to every node on the boundary.
    pub fan: bool,
}

impl CellType {
    /// Named points other than corners: a cell puts a node on each.
    pub fn points(&self) -> impl Iterator<Item = Point> + '_ {
        let centre = self.fan.then_some(Point::Centre);
        self.springs
            .iter()
            .flatten()
            .copied()
            .filter(|point| !matches!(point, Point::Corner(_)))
            .chain(centre)
    }

    /// The springs with their points moved, in one order whatever the order in which they are defined.
    pub fn springs_at(&self, moved: impl Fn(Point) -> Point) -> Vec<[Point; 2]> {
        let ends = |&[a, b]: &[Point; 2]| {
            let (a, b) = (moved(a), moved(b));
            [a.min(b), a.max(b)]
        };
        let mut springs: Vec<[Point; 2]> = self.springs.iter().map(ends).collect();
        springs.sort_unstable();
        springs.dedup();
        springs
    }

    /// How many of the four turns give different springs: 1, 2 or 4.
    pub fn distinct_turns(&self) -> u8 {
        let turned = |turn: u8| self.springs_at(|point| point.turned(turn));
        let upright = turned(0);
        [1, 2].into_iter().find(|&turn| turned(turn) == upright).unwrap_or(4)
    }
}

/// What is wrong with the definition of a cell type.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum CellTypeError {
    /// The name is not a word or is taken.
    #[error("'{0}' cannot name a cell type: use a new word of a-z, 0-9 and _ that starts with a letter")]
    Name(String),
    /// A spring is not written as two different points.
    #[error("'{0}' is not a spring: write two different points of c0-c3, m0-m3, x, such as c0-x")]
    Spring(String),
    /// More than 249 types.
    #[error("too many cell types: at most 249 can be defined")]
    TooMany,
}

/// All cell types of a design: the seven built-in ones, then the user's.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Catalogue {
    types: Vec<CellType>,
    genes: GeneTable,
}

impl Default for Catalogue {
    fn default() -> Self {
        let built_in = [
            ("null", "", false, false),
            ("quad", "", true, false),
            ("braced", "x-c0 x-c1 x-c2 x-c3", true, false),
            ("diagonal", "c0-c2", true, false),
            ("strip", "m0-m2", true, false),
            ("inscribed", "m0-m1 m1-m2 m2-m3 m3-m0", true, false),
            ("dynamic", "", false, true),
        ];
        let types = built_in
            .into_iter()
            .map(|(name, springs, perimeter, fan)| CellType {
                name: name.to_owned(),
                springs: springs.split_whitespace().filter_map(parse_spring).collect(),
                perimeter,
                fan,
            })
            .collect();
        Catalogue { types, genes: GeneTable::default() }
    }
}

impl Catalogue {
    /// Number of built-in types.
    pub const BUILT_IN: u8 = 7;

    /// Adds a user-defined type; its springs are written `c0-x`.
    ///
    /// # Errors
    /// A bad or taken name, a bad spring, too many types.
    pub fn define(
        &mut self,
        name: &str,
        springs: &[String],
        perimeter: bool,
        fan: bool,
    ) -> Result<CellTypeId, CellTypeError> {
        let word = name.starts_with(|c: char| c.is_ascii_lowercase())
            && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        if !word || self.types.iter().any(|known| known.name == name) {
            return Err(CellTypeError::Name(name.to_owned()));
        }
        if self.types.len() > usize::from(u8::MAX) {
            return Err(CellTypeError::TooMany);
        }
        let springs = springs
            .iter()
            .map(|text| parse_spring(text).ok_or_else(|| CellTypeError::Spring(text.clone())))
            .collect::<Result<Vec<_>, _>>()?;
        self.types.push(CellType { name: name.to_owned(), springs, perimeter, fan });
        Ok(CellTypeId((self.types.len() - 1) as u8))
    }

    /// The numbers of all types.
    pub fn ids(&self) -> impl Iterator<Item = CellTypeId> + use<> {
        (0..self.types.len()).map(|number| CellTypeId(number as u8))
    }

    /// The type of a number that this catalogue gave out.
    pub fn get(&self, id: CellTypeId) -> &CellType {
        &self.types[usize::from(id.0)]
    }

    /// Finds a type by number (built-in) or name.
    pub fn find(&self, word: &str) -> Option<CellTypeId> {
        let index = match whole_number(word) {
            Some(number) if number < u32::from(Self::BUILT_IN) => number as usize,
            Some(_) => return None,
            None => self.types.iter().position(|known| known.name == word)?,
        };
        Some(CellTypeId(index as u8))
    }

    /// Adds a gene; `None` if there is one of its name, or too many.
    pub fn define_gene(&mut self, gene: Gene) -> Option<GeneId> {
        self.genes.add(gene)
    }

    /// The gene of a number that this catalogue gave out.
    pub fn gene(&self, id: GeneId) -> &Gene {
        self.genes.get(id)
    }

    /// Finds a gene by name.
    pub fn find_gene(&self, name: &str) -> Option<GeneId> {
        self.genes.find(name)
    }

    /// All genes, in the order of their numbers.
    pub fn genes(&self) -> &[Gene] {
        self.genes.all()
    }

    /// How a type is written in cell notation: its number if built in, else its name.
    pub fn word(&self, id: CellTypeId) -> String {
        if id.0 < Self::BUILT_IN { id.0.to_string() } else { self.get(id).name.clone() }
    }
}

fn parse_spring(text: &str) -> Option<[Point; 2]> {
    let (a, b) = text.split_once('-')?;
    let (a, b) = (Point::parse(a.trim())?, Point::parse(b.trim())?);
    (a != b).then_some([a, b])
}

//! Orientations of a square and frames: how a cell is looked at, and how that view is carried across edges.
//!
//! ```text
//!   c3 ──2── c2     An orientation says which corner and side of a cell stand where the looker's
//!   │        │      corner k and side k are: a turn moves corner k to k + turn,
//!   3        1      a mirrored one moves it to turn − k. There are eight.
//!   │        │
//!   c0 ──0── c1
//! ```

use crate::address::Place;
use crate::base_mesh::BaseMesh;
use crate::cell_type::{Catalogue, CellType, CellTypeId, Point};
use crate::forest::Content;

/// One of the eight ways in which a square can lie on a square.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub struct Orientation {
    /// The other way round.
    pub mirrored: bool,
    /// Quarter turns, 0–3.
    pub turn: u8,
}

impl Orientation {
    /// As it is.
    pub const UPRIGHT: Orientation = Orientation { mirrored: false, turn: 0 };

    /// The orientation of some quarter turns, mirrored or not.
    pub fn new(turn: u8, mirrored: bool) -> Orientation {
        Orientation { mirrored, turn: turn % 4 }
    }

    /// All eight, unmirrored ones first.
    pub fn all() -> impl Iterator<Item = Orientation> {
        [false, true].into_iter().flat_map(|mirrored| (0..4).map(move |turn| Orientation { mirrored, turn }))
    }

    /// Where corner `k` comes to lie; the same for children, who hold their parent's corners.
    pub fn corner(self, k: u8) -> u8 {
        if self.mirrored { (4 + self.turn - k) % 4 } else { (self.turn + k) % 4 }
    }

    /// Where side `k`, from corner `k` to corner `k + 1`, comes to lie.
    pub fn side(self, k: u8) -> u8 {
        if self.mirrored { (self.turn + 7 - k) % 4 } else { (self.turn + k) % 4 }
    }

    /// This orientation after `first`.
    pub fn after(self, first: Orientation) -> Orientation {
        let turn = if self.mirrored { 4 + self.turn - first.turn } else { self.turn + first.turn };
        Orientation::new(turn, self.mirrored != first.mirrored)
    }

    /// The orientation that undoes this one.
    pub fn inverse(self) -> Orientation {
        if self.mirrored { self } else { Orientation::new(4 - self.turn, false) }
    }

    /// Where a cell of `place` comes to lie when its face is carried to another one.
    pub fn place(self, place: Place, face: u32) -> Place {
        place.path().fold(Place::top(face), |above, child| above.child(self.corner(child)))
    }

    /// Type and turn as they come to lie.
    ///
    /// # Errors
    /// The type, if it would be mirrored and has no mirror image.
    pub fn content(self, content: Content, mirrors: &Mirrors) -> Result<Content, CellTypeId> {
        if !self.mirrored {
            return Ok(Content { turn: (self.turn + content.turn) % 4, ..content });
        }
        let (kind, turn) = mirrors.image(content.kind).ok_or(content.kind)?;
        Ok(Content { kind, turn: (turn + self.turn + 4 - content.turn) % 4 })
    }
}

/// The mirror image of every type of a catalogue.
///
/// Mirroring twice gives the type back: of several types with the same springs each has an image of its own,
/// or none.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Mirrors(Vec<Option<(CellTypeId, u8)>>);

impl Mirrors {
    /// Finds the images of a catalogue's types.
    pub fn new(catalogue: &Catalogue) -> Mirrors {
        let types: Vec<&CellType> = catalogue.ids().map(|id| catalogue.get(id)).collect();
        let mut images: Vec<Option<(CellTypeId, u8)>> = vec![None; types.len()];
        for at in 0..types.len() {
            if images[at].is_some() {
                continue;
            }
            let itself = std::iter::once(at);
            let others = (at + 1..types.len()).filter(|&other| images[other].is_none());
            let found =
                itself.chain(others).find_map(|other| Some((other, image_turn(types[at], types[other])?)));
            if let Some((other, turn)) = found {
                images[at] = Some((CellTypeId(other as u8), turn));
                images[other] = Some((CellTypeId(at as u8), turn));
            }
        }
        Mirrors(images)
    }

    /// The type that is another one's image, and the turns that it needs beside; `None` if there is none.
    pub fn image(&self, kind: CellTypeId) -> Option<(CellTypeId, u8)> {
        self.0.get(usize::from(kind.0)).copied().flatten()
    }
}

/// The turn in which a type shows the springs of another one mirrored.
fn image_turn(original: &CellType, image: &CellType) -> Option<u8> {
    let mirrored = original.springs_at(|point| match point {
        Point::Corner(k) => Point::Corner((4 - k) % 4),
        Point::Middle(k) => Point::Middle(3 - k),
        Point::Centre => Point::Centre,
    });
    let alike = (original.perimeter, original.fan) == (image.perimeter, image.fan);
    alike.then(|| (0..4).find(|&turn| image.springs_at(|point| point.turned(turn)) == mirrored)).flatten()
}

/// A top-level cell as it is looked at: the looker's corner k is the cell's corner `orientation.corner(k)`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Frame {
    /// The top-level cell.
    pub face: u32,
    /// How it lies before the looker.
    pub orientation: Orientation,
}

/// Why there is no way across a side.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Barrier {
    /// No other cell lies on the edge.
    Border,
    /// More than two cells lie on the edge.
    Branching,
}

impl Frame {
    /// The frame in which a corner of a face is the first.
    pub fn at_corner(face: u32, corner: u8, mirrored: bool) -> Frame {
        Frame { face, orientation: Orientation::new(corner, mirrored) }
    }

    /// The frame across a side, numbered as the looker sees it; the view is carried along.
    ///
    /// # Errors
    /// A free edge, or one with more than two cells.
    pub fn across(self, mesh: &BaseMesh, side: u8) -> Result<Frame, Barrier> {
        let under = mesh.side_edge(self.face, self.orientation.side(side));
        let other = match mesh.faces_at_edge(under.edge) {
            [_] => return Err(Barrier::Border),
            [a, b] if a.face == self.face => b,
            [a, _] => a,
            _ => return Err(Barrier::Branching),
        };
        // The looker's corner `side` becomes the looker's corner `side + 3` beyond the edge.
        let shared = mesh.faces()[self.face as usize][usize::from(self.orientation.corner(side))];
        let corner = |k: u8| mesh.faces()[other.face as usize][usize::from(k)];
        let (first, second) = (other.side, (other.side + 1) % 4);
        let near = (side + 3) % 4;
        let orientation = if corner(second) == shared {
            Orientation::new(second + 4 - near, false)
        } else {
            Orientation::new(first + near, true)
        };
        Ok(Frame { face: other.face, orientation })
    }

    /// Where face and view go that carry `from` to this frame, seen from the face of `from` as it is.
    pub fn reached_from(self, from: Frame) -> Frame {
        Frame { orientation: self.orientation.after(from.orientation.inverse()), ..self }
    }

    /// No other cell lies on the side, numbered as the looker sees it.
    pub fn is_free(self, mesh: &BaseMesh, side: u8) -> bool {
        mesh.is_free_edge(mesh.side_edge(self.face, self.orientation.side(side)).edge)
    }
}

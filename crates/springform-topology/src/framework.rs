//! Framework: joined cylinders and sheets, as counts and pairings (the paper's metatopology, Fig. 4a).

/// Local topology of all parts (the paper, Fig. 7).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Grid {
    /// Rows of quads.
    Quad,
    /// Staggered rows; every cell is a diamond, at a free ring half a diamond.
    Dia,
}

/// Shape of a part.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// Closed `around`, with a start and an end ring.
    Cylinder,
    /// Open, with start, end, left and right sides.
    Sheet,
}

/// A cylinder or an open sheet.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Part {
    /// Name, unique in the framework.
    pub name: String,
    /// Cylinder or sheet.
    pub shape: Shape,
    /// Ring edges around a cylinder, or edges across a sheet.
    pub around: u32,
    /// Rows between start and end.
    pub along: u32,
}

/// A border of a part: a ring of a cylinder or a side of a sheet.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Side {
    /// First row.
    Start,
    /// Last row.
    End,
    /// First column of a sheet.
    Left,
    /// Last column of a sheet.
    Right,
}

impl Side {
    /// The side called `name`.
    pub fn parse(name: &str) -> Option<Side> {
        Some(match name {
            "start" => Side::Start,
            "end" => Side::End,
            "left" => Side::Left,
            "right" => Side::Right,
            _ => return None,
        })
    }

    /// Name in design files.
    pub fn name(self) -> &'static str {
        match self {
            Side::Start => "start",
            Side::End => "end",
            Side::Left => "left",
            Side::Right => "right",
        }
    }
}

/// A run of edges on a ring or side.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Arc {
    /// Index of the part.
    pub part: usize,
    /// Which border of the part.
    pub side: Side,
    /// First vertex.
    pub start: u32,
    /// Number of edges.
    pub length: u32,
}

/// Two arcs that are one.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Join {
    /// One arc.
    pub first: Arc,
    /// The other.
    pub second: Arc,
    /// The second arc runs against the first.
    pub reversed: bool,
    /// Dia-grid: keep the half diamonds and a cord along the seam.
    pub cord: bool,
}

/// The metatopology: parts and joins on one grid.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Framework {
    /// Quad-grid or dia-grid.
    pub grid: Grid,
    /// Cylinders and sheets.
    pub parts: Vec<Part>,
    /// Pairs of arcs that are identified.
    pub joins: Vec<Join>,
}

impl Part {
    /// Number of edges on a border; `None` where the part has no such border.
    pub fn border_edges(&self, side: Side, grid: Grid) -> Option<u32> {
        match (side, self.shape) {
            (Side::Start | Side::End, _) => Some(self.around),
            (_, Shape::Cylinder) => None,
            (_, Shape::Sheet) => Some(if grid == Grid::Dia { self.along / 2 } else { self.along }),
        }
    }
}

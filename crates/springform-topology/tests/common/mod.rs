//! Random designs for property tests: frameworks, meshes, forests, edits; the tests of all crates share it.

// Every test file uses another part of this.
#![allow(dead_code)]

pub mod oracle;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use springform_topology::address::Place;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::{Catalogue, CellTypeId, Point};
use springform_topology::edit::Edit;
use springform_topology::filters::{Method, recursive};
use springform_topology::forest::{CellIndex, Content, Forest, NodePair, Override};
use springform_topology::framework::{Arc, Framework, Grid, Join, Part, Shape, Side};
use springform_topology::node_key::{NodeKey, UNITS};
use springform_topology::notation::write_cell;
use std::fmt;

/// The year of the paper; `PROPTEST_RNG_SEED` explores elsewhere.
const SEED: u64 = 2015;

/// Deepest level of random cells.
const DEEPEST: u8 = 6;

/// Settings of a property: the same cases on every run.
pub fn cases(count: u32) -> Config {
    let mut config = Config { cases: count, failure_persistence: None, ..Config::default() };
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(SEED);
    }
    config
}

/// Raw random numbers from which tests build what fits; where they end, every further one is zero.
#[derive(Clone)]
pub struct Dice {
    numbers: Vec<u32>,
    next: usize,
}

/// On one line, however a failure is printed.
impl fmt::Debug for Dice {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{:?}", self.numbers)
    }
}

impl Dice {
    pub fn new(numbers: Vec<u32>) -> Dice {
        Dice { numbers, next: 0 }
    }

    pub fn below(&mut self, bound: u32) -> u32 {
        let number = self.numbers.get(self.next).copied().unwrap_or(0);
        self.next += 1;
        number % bound
    }

    pub fn between(&mut self, lowest: u32, highest: u32) -> u32 {
        lowest + self.below(highest - lowest + 1)
    }

    pub fn percent(&mut self, chance: u32) -> bool {
        self.below(100) < chance
    }

    pub fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len() as u32) as usize]
    }

    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last as u32 + 1) as usize);
        }
    }
}

/// Up to `count` raw numbers.
pub fn dice(count: usize) -> impl Strategy<Value = Dice> {
    vec(any::<u32>(), 0..=count).prop_map(Dice::new)
}

/// Raw numbers of up to `count` edits.
pub fn edit_dice(count: usize) -> impl Strategy<Value = Vec<Dice>> {
    vec(vec(any::<u32>(), 14).prop_map(Dice::new), 0..=count)
}

/// A base mesh with all that a forest is expressed with.
#[derive(Clone)]
pub struct Design {
    pub mesh: BaseMesh,
    pub catalogue: Catalogue,
    pub method: Method,
    pub anchors: Vec<u32>,
    pub forest: Forest,
}

/// Short enough to read when a property fails.
impl fmt::Debug for Design {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Design { mesh, catalogue, method, anchors, forest } = self;
        writeln!(formatter, "{} on {:?}, anchors {anchors:?}", method.name(), mesh.faces())?;
        for number in Catalogue::BUILT_IN..=Catalogue::BUILT_IN + 1 {
            writeln!(formatter, "{:?}", catalogue.get(CellTypeId(number)))?;
        }
        for face in 0..forest.top_level() {
            writeln!(formatter, "{face} = {}", write_cell(forest, forest.top(face), catalogue))?;
        }
        for (pair, what) in forest.overrides() {
            writeln!(formatter, "{} {} {what:?}", pair.keys()[0], pair.keys()[1])?;
        }
        Ok(())
    }
}

/// Designs of all methods on undivided frameworks and meshes.
pub fn designs() -> impl Strategy<Value = Design> {
    dice(90).prop_map(|mut dice| design(&mut dice))
}

/// Designs after up to `edits` random edits, closed where the method asks for it.
pub fn grown_designs(edits: usize) -> impl Strategy<Value = Design> {
    (designs(), edit_dice(edits)).prop_map(|(mut design, edits)| {
        design.grow(edits);
        design
    })
}

fn design(dice: &mut Dice) -> Design {
    let method = dice.pick(&[Method::Dynamic, Method::Extensible, Method::Recursive]);
    let mesh = mesh(dice);
    let catalogue = catalogue(dice);
    let mut vertices: Vec<u32> = (0..mesh.vertex_count()).collect();
    dice.shuffle(&mut vertices);
    vertices.truncate(dice.between(2, 5) as usize);
    let kind = if dice.percent(75) { Content::QUAD } else { content(dice, method, &catalogue) };
    let forest = Forest::new(mesh.faces().len() as u32, kind);
    Design { mesh, catalogue, method, anchors: vertices, forest }
}

impl Design {
    /// Applies random edits, then closes; returns all that was done.
    pub fn grow(&mut self, edits: Vec<Dice>) -> Vec<Edit> {
        let mut done = Vec::new();
        for mut dice in edits {
            let edit = self.random_edit(&mut dice);
            edit.apply(&mut self.forest).expect("random edits fit");
            done.push(edit);
        }
        if self.method == Method::Recursive {
            done.extend(self.close());
        }
        done
    }

    /// Balances levels.
    pub fn close(&mut self) -> Vec<Edit> {
        recursive::close(&self.mesh, &mut self.forest).expect("a valid forest closes")
    }

    /// An edit that fits the forest and the method.
    pub fn random_edit(&self, dice: &mut Dice) -> Edit {
        let cells = stored_cells(&self.forest);
        // Half of the edits go to young cells, so that levels differ widely.
        let young = if dice.percent(50) { cells.len().saturating_sub(6) } else { 0 };
        let (cell, place) = dice.pick(&cells[young..]);
        let contents: [Content; 4] = std::array::from_fn(|_| content(dice, self.method, &self.catalogue));
        let stored = self.forest.children(cell);
        let childless = stored.filter(|children| {
            self.forest.is_on(cell) && children.iter().all(|&child| self.forest.children(child).is_none())
        });
        match (dice.below(100), stored, childless) {
            (0..50, None, _) if place.level < DEEPEST => Edit::Subdivide { cell: place, children: contents },
            (0..30, Some(_), _) => Edit::Toggle { cell: place, on: !self.forest.is_on(cell) },
            (30..40, _, Some(children)) => {
                Edit::Merge { cell: place, children: children.map(|child| self.forest.content(child)) }
            }
            (80.., _, _) => self.random_override(dice),
            _ => Edit::Retype { cell: place, from: self.forest.content(cell), to: contents[0] },
        }
    }

    fn random_override(&self, dice: &mut Dice) -> Edit {
        let cells = stored_cells(&self.forest);
        let (_, first) = dice.pick(&cells);
        let second = if dice.percent(60) { first } else { dice.pick(&cells).1 };
        let (a, b) = (dice.below(9), dice.below(9));
        // Two opposite corners stand in where both points are the same.
        let pair = NodePair::new(self.key(first, a % 3, a / 3), self.key(second, b % 3, b / 3))
            .or_else(|| NodePair::new(self.key(first, 0, 0), self.key(first, 2, 2)))
            .expect("opposite corners of a cell differ");
        match self.forest.overrides().get(&pair) {
            Some(&what) => Edit::Override { pair, what, set: false },
            None => Edit::Override { pair, what: dice.pick(&[Override::Cut, Override::Added]), set: true },
        }
    }

    /// The key of a point of a cell, `right` and `up` in half cells from corner c0.
    pub fn key(&self, place: Place, right: u32, up: u32) -> NodeKey {
        let half = UNITS >> (place.level + 1);
        NodeKey::at(&self.mesh, place.face, (2 * place.i + right) * half, (2 * place.j + up) * half)
    }
}

/// Every cell of a forest, switched off or not, in order of face and child.
pub fn stored_cells(forest: &Forest) -> Vec<(CellIndex, Place)> {
    let mut open: Vec<_> =
        (0..forest.top_level()).rev().map(|face| (forest.top(face), Place::top(face))).collect();
    let mut cells = Vec::new();
    while let Some((cell, place)) = open.pop() {
        cells.push((cell, place));
        let children = forest.children(cell).into_iter().flatten();
        let below: Vec<_> = children.zip(0..4).map(|(child, k)| (child, place.child(k))).collect();
        open.extend(below.into_iter().rev());
    }
    cells
}

/// Places of expressed cells, found without the forest's own visits.
pub fn leaves(forest: &Forest) -> Vec<(CellIndex, Place)> {
    let hidden = |place: Place| {
        (0..place.level)
            .any(|level| forest.find(place.ancestor(level)).is_some_and(|above| !forest.is_on(above)))
    };
    let stands = |cell: CellIndex| forest.children(cell).is_none() || !forest.is_on(cell);
    stored_cells(forest).into_iter().filter(|&(cell, place)| stands(cell) && !hidden(place)).collect()
}

/// A base mesh: four in five from joined parts, the others from a list of quads.
pub fn mesh(dice: &mut Dice) -> BaseMesh {
    if dice.percent(80) { framework(dice).1 } else { quads(dice) }
}

/// One to four small cylinders and sheets with valid joins, and their base mesh.
pub fn framework(dice: &mut Dice) -> (Framework, BaseMesh) {
    let grid = dice.pick(&[Grid::Dia, Grid::Quad]);
    let parts = (0..dice.between(1, 4)).map(|number| part(dice, grid, number)).collect();
    let mut framework = Framework { grid, parts, joins: Vec::new() };
    let mut mesh = BaseMesh::from_framework(&framework).expect("parts without joins are valid");
    for _ in 0..dice.below(6) {
        let next = join(dice, &framework);
        framework.joins.push(next);
        match BaseMesh::from_framework(&framework) {
            Ok(joined) => mesh = joined,
            Err(_) => drop(framework.joins.pop()),
        }
    }
    (framework, mesh)
}

fn part(dice: &mut Dice, grid: Grid, number: u32) -> Part {
    let name = format!("p{number}");
    if dice.percent(60) {
        Part { name, shape: Shape::Cylinder, around: dice.between(3, 6), along: dice.between(1, 3) }
    } else {
        let along = if grid == Grid::Dia { 2 * dice.between(1, 2) } else { dice.between(1, 4) };
        Part { name, shape: Shape::Sheet, around: dice.between(1, 4), along }
    }
}

/// A join that may or may not be valid; every third one meets an arc that is joined already.
fn join(dice: &mut Dice, framework: &Framework) -> Join {
    let second = arc(dice, framework);
    let (reversed, cord) = (dice.percent(50), dice.percent(50));
    match framework.joins.last() {
        Some(last) if dice.percent(35) => Join {
            first: last.second,
            second: Arc { length: last.second.length, ..second },
            reversed,
            ..*last
        },
        _ => {
            let first = Arc { length: second.length, ..arc(dice, framework) };
            Join { first, second, reversed, cord }
        }
    }
}

fn arc(dice: &mut Dice, framework: &Framework) -> Arc {
    let part = dice.below(framework.parts.len() as u32) as usize;
    let side = dice.pick(&[Side::Start, Side::End, Side::Start, Side::End, Side::Left, Side::Right]);
    let edges = framework.parts[part].border_edges(side, framework.grid).unwrap_or(1);
    Arc { part, side, start: dice.below(edges), length: dice.between(1, edges) }
}

/// A base mesh from random quads, whatever surface or non-surface they give.
pub fn quads(dice: &mut Dice) -> BaseMesh {
    let vertices = dice.between(4, 10);
    let faces = (0..dice.between(1, 8)).map(|_| quad(dice, vertices)).collect();
    let (count, faces) = renumbered(vertices, faces);
    BaseMesh::from_faces(count, faces).expect("quads with four different corners are valid")
}

fn quad(dice: &mut Dice, vertices: u32) -> [u32; 4] {
    let mut corners: Vec<u32> = (0..vertices).collect();
    dice.shuffle(&mut corners);
    [corners[0], corners[1], corners[2], corners[3]]
}

/// Leaves out vertices that occur in no face.
fn renumbered(vertices: u32, mut faces: Vec<[u32; 4]>) -> (u32, Vec<[u32; 4]>) {
    let used: Vec<u32> =
        (0..vertices).filter(|vertex| faces.iter().any(|face| face.contains(vertex))).collect();
    for corner in faces.iter_mut().flatten() {
        *corner = used.iter().position(|vertex| vertex == corner).expect("the vertex is used") as u32;
    }
    (used.len() as u32, faces)
}

/// All named points of a cell.
pub const POINTS: [(&str, Point); 9] = [
    ("c0", Point::Corner(0)),
    ("c1", Point::Corner(1)),
    ("c2", Point::Corner(2)),
    ("c3", Point::Corner(3)),
    ("m0", Point::Middle(0)),
    ("m1", Point::Middle(1)),
    ("m2", Point::Middle(2)),
    ("m3", Point::Middle(3)),
    ("x", Point::Centre),
];

/// The built-in types and two random ones; only the second may have a fan.
pub fn catalogue(dice: &mut Dice) -> Catalogue {
    let mut catalogue = Catalogue::default();
    for (name, fan) in [("first", false), ("second", true)] {
        let springs: Vec<String> = (0..dice.below(5)).map(|_| named_spring(dice)).collect();
        let perimeter = dice.percent(50);
        catalogue.define(name, &springs, perimeter, fan && dice.percent(70)).expect("a valid cell type");
    }
    catalogue
}

fn named_spring(dice: &mut Dice) -> String {
    let first = dice.below(9);
    let second = (first + dice.between(1, 8)) % 9;
    format!("{}-{}", POINTS[first as usize].0, POINTS[second as usize].0)
}

/// Type and turn that a method allows; the quad half of the time.
pub fn content(dice: &mut Dice, method: Method, catalogue: &Catalogue) -> Content {
    let number = if dice.percent(40) { 1 } else { dice.below(u32::from(Catalogue::BUILT_IN) + 2) };
    let kind = CellTypeId(number as u8);
    let kind = if method.allows(kind, catalogue) { kind } else { CellTypeId(1) };
    Content { kind, turn: dice.below(4) as u8 }
}

//! What design files say of springs, rods, loads and supports, for Rust.

use crate::convert::refusal;
use pyo3::prelude::*;
use springform_mechanics::curve::Curve;
use springform_mechanics::network::{Path, Sense};
use springform_mechanics::rigging::{
    Along, AnchorSupport, CellChoice, CellPressure, Hold, Law, Line, NodeLoad, PathRod, Rest, Rigging,
    SpringChoice, SpringGroup,
};
use springform_mechanics::vector::Vector;
use springform_topology::address::Place;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::{Catalogue, CellTypeId};
use springform_topology::forest::NodePair;
use springform_topology::framework::Side;
use springform_topology::node_key::NodeKey;

/// Sections of a design file, as Python holds them.
#[derive(FromPyObject)]
pub struct Sections {
    groups: Vec<Group>,
    stiffness_factors: Vec<(String, f64)>,
    rods: Vec<Rod>,
    node_loads: Vec<Load>,
    pressures: Vec<PressureSection>,
    anchors: Vec<Anchor>,
}

#[derive(FromPyObject)]
struct Group {
    parts: Option<Vec<String>>,
    types: Option<Vec<Word>>,
    levels: Option<Vec<u8>>,
    along: Option<Vec<String>>,
    pairs: Option<Vec<String>>,
    stiffness: Option<f64>,
    axial_stiffness: Option<f64>,
    force_density: Option<f64>,
    force: Option<f64>,
    curve: Option<Vec<[f64; 2]>>,
    rest_length: Option<f64>,
    rest_ratio: Option<Ratio>,
    prestress: Option<f64>,
    sense: Option<String>,
    section_area: Option<f64>,
    self_weight: Option<f64>,
    thermal_expansion: Option<f64>,
    temperature: Option<f64>,
}

#[derive(FromPyObject)]
enum Word {
    Number(u32),
    Name(String),
}

#[derive(FromPyObject)]
enum Ratio {
    One(f64),
    ByLevel(Vec<f64>),
}

#[derive(FromPyObject)]
struct Rod {
    along: Option<String>,
    vertices: Option<Vec<u32>>,
    bending_stiffness: f64,
    axial_stiffness: f64,
    length: Option<f64>,
    section_area: Option<f64>,
    self_weight: f64,
}

#[derive(FromPyObject)]
struct Load {
    ring: Option<String>,
    index: Option<usize>,
    vertex: Option<u32>,
    node: Option<String>,
    force: Vector,
}

#[derive(FromPyObject)]
struct PressureSection {
    parts: Option<Vec<String>>,
    types: Option<Vec<Word>>,
    levels: Option<Vec<u8>>,
    cells: Option<Vec<String>>,
    pressure: f64,
    follower: bool,
}

#[derive(FromPyObject)]
struct Anchor {
    holds: String,
    line: Option<Vector>,
    plane: Option<Vector>,
}

impl Sections {
    /// The rigging on a base mesh.
    ///
    /// # Errors
    /// A part, boundary, type, cell, node or curve that does not exist.
    pub fn rigging(&self, mesh: &BaseMesh, catalogue: &Catalogue) -> PyResult<Rigging> {
        let reader = Reader { mesh, catalogue };
        let mut rigging = Rigging::default();
        for (number, group) in self.groups.iter().enumerate() {
            let group = reader.group(&format!("springs.groups[{number}]"), group, &mut rigging.curves)?;
            rigging.groups.push(group);
        }
        for (line, factor) in &self.stiffness_factors {
            let pair = pair(mesh, line)
                .map_err(|problem| refusal(format!("springs.stiffness_factors.{line}"), problem))?;
            rigging.factors.push((pair, *factor));
        }
        for (number, rod) in self.rods.iter().enumerate() {
            let (path, closed) = reader.path(&format!("rods[{number}]"), rod)?;
            rigging.rods.push(PathRod {
                path,
                closed,
                bending_stiffness: rod.bending_stiffness,
                axial_stiffness: rod.axial_stiffness,
                length: rod.length,
                area: rod.section_area,
                weight: rod.self_weight,
            });
        }
        for (number, load) in self.node_loads.iter().enumerate() {
            let node = reader.node(&format!("loads.nodes[{number}]"), load)?;
            rigging.loads.push(NodeLoad { node, force: load.force });
        }
        for (number, one) in self.pressures.iter().enumerate() {
            let key = format!("loads.pressures[{number}]");
            let choice = reader.cells(&key, &one.parts, &one.types, &one.levels)?;
            let places = reader.places(&key, &one.cells)?;
            let cells = CellChoice { places, ..choice };
            rigging.pressures.push(CellPressure { cells, pressure: one.pressure, follows: one.follower });
        }
        rigging.supports = self.anchors.iter().enumerate().filter_map(Anchor::support).collect();
        Ok(rigging)
    }
}

impl Anchor {
    /// The support of an anchor that is not held along all axes.
    fn support((anchor, said): (usize, &Anchor)) -> Option<AnchorSupport> {
        let hold = match (said.line, said.plane) {
            (Some(along), _) => Hold::Slide(Path::Line(along)),
            (None, Some(normal)) => Hold::Slide(Path::Plane(normal)),
            (None, None) => Hold::Axes(['x', 'y', 'z'].map(|axis| said.holds.contains(axis))),
        };
        (hold != Hold::Axes([true; 3])).then_some(AnchorSupport { anchor, hold })
    }
}

/// Finds what names stand for.
struct Reader<'a> {
    mesh: &'a BaseMesh,
    catalogue: &'a Catalogue,
}

impl Reader<'_> {
    fn group(&self, key: &str, group: &Group, curves: &mut Vec<Curve>) -> PyResult<SpringGroup> {
        let along = match &group.along {
            None => None,
            Some(words) => {
                let line = |(at, word): (usize, &String)| self.line(&format!("{key}.along[{at}]"), word);
                let lines = words.iter().enumerate().map(line).collect::<PyResult<Vec<_>>>()?;
                Some(Along::new(self.mesh, &lines))
            }
        };
        let pairs = match &group.pairs {
            None => None,
            Some(lines) => Some(pairs(self.mesh, &format!("{key}.pairs"), lines)?),
        };
        let mut law = [
            group.stiffness.map(Law::Stiffness),
            group.axial_stiffness.map(Law::AxialStiffness),
            group.force_density.map(Law::ForceDensity),
            group.force.map(Law::Force),
        ]
        .into_iter()
        .flatten()
        .next();
        if let Some(points) = &group.curve {
            let curve = Curve::new(points).map_err(|error| refusal(format!("{key}.curve"), error))?;
            law = Some(Law::Curve(curves.len() as u32));
            curves.push(curve);
        }
        let ratio = group.rest_ratio.as_ref().map(|ratio| match ratio {
            Ratio::One(ratio) => Rest::Ratio(vec![*ratio]),
            Ratio::ByLevel(ratios) => Rest::Ratio(ratios.clone()),
        });
        Ok(SpringGroup {
            springs: SpringChoice {
                cells: self.cells(key, &group.parts, &group.types, &group.levels)?,
                along,
                pairs,
            },
            law,
            rest: group.rest_length.map(Rest::Length).or(ratio).or(group.prestress.map(Rest::Prestress)),
            sense: group.sense.as_deref().map(|word| match word {
                "tension" => Sense::Tension,
                "compression" => Sense::Compression,
                _ => Sense::Both,
            }),
            area: group.section_area,
            weight: group.self_weight,
            expansion: group.thermal_expansion,
            temperature: group.temperature,
        })
    }

    fn cells(
        &self,
        key: &str,
        parts: &Option<Vec<String>>,
        types: &Option<Vec<Word>>,
        levels: &Option<Vec<u8>>,
    ) -> PyResult<CellChoice> {
        let each = |at: usize, name: &String| self.part(&format!("{key}.parts[{at}]"), name);
        let parts = parts.as_ref().map(|names| names.iter().enumerate().map(|(at, name)| each(at, name)));
        let each = |at: usize, word: &Word| self.cell_type(&format!("{key}.types[{at}]"), word);
        let types = types.as_ref().map(|words| words.iter().enumerate().map(|(at, word)| each(at, word)));
        Ok(CellChoice {
            parts: parts.map(Iterator::collect::<PyResult<_>>).transpose()?,
            types: types.map(Iterator::collect::<PyResult<_>>).transpose()?,
            levels: levels.clone(),
            places: None,
        })
    }

    fn part(&self, key: &str, name: &str) -> PyResult<u32> {
        let mut names: Vec<&str> = self.mesh.borders().iter().map(|border| border.part.as_str()).collect();
        names.dedup();
        let found = names.iter().position(|part| *part == name);
        found.map(|part| part as u32).ok_or_else(|| refusal(key, format!("no part is called '{name}'")))
    }

    fn cell_type(&self, key: &str, word: &Word) -> PyResult<CellTypeId> {
        let text = match word {
            Word::Number(number) => number.to_string(),
            Word::Name(name) => name.clone(),
        };
        let unknown = || refusal(key, format!("there is no cell type '{text}'; use 0-6 or a defined name"));
        self.catalogue.find(&text).ok_or_else(unknown)
    }

    fn line(&self, key: &str, word: &str) -> PyResult<Line> {
        match word {
            "ring" => Ok(Line::Free),
            "seam" => Ok(Line::Seams),
            name => self.border(key, name).map(Line::Border),
        }
    }

    fn border(&self, key: &str, name: &str) -> PyResult<usize> {
        let parsed = name.split_once('.').and_then(|(part, side)| Some((part, Side::parse(side)?)));
        let found = parsed.and_then(|(part, side)| {
            self.mesh.borders().iter().position(|border| border.part == part && border.side == side)
        });
        found.ok_or_else(|| refusal(key, format!("no boundary is called '{name}'")))
    }

    /// Base vertices along a rod, each once, and whether the last is followed by the first.
    fn path(&self, key: &str, rod: &Rod) -> PyResult<(Vec<u32>, bool)> {
        if let Some(name) = &rod.along {
            let border = &self.mesh.borders()[self.border(&format!("{key}.along"), name)?];
            return Ok((border.path.clone(), border.closed));
        }
        let mut path = rod.vertices.clone().unwrap_or_default();
        let count = self.mesh.vertex_count();
        for (at, &vertex) in path.iter().enumerate() {
            let key = format!("{key}.vertices[{at}]");
            if vertex >= count {
                return Err(refusal(key, format!("there is no such vertex; there are {count}, from 0")));
            }
            let joined = |before: u32| self.mesh.edge_between(before, vertex).is_some();
            if let Some(&before) = at.checked_sub(1).and_then(|before| path.get(before))
                && !joined(before)
            {
                let problem = "are not joined by an edge of the base mesh; list all vertices on the way";
                return Err(refusal(key, format!("vertices {before} and {vertex} {problem}")));
            }
        }
        let closed = path.len() > 1 && path.first() == path.last();
        path.truncate(path.len() - usize::from(closed));
        Ok((path, closed))
    }

    fn places(&self, key: &str, addresses: &Option<Vec<String>>) -> PyResult<Option<Vec<Place>>> {
        let faces = self.mesh.faces().len();
        let place = |(at, address): (usize, &String)| {
            let key = format!("{key}.cells[{at}]");
            let place = Place::parse(address).map_err(|error| refusal(&key, error))?;
            let missing =
                || format!("there is no top-level cell {}; the framework has {faces}, from 0", place.face);
            if (place.face as usize) < faces { Ok(place) } else { Err(refusal(&key, missing())) }
        };
        addresses.as_ref().map(|all| all.iter().enumerate().map(place).collect()).transpose()
    }

    fn node(&self, key: &str, load: &Load) -> PyResult<NodeKey> {
        if let Some(text) = &load.node {
            return NodeKey::parse(text, self.mesh).map_err(|error| refusal(format!("{key}.node"), error));
        }
        let of_ring = || {
            let (part, side) = load.ring.as_ref()?.split_once('.')?;
            self.mesh.border_vertex(part, Side::parse(side)?, load.index?)
        };
        let count = self.mesh.vertex_count();
        let vertex = load.vertex.or_else(of_ring).filter(|&vertex| vertex < count);
        let missing = || refusal(key, format!("there is no such vertex; there are {count}, from 0"));
        vertex.map(NodeKey::vertex).ok_or_else(missing)
    }
}

/// Pairs of nodes, each written as two keys.
///
/// # Errors
/// Not two different nodes of the framework.
pub fn pairs(mesh: &BaseMesh, key: &str, lines: &[String]) -> PyResult<Vec<NodePair>> {
    let numbered = lines.iter().enumerate();
    numbered
        .map(|(at, line)| pair(mesh, line).map_err(|problem| refusal(format!("{key}[{at}]"), problem)))
        .collect()
}

/// Two nodes, written as two keys; else what is wrong.
fn pair(mesh: &BaseMesh, line: &str) -> Result<NodePair, String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [a, b] = words[..] else {
        return Err("write two nodes, such as 'v1 e7:1/2'".to_owned());
    };
    let node = |word| NodeKey::parse(word, mesh).map_err(|error| error.to_string());
    NodePair::new(node(a)?, node(b)?).ok_or_else(|| "the two nodes are the same".to_owned())
}

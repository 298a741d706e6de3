//! Measures of a net at equilibrium (the paper §3.5–3.6, Fig. 15).

use crate::border::nodes_along;
use crate::network::Network;
use crate::vector::{Vector, cross, length, mean, scale, subtract};
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::NULL;
use springform_topology::expression::Expression;
use springform_topology::framework::Side;

/// A spring weaker than this share of the strongest makes the force differential undefined.
pub const VANISHING_FORCE: f64 = 1e-12;

/// Measures of one net.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Measures {
    /// Number of springs.
    pub springs: u32,
    /// Number of nodes.
    pub nodes: u32,
    /// Number of expressed cells.
    pub cells: u32,
    /// Largest over smallest spring force; `None` if a spring carries next to nothing.
    pub force_differential: Option<f64>,
    /// Smallest spring force [N].
    pub force_min: f64,
    /// Largest spring force [N].
    pub force_max: f64,
    /// Mean spring force [N].
    pub force_mean: f64,
    /// Standard deviation of spring forces [N].
    pub force_deviation: f64,
    /// Standard deviation over mean.
    pub force_variation: f64,
    /// Largest minus smallest spring force [N].
    pub force_range: f64,
    /// Sum of spring lengths [m].
    pub total_length: f64,
    /// Sum of force times length [N m].
    pub load_path: f64,
    /// Area of all cells but null ones [m²], each as a fan of triangles about the mean of its boundary.
    pub area: f64,
    /// Shortest spring [m]: the maker's smallest length of material between nodes.
    pub shortest_spring: f64,
    /// Total length over area [1/m].
    pub length_per_area: f64,
}

/// An opening of a cylinder or the outline of a sheet's side, at equilibrium.
#[derive(Clone, PartialEq, Debug)]
pub struct Aperture {
    /// Name of the part.
    pub part: String,
    /// Which border.
    pub side: Side,
    /// Length along the border [m].
    pub perimeter: f64,
    /// Size of the vector area [m²]; zero for an open border.
    pub area: f64,
    /// Unit normal of the vector area; zero for an open border.
    pub normal: Vector,
}

impl Measures {
    /// Measures a net whose springs have these forces at these positions; links of rods, which stand behind the
    /// springs of the net, are none of them.
    pub fn new(
        expression: &Expression,
        network: &Network<'_>,
        positions: &[Vector],
        forces: &[f64],
    ) -> Measures {
        let forces = &forces[..expression.springs.len()];
        let count = forces.len().max(1) as f64;
        let (mut force_min, mut force_max, mut force_sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        let (mut total_length, mut load_path, mut shortest_spring) = (0.0, 0.0, f64::INFINITY);
        for (&force, &[a, b]) in forces.iter().zip(network.springs.iter()) {
            let length = length(subtract(positions[b as usize], positions[a as usize]));
            force_min = f64::min(force_min, force);
            force_max = f64::max(force_max, force);
            force_sum += force;
            total_length += length;
            load_path += force * length;
            shortest_spring = f64::min(shortest_spring, length);
        }
        let force_mean = force_sum / count;
        let variance = forces.iter().map(|force| (force - force_mean).powi(2)).sum::<f64>() / count;
        let area = area(expression, positions);
        Measures {
            springs: forces.len() as u32,
            nodes: positions.len() as u32,
            cells: expression.cells.len() as u32,
            force_differential: force_differential(force_min, force_max),
            force_min,
            force_max,
            force_mean,
            force_deviation: variance.sqrt(),
            force_variation: variance.sqrt() / force_mean,
            force_range: force_max - force_min,
            total_length,
            load_path,
            area,
            shortest_spring,
            length_per_area: total_length / area,
        }
    }
}

pub(crate) fn force_differential(smallest: f64, largest: f64) -> Option<f64> {
    (smallest >= VANISHING_FORCE * largest && smallest > 0.0).then(|| largest / smallest)
}

/// Spring utilization factor: change of force differential over change of the number of springs (the paper §3.6).
///
/// `reference` is (force differential, springs), (0, 0) for differential per spring. `None` where no spring was
/// gained or a differential is undefined.
pub fn spring_utilization(measures: &Measures, reference: (Option<f64>, u32)) -> Option<f64> {
    let gained = i64::from(measures.springs) - i64::from(reference.1);
    let change = measures.force_differential? - reference.0?;
    (gained > 0).then(|| change / gained as f64)
}

/// Inner force of every expressed cell: the sum of the forces of its springs [N] (the paper §3.5).
///
/// The expression must have owners.
pub fn inner_forces(expression: &Expression, forces: &[f64]) -> Vec<f64> {
    let sum = |cell| expression.cell_springs.of(cell).iter().map(|&spring| forces[spring as usize]).sum();
    (0..expression.cells.len() as u32).map(sum).collect()
}

/// Openings and sides of the parts: outlines through all nodes that the net has on a border, whether or not cords
/// run along it. Normals follow the right-hand rule round a ring.
pub fn apertures(mesh: &BaseMesh, expression: &Expression, positions: &[Vector]) -> Vec<Aperture> {
    mesh.borders()
        .iter()
        .map(|border| {
            let outline: Vec<Vector> = nodes_along(mesh, expression, &border.path, border.closed)
                .into_iter()
                .map(|at| positions[at.node as usize])
                .collect();
            let stretches = if border.closed { outline.len() } else { outline.len().saturating_sub(1) };
            let stretch = |at: usize| (outline[at], outline[(at + 1) % outline.len()]);
            let perimeter = (0..stretches).map(|at| length(subtract(stretch(at).1, stretch(at).0))).sum();
            let vector = if border.closed { vector_area(&outline) } else { [0.0; 3] };
            let area = length(vector);
            let normal = if area > 0.0 { scale(vector, 1.0 / area) } else { [0.0; 3] };
            Aperture { part: border.part.clone(), side: border.side, perimeter, area, normal }
        })
        .collect()
}

fn area(expression: &Expression, positions: &[Vector]) -> f64 {
    let mut total = 0.0;
    let boundaries = expression.cell_boundaries.starts().windows(2);
    for (expressed, ends) in expression.cells.iter().zip(boundaries) {
        let boundary = &expression.cell_boundaries.items()[ends[0] as usize..ends[1] as usize];
        if expressed.content.kind == NULL || boundary.len() < 3 {
            continue;
        }
        let at = |node: &u32| positions[*node as usize];
        let middle = mean(boundary.iter().map(at));
        let mut add = |here: Vector, next: Vector| total += 0.5 * length(cross(here, next));
        let first = subtract(at(&boundary[0]), middle);
        let mut here = first;
        for node in &boundary[1..] {
            let next = subtract(at(node), middle);
            add(here, next);
            here = next;
        }
        add(here, first);
    }
    total
}

/// Vector area of a closed polygon (Newell).
fn vector_area(outline: &[Vector]) -> Vector {
    let middle = mean(outline.iter().copied());
    let mut total = [0.0; 3];
    for (here, next) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        let triangle = cross(subtract(*here, middle), subtract(*next, middle));
        total = crate::vector::add(total, scale(triangle, 0.5));
    }
    total
}

//! Bending-active rods: bending stiffness over three consecutive nodes.
//!
//! Adriaenssens & Barnes, "Tensegrity spline beam and grid shell structures", 2001: three consecutive nodes lie on a
//! circle, whose curvature 2 sin α / l gives the bending moment; α is the angle between the two links and l the chord
//! over both. Departure: links count with their unstressed lengths, also in the chord, so that the moment depends on α
//! alone and has an energy, E = 2 EI (a + b − l(α)) / (a b) for links a and b. Rods are straight when unstressed, have
//! the same stiffness about all axes of their section, and no torsion (as in the source).

use crate::vector::{Vector, add, cross, dot, length, scale, subtract};

/// A rod through consecutive nodes; springs between the nodes carry its axial force.
#[derive(Clone, PartialEq, Debug)]
pub struct Rod {
    /// Nodes along the rod, each once.
    pub nodes: Vec<u32>,
    /// The last node is followed by the first.
    pub closed: bool,
    /// Unstressed length of every link between consecutive nodes [m]; as many as nodes if closed, else one less.
    pub lengths: Vec<f64>,
    /// Bending stiffness EI [N m²].
    pub bending_stiffness: f64,
}

/// A node of a rod between two links.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bend {
    /// The node before, the node, and the node after.
    pub nodes: [u32; 3],
    /// Unstressed lengths of the two links [m].
    pub lengths: [f64; 2],
    /// Bending stiffness EI [N m²].
    pub stiffness: f64,
}

/// What a bend does at given links; blocks are over the two links.
pub struct Bending {
    /// Energy [J].
    pub energy: f64,
    /// Change of energy with both links [N].
    pub forces: [Vector; 2],
    /// Second changes of energy: with the first link twice, the first and the second, the second twice [N/m].
    pub stiffness: [[Vector; 3]; 3],
}

const IDENTITY: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Rod {
    /// The bends of the rod, in its order.
    pub fn bends(&self) -> impl Iterator<Item = Bend> + '_ {
        let count = self.nodes.len();
        let bends = if self.closed { count } else { count.saturating_sub(2) };
        (0..bends).map(move |first| {
            let at = |step: usize| self.nodes[(first + step) % count];
            let link = |step: usize| self.lengths[(first + step) % self.lengths.len()];
            Bend {
                nodes: [at(0), at(1), at(2)],
                lengths: [link(0), link(1)],
                stiffness: self.bending_stiffness,
            }
        })
    }
}

impl Rod {
    /// Bending moment at every node of the rod [N m]; zero at the ends of an open one.
    pub fn moments(&self, positions: &[Vector]) -> Vec<f64> {
        let mut moments = vec![0.0; self.nodes.len()];
        for (first, bend) in self.bends().enumerate() {
            moments[(first + 1) % self.nodes.len()] = bend.moment(bend.angle(positions));
        }
        moments
    }
}

impl Bend {
    /// The links at positions of the nodes.
    pub fn links(&self, positions: &[Vector]) -> [Vector; 2] {
        let [a, b, c] = self.nodes.map(|node| positions[node as usize]);
        [subtract(b, a), subtract(c, b)]
    }

    /// Angle between the links at positions of the nodes [rad].
    pub fn angle(&self, positions: &[Vector]) -> f64 {
        let [first, second] = self.links(positions);
        length(cross(first, second)).atan2(dot(first, second))
    }

    /// Bending moment at an angle between the links [N m]: EI times the curvature of the circle through the nodes.
    pub fn moment(&self, angle: f64) -> f64 {
        let chord = self.chord(angle.cos());
        if chord > 0.0 { 2.0 * self.stiffness * angle.sin() / chord } else { 0.0 }
    }

    /// Energy and its changes at the links; `semidefinite` leaves out what would make the stiffness indefinite.
    pub fn bending(&self, links: [Vector; 2], semidefinite: bool) -> Bending {
        let [a, b] = self.lengths;
        let sizes = links.map(length);
        let [first, second] =
            [0, 1].map(|at| if sizes[at] > 0.0 { scale(links[at], 1.0 / sizes[at]) } else { [0.0; 3] });
        let cosine = dot(first, second);
        let chord = self.chord(cosine).max(1e-9 * (a + b));
        // E as a function of the cosine: its value, its first and its second change. For the value a + b − l is written as
        // 2 a b (1 − cos α) / (a + b + l), and 1 − cos α as |e₁ − e₂|² / 2: small angles would lose all digits.
        let apart = subtract(first, second);
        let energy = 2.0 * self.stiffness * dot(apart, apart) / (a + b + chord);
        let rate = -2.0 * self.stiffness / chord;
        let curvature = 2.0 * self.stiffness * a * b / chord.powi(3);
        // Changes of the cosine with both links.
        let inverse = sizes.map(|size| if size > 0.0 { 1.0 / size } else { 0.0 });
        let towards = [
            scale(subtract(second, scale(first, cosine)), inverse[0]),
            scale(subtract(first, scale(second, cosine)), inverse[1]),
        ];
        let across = [across_of(first), across_of(second)];
        let stiffness = if semidefinite {
            // 1 − cos α = |e₁ − e₂|² / 2, and the square of a difference is never negative.
            [
                times(across[0], -rate * inverse[0] * inverse[0]),
                times(product(across[0], across[1]), rate * inverse[0] * inverse[1]),
                times(across[1], -rate * inverse[1] * inverse[1]),
            ]
        } else {
            let twice = |at: usize| {
                let (unit, towards) = ([first, second][at], towards[at]);
                let turned = plus(outer(unit, towards), outer(towards, unit));
                times(plus(turned, times(across[at], cosine * inverse[at])), -inverse[at])
            };
            let units = plus(outer(first, first), outer(second, second));
            let apart = plus(IDENTITY, plus(times(units, -1.0), times(outer(first, second), cosine)));
            let mixed = times(apart, inverse[0] * inverse[1]);
            [
                plus(times(outer(towards[0], towards[0]), curvature), times(twice(0), rate)),
                plus(times(outer(towards[0], towards[1]), curvature), times(mixed, rate)),
                plus(times(outer(towards[1], towards[1]), curvature), times(twice(1), rate)),
            ]
        };
        Bending { energy, forces: towards.map(|towards| scale(towards, rate)), stiffness }
    }

    /// Chord over both links at the cosine of the angle between them, links unstressed [m].
    fn chord(&self, cosine: f64) -> f64 {
        let [a, b] = self.lengths;
        (a * a + b * b + 2.0 * a * b * cosine).max(0.0).sqrt()
    }
}

fn outer(a: Vector, b: Vector) -> [Vector; 3] {
    a.map(|value| scale(b, value))
}

/// I − u uᵀ of a unit vector.
fn across_of(unit: Vector) -> [Vector; 3] {
    plus(IDENTITY, times(outer(unit, unit), -1.0))
}

fn plus(a: [Vector; 3], b: [Vector; 3]) -> [Vector; 3] {
    std::array::from_fn(|row| add(a[row], b[row]))
}

fn times(a: [Vector; 3], factor: f64) -> [Vector; 3] {
    a.map(|row| scale(row, factor))
}

fn product(a: [Vector; 3], b: [Vector; 3]) -> [Vector; 3] {
    std::array::from_fn(|row| std::array::from_fn(|column| (0..3).map(|at| a[row][at] * b[at][column]).sum()))
}

//! Rigging: what a design says of its springs, rods, loads and supports, by place and not by number, so that it holds
//! for every net that grows on the framework.
//!
//! ```text
//! assembled network ─ laws of spring groups ─ rods ─ loads ─ supports ─ network to solve
//! ```
//!
//! The springs of the net stay first and in their order; links of rods follow. "Drawn" means the positions that the
//! network was assembled with.

mod choice;
mod groups;
mod rods;

pub use choice::{Along, CellChoice, Line, SpringChoice};
pub use groups::{Law, Properties, Rest, SpringGroup};
pub use rods::PathRod;

use choice::spring_between;

use crate::curve::Curve;
use crate::equilibrium::press;
use crate::network::{Network, NetworkError, Path, Pressure, Slide};
use crate::vector::{Vector, add};
use springform_topology::base_mesh::{BaseMesh, Groups};
use springform_topology::cell_type::NULL;
use springform_topology::expression::Expression;
use springform_topology::forest::NodePair;
use springform_topology::node_key::NodeKey;
use thiserror::Error;

/// Laws of groups of springs, rods, loads and supports; empty for a net of the design's plain law.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Rigging {
    /// Groups of springs; later ones win.
    pub groups: Vec<SpringGroup>,
    /// Factors on the stiffness that springs have by their laws; pairs without a spring are passed over.
    pub factors: Vec<(NodePair, f64)>,
    /// Measured curves of the groups.
    pub curves: Vec<Curve>,
    /// Rods.
    pub rods: Vec<PathRod>,
    /// Dead loads on nodes.
    pub loads: Vec<NodeLoad>,
    /// Pressure on cells; all that hold a cell add up.
    pub pressures: Vec<CellPressure>,
    /// Supports of anchors that are not held along all axes.
    pub supports: Vec<AnchorSupport>,
}

/// A dead load.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NodeLoad {
    /// The node; a net without it can't carry the load.
    pub node: NodeKey,
    /// [N].
    pub force: Vector,
}

/// Pressure on cells, voids left out.
#[derive(Clone, PartialEq, Debug)]
pub struct CellPressure {
    /// Which cells.
    pub cells: CellChoice,
    /// [Pa], positive along the normal of the right-hand rule round a cell from corner c0 to c1.
    pub pressure: f64,
    /// It stays square to the cells; else it is as on the drawn cells.
    pub follows: bool,
}

/// How an anchor is held.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AnchorSupport {
    /// Which anchor.
    pub anchor: usize,
    /// How.
    pub hold: Hold,
}

/// What a support holds.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Hold {
    /// Axes x, y, z.
    Axes([bool; 3]),
    /// All but a path on which the node slides.
    Slide(Path),
}

/// Why a rigging does not fit a net.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
#[error("{key}: {problem}")]
pub struct RiggingError {
    /// Place in the design, such as `springs.groups[2]`.
    pub key: String,
    /// What is wrong and what to do.
    pub problem: String,
}

impl Rigging {
    /// Nothing is said.
    pub fn is_empty(&self) -> bool {
        *self == Rigging::default()
    }

    /// The groups ask which cells own a spring.
    pub fn needs_owners(&self) -> bool {
        self.groups.iter().any(SpringGroup::needs_owners)
    }

    /// Rigs a network as it was assembled of an expression, which has owners if [`Rigging::needs_owners`]; the network
    /// may have been rigged before it was assembled again. After an error it is of no use.
    ///
    /// # Errors
    /// A spring without a possible unstressed length, a rod along too few nodes, a load on a node that the net lacks, a
    /// number that overflows.
    pub fn rig(
        &self,
        mesh: &BaseMesh,
        expression: &Expression,
        network: &mut Network<'static>,
    ) -> Result<(), RiggingError> {
        if self.is_empty() {
            return Ok(());
        }
        clear(network);
        let mut weights = vec![0.0; expression.springs.len()];
        if !self.groups.is_empty() {
            self.set_laws(mesh, expression, network, &mut weights)?;
        }
        for &(pair, factor) in &self.factors {
            if let Some(spring) = spring_between(pair, expression) {
                network.stiffness.to_mut()[spring] *= factor;
            }
        }
        for (number, rod) in self.rods.iter().enumerate() {
            rod.add(number, mesh, expression, network, &mut weights)?;
        }
        self.load(mesh, expression, network)?;
        weigh(&weights, network);
        self.support(expression, network);
        let overflow = |error: NetworkError| RiggingError {
            key: "springs".into(),
            problem: format!("makes no network: {error}; write other numbers"),
        };
        network.check().map_err(overflow)
    }

    fn load(
        &self,
        mesh: &BaseMesh,
        expression: &Expression,
        network: &mut Network<'static>,
    ) -> Result<(), RiggingError> {
        for (number, load) in self.loads.iter().enumerate() {
            let node = expression.node(load.node).ok_or_else(|| RiggingError {
                key: format!("loads.nodes[{number}]"),
                problem: format!("the net has no node {} to carry the load; put it elsewhere", load.node),
            })?;
            let loads = network.loads.to_mut();
            loads[node as usize] = add(loads[node as usize], load.force);
        }
        let mut following: Vec<(u32, f64)> = Vec::new();
        for pressure in &self.pressures {
            for (cell, expressed) in expression.cells.iter().enumerate() {
                let boundary = expression.cell_boundaries.of(cell as u32);
                let void = expressed.content.kind == NULL || boundary.len() < 3;
                if void || !pressure.cells.holds(mesh, expressed) {
                    continue;
                }
                if pressure.follows {
                    following.push((cell as u32, pressure.pressure));
                } else {
                    press(boundary, pressure.pressure, &network.positions, network.loads.to_mut());
                }
            }
        }
        if !following.is_empty() {
            let nodes = |at: usize| expression.cell_boundaries.of(following[at].0).iter();
            let pairs = (0..following.len()).flat_map(|at| nodes(at).map(move |&node| (at as u32, node)));
            network.pressure = Pressure {
                cells: Groups::collect(following.len(), pairs),
                values: following.iter().map(|&(_, value)| value).collect(),
            };
        }
        Ok(())
    }

    fn support(&self, expression: &Expression, network: &mut Network<'static>) {
        for support in &self.supports {
            let node = expression.anchors[support.anchor];
            match support.hold {
                Hold::Axes(axes) => network.fixed.to_mut()[node as usize] = axes,
                Hold::Slide(path) => {
                    network.fixed.to_mut()[node as usize] = [false; 3];
                    network.slides.to_mut().push(Slide { node, path });
                }
            }
        }
    }
}

/// Leaves of a network what assembly writes.
fn clear(network: &mut Network<'static>) {
    network.curve.to_mut().clear();
    network.curves.to_mut().clear();
    network.rods.to_mut().clear();
    network.weight.to_mut().clear();
    network.slides.to_mut().clear();
    network.pressure = Pressure::default();
}

/// Lumps the weight of springs with an unstressed length; that of others follows their length.
fn weigh(weights: &[f64], network: &mut Network<'static>) {
    let mut following = vec![0.0; weights.len()];
    for (spring, &weight) in weights.iter().enumerate().filter(|&(_, &weight)| weight != 0.0) {
        let rest = network.rest_length[spring];
        if rest == 0.0 {
            following[spring] = weight;
            continue;
        }
        for node in network.springs[spring] {
            network.loads.to_mut()[node as usize][2] -= 0.5 * weight * rest;
        }
    }
    if following.iter().any(|&weight| weight != 0.0) {
        network.weight = following.into();
    }
}

//! From genotype to measured phenotype: expression, network, equilibrium, measures in one call.

use crate::lineage::{Heir, Lineage};
use springform_mechanics::assembly::{SpringLaw, assemble, assemble_into, embed};
use springform_mechanics::embedding::Embedding;
use springform_mechanics::equilibrium::{Equilibrium, Settings, Solver, Status};
use springform_mechanics::measures::{Measures, inner_forces};
use springform_mechanics::network::Network;
use springform_mechanics::rigging::{Rigging, RiggingError};
use springform_mechanics::stage::Stage;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::Catalogue;
use springform_topology::edit::{Edit, EditError};
use springform_topology::expression::{Expression, ExpressionError, Growth, express};
use springform_topology::filters::Method;
use springform_topology::forest::Forest;
use springform_topology::gene::{self, GeneError};
use thiserror::Error;

/// Everything of a design but its forest: what stays the same while a forest is edited or evolved.
#[derive(Clone, PartialEq, Debug)]
pub struct Setting {
    /// The base mesh.
    pub mesh: BaseMesh,
    /// Cell types.
    pub catalogue: Catalogue,
    /// Method of resolving neighbours.
    pub method: Method,
    /// Base vertex of every anchor, each once.
    pub anchors: Vec<u32>,
    /// Anchor positions and drawn positions.
    pub embedding: Embedding,
    /// Stiffness of springs.
    pub law: SpringLaw,
    /// Laws of groups of springs, rods, loads and supports.
    pub rigging: Rigging,
    /// When equilibrium is reached.
    pub solver: Settings,
}

/// A genotype's net at equilibrium.
#[derive(Clone, PartialEq, Debug)]
pub struct Phenotype {
    /// Nodes, springs and cells.
    pub expression: Expression,
    /// Springs as the solver got them.
    pub network: Network<'static>,
    /// Positions and forces.
    pub equilibrium: Equilibrium,
    /// Measures at equilibrium.
    pub measures: Measures,
}

/// Why a genotype has no measured phenotype.
#[derive(Clone, PartialEq, Debug, Error)]
pub enum PhenotypeError {
    /// The filters leave no net.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    /// An edit does not fit.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// A gene can't be held where it is referred to.
    #[error(transparent)]
    Gene(#[from] GeneError),
    /// More cells than [`springform_topology::MAX_CELLS`].
    #[error("the forest has too many cells")]
    TooManyCells,
    /// The springs, rods or loads of the design don't fit the net.
    #[error(transparent)]
    Rigging(#[from] RiggingError),
    /// No equilibrium.
    #[error("the net finds no equilibrium: {0:?}, residual {1:.3e}")]
    Equilibrium(Status, f64),
}

impl Setting {
    /// Built-in cell types and springs of one stiffness, held by anchors alone: `positions` [m] of every one.
    #[must_use]
    pub fn new(mesh: BaseMesh, method: Method, anchors: Vec<u32>, positions: Vec<[f64; 3]>) -> Setting {
        Setting {
            embedding: embed(&mesh, &anchors, positions),
            mesh,
            catalogue: Catalogue::default(),
            method,
            anchors,
            law: SpringLaw::default(),
            rigging: Rigging::default(),
            solver: Settings::default(),
        }
    }

    /// Filters that write into the forest: level balance under the recursive method.
    ///
    /// # Errors
    /// None on a valid forest.
    pub fn close(&self, forest: &mut Forest) -> Result<Vec<Edit>, GeneError> {
        match self.method {
            Method::Recursive => gene::close_alike(&self.mesh, &self.catalogue, forest),
            Method::Extensible | Method::Dynamic => Ok(Vec::new()),
        }
    }

    /// Grows the network of a closed forest.
    ///
    /// # Errors
    /// The filters leave no net, or its springs, rods or loads don't fit.
    pub fn grow(&self, forest: &Forest) -> Result<(Expression, Network<'static>), PhenotypeError> {
        let expression = express(&self.mesh, forest, &self.catalogue, self.method, &self.anchors)?;
        let mut network = assemble(&expression, &self.embedding, self.law);
        self.rigging.rig(&self.mesh, &expression, &mut network)?;
        Ok((expression, network))
    }

    /// Grows, solves and measures a closed forest.
    ///
    /// # Errors
    /// The filters leave no net, or the net is refused or finds no equilibrium.
    pub fn evaluate(&self, forest: &Forest) -> Result<Phenotype, PhenotypeError> {
        self.evaluate_with_lineage(forest).map(|(phenotype, _)| phenotype)
    }

    /// The same, and the order of elimination that mutants inherit.
    ///
    /// # Errors
    /// The filters leave no net, or the net is refused or finds no equilibrium.
    pub fn evaluate_with_lineage(&self, forest: &Forest) -> Result<(Phenotype, Lineage), PhenotypeError> {
        let (expression, network) = self.grow(forest)?;
        let mut solver = Solver::default();
        let equilibrium = solver.solve(&network, &self.solver);
        if equilibrium.status != Status::Converged {
            return Err(PhenotypeError::Equilibrium(equilibrium.status, equilibrium.residual));
        }
        let measures = Measures::new(&expression, &network, &equilibrium.positions, &equilibrium.forces);
        let lineage = Lineage { nodes: expression.nodes.clone(), order: solver.order().collect() };
        Ok((Phenotype { expression, network, equilibrium, measures }, lineage))
    }
}

/// Measures one forest after the other without asking for new memory, once it has seen one of the size; what it gives
/// depends on nothing that it measured before.
#[derive(Clone, Default)]
pub struct Evaluator {
    growth: Growth,
    network: Network<'static>,
    heir: Heir,
    solver: Solver,
    equilibrium: Equilibrium,
}

/// What an individual is judged by.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Evaluation {
    /// Measures at equilibrium.
    pub measures: Measures,
    /// Residual of the equilibrium over the mean force.
    pub residual: f64,
}

impl Evaluator {
    /// Grows, solves and measures a closed forest in the order of elimination of its parent, with the outcome of
    /// [`Setting::evaluate`] but for rounding; tells `observe` when a stage ends.
    ///
    /// # Errors
    /// The filters leave no net, or the net is refused or finds no equilibrium.
    pub fn evaluate(
        &mut self,
        setting: &Setting,
        forest: &Forest,
        parent: &Lineage,
        observe: &mut impl FnMut(Stage),
    ) -> Result<Evaluation, PhenotypeError> {
        let Setting { mesh, catalogue, method, anchors, embedding, law, rigging, solver } = setting;
        let grown = || observe(Stage::Nodes);
        self.growth.express_observed(mesh, forest, catalogue, *method, anchors, grown)?;
        observe(Stage::Filter);
        if rigging.needs_owners() {
            self.growth.add_owners();
        }
        let expression = self.growth.expression();
        assemble_into(expression, embedding, *law, &mut self.network);
        rigging.rig(mesh, expression, &mut self.network)?;
        observe(Stage::Nodes);
        let order = self.heir.order(&expression.nodes, parent);
        self.solver.solve_ordered_into(&self.network, solver, Some(order), &mut self.equilibrium, observe);
        let Equilibrium { positions, forces, residual, status, .. } = &self.equilibrium;
        if *status != Status::Converged {
            return Err(PhenotypeError::Equilibrium(*status, *residual));
        }
        let measures = Measures::new(expression, &self.network, positions, forces);
        observe(Stage::Measure);
        Ok(Evaluation { measures, residual: *residual })
    }
}

impl Phenotype {
    /// Inner force of every expressed cell [N].
    pub fn inner_forces(&self) -> Vec<f64> {
        inner_forces(&self.expression, &self.equilibrium.forces)
    }
}

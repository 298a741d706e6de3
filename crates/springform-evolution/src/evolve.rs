//! The hybrid evolutionary algorithm: no crossover, many mutants, filters, the best goes on (the paper §3.1, Fig. 9).
//!
//! With comma selection the best mutant becomes the next parent even if it is worse than its parent
//! (Laumanns et al. 2000 in the paper, §3.6); with plus selection the parent contends.

use crate::draws::Draws;
use crate::ending::{Ending, Reason};
use crate::fitness::{Criterion, Fitness, Score, Standing};
use crate::lineage::Lineage;
use crate::mutation::{Candidates, Palette, Strategy};
use crate::phenotype::{Evaluation, PhenotypeError, Setting};
use crate::selection::{WEIGHTINGS, Weighting, WeightingParameters};
use crate::variation::Variation;
use crate::workspace::{Workspace, Workspaces};
use rayon::prelude::*;
use springform_mechanics::measures::Measures;
use springform_mechanics::stage::Stage;
use springform_topology::MAX_CELLS;
use springform_topology::cell_type::CellTypeId;
use springform_topology::edit::Edit;
use springform_topology::filters::Method;
use springform_topology::forest::Forest;
use springform_topology::gene::Instances;

/// Mutants that are evaluated between two questions whether to go on.
const BATCH: u32 = 256;

/// Who may become the next parent.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Selection {
    /// Mutants only.
    Comma,
    /// Mutants and their parent.
    Plus,
}

/// Parameters of a run that stay the same from generation to generation.
#[derive(Clone, PartialEq, Debug)]
pub struct Parameters {
    /// Mutants a generation, λ.
    pub population: u32,
    /// Seed of all draws.
    pub seed: u64,
    /// Cell types that mutation draws; not empty.
    pub types: Vec<CellTypeId>,
    /// Numbers in the weights.
    pub weights: WeightingParameters,
    /// Strategies mutate with their individuals.
    pub self_adapt: bool,
    /// How individuals are compared.
    pub criterion: Criterion,
    /// Who may become the next parent.
    pub selection: Selection,
    /// Genes, symmetries and the region of mutation.
    pub variation: Variation,
}

impl Parameters {
    /// Spring utilization against the start, comma selection and a strategy that stays.
    #[must_use]
    pub fn new(population: u32, seed: u64, types: Vec<CellTypeId>) -> Parameters {
        Parameters {
            population,
            seed,
            types,
            weights: WeightingParameters::default(),
            self_adapt: false,
            criterion: Criterion::by(Fitness::Suf),
            selection: Selection::Comma,
            variation: Variation::default(),
        }
    }
}

/// The genotype and standing from which a generation is drawn.
#[derive(Clone, Debug)]
pub struct Parent {
    /// Closed genotype.
    pub forest: Forest,
    /// Strategy that its mutants inherit.
    pub strategy: Strategy,
    /// Measures of its net.
    pub measures: Measures,
    /// Spring utilization factor against the reference it was chosen by.
    pub suf: Option<f64>,
    candidates: Candidates,
    lineage: Lineage,
}

/// One evaluated mutant.
#[derive(Clone, PartialEq, Debug)]
pub struct Individual {
    /// What was done to the parent, closure included.
    pub edits: Vec<Edit>,
    /// Strategy that it was drawn with.
    pub strategy: Strategy,
    /// Fingerprint of its genotype.
    pub fingerprint: u64,
    /// Measures; `None` if it is invalid.
    pub measures: Option<Measures>,
    /// Residual of its equilibrium over the mean force.
    pub residual: Option<f64>,
    /// Spring utilization factor.
    pub suf: Option<f64>,
    /// Fitness.
    pub score: Score,
}

/// A run at some generation.
pub struct Evolution {
    setting: Setting,
    parameters: Parameters,
    start: Standing,
    parent: Parent,
    generation: u32,
    threads: rayon::ThreadPool,
    workspaces: Workspaces,
}

/// What one generation gave.
#[derive(Clone, PartialEq, Debug)]
pub struct Generation {
    /// Its number, from 1.
    pub number: u32,
    /// All mutants, in order.
    pub individuals: Vec<Individual>,
    /// The mutant that became parent; `None` if the parent stayed.
    pub winner: Option<usize>,
}

impl Evolution {
    /// A run before its first generation, or one picked up after `generation` with the parent of that time.
    ///
    /// `start` is the standing of the design that the run began with; `None` takes it from `forest`.
    /// `suf` is the parent's spring utilization factor when it was chosen.
    ///
    /// # Errors
    /// The forest gives no net.
    ///
    /// # Panics
    /// The operating system refuses a thread.
    pub fn new(
        setting: Setting,
        parameters: Parameters,
        mut forest: Forest,
        strategy: Strategy,
        resumed: Option<(u32, Standing, Option<f64>)>,
        threads: usize,
    ) -> Result<Evolution, PhenotypeError> {
        setting.close(&mut forest)?;
        let (generation, start, suf) =
            resumed.map_or((0, None, None), |(at, start, suf)| (at, Some(start), suf));
        let parent = Parent::new(&setting, &parameters, forest, strategy, suf)?;
        let start = start.unwrap_or_else(|| Standing::from(&parent.measures));
        let threads = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let threads = threads.expect("the operating system gives threads");
        let workspaces = Workspaces::default();
        Ok(Evolution { setting, parameters, start, parent, generation, threads, workspaces })
    }

    /// The parent of the next generation.
    pub fn parent(&self) -> &Parent {
        &self.parent
    }

    /// Standing of the design that the run began with.
    pub fn start(&self) -> Standing {
        self.start
    }

    /// Number of generations made.
    pub fn generation(&self) -> u32 {
        self.generation
    }

    /// What the run grows in.
    pub fn setting(&self) -> &Setting {
        &self.setting
    }

    /// The ending condition that holds now.
    pub fn reached(&self, ending: &Ending) -> Option<Reason> {
        ending.reached(self.generation, self.start, Standing::from(&self.parent.measures), self.parent.suf)
    }

    /// Makes one generation and takes its winner as parent.
    ///
    /// # Errors
    /// None: the winner has been evaluated before.
    pub fn advance(&mut self) -> Result<Generation, PhenotypeError> {
        let individuals = self.batches().flat_map(|first| self.batch(first)).collect();
        self.choose_parent(individuals)
    }

    /// Makes one generation like [`Evolution::advance`], but asks now and then whether to go on.
    ///
    /// `None` if not: then nothing has changed.
    ///
    /// # Errors
    /// None: the winner has been evaluated before.
    pub fn advance_while(
        &mut self,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<Option<Generation>, PhenotypeError> {
        let mut individuals = Vec::with_capacity(self.parameters.population as usize);
        for first in self.batches() {
            individuals.extend(self.batch(first));
            if !go_on() {
                return Ok(None);
            }
        }
        self.choose_parent(individuals).map(Some)
    }

    fn batches(&self) -> impl Iterator<Item = u32> + use<> {
        (0..self.parameters.population).step_by(BATCH as usize)
    }

    fn batch(&self, first: u32) -> Vec<Individual> {
        let number = self.generation + 1;
        let last = self.parameters.population.min(first.saturating_add(BATCH));
        let individual = |index| {
            self.workspaces.with(|workspace| self.individual_in(number, index, workspace, &mut |_| {}))
        };
        // One by one, or a thread would be left with a long stretch when the others are done.
        self.threads.install(|| (first..last).into_par_iter().with_max_len(1).map(individual).collect())
    }

    fn choose_parent(&mut self, individuals: Vec<Individual>) -> Result<Generation, PhenotypeError> {
        let winner = self.choose(&individuals);
        if let Some(index) = winner {
            let individual = &individuals[index];
            let mut forest = self.parent.forest.clone();
            Edit::apply_all(&individual.edits, &mut forest)?;
            let Individual { strategy, suf, .. } = *individual;
            self.parent = Parent::new(&self.setting, &self.parameters, forest, strategy, suf)?;
        }
        self.generation += 1;
        Ok(Generation { number: self.generation, individuals, winner })
    }

    /// The closed genotype of a mutant of the present parent, and the edits that made it, without its net; `None`
    /// if it has none.
    pub fn genotype(&self, generation: u32, index: u32) -> Option<(Forest, Vec<Edit>)> {
        self.workspaces.with(|workspace| {
            let (_, grown) = self.draw(generation, index, workspace, &mut |_| {});
            grown.ok().map(|()| (workspace.forest.clone(), workspace.edits.clone()))
        })
    }

    /// Draws and evaluates one mutant of the present parent, the same whenever it is asked for.
    pub fn individual(&self, generation: u32, index: u32) -> Individual {
        self.individual_in(generation, index, &mut Workspace::default(), &mut |_| {})
    }

    /// The same in memory that is used again and again; `observe` is told when a stage ends.
    pub fn individual_in(
        &self,
        generation: u32,
        index: u32,
        workspace: &mut Workspace,
        observe: &mut impl FnMut(Stage),
    ) -> Individual {
        let (strategy, grown) = self.draw(generation, index, workspace, observe);
        let Workspace { forest, evaluator, edits, .. } = workspace;
        let fingerprint = if grown.is_ok() { forest.fingerprint() } else { 0 };
        observe(Stage::Mutate);
        let evaluation = grown
            .and_then(|()| evaluator.evaluate(&self.setting, forest, &self.parent.lineage, observe))
            .ok();
        let judged = evaluation.map(|Evaluation { measures, residual }| {
            let criterion = &self.parameters.criterion;
            let parent = Standing::from(&self.parent.measures);
            let suf = criterion.suf(&measures, self.start, parent);
            (measures, residual, suf, criterion.score(&measures, self.start, parent))
        });
        Individual {
            edits: edits.clone(),
            strategy,
            fingerprint,
            measures: judged.map(|(measures, ..)| measures),
            residual: judged.map(|(_, residual, ..)| residual),
            suf: judged.and_then(|(_, _, suf, _)| suf),
            score: judged.map_or(Score::UNDEFINED, |(.., score)| score),
        }
    }

    /// Draws a mutant into a workspace.
    fn draw(
        &self,
        generation: u32,
        index: u32,
        workspace: &mut Workspace,
        observe: &mut impl FnMut(Stage),
    ) -> (Strategy, Result<(), PhenotypeError>) {
        let mut draws = Draws::new(self.parameters.seed, u64::from(generation), u64::from(index));
        let inherited = self.parent.strategy;
        let strategy = if self.parameters.self_adapt { inherited.mutated(&mut draws) } else { inherited };
        let palette = Palette {
            types: &self.parameters.types,
            catalogue: &self.setting.catalogue,
            weights: &self.parameters.weights,
        };
        let Workspace { mutator, edits, .. } = workspace;
        edits.clear();
        mutator.mutate(&self.parent.candidates, &strategy, &palette, &mut draws, edits);
        let grown = self.grow_mutant(workspace, &mut draws, observe);
        (strategy, grown)
    }

    /// The mutant's closed forest; what closing took is appended to the edits.
    fn grow_mutant(
        &self,
        workspace: &mut Workspace,
        draws: &mut Draws,
        observe: &mut impl FnMut(Stage),
    ) -> Result<(), PhenotypeError> {
        let Workspace { forest, edits, closure, .. } = workspace;
        forest.clone_from(&self.parent.forest);
        Edit::apply_all(edits, forest)?;
        self.parameters.variation.complete(&self.setting, forest, edits, draws)?;
        observe(Stage::Mutate);
        if !forest.references().is_empty() {
            edits.extend(self.setting.close(forest)?);
        } else if self.setting.method == Method::Recursive {
            closure.close_after(&self.setting.mesh, forest, edits)?;
        }
        observe(Stage::Filter);
        if forest.stored() > MAX_CELLS {
            return Err(PhenotypeError::TooManyCells);
        }
        Ok(())
    }

    fn choose(&self, individuals: &[Individual]) -> Option<usize> {
        let springs = |measures: Option<&Measures>| measures.map_or(0, |measures| measures.springs);
        let mut standings: Vec<(Score, u32)> =
            individuals.iter().map(|one| (one.score, springs(one.measures.as_ref()))).collect();
        let criterion = &self.parameters.criterion;
        if self.parameters.selection == Selection::Comma {
            return criterion.choose(&standings);
        }
        let parent = &self.parent.measures;
        standings.insert(0, (criterion.incumbent(parent, self.start), parent.springs));
        criterion.choose(&standings).and_then(|index| index.checked_sub(1))
    }
}

impl Parent {
    /// Measures a forest anew, whoever measured it before: what a parent is must not depend on its own parent.
    fn new(
        setting: &Setting,
        parameters: &Parameters,
        forest: Forest,
        strategy: Strategy,
        suf: Option<f64>,
    ) -> Result<Parent, PhenotypeError> {
        let weighs = |weighting| parameters.self_adapt || weighting == strategy.weighting;
        let (phenotype, lineage) = setting.evaluate_with_lineage(&forest)?;
        let inner_forces = if weighs(Weighting::Stress) { phenotype.inner_forces() } else { Vec::new() };
        let mut candidates = Candidates::new(&forest, &inner_forces);
        let instances = Instances::new(&setting.mesh, &setting.catalogue, &forest)?;
        candidates.favour(|place| {
            if instances.represents(place.face) { parameters.variation.factor(place) } else { 0.0 }
        });
        for (weighting, _) in WEIGHTINGS.into_iter().filter(|&(weighting, _)| weighs(weighting)) {
            candidates.weigh(weighting, &parameters.weights);
        }
        Ok(Parent { forest, strategy, measures: phenotype.measures, suf, candidates, lineage })
    }
}

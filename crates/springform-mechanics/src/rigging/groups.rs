//! Groups of springs: what each says of its springs, and what that makes of a spring's law.
//!
//! Every property of a spring comes from the last group that holds the spring and says something of the property.

use super::choice::SpringChoice;
use super::{Rigging, RiggingError};
use crate::curve::Curve;
use crate::network::{NO_CURVE, Network, Sense};
use springform_topology::base_mesh::BaseMesh;
use springform_topology::expression::Expression;

/// What a design says of some springs; `None` leaves a property to earlier groups.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SpringGroup {
    /// Which springs.
    pub springs: SpringChoice,
    /// Force against length.
    pub law: Option<Law>,
    /// Unstressed length.
    pub rest: Option<Rest>,
    /// Whether they pull, push, or both; they pull unless said.
    pub sense: Option<Sense>,
    /// Area of the cross-section [m²].
    pub area: Option<f64>,
    /// Weight per length [N/m].
    pub weight: Option<f64>,
    /// Thermal expansion [1/K].
    pub expansion: Option<f64>,
    /// Temperature above that at which lengths are given [K].
    pub temperature: Option<f64>,
}

/// Force against length.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Law {
    /// F = k (L − r), k [N/m].
    Stiffness(f64),
    /// F = EA (L − L0)/L0, EA [N] referring to the unstressed length L0.
    AxialStiffness(f64),
    /// F = q L, q [N/m].
    ForceDensity(f64),
    /// F = T [N], whatever the length.
    Force(f64),
    /// A measured curve by its number in [`Rigging::curves`].
    Curve(u32),
}

/// Unstressed length.
#[derive(Clone, PartialEq, Debug)]
pub enum Rest {
    /// A length [m].
    Length(f64),
    /// A share of the drawn length, by the level of the spring's deepest cell; the last holds for deeper ones. Not empty.
    Ratio(Vec<f64>),
    /// Such that the spring has this force at its drawn length [N].
    Prestress(f64),
}

/// What holds for one spring.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Properties<'a> {
    /// Its law; `None`: that of the design.
    pub law: Option<Law>,
    /// Its unstressed length and the group that says it.
    pub rest: Option<(usize, &'a Rest)>,
    /// Whether it pulls, pushes, or both.
    pub sense: Option<Sense>,
    /// Area of its cross-section [m²].
    pub area: Option<f64>,
    /// Its weight per length [N/m].
    pub weight: Option<f64>,
    /// Its thermal expansion [1/K].
    pub expansion: Option<f64>,
    /// Its temperature difference [K].
    pub temperature: Option<f64>,
}

impl SpringGroup {
    /// The group asks which cells own a spring.
    pub(super) fn needs_owners(&self) -> bool {
        self.rest.as_ref().is_some_and(Rest::is_by_level) || !self.springs.cells.is_all()
    }
}

impl Rest {
    fn is_by_level(&self) -> bool {
        matches!(self, Rest::Ratio(ratios) if ratios.len() > 1)
    }
}

impl Rigging {
    /// What the groups say of every spring of a net.
    pub fn properties(&self, mesh: &BaseMesh, expression: &Expression) -> Vec<Properties<'_>> {
        let mut all = vec![Properties::default(); expression.springs.len()];
        for (number, group) in self.groups.iter().enumerate() {
            let chosen = group.springs.chosen(mesh, expression);
            for (properties, _) in all.iter_mut().zip(chosen).filter(|&(_, chosen)| chosen) {
                properties.law = group.law.or(properties.law);
                properties.rest = group.rest.as_ref().map(|rest| (number, rest)).or(properties.rest);
                properties.sense = group.sense.or(properties.sense);
                properties.area = group.area.or(properties.area);
                properties.weight = group.weight.or(properties.weight);
                properties.expansion = group.expansion.or(properties.expansion);
                properties.temperature = group.temperature.or(properties.temperature);
            }
        }
        all
    }

    /// Gives the springs of a network their laws, and writes their weights per length [N/m].
    pub(super) fn set_laws(
        &self,
        mesh: &BaseMesh,
        expression: &Expression,
        network: &mut Network<'static>,
        weights: &mut [f64],
    ) -> Result<(), RiggingError> {
        let lengths = network.lengths(&network.positions);
        let properties = self.properties(mesh, expression);
        let mut curve = vec![NO_CURVE; lengths.len()];
        for (spring, properties) in properties.iter().enumerate() {
            let by_level = properties.rest.is_some_and(|(_, rest)| rest.is_by_level());
            // Owners are known only where a group asks for them.
            let level = if by_level { level(expression, spring as u32) } else { 0 };
            let drawn = Drawn { length: lengths[spring], level };
            let refuse = |error: Unfit| error.of(properties, expression, spring);
            let law = properties.law.unwrap_or(Law::Stiffness(network.stiffness[spring]));
            let elastic = resolve(law, properties, drawn, &self.curves).map_err(refuse)?;
            network.stiffness.to_mut()[spring] = elastic.stiffness;
            network.rest_length.to_mut()[spring] = elastic.rest;
            network.force.to_mut()[spring] = elastic.force;
            network.sense.to_mut()[spring] = properties.sense.unwrap_or(Sense::Tension);
            // Warmth makes a spring longer, not heavier: its weight is that of the cold length.
            weights[spring] = properties.weight.unwrap_or(0.0) / elastic.warmer;
            curve[spring] = if let Law::Curve(number) = law { number } else { NO_CURVE };
        }
        if curve.iter().any(|&number| number != NO_CURVE) {
            network.curve = curve.into();
            network.curves = self.curves.clone().into();
        }
        Ok(())
    }
}

#[derive(Clone, Copy)]
struct Drawn {
    length: f64,
    level: u8,
}

struct Elastic {
    stiffness: f64,
    rest: f64,
    force: f64,
    /// Unstressed length over that of the cold spring.
    warmer: f64,
}

/// What does not fit a spring.
enum Unfit {
    Unstressed(f64),
    Frozen,
}

impl Unfit {
    fn of(self, properties: &Properties<'_>, expression: &Expression, spring: usize) -> RiggingError {
        let [a, b] = expression.springs[spring].nodes.map(|node| expression.nodes[node as usize]);
        let problem = match self {
            Unfit::Unstressed(length) => {
                format!("would be {length:.3e} m long without force; its law needs another length")
            }
            Unfit::Frozen => "shrinks to nothing at its temperature; write a smaller difference".into(),
        };
        let key = properties.rest.map_or("springs".into(), |(group, _)| format!("springs.groups[{group}]"));
        RiggingError { key, problem: format!("the spring {a} {b} {problem}") }
    }
}

/// Stiffness, rest length and constant force; the same law as that of a bare network.
fn resolve(law: Law, properties: &Properties<'_>, drawn: Drawn, curves: &[Curve]) -> Result<Elastic, Unfit> {
    let warmer = 1.0 + properties.expansion.unwrap_or(0.0) * properties.temperature.unwrap_or(0.0);
    if warmer.is_nan() || warmer <= 0.0 {
        return Err(Unfit::Frozen);
    }
    let rest = properties.rest.map(|(_, rest)| rest);
    let cold = |without: f64, stretched: &dyn Fn(f64) -> f64| match rest {
        None => without,
        Some(Rest::Length(length)) => *length,
        Some(Rest::Ratio(ratios)) => ratios[usize::from(drawn.level).min(ratios.len() - 1)] * drawn.length,
        Some(Rest::Prestress(force)) => stretched(*force),
    };
    let checked = |length: f64, least: bool| {
        let fits = length.is_finite() && if least { length >= 0.0 } else { length > 0.0 };
        if fits { Ok(length) } else { Err(Unfit::Unstressed(length)) }
    };
    Ok(match law {
        Law::Stiffness(k) => {
            let rest = checked(cold(0.0, &|force| drawn.length - force / k), true)?;
            let warmer = if rest > 0.0 { warmer } else { 1.0 };
            Elastic { stiffness: k, rest: rest * warmer, force: 0.0, warmer }
        }
        Law::AxialStiffness(axial) => {
            let rest = checked(cold(drawn.length, &|force| drawn.length / (1.0 + force / axial)), false)?;
            Elastic { stiffness: axial / rest / warmer, rest: rest * warmer, force: 0.0, warmer }
        }
        Law::ForceDensity(density) => Elastic { stiffness: density, rest: 0.0, force: 0.0, warmer: 1.0 },
        Law::Force(force) => Elastic { stiffness: 0.0, rest: 0.0, force, warmer: 1.0 },
        Law::Curve(number) => {
            let curve = &curves[number as usize];
            let axial = curve.axial_stiffness();
            let stretched = |force: f64| drawn.length / (1.0 + curve.strain(force / axial));
            let rest = checked(cold(drawn.length, &stretched), false)?;
            // A measured curve keeps its axial stiffness; k r is that.
            Elastic { stiffness: axial / rest / warmer, rest: rest * warmer, force: 0.0, warmer }
        }
    })
}

/// Level of a spring's deepest cell; 0 for a spring added by hand.
fn level(expression: &Expression, spring: u32) -> u8 {
    let cells = expression.spring_cells.of(spring).iter();
    cells.map(|&cell| expression.cells[cell as usize].place.level).max().unwrap_or(0)
}

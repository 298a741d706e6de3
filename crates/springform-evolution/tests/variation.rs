//! Properties of genes, symmetries and regions in evolution: kept, replayed, and drawn the same every time.

mod runs;

use proptest::prelude::*;
use runs::common::{Dice, cases, dice};
use runs::{Start, starts};
use springform_evolution::cell_weights::CellWeights;
use springform_evolution::evolve::{Evolution, Individual, Parameters};
use springform_evolution::mutation::{Amount, Strategy};
use springform_evolution::variation::Variation;
use springform_topology::address::Place;
use springform_topology::cell_type::CellTypeId;
use springform_topology::edit::Edit;
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest};
use springform_topology::node_key::NodeKey;
use springform_topology::orientation::{Mirrors, Orientation};
use springform_topology::patch::{Patch, Viewpoint, lift};
use springform_topology::selection::Selection;
use springform_topology::symmetry::{Orbits, symmetries};
use springform_topology::tree::Tree;
use std::collections::{BTreeMap, BTreeSet};

fn begin(start: &Start, dice: &mut Dice, variation: Variation) -> Option<Evolution> {
    let parameters = runs::parameters(start.setting.method, dice);
    let parameters = Parameters { population: 5, variation, ..parameters };
    let strategy = runs::strategy(dice);
    Evolution::new(start.setting.clone(), parameters, start.forest.clone(), strategy, None, 2).ok()
}

/// Every individual of some generations, replayed from its parent.
fn replayed(evolution: &mut Evolution, generations: u32) -> Vec<(Forest, Forest)> {
    let mut pairs = Vec::new();
    for _ in 0..generations {
        let parent = evolution.parent().forest.clone();
        let (number, index) = (evolution.generation() + 1, 3);
        let alone = evolution.individual(number, index);
        let generation = evolution.advance().expect("the winner was evaluated");
        assert_eq!(generation.individuals[index as usize].edits, alone.edits);
        for individual in generation.individuals.iter().filter(|one| one.measures.is_some()) {
            let mut forest = parent.clone();
            Edit::apply_all(&individual.edits, &mut forest).expect("edits of an individual fit its parent");
            assert_eq!(forest.fingerprint(), individual.fingerprint);
            pairs.push((parent.clone(), forest));
        }
    }
    pairs
}

fn patch(start: &Start, dice: &mut Dice) -> Patch {
    let setting = &start.setting;
    let vertex = dice.pick(&setting.anchors);
    let round = Selection::rings(&setting.mesh, &[NodeKey::vertex(vertex)], dice.between(1, 2), 0);
    let viewpoint = if dice.percent(50) { Viewpoint::Anchor(vertex) } else { Viewpoint::Anywhere };
    let mirrors = Mirrors::new(&setting.catalogue);
    lift(&setting.mesh, &start.forest, &round, viewpoint, &mirrors).expect("cells at an anchor").patch
}

proptest! {
    #![proptest_config(cases(300))]

    /// With symmetry every individual keeps the framework's symmetry, whatever is drawn, closed or grafted.
    #[test]
    fn symmetric_runs_stay_symmetric(mut start in starts(0), mut dice in dice(60)) {
        let setting = &start.setting;
        let Ok(group) = symmetries(&setting.mesh, &setting.anchors) else { return Ok(()) };
        let types = (0..7).map(CellTypeId).collect::<BTreeSet<_>>();
        let faces = start.forest.top_level();
        start.forest = Forest::new(faces, Content::QUAD);
        let orbits = Orbits::new(&group, faces, &setting.catalogue, &types).expect("built-in types have images");
        let genes = if dice.percent(50) { vec![patch(&start, &mut dice)] } else { Vec::new() };
        let variation =
            Variation { genes, grafts: Amount::Count(2.0), orbits: Some(orbits.clone()), ..Variation::default() };
        let mesh = setting.mesh.clone();
        let Some(mut evolution) = begin(&start, &mut dice, variation) else { return Ok(()) };
        for (_, forest) in replayed(&mut evolution, 3) {
            prop_assert_eq!(orbits.check(&mesh, &forest, &group), Ok(()));
        }
    }

    /// Within a region mutation changes nothing outside; only closing may.
    #[test]
    fn evolution_stays_within_its_region(start in starts(12), mut dice in dice(60)) {
        let vertex = dice.pick(&start.setting.anchors);
        let level = dice.below(2) as u8;
        let round = Selection::rings(&start.setting.mesh, &[NodeKey::vertex(vertex)], 1, level);
        let genes = if dice.percent(50) { vec![patch(&start, &mut dice)] } else { Vec::new() };
        let within = Some(round.clone());
        let variation = Variation { genes, grafts: Amount::Share(0.2), within, ..Variation::default() };
        let Some(mut evolution) = begin(&start, &mut dice, variation) else { return Ok(()) };
        for (parent, forest) in replayed(&mut evolution, 2) {
            for face in 0..forest.top_level() {
                let same = Tree::of(&parent, parent.top(face)) == Tree::of(&forest, forest.top(face));
                let selected = round.faces().contains(&face);
                prop_assert!(same || selected || start.setting.method == Method::Recursive);
                prop_assert!(same || !round.contains(Place::top(face)) || selected);
            }
        }
    }

    /// Cells of factor 0 stay as they are, however deep they lie, under steps on the cells above and under genes.
    #[test]
    fn what_is_kept_out_of_stays(start in starts(12), mut dice in dice(60)) {
        let mut places = Vec::new();
        start.forest.visit_reachable(|_, place| places.push(place));
        let place = dice.pick(&places);
        let genes = if dice.percent(50) { vec![patch(&start, &mut dice)] } else { Vec::new() };
        let cell_weights = CellWeights::new([(Place::top(place.face), 3.0), (place, 0.0)]);
        let variation = Variation { genes, cell_weights, ..Variation::default() };
        let Some(mut evolution) = begin(&start, &mut dice, variation) else { return Ok(()) };
        for (parent, forest) in replayed(&mut evolution, 2) {
            let tree = |forest: &Forest| forest.find(place).map(|cell| Tree::of(forest, cell));
            prop_assert!(tree(&parent) == tree(&forest) || start.setting.method == Method::Recursive);
        }
    }

    /// Factors of 1 change no bit.
    #[test]
    fn factors_of_one_change_nothing(start in starts(12), dice in dice(60)) {
        let ones = CellWeights::new((0..start.forest.top_level()).map(|face| (Place::top(face), 1.0)));
        let run = |cell_weights| {
            let variation = Variation { cell_weights, ..Variation::default() };
            let mut evolution = begin(&start, &mut dice.clone(), variation)?;
            Some(evolution.advance().expect("the winner was evaluated").individuals)
        };
        let (plain, weighted) = (run(CellWeights::default()), run(ones));
        let edits = |individuals: Option<Vec<Individual>>| {
            individuals.map(|all| all.into_iter().map(|one| one.edits).collect::<Vec<_>>())
        };
        prop_assert_eq!(edits(plain), edits(weighted));
    }

    /// An orbit's factor is the mean of its cells', 0 if one of them is kept out of, whichever cells were brushed.
    #[test]
    fn orbits_have_one_factor(start in starts(8), mut dice in dice(60)) {
        let setting = &start.setting;
        let Ok(group) = symmetries(&setting.mesh, &setting.anchors) else { return Ok(()) };
        let types = (0..7).map(CellTypeId).collect();
        let orbits = Orbits::new(&group, start.forest.top_level(), &setting.catalogue, &types).expect("images");
        let mut places = Vec::new();
        start.forest.visit_reachable(|_, place| places.push(place));
        let brushed: Vec<(Place, f64)> = (0..6)
            .map(|_| (dice.pick(&places), f64::from(dice.pick(&[0, 1, 1, 3, 7, 10, 100]))))
            .collect();
        let one = &group[dice.below(group.len() as u32) as usize];
        let variation = |factors: Vec<(Place, f64)>| Variation {
            orbits: Some(orbits.clone()), cell_weights: CellWeights::new(factors), ..Variation::default()
        };
        let carried: BTreeMap<Place, f64> =
            brushed.iter().map(|&(place, factor)| (one.place(place), factor)).collect();
        let (here, there) = (variation(brushed.clone()), variation(carried.into_iter().collect()));
        for place in places {
            let factor = here.factor_of_orbit(place);
            prop_assert_eq!(factor, here.factor_of_orbit(one.place(place)), "whichever cell is asked");
            prop_assert_eq!(factor, there.factor_of_orbit(place), "whichever cells are brushed");
            let images: BTreeSet<Place> = group.iter().map(|one| one.place(place)).collect();
            let each: Vec<f64> = images.iter().map(|&image| here.cell_weights.of(image)).collect();
            let mean = each.iter().sum::<f64>() / each.len() as f64;
            let expected = if each.contains(&0.0) { 0.0 } else { mean };
            prop_assert!((factor - expected).abs() <= 1e-12 * expected);
            prop_assert_eq!(here.factor(place), if orbits.represents(place) { factor } else { 0.0 });
        }
    }

    /// Under symmetries too, cells of factor 0 stay as they are, and so do all their images.
    #[test]
    fn what_is_kept_out_of_stays_in_all_its_images(mut start in starts(0), mut dice in dice(60)) {
        let setting = &start.setting;
        let Ok(group) = symmetries(&setting.mesh, &setting.anchors) else { return Ok(()) };
        let types = (0..7).map(CellTypeId).collect();
        let faces = start.forest.top_level();
        start.forest = Forest::new(faces, Content::QUAD);
        let orbits = Orbits::new(&group, faces, &setting.catalogue, &types).expect("images");
        let place = Place::top(dice.below(faces));
        let genes = if dice.percent(50) { vec![patch(&start, &mut dice)] } else { Vec::new() };
        let cell_weights = CellWeights::new([(place, 0.0)]);
        let variation = Variation { genes, orbits: Some(orbits), cell_weights, ..Variation::default() };
        let Some(mut evolution) = begin(&start, &mut dice, variation) else { return Ok(()) };
        for (parent, forest) in replayed(&mut evolution, 2) {
            for image in group.iter().map(|one| one.place(place)) {
                let tree = |forest: &Forest| forest.find(image).map(|cell| Tree::of(forest, cell));
                prop_assert!(tree(&parent) == tree(&forest) || start.setting.method == Method::Recursive);
            }
        }
    }

    /// Without other mutations a mutant is its parent with the gene in some places, whole cell by whole cell.
    #[test]
    fn genes_are_inserted(start in starts(12), mut dice in dice(60)) {
        let mut gene = patch(&start, &mut dice);
        let marked = Tree::read("1(1 1(1 1 1 1) 1 1)", &start.setting.catalogue).expect("a tree");
        for tree in gene.cells.iter_mut().flat_map(|cell| cell.trees.values_mut()) {
            tree.clone_from(&marked);
        }
        let variation = Variation { genes: vec![gene], ..Variation::default() };
        let none = Amount::Count(0.0);
        let strategy = Strategy { insertions: none, switches: none, toggles: none, ..runs::strategy(&mut dice) };
        let drawn = runs::parameters(start.setting.method, &mut dice);
        let parameters = Parameters { population: 5, self_adapt: false, variation, ..drawn };
        let (setting, forest) = (start.setting.clone(), start.forest.clone());
        let Ok(mut evolution) = Evolution::new(setting, parameters, forest, strategy, None, 1) else { return Ok(()) };
        let images: Vec<Tree> = Orientation::all()
            .filter_map(|turned| marked.oriented(turned, &Mirrors::new(&start.setting.catalogue)).ok())
            .collect();
        for (parent, forest) in replayed(&mut evolution, 1) {
            let mut trees = (0..forest.top_level()).map(|face| {
                let (before, now) = (Tree::of(&parent, parent.top(face)), Tree::of(&forest, forest.top(face)));
                (now != before, now)
            });
            let closed = start.setting.method == Method::Recursive;
            prop_assert!(trees.all(|(changed, tree)| closed || !changed || images.contains(&tree)));
        }
    }
}

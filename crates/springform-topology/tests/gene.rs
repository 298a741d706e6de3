//! Properties of genes by reference: instances stay alike under edits and closing, and everything can be undone.

mod common;

use common::{Design, Dice, cases, dice, edit_dice, grown_designs};
use proptest::prelude::*;
use springform_topology::edit::Edit;
use springform_topology::filters::Method;
use springform_topology::gene::{Gene, GeneError, Instances, Reference, close_alike, follow};
use springform_topology::node_key::NodeKey;
use springform_topology::orientation::{Mirrors, Orientation};
use springform_topology::patch::{Viewpoint, lift};
use springform_topology::selection::Selection;
use springform_topology::tree::Tree;

/// A gene lifted somewhere and referred to wherever it fits among some random places; what that took.
fn refer(design: &mut Design, dice: &mut Dice) -> Option<Vec<Edit>> {
    let vertex = dice.pick(&design.anchors);
    let round = Selection::rings(&design.mesh, &[NodeKey::vertex(vertex)], 1, 0);
    let mirrors = Mirrors::new(&design.catalogue);
    let viewpoint = Viewpoint::Anchor(vertex);
    let patch = lift(&design.mesh, &design.forest, &round, viewpoint, &mirrors).ok()?.patch;
    let gene = design.catalogue.define_gene(Gene { name: "crown".to_owned(), patch })?;
    let mut done = Vec::new();
    for _ in 0..6 {
        let orientation = Orientation::new(dice.below(4) as u8, dice.percent(50));
        let reference = Reference { gene, orientation };
        let seed = dice.below(design.forest.top_level());
        let (mut forest, mut edits) =
            (design.forest.clone(), vec![Edit::Refer { seed, reference, set: true }]);
        if Edit::apply_all(&edits, &mut forest).is_err() {
            continue;
        }
        match follow(&design.mesh, &design.catalogue, &mut forest, &mut edits) {
            Ok(()) => {
                design.forest = forest;
                done.extend(edits);
            }
            Err(GeneError::Edit(error)) => panic!("{error}"),
            Err(_) => {}
        }
    }
    Some(done)
}

/// All instances of every gene hold the same, as their frames see it.
fn alike(design: &Design) -> bool {
    let mirrors = Mirrors::new(&design.catalogue);
    let instances = Instances::new(&design.mesh, &design.catalogue, &design.forest).expect("they fit");
    let mut seen = instances.list.iter().map(|one| -> Vec<Tree> {
        let tree = |at: &springform_topology::orientation::Frame| {
            let tree = Tree::of(&design.forest, design.forest.top(at.face));
            tree.oriented(at.orientation.inverse(), &mirrors).expect("types with images")
        };
        one.cells.iter().map(tree).collect()
    });
    let Some(first) = seen.next() else { return true };
    seen.all(|other| other == first)
}

proptest! {
    #![proptest_config(cases(1500))]

    /// Whatever is done to one instance is done to all; undoing it all gives the forest back.
    #[test]
    fn instances_stay_alike(
        mut design in grown_designs(15), mut dice in dice(40), edits in edit_dice(8)
    ) {
        let start = design.forest.clone();
        let Some(mut done) = refer(&mut design, &mut dice) else { return Ok(()) };
        prop_assert!(alike(&design));
        for mut dice in edits {
            let mut more = vec![design.random_edit(&mut dice)];
            // A type without mirror image can't come into a gene that is mirrored somewhere.
            let before = design.forest.clone();
            Edit::apply_all(&more, &mut design.forest).expect("random edits fit");
            match follow(&design.mesh, &design.catalogue, &mut design.forest, &mut more) {
                Ok(()) => done.extend(more),
                Err(GeneError::NoMirror(..)) => design.forest = before,
                Err(error) => prop_assert!(false, "{}", error),
            }
            prop_assert!(alike(&design));
        }
        if design.method == Method::Recursive {
            done.extend(close_alike(&design.mesh, &design.catalogue, &mut design.forest).expect("closes"));
            prop_assert!(alike(&design));
            let again = close_alike(&design.mesh, &design.catalogue, &mut design.forest).expect("closes");
            prop_assert_eq!(again, vec![]);
        }
        let end = design.forest.clone();
        for edit in &done {
            let line = edit.write(&design.catalogue);
            prop_assert_eq!(Edit::parse(&line, &design.mesh, &design.catalogue), Ok(*edit));
        }
        Edit::apply_all(&Edit::invert_all(&done), &mut design.forest).expect("edits invert");
        prop_assert_eq!(&design.forest, &start);
        Edit::apply_all(&done, &mut design.forest).expect("edits repeat");
        prop_assert_eq!(&design.forest, &end);
        prop_assert_eq!(design.forest.fingerprint(), end.fingerprint());
    }

    /// The gene is what its instances hold, so that it can be written down and referred to anew.
    #[test]
    fn genes_are_what_their_instances_hold(mut design in grown_designs(15), mut dice in dice(60)) {
        if refer(&mut design, &mut dice).is_none() { return Ok(()) }
        let instances = Instances::new(&design.mesh, &design.catalogue, &design.forest).expect("they fit");
        for instance in &instances.list {
            let patch = instances.content(&design.forest, &design.catalogue, instance.gene).expect("an instance");
            prop_assert_eq!(&patch, &design.catalogue.gene(instance.gene).patch);
            prop_assert_eq!(instances.represents(instance.frame.face), instance == &instances.list[0]);
            let reference = design.forest.references()[&instance.frame.face];
            let text = reference.write(&design.catalogue);
            prop_assert_eq!(Reference::parse(&text, &design.catalogue), Some(reference));
        }
    }
}

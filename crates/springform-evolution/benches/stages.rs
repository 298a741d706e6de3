//! Times every stage of an individual of about 2,000 springs, whole individuals, and cords with rest lengths.

mod nets;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use nets::Net;
use springform_evolution::draws::Draws;
use springform_evolution::mutation::{Candidates, Palette, Strategy, mutate};
use springform_evolution::selection::WeightingParameters;
use springform_mechanics::assembly::assemble;
use springform_mechanics::equilibrium::{Settings, Solver, dynamic_relaxation, implicit_euler, solve};
use springform_mechanics::measures::Measures;
use springform_mechanics::network::Network;
use springform_mechanics::sparse::{Graph, ScalarFactor, Symbolic};
use springform_topology::cell_type::CellTypeId;
use springform_topology::edit::Edit;
use springform_topology::expression::express;
use springform_topology::filters::Method;
use std::hint::black_box;

/// What mutation draws from in a net, and how.
struct Mutation {
    candidates: Candidates,
    strategy: Strategy,
    types: Vec<CellTypeId>,
    weights: WeightingParameters,
}

impl Mutation {
    fn new(net: &Net) -> Mutation {
        let phenotype = net.setting.evaluate(&net.forest).expect("the net has an equilibrium");
        let parent = net.evolution();
        Mutation {
            candidates: Candidates::new(&net.forest, &phenotype.inner_forces()),
            strategy: parent.parent().strategy,
            types: nets::types(net.setting.method),
            weights: WeightingParameters::default(),
        }
    }

    fn edits(&self, net: &Net, index: u64) -> Vec<Edit> {
        let palette =
            Palette { types: &self.types, catalogue: &net.setting.catalogue, weights: &self.weights };
        mutate(&self.candidates, &self.strategy, &palette, &mut Draws::new(1, 1, index))
    }
}

fn topology(bench: &mut Criterion) {
    for (name, method) in [("dynamic", Method::Dynamic), ("recursive", Method::Recursive)] {
        let net = Net::new(method);
        let mutation = Mutation::new(&net);
        let edits = &mutation.edits(&net, 0);
        bench.bench_function(&format!("mutate/{name}"), |bencher| {
            let mut index = 0;
            bencher.iter(|| {
                index += 1;
                mutation.edits(&net, index)
            });
        });
        bench.bench_function(&format!("apply and filter/{name}"), |bencher| {
            bencher.iter_batched_ref(
                || net.forest.clone(),
                |forest| {
                    Edit::apply_all(edits, forest).expect("edits of a mutant fit");
                    net.setting.close(forest)
                },
                BatchSize::SmallInput,
            );
        });
        bench.bench_function(&format!("express/{name}"), |bencher| {
            let setting = &net.setting;
            bencher.iter(|| {
                express(&setting.mesh, &net.forest, &setting.catalogue, setting.method, &setting.anchors)
            });
        });
    }
}

fn mechanics(bench: &mut Criterion) {
    let net = Net::new(Method::Dynamic);
    let (expression, network) = net.setting.grow(&net.forest).expect("the scene gives a net");
    let (graph, diagonal, links) = laplacian(&network);
    let (mut symbolic, mut factor) = (Symbolic::default(), ScalarFactor::default());
    symbolic.build(&graph);
    factor.lay_out(&graph, &symbolic);
    let settings = Settings::default();
    let equilibrium = solve(&network, &settings);
    bench.bench_function("assemble", |bencher| {
        bencher.iter(|| assemble(&expression, &net.setting.embedding, net.setting.law));
    });
    bench.bench_function("order and analyse", |bencher| {
        bencher.iter(|| {
            symbolic.build(&graph);
            factor.lay_out(&graph, &symbolic);
        });
    });
    bench.bench_function("factor", |bencher| {
        bencher.iter(|| factor.factor(&graph, &symbolic, &diagonal, &links));
    });
    bench.bench_function("solve", |bencher| {
        let sides = || vec![[1.0, 2.0, 3.0, 0.0]; graph.rows()];
        bencher.iter_batched_ref(sides, |sides| factor.solve(sides), BatchSize::SmallInput);
    });
    let mut solver = Solver::default();
    bench.bench_function("linear equilibrium", |bencher| {
        bencher.iter(|| solver.solve(&network, &settings));
    });
    bench.bench_function("measure", |bencher| {
        bencher.iter(|| Measures::new(&expression, &network, &equilibrium.positions, &equilibrium.forces));
    });
}

fn cords(bench: &mut Criterion) {
    let cords = Net::new(Method::Dynamic).cords();
    let settings = Settings { tolerance: 1e-6, iterations: 100_000 };
    let mut solver = Solver::default();
    bench.bench_function("cords/direct", |bencher| bencher.iter(|| solver.solve(&cords, &settings)));
    bench.bench_function("cords/dynamic relaxation", |bencher| {
        bencher.iter(|| dynamic_relaxation::solve(&cords, &settings));
    });
    bench.bench_function("cords/implicit Euler", |bencher| {
        bencher.iter(|| implicit_euler::solve(&cords, &settings, implicit_euler::Motion::default()));
    });
}

fn individuals(bench: &mut Criterion) {
    for (name, method) in [("dynamic", Method::Dynamic), ("recursive", Method::Recursive)] {
        let evolution = Net::new(method).evolution();
        let mut index = 0;
        bench.bench_function(&format!("individual/{name}"), |bencher| {
            bencher.iter(|| {
                index = (index + 1) % 100;
                black_box(evolution.individual(1, index))
            });
        });
    }
}

/// The Laplacian of a network over its free nodes: graph, diagonal, and an entry a spring.
fn laplacian(network: &Network<'_>) -> (Graph, Vec<f64>, Vec<f64>) {
    let mut rows = vec![Graph::OUTSIDE; network.fixed.len()];
    let free = (0..rows.len()).filter(|&node| !network.fixed[node][0]);
    free.enumerate().for_each(|(row, node)| rows[node] = row as u32);
    let links: Vec<[u32; 2]> =
        network.springs.iter().map(|ends| ends.map(|node| rows[node as usize])).collect();
    let size = rows.iter().filter(|&&row| row != Graph::OUTSIDE).count();
    let mut graph = Graph::default();
    graph.build(size, links.iter().copied());
    let mut diagonal = vec![0.0; size];
    for (link, &k) in links.iter().zip(network.stiffness.iter()) {
        let inside = link.iter().filter(|&&row| row != Graph::OUTSIDE);
        inside.for_each(|&row| diagonal[row as usize] += k);
    }
    (graph, diagonal, network.stiffness.iter().map(|k| -k).collect())
}

criterion_group!(stages, topology, mechanics, cords, individuals);
criterion_main!(stages);

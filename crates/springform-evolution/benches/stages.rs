//! Times every stage of an individual of about 2,000 springs, whole individuals, and cords with rest lengths.

mod nets;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use nets::Net;
use springform_evolution::draws::Draws;
use springform_evolution::mutation::{Candidates, Palette, Strategy, mutate};
use springform_evolution::selection::WeightingParameters;
use springform_mechanics::assembly::assemble;
use springform_mechanics::equilibrium::cholesky::{Factor, Symbolic, SymmetricMatrix};
use springform_mechanics::equilibrium::{Settings, dynamic_relaxation, implicit_euler, solve};
use springform_mechanics::measures::Measures;
use springform_mechanics::network::Network;
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
    let matrix = laplacian(&network);
    let symbolic = Symbolic::new(&matrix);
    let factor = Factor::with_symbolic(&matrix, symbolic.clone()).expect("a held net");
    let settings = Settings::default();
    let equilibrium = solve(&network, &settings);
    bench.bench_function("assemble", |bencher| {
        bencher.iter(|| assemble(&expression, &net.setting.embedding, net.setting.law));
    });
    bench.bench_function("order and analyse", |bencher| bencher.iter(|| Symbolic::new(&matrix)));
    bench.bench_function("factor", |bencher| {
        bencher.iter_batched(
            || symbolic.clone(),
            |symbolic| Factor::with_symbolic(&matrix, symbolic),
            BatchSize::SmallInput,
        );
    });
    bench.bench_function("solve", |bencher| {
        bencher.iter_batched_ref(
            || vec![[1.0, 2.0, 3.0]; matrix.size()],
            |sides| factor.solve(sides),
            BatchSize::SmallInput,
        );
    });
    bench.bench_function("linear equilibrium", |bencher| bencher.iter(|| solve(&network, &settings)));
    bench.bench_function("measure", |bencher| {
        bencher.iter(|| Measures::new(&expression, &network, &equilibrium.positions, &equilibrium.forces));
    });
}

fn cords(bench: &mut Criterion) {
    let cords = Net::new(Method::Dynamic).cords();
    let settings = Settings { tolerance: 1e-6, iterations: 100_000 };
    bench.bench_function("cords/direct", |bencher| bencher.iter(|| solve(&cords, &settings)));
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

/// The Laplacian of a network over its free nodes.
fn laplacian(network: &Network<'_>) -> SymmetricMatrix {
    let mut rows = vec![None; network.fixed.len()];
    let free = (0..rows.len()).filter(|&node| !network.fixed[node][0]);
    free.enumerate().for_each(|(row, node)| rows[node] = Some(row as u32));
    let mut diagonal = vec![0.0; rows.iter().flatten().count()];
    let mut entries = Vec::new();
    for (ends, &k) in network.springs.iter().zip(network.stiffness.iter()) {
        let ends = ends.map(|node| rows[node as usize]);
        ends.iter().flatten().for_each(|&row| diagonal[row as usize] += k);
        if let [Some(a), Some(b)] = ends {
            entries.push((a, b, -k));
        }
    }
    SymmetricMatrix::new(diagonal, &entries)
}

criterion_group!(stages, topology, mechanics, cords, individuals);
criterion_main!(stages);

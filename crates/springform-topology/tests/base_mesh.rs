//! Properties of base meshes: closed counting formulas, valence, Euler characteristic, consistency, refusals.

mod common;

use common::cases;
use common::oracle::SlowNet;
use proptest::prelude::*;
use springform_topology::address::Place;
use springform_topology::base_mesh::{BaseMesh, MeshError};
use springform_topology::cell_type::Catalogue;
use springform_topology::edit::Edit;
use springform_topology::expression::{Expression, express};
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest};
use springform_topology::framework::{Arc, Framework, Grid, Join, Part, Shape, Side};
use std::collections::{BTreeMap, BTreeSet};

fn cylinder(name: &str, around: u32, along: u32) -> Part {
    Part { name: name.to_owned(), shape: Shape::Cylinder, around, along }
}

fn sheet(name: &str, around: u32, along: u32) -> Part {
    Part { name: name.to_owned(), shape: Shape::Sheet, around, along }
}

fn arc(part: usize, side: Side, start: u32, length: u32) -> Arc {
    Arc { part, side, start, length }
}

fn join(first: Arc, second: Arc, cord: bool) -> Join {
    Join { first, second, reversed: false, cord }
}

fn mesh(grid: Grid, parts: Vec<Part>, joins: Vec<Join>) -> Result<BaseMesh, MeshError> {
    BaseMesh::from_framework(&Framework { grid, parts, joins })
}

fn grid() -> impl Strategy<Value = Grid> {
    prop_oneof![Just(Grid::Quad), Just(Grid::Dia)]
}

/// Vertices − edges + faces.
fn euler_characteristic(mesh: &BaseMesh) -> i64 {
    i64::from(mesh.vertex_count()) - mesh.edges().len() as i64 + mesh.faces().len() as i64
}

/// All cells subdivided `level` times.
fn uniform(mesh: &BaseMesh, level: u8) -> Forest {
    let mut forest = Forest::new(mesh.faces().len() as u32, Content::QUAD);
    for depth in 0..level {
        for (_, place) in common::leaves(&forest) {
            assert_eq!(place.level, depth);
            let edit = Edit::Subdivide { cell: place, children: [Content::QUAD; 4] };
            edit.apply(&mut forest).expect("an undivided cell");
        }
    }
    forest
}

/// The net of plain quads with every vertex an anchor, so that nothing is filtered.
fn full_net(mesh: &BaseMesh, level: u8) -> Expression {
    let anchors: Vec<u32> = (0..mesh.vertex_count()).collect();
    express(mesh, &uniform(mesh, level), &Catalogue::default(), Method::Dynamic, &anchors).expect("a net")
}

/// The paper's three cylinders: a trunk that splits into two along shared seams.
fn three_cylinders(grid: Grid, around: u32, along: u32, cord: bool) -> BaseMesh {
    let (half, quarter) = (around / 2, around / 4);
    let parts = ["trunk", "left", "right"].map(|name| cylinder(name, around, along)).to_vec();
    let joins = vec![
        join(arc(0, Side::End, quarter, half), arc(1, Side::Start, quarter, half), cord),
        join(arc(0, Side::End, 3 * quarter, half), arc(2, Side::Start, 3 * quarter, half), cord),
        Join {
            reversed: true,
            ..join(arc(1, Side::Start, 3 * quarter, half), arc(2, Side::Start, quarter, half), cord)
        },
    ];
    mesh(grid, parts, joins).expect("a valid framework")
}

proptest! {
    #![proptest_config(cases(1500))]

    /// V = (l + 1) a, F = l a, E = (2 l + 1) a; on a dia-grid 2 a middles more, F = (l + 1) a, E = 2 l a + 4
    /// a.
    #[test]
    fn cylinders_have_closed_counts(grid in grid(), a in 3u32..30, l in 1u32..20) {
        let mesh = mesh(grid, vec![cylinder("c", a, l)], vec![]).expect("a valid cylinder");
        let (vertices, faces, edges) = match grid {
            Grid::Quad => ((l + 1) * a, l * a, (2 * l + 1) * a),
            Grid::Dia => ((l + 1) * a + 2 * a, (l + 1) * a, 2 * l * a + 4 * a),
        };
        prop_assert_eq!(mesh.vertex_count(), vertices);
        prop_assert_eq!(mesh.faces().len() as u32, faces);
        prop_assert_eq!(mesh.edges().len() as u32, edges);
        prop_assert_eq!(euler_characteristic(&mesh), 0);
    }

    /// Sheets a × l: a disc, on a dia-grid with rows of a + 1 and a vertices and 2 a + l middles.
    #[test]
    fn sheets_have_closed_counts(grid in grid(), a in 1u32..20, half in 1u32..10) {
        let l = 2 * half;
        let mesh = mesh(grid, vec![sheet("s", a, l)], vec![]).expect("a valid sheet");
        let (vertices, faces, edges) = match grid {
            Grid::Quad => ((l + 1) * (a + 1), l * a, l * (a + 1) + (l + 1) * a),
            Grid::Dia => {
                ((half + 1) * (a + 1) + half * a + 2 * a + l, a * (l + 1) + half, 2 * l * a + 4 * a + 2 * l)
            }
        };
        prop_assert_eq!(mesh.vertex_count(), vertices);
        prop_assert_eq!(mesh.faces().len() as u32, faces);
        prop_assert_eq!(mesh.edges().len() as u32, edges);
        prop_assert_eq!(euler_characteristic(&mesh), 1);
    }

    /// A chain of cylinders joined ring to ring is a cylinder, closed on itself a torus: χ = 0; every seam
    /// without a cord takes 4 springs an edge on a dia-grid, one with a cord 2.
    #[test]
    fn chains_and_tori_have_no_euler_characteristic(
        grid in grid(), a in 3u32..12, l in 2u32..6, count in 1usize..4, shift in 0u32..12, closed: bool,
        cord: bool
    ) {
        let parts = (0..count).map(|number| cylinder(&format!("c{number}"), a, l)).collect();
        let last = if closed && l > 2 { count } else { count - 1 };
        let seam = |number: usize| {
            let (above, below) =
                (arc(number, Side::End, shift % a, a), arc((number + 1) % count, Side::Start, 0, a));
            join(above, below, cord)
        };
        let mesh = mesh(grid, parts, (0..last).map(seam).collect()).expect("a valid chain");
        prop_assert_eq!(euler_characteristic(&mesh), 0);
        let (each, lost) = match grid {
            Grid::Quad => ((2 * l + 1) * a, a),
            Grid::Dia => (2 * l * a + 4 * a, if cord { 2 * a } else { 4 * a }),
        };
        prop_assert_eq!(mesh.edges().len() as u32, count as u32 * each - last as u32 * lost);
    }

    /// Two cylinders joined along an arc: χ = 0 + 0 − 1. Three as a pair of trousers: the same.
    #[test]
    fn open_seams_cost_one(
        grid in grid(), quarter in 2u32..5, l in 2u32..5, length in 1u32..5,
        starts in (0u32..20, 0u32..20), cord: bool,
        reversed: bool
    ) {
        let a = 4 * quarter;
        let seam = join(
            arc(0, Side::End, starts.0 % a, length), arc(1, Side::Start, starts.1 % a, length), cord,
        );
        let parts = vec![cylinder("a", a, l), cylinder("b", a, l)];
        let two = mesh(grid, parts, vec![Join { reversed, ..seam }]).expect("a valid seam");
        prop_assert_eq!(euler_characteristic(&two), -1);
        prop_assert_eq!(euler_characteristic(&three_cylinders(grid, a, l, cord)), -1);
    }

    /// Faces, sides, edges and vertices point at one another; every vertex is in a face; every edge has a
    /// face.
    #[test]
    fn everything_is_consistent(mut dice in common::dice(90)) {
        let mesh = common::mesh(&mut dice);
        let mut at_vertex: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for (face, corners) in (0u32..).zip(mesh.faces()) {
            prop_assert_eq!(corners.iter().collect::<BTreeSet<_>>().len(), 4);
            for side in 0..4u8 {
                let (from, to) = (corners[usize::from(side)], corners[usize::from(side + 1) % 4]);
                let under = mesh.side_edge(face, side);
                prop_assert_eq!(mesh.edges()[under.edge as usize], [from.min(to), from.max(to)]);
                prop_assert_eq!(under.reversed, from > to);
                let mut there = mesh.faces_at_edge(under.edge).iter();
                prop_assert!(there.any(|at| (at.face, at.side, at.reversed) == (face, side, under.reversed)));
                at_vertex.entry(from).or_default().insert(face);
            }
        }
        prop_assert_eq!(at_vertex.len() as u32, mesh.vertex_count());
        for (vertex, faces) in at_vertex {
            prop_assert!(mesh.faces_at_vertex(vertex).iter().copied().eq(faces));
        }
        let different: BTreeSet<_> = mesh.edges().iter().collect();
        prop_assert_eq!(different.len(), mesh.edges().len());
        for edge in 0..mesh.edges().len() as u32 {
            prop_assert!(!mesh.faces_at_edge(edge).is_empty());
            prop_assert_eq!(mesh.is_free_edge(edge), mesh.faces_at_edge(edge).len() == 1);
        }
    }

    /// Borders run along edges; their numbered vertices are found by name.
    #[test]
    fn borders_run_along_edges(mut dice in common::dice(90)) {
        let (framework, mesh) = common::framework(&mut dice);
        let edges: BTreeSet<[u32; 2]> = mesh.edges().iter().copied().collect();
        for border in mesh.borders() {
            let part = framework.parts.iter().find(|part| part.name == border.part).expect("a part");
            let count =
                part.border_edges(border.side, framework.grid).expect("a border of the part") as usize;
            prop_assert_eq!(border.vertices.len(), if border.closed { count } else { count + 1 });
            for (index, &vertex) in border.vertices.iter().enumerate() {
                prop_assert_eq!(mesh.border_vertex(&border.part, border.side, index), Some(vertex));
                prop_assert!(border.path.contains(&vertex));
            }
            // A seam without a cord has no edge of its own; elsewhere the path follows edges.
            let merged = framework.grid == Grid::Dia && framework.joins.iter().any(|join| !join.cord);
            if !merged {
                let around = if border.closed { border.path.first() } else { None };
                let path: Vec<u32> = border.path.iter().chain(around).copied().collect();
                for ends in path.windows(2) {
                    prop_assert!(edges.contains(&[ends[0].min(ends[1]), ends[0].max(ends[1])]));
                }
            }
        }
    }

    /// The order of joins does not matter.
    #[test]
    fn joins_commute(mut dice in common::dice(90), mut order in common::dice(12)) {
        let (mut framework, mesh) = common::framework(&mut dice);
        order.shuffle(&mut framework.joins);
        prop_assert_eq!(BaseMesh::from_framework(&framework), Ok(mesh));
    }

    /// A mesh made again from its own faces has the same edges.
    #[test]
    fn faces_are_enough(mut dice in common::dice(90)) {
        let mesh = common::mesh(&mut dice);
        let again = BaseMesh::from_faces(mesh.vertex_count(), mesh.faces().to_vec()).expect("valid faces");
        prop_assert_eq!(again.edges(), mesh.edges());
        prop_assert_eq!(again.faces(), mesh.faces());
    }

    /// The map has a place for every face, whose corners make a cell of area one or, at a ring, half of it.
    #[test]
    fn maps_unroll_parts(mut dice in common::dice(90)) {
        let (framework, mesh) = common::framework(&mut dice);
        prop_assert_eq!(mesh.map().len(), mesh.faces().len());
        let whole = if framework.grid == Grid::Quad { 8 } else { 4 };
        for place in mesh.map() {
            prop_assert!((place.part as usize) < framework.parts.len());
            let corners = place.corners;
            let twice: i32 = (0..4).map(|k| {
                let ((u, v), (next_u, next_v)) = (corners[k], corners[(k + 1) % 4]);
                u * next_v - next_u * v
            }).sum();
            prop_assert!(
                twice == whole || (framework.grid == Grid::Dia && twice == whole / 2), "{corners:?}"
            );
        }
    }

    /// Nonsense is refused, never a panic.
    #[test]
    fn random_frameworks_never_panic(
        numbers in prop::collection::vec(0u32..9, 24),
        huge in prop::sample::select(vec![0, 1, 7, 1 << 20, u32::MAX]),
    ) {
        let sides = [Side::Start, Side::End, Side::Left, Side::Right];
        let some_arc = |at: usize| {
            let length = if numbers[at + 3] == 8 { huge } else { numbers[at + 3] };
            arc(numbers[at] as usize % 2, sides[numbers[at + 1] as usize % 4], numbers[at + 2], length)
        };
        let around = if numbers[22] == 8 { huge } else { numbers[16] };
        let parts = vec![cylinder("a", around, numbers[17]), sheet("b", numbers[18], numbers[19])];
        let seam = Join { reversed: numbers[20] > 4, ..join(some_arc(0), some_arc(4), numbers[21] > 4) };
        let grid = if numbers[23] > 4 { Grid::Dia } else { Grid::Quad };
        let other = join(some_arc(8), some_arc(12), numbers[21] > 4);
        if let Err(error) = mesh(grid, parts, vec![seam, other]) {
            prop_assert!(error.key.starts_with("framework"), "{error}");
        }
    }
}

proptest! {
    #![proptest_config(cases(1000))]

    /// Inside a dia-grid every node has four springs at any level, seams without a cord included.
    #[test]
    fn dia_grids_are_four_valent_inside(
        a in 3u32..7, l in 2u32..5, level in 0u8..=2, length in 1u32..3, cord: bool,
    ) {
        let seam = join(arc(0, Side::End, 0, length), arc(1, Side::Start, 0, length), cord);
        let parts = vec![cylinder("a", a, l), sheet("b", a, 2 * l)];
        let mesh = mesh(Grid::Dia, parts, vec![seam]).expect("a framework");
        let net = full_net(&mesh, level);
        let mut valence = vec![0; net.nodes.len()];
        let mut on_ring = vec![false; net.nodes.len()];
        for spring in &net.springs {
            for node in spring.nodes {
                valence[node as usize] += 1;
                on_ring[node as usize] |= spring.ring;
            }
        }
        // Vertices on a seam belong to two parts, so they may have more; they are on its two rings' paths.
        let seam: BTreeSet<u32> = [(0, Side::End), (1, Side::Start)].into_iter().flat_map(|(part, side)| {
            let border =
                mesh.borders().iter().find(|b| b.part == ["a", "b"][part] && b.side == side).expect("a ring");
            border.path.clone()
        }).filter_map(|vertex| net.node(springform_topology::node_key::NodeKey::vertex(vertex))).collect();
        for node in 0..net.nodes.len() as u32 {
            if !on_ring[node as usize] && !seam.contains(&node) {
                prop_assert_eq!(valence[node as usize], 4, "node {}", net.nodes[node as usize]);
            }
        }
    }

    /// A full ring joined without a cord disappears: the chain is the longer cylinder, spring for spring.
    #[test]
    fn a_seam_without_a_cord_leaves_no_trace(
        a in 3u32..9, first in 1u32..4, second in 1u32..4, level in 0u8..=1,
    ) {
        let seam = join(arc(0, Side::End, 0, a), arc(1, Side::Start, 0, a), false);
        let joined = mesh(Grid::Dia, vec![cylinder("a", a, first), cylinder("b", a, second)], vec![seam]);
        let whole = mesh(Grid::Dia, vec![cylinder("c", a, first + second)], vec![]).expect("a cylinder");
        let degrees = |mesh: &BaseMesh| {
            let net = full_net(mesh, level);
            let slow = SlowNet::from_expression(mesh, &net);
            let mut valence = vec![0usize; net.nodes.len()];
            net.springs.iter().flat_map(|spring| spring.nodes).for_each(|node| valence[node as usize] += 1);
            valence.sort_unstable();
            (slow.springs.len(), valence)
        };
        prop_assert_eq!(degrees(&joined.expect("a chain")), degrees(&whole));
    }
}

#[test]
fn the_papers_net_has_some_700_springs() {
    assert_eq!(full_net(&three_cylinders(Grid::Dia, 16, 6, false), 0).springs.len(), 672);
    assert_eq!(full_net(&three_cylinders(Grid::Dia, 16, 6, true), 0).springs.len(), 720);
    let one = mesh(Grid::Dia, vec![cylinder("c", 16, 6)], vec![]).expect("a cylinder");
    assert_eq!(full_net(&one, 0).springs.len(), 2 * 16 * 6 + 2 * 2 * 16);
}

#[test]
fn three_cells_may_meet_on_a_cord() {
    let parts = vec![cylinder("a", 6, 2), cylinder("b", 6, 2), cylinder("c", 6, 2)];
    let seams = |cord| {
        vec![
            join(arc(0, Side::End, 0, 2), arc(1, Side::Start, 0, 2), cord),
            join(arc(1, Side::Start, 0, 2), arc(2, Side::Start, 3, 2), cord),
        ]
    };
    let refused =
        mesh(Grid::Dia, parts.clone(), seams(false)).expect_err("three cells on a seam without a cord");
    assert_eq!(refused.key, "framework.joins[0]");
    assert!(refused.problem.starts_with("3 cells meet"), "{refused}");
    for grid in [Grid::Dia, Grid::Quad] {
        let joined = mesh(grid, parts.clone(), seams(true)).expect("a seam with a cord");
        let most = (0..joined.edges().len() as u32).map(|edge| joined.faces_at_edge(edge).len()).max();
        assert_eq!(most, Some(3));
    }
}

#[test]
fn frameworks_that_do_not_fit_are_refused() {
    let two = || vec![cylinder("a", 8, 3), sheet("b", 4, 4)];
    let refused =
        |joins: Vec<Join>| mesh(Grid::Dia, two(), joins).expect_err("the joins do not fit").to_string();
    let unequal = refused(vec![join(arc(0, Side::End, 0, 3), arc(1, Side::Start, 0, 4), true)]);
    assert!(unequal.contains("3 and 4 edges"), "{unequal}");
    for (second, words) in [
        (arc(1, Side::Start, 2, 3), "does not fit"),
        (arc(1, Side::Left, 0, 3), "does not fit"),
        (arc(0, Side::Left, 0, 3), "no left border"),
        (arc(7, Side::Start, 0, 3), "no start border"),
        (arc(0, Side::Start, 8, 3), "does not fit"),
    ] {
        let error = refused(vec![join(arc(0, Side::End, 0, 3), second, true)]);
        assert!(error.starts_with("framework.joins[0].second") && error.contains(words), "{error}");
    }
    let nothing = refused(vec![join(arc(0, Side::End, 0, 0), arc(1, Side::Start, 0, 0), true)]);
    assert!(nothing.contains("does not fit"), "{nothing}");
    let itself = refused(vec![join(arc(0, Side::End, 0, 8), arc(0, Side::End, 0, 8), true)]);
    assert!(itself.contains("joined to itself"), "{itself}");
    let folded = refused(vec![join(arc(0, Side::End, 0, 4), arc(0, Side::End, 1, 4), true)]);
    assert!(folded.contains("fold a cell"), "{folded}");
    let mixed = refused(vec![
        join(arc(0, Side::End, 0, 3), arc(1, Side::Start, 0, 3), true),
        join(arc(0, Side::End, 2, 2), arc(1, Side::End, 0, 2), false),
    ]);
    assert!(mixed.contains("with and without a cord"), "{mixed}");
}

#[test]
fn parts_that_are_too_small_or_too_large_are_refused() {
    for (grid, part) in [
        (Grid::Quad, cylinder("p", 2, 4)),
        (Grid::Quad, cylinder("p", 8, 0)),
        (Grid::Quad, sheet("p", 0, 4)),
        (Grid::Dia, sheet("p", 4, 3)),
        (Grid::Quad, cylinder("p", 1 << 20, 1)),
        (Grid::Dia, cylinder("p", u32::MAX, u32::MAX)),
    ] {
        let error = mesh(grid, vec![part], vec![]).expect_err("the part does not fit");
        assert_eq!(error.key, "framework.p");
    }
    assert!(mesh(Grid::Quad, vec![], vec![]).is_err());
}

#[test]
fn meshes_from_files_are_checked() {
    for (vertices, faces, key) in [
        (4, vec![], "framework"),
        (4, vec![[0, 1, 2, 4]], "framework.mesh.faces[0]"),
        (4, vec![[0, 1, 2, 3], [0, 1, 2, 1]], "framework.mesh.faces[1]"),
        (5, vec![[0, 1, 2, 3]], "framework.mesh.vertices[4]"),
    ] {
        let found = BaseMesh::from_faces(vertices, faces).expect_err("the mesh is not valid").key;
        // Without a face, the first vertex that no face uses is named.
        assert!(found == key || (key == "framework" && found == "framework.mesh.vertices[0]"), "{found}");
    }
}

#[test]
fn cells_at_a_vertex_and_its_faces_agree() {
    let mesh = three_cylinders(Grid::Dia, 8, 3, true);
    let net = full_net(&mesh, 0);
    for vertex in 0..mesh.vertex_count() {
        let faces: Vec<Place> = mesh.faces_at_vertex(vertex).iter().map(|&face| Place::top(face)).collect();
        let node =
            net.node(springform_topology::node_key::NodeKey::vertex(vertex)).expect("every vertex is a node");
        let cells: Vec<Place> =
            net.cells_at(node).into_iter().map(|cell| net.cells[cell as usize].place).collect();
        assert_eq!(cells, faces);
    }
}

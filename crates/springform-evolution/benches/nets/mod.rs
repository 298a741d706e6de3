//! The nets of the benchmarks: a packaged scene, refined by a fixed rule to about 2,000 springs.

use springform_evolution::evolve::{Evolution, Parameters};
use springform_evolution::mutation::{Amount, Strategy};
use springform_evolution::phenotype::Setting;
use springform_evolution::selection::Weighting;
use springform_mechanics::network::Network;
use springform_topology::address::Place;
use springform_topology::base_mesh::BaseMesh;
use springform_topology::cell_type::{CellTypeId, DYNAMIC, QUAD};
use springform_topology::edit::Edit;
use springform_topology::filters::Method;
use springform_topology::forest::{Content, Forest};
use springform_topology::framework::{Arc, Framework, Grid, Join, Part, Shape, Side};
use toml::{Table, Value};

/// Rest length over drawn length of cords.
pub const REST_RATIO: f64 = 0.6;

const SCENE: &str = include_str!("../../../../python/springform/scenes/three-cylinders.toml");

/// A design: everything but the forest, and the forest.
pub struct Net {
    pub setting: Setting,
    pub forest: Forest,
}

impl Net {
    /// The three cylinders at about 2,000 springs.
    pub fn new(method: Method) -> Net {
        let scene: Table = SCENE.parse().expect("the scene is TOML");
        let framework = &scene["framework"];
        let mesh = base_mesh(framework);
        let (anchors, positions): (Vec<u32>, Vec<[f64; 3]>) =
            list(framework, "anchors").iter().map(|anchor| target(&mesh, anchor)).unzip();
        let setting = Setting::new(mesh, method, anchors, positions);
        let mut forest = Forest::new(setting.mesh.faces().len() as u32, Content::QUAD);
        refine(&mut forest, method);
        setting.close(&mut forest).expect("a valid forest");
        Net { setting, forest }
    }

    /// A run with this net as parent; its mutants are those of default parameters.
    pub fn evolution(&self) -> Evolution {
        let parameters = Parameters::new(1, 1, types(self.setting.method));
        let (three, one) = (Amount::Count(3.0), Amount::Count(1.0));
        let strategy =
            Strategy { insertions: three, switches: three, toggles: one, weighting: Weighting::Exponential };
        Evolution::new(self.setting.clone(), parameters, self.forest.clone(), strategy, None, 1)
            .expect("the scene gives a net")
    }

    /// The network as drawn, made of cords that are stressed against their drawn lengths.
    pub fn cords(&self) -> Network<'static> {
        let (_, network) = self.setting.grow(&self.forest).expect("the scene gives a net");
        let lengths = network.lengths(&network.positions);
        let rest_length = lengths.into_iter().map(|length| REST_RATIO * length).collect();
        Network { rest_length, ..network }
    }
}

/// Cell types that mutation draws under a method.
pub fn types(method: Method) -> Vec<CellTypeId> {
    if method == Method::Recursive { vec![QUAD] } else { vec![QUAD, DYNAMIC] }
}

/// Subdivides three faces of five, every fifth into dynamic cells where they are allowed, and some cells again.
fn refine(forest: &mut Forest, method: Method) {
    let dynamic = Content { kind: DYNAMIC, turn: 0 };
    for face in (0..forest.top_level()).filter(|face| face % 5 < 3) {
        let content = if face % 5 == 0 && method == Method::Dynamic { dynamic } else { Content::QUAD };
        let subdivide = |cell| Edit::Subdivide { cell, children: [content; 4] };
        subdivide(Place::top(face)).apply(forest).expect("a cell without children");
        if face % 11 == 0 {
            subdivide(Place::top(face).child(face as u8 % 4)).apply(forest).expect("a new cell");
        }
    }
}

fn base_mesh(framework: &Value) -> BaseMesh {
    let cylinders = list(framework, "cylinders");
    let part = |cylinder: &Value| Part {
        name: text(cylinder, "name").to_owned(),
        shape: Shape::Cylinder,
        around: whole(cylinder, "around"),
        along: whole(cylinder, "along"),
    };
    let arc = |arc: &Value| {
        let (name, side) = ring(arc);
        let part = cylinders.iter().position(|cylinder| text(cylinder, "name") == name);
        let part = part.expect("a cylinder of the scene");
        Arc { part, side, start: whole(arc, "start"), length: whole(arc, "length") }
    };
    let join = |join: &Value| Join {
        first: arc(&join["first"]),
        second: arc(&join["second"]),
        reversed: join.get("reversed").is_some_and(|value| value.as_bool() == Some(true)),
        cord: false,
    };
    let parts = cylinders.iter().map(part).collect();
    let joins = list(framework, "joins").iter().map(join).collect();
    BaseMesh::from_framework(&Framework { grid: Grid::Dia, parts, joins }).expect("a valid framework")
}

fn target(mesh: &BaseMesh, anchor: &Value) -> (u32, [f64; 3]) {
    let (part, side) = ring(anchor);
    let vertex = mesh.border_vertex(part, side, whole(anchor, "index") as usize);
    let position = anchor["position"].as_array().expect("a position");
    let coordinate = |axis: usize| position[axis].as_float().expect("a coordinate");
    (vertex.expect("a vertex of the ring"), std::array::from_fn(coordinate))
}

fn ring(value: &Value) -> (&str, Side) {
    let (part, side) = text(value, "ring").split_once('.').expect("a ring of a part");
    (part, Side::parse(side).expect("a side"))
}

fn list<'a>(value: &'a Value, key: &str) -> &'a Vec<Value> {
    value[key].as_array().expect("a list")
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().expect("a text")
}

fn whole(value: &Value, key: &str) -> u32 {
    value[key].as_integer().expect("a whole number") as u32
}

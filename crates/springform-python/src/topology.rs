//! Base meshes and forests for Python.

use crate::convert::{refusal, rows};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use springform_topology::base_mesh;
use springform_topology::forest;
use springform_topology::framework::{Arc, Framework, Grid, Join, Part, Shape, Side};

/// (part, side, first vertex, number of edges).
type ArcTuple = (usize, String, u32, u32);

type MapArrays<'py> = (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray2<i32>>);

#[pyclass(frozen, module = "springform._core")]
pub struct BaseMesh {
    pub mesh: base_mesh::BaseMesh,
}

fn side(name: &str) -> PyResult<Side> {
    Side::parse(name).ok_or_else(|| refusal("side", format!("there is no side '{name}'")))
}

fn arc((part, name, start, length): ArcTuple) -> PyResult<Arc> {
    Ok(Arc { part, side: side(&name)?, start, length })
}

#[pymethods]
impl BaseMesh {
    #[staticmethod]
    fn from_framework(
        dia: bool,
        parts: Vec<(String, bool, u32, u32)>,
        joins: Vec<(ArcTuple, ArcTuple, bool, bool)>,
    ) -> PyResult<Self> {
        let parts = parts
            .into_iter()
            .map(|(name, closed, around, along)| {
                let shape = if closed { Shape::Cylinder } else { Shape::Sheet };
                Part { name, shape, around, along }
            })
            .collect();
        let joins = joins
            .into_iter()
            .map(|(first, second, reversed, cord)| {
                Ok(Join { first: arc(first)?, second: arc(second)?, reversed, cord })
            })
            .collect::<PyResult<_>>()?;
        let grid = if dia { Grid::Dia } else { Grid::Quad };
        let mesh = base_mesh::BaseMesh::from_framework(&Framework { grid, parts, joins })
            .map_err(|error| refusal(error.key, error.problem))?;
        Ok(BaseMesh { mesh })
    }

    #[staticmethod]
    fn from_faces(vertex_count: u32, faces: Vec<[u32; 4]>) -> PyResult<Self> {
        let mesh = base_mesh::BaseMesh::from_faces(vertex_count, faces)
            .map_err(|error| refusal(error.key, error.problem))?;
        Ok(BaseMesh { mesh })
    }

    #[getter]
    fn vertex_count(&self) -> u32 {
        self.mesh.vertex_count()
    }

    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, self.mesh.faces().to_vec())
    }

    #[getter]
    fn edges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, self.mesh.edges().to_vec())
    }

    fn border_vertex(&self, part: &str, name: &str, index: usize) -> PyResult<Option<u32>> {
        Ok(self.mesh.border_vertex(part, side(name)?, index))
    }

    /// (part, side, path of base vertices, closed) of every border.
    #[getter]
    fn borders(&self) -> Vec<(String, &'static str, Vec<u32>, bool)> {
        let borders = self.mesh.borders().iter();
        borders.map(|b| (b.part.clone(), b.side.name(), b.path.clone(), b.closed)).collect()
    }

    /// Unrolled map: part of every face, and its corners as (f, 8) half columns and half rows.
    #[getter]
    fn map<'py>(&self, py: Python<'py>) -> PyResult<MapArrays<'py>> {
        let map = self.mesh.map();
        let flat = |corners: [(i32, i32); 4]| -> [i32; 8] {
            std::array::from_fn(|at| [corners[at / 2].0, corners[at / 2].1][at % 2])
        };
        let parts = map.iter().map(|place| place.part).collect();
        Ok((PyArray1::from_vec(py, parts), rows(py, map.iter().map(|place| flat(place.corners)).collect())?))
    }
}

#[pyclass(frozen, module = "springform._core")]
pub struct Forest {
    pub forest: forest::Forest,
}

#[pymethods]
impl Forest {
    #[getter]
    fn fingerprint(&self) -> u64 {
        self.forest.fingerprint()
    }

    fn __eq__(&self, other: &Forest) -> bool {
        self.forest == other.forest
    }
}

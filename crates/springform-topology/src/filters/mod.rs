//! Filters: deterministic, idempotent engines that make a net whole (the paper §3.1–3.2, Fig. 11).
//!
//! A method says which cell types may occur and what a filter does where levels differ; the continuity
//! filter always comes last.

pub mod continuity;
pub mod recursive;

use crate::cell_type::{Catalogue, CellTypeId, QUAD};

/// How neighbouring cells of different level are resolved.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Method {
    /// QrT: type 1 only, levels differ by one at most, support springs at hanging nodes.
    Recursive,
    /// QeT: any type without a fan, any difference of levels.
    Extensible,
    /// QdT: any type.
    Dynamic,
}

impl Method {
    /// The method called `name`.
    pub fn parse(name: &str) -> Option<Method> {
        Some(match name {
            "recursive" => Method::Recursive,
            "extensible" => Method::Extensible,
            "dynamic" => Method::Dynamic,
            _ => return None,
        })
    }

    /// Name in design files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Method::Recursive => "recursive",
            Method::Extensible => "extensible",
            Method::Dynamic => "dynamic",
        }
    }

    /// A cell of this type may be expressed.
    pub fn allows(self, kind: CellTypeId, catalogue: &Catalogue) -> bool {
        match self {
            Method::Recursive => kind == QUAD,
            Method::Extensible => !catalogue.get(kind).fan,
            Method::Dynamic => true,
        }
    }

    /// The types that the method allows, in words.
    pub fn allowed_words(self) -> &'static str {
        match self {
            Method::Recursive => "type 1 only",
            Method::Extensible => "types 0-5 and defined types without a fan",
            Method::Dynamic => "all types",
        }
    }
}

//! Workspaces: the memory in which individuals are made and measured, used again from one to the next.
//!
//! Whatever a workspace held before, the next individual is the same to the bit; so it does not matter which thread
//! takes which.

use crate::mutation::Mutator;
use crate::phenotype::Evaluator;
use springform_topology::edit::Edit;
use springform_topology::filters::recursive::Closure;
use springform_topology::forest::{Content, Forest};
use std::sync::{Mutex, PoisonError};

/// Memory for one individual at a time.
pub struct Workspace {
    pub(crate) mutator: Mutator,
    pub(crate) edits: Vec<Edit>,
    pub(crate) forest: Forest,
    pub(crate) closure: Closure,
    pub(crate) evaluator: Evaluator,
}

impl Default for Workspace {
    fn default() -> Self {
        Workspace {
            mutator: Mutator::default(),
            edits: Vec::new(),
            forest: Forest::new(0, Content::QUAD),
            closure: Closure::default(),
            evaluator: Evaluator::default(),
        }
    }
}

/// As many workspaces as were ever needed at once.
#[derive(Default)]
pub(crate) struct Workspaces {
    idle: Mutex<Vec<Workspace>>,
}

impl Workspaces {
    /// Works in an idle workspace, or a new one if there is none.
    pub fn with<R>(&self, work: impl FnOnce(&mut Workspace) -> R) -> R {
        // A list of idle workspaces is whole whatever happened to those that are not in it.
        let idle = || self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let mut workspace = idle().pop().unwrap_or_default();
        let result = work(&mut workspace);
        idle().push(workspace);
        result
    }
}

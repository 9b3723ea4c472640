//! The parts of the server that answers use.

use std::sync::Arc;

use super::{
    desk::Desk, drawings::Drawings, guard::Guard, progressive::Progressive, references::References,
};

/// The parts of the server that answers use.
#[derive(Clone)]
pub(super) struct App {
    pub(super) desk: Arc<Desk>,
    pub(super) drawings: Arc<Drawings>,
    pub(super) progressive: Arc<Progressive>,
    pub(super) references: Arc<References>,
    pub(super) guard: Arc<Guard>,
}

impl App {
    pub(super) fn new(desk: Arc<Desk>, guard: Guard) -> Self {
        Self {
            desk,
            drawings: Arc::default(),
            progressive: Arc::default(),
            references: Arc::default(),
            guard: guard.into(),
        }
    }
}

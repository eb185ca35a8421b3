//! Lanes are kept between uses: their registers are large and their constants are loaded once.

use std::sync::Mutex;

use super::code::Code;
use super::limits::Limits;
use super::machine::Machine;
use crate::world::World;

pub struct Pool<'r> {
    pub code: &'r Code,
    pub limits: &'r Limits,
    live: &'r [u32],
    world: Option<&'r dyn World>,
    idle: Mutex<Vec<Machine<'r>>>,
}

impl<'r> Pool<'r> {
    pub fn new(
        code: &'r Code,
        live: &'r [u32],
        limits: &'r Limits,
        world: Option<&'r dyn World>,
    ) -> Pool<'r> {
        Pool { code, limits, live, world, idle: Mutex::new(Vec::new()) }
    }

    /// Does something with a lane of its own.
    pub fn with<T>(&self, work: impl FnOnce(&mut Machine<'r>) -> T) -> T {
        let idle = || self.idle.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let kept = idle().pop();
        let mut machine = kept.unwrap_or_else(|| Machine::new(self.code, self.live, self.limits, self.world));
        let result = work(&mut machine);
        idle().push(machine);
        result
    }
}

//! What `tempco` can be told to do.

use crate::command::{
    add, compare, demo, device, diagnose, effects, export, flash, inspect, plan, remove, reproduce, reveal, simulate,
    train, verify,
};
use crate::failure::{Answer, Failure};
use crate::workbench;
use clap::Subcommand;

/// The verbs, in the order in which a calibration uses them.
#[derive(Subcommand)]
pub enum Command {
    Demo(demo::Demo),
    Simulate(simulate::Simulate),
    Reveal(reveal::Reveal),
    Train(train::Train),
    Compare(compare::Compare),
    Diagnose(diagnose::Diagnose),
    Plan(plan::Plan),
    Effects(effects::Effects),
    Add(add::Add),
    Remove(remove::Remove),
    Export(export::Export),
    Inspect(inspect::Inspect),
    Verify(verify::Verify),
    Flash(flash::Flash),
    Device(device::Device),
    Reproduce(reproduce::Reproduce),
    Workbench(workbench::Workbench),
}

impl Command {
    pub fn run(&self) -> Result<Answer, Failure> {
        match self {
            Self::Demo(command) => command.run(),
            Self::Simulate(command) => command.run(),
            Self::Reveal(command) => command.run(),
            Self::Train(command) => command.run(),
            Self::Compare(command) => command.run(),
            Self::Diagnose(command) => command.run(),
            Self::Plan(command) => command.run(),
            Self::Effects(command) => command.run(),
            Self::Add(command) => command.run(),
            Self::Remove(command) => command.run(),
            Self::Export(command) => command.run(),
            Self::Inspect(command) => command.run(),
            Self::Verify(command) => command.run(),
            Self::Flash(command) => command.run(),
            Self::Device(command) => command.run(),
            Self::Reproduce(command) => command.run(),
            Self::Workbench(command) => command.run(),
        }
    }
}

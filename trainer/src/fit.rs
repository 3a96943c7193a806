//! Numerics: solvers know residuals and derivatives, no physics; problems know no solver.

pub mod at_bound;
pub mod dataset;
pub mod effects;
pub mod firefly;
pub mod gradient_descent;
pub mod levenberg_marquardt;
pub mod neighbours;
pub mod network;
pub mod polynomial;
pub mod random;
pub mod test_functions;

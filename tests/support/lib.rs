//! What several claims need: one example calibration, what must hold for any bytes, recorded bytes, the image in QEMU, the workspace's folders.

pub mod example;
pub mod fuzz;
pub mod golden;
pub mod qemu;
pub mod workspace;

//! What several claims need: one example calibration, recorded bytes, the image in QEMU, the workspace's folders.

pub mod example;
pub mod golden;
pub mod qemu;
pub mod workspace;

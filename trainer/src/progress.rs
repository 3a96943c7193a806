//! What long work tells while it runs. The library prints nothing and reads no clock.

/// Watches a training and may end it.
pub trait Progress: Sync {
    /// Called before restarts begin, so many of them; more than once where a training first makes a simpler model.
    fn begins(&self, _restarts: usize) {}

    /// Called as restarts advance, from several threads. Those beyond the number that began go on from the best.
    fn restart(&self, _news: RestartNews) {}

    /// Whether the user wants to stop. What was found until then is kept.
    fn cancelled(&self) -> bool {
        false
    }
}

/// How one restart is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestartNews {
    /// Which of the restarts.
    pub index: usize,
    /// Iterations so far.
    pub iteration: usize,
    /// RMS residual on the training runs so far, g.
    pub residual_g: f64,
    /// What noise from sample to sample leaves of that at least, g, where it is known. Samples of one state are averaged,
    /// so that it is less than the noise of one sample.
    pub noise_g: Option<f64>,
    /// Whether this restart has ended.
    pub done: bool,
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiet;

impl Progress for Quiet {}

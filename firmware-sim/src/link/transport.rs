//! A line, whatever carries its bytes.

/// A line that carries bytes both ways and may lose them.
pub trait Transport {
    /// What this kind of line fails with, beyond repair by repetition.
    type Error: std::error::Error + 'static;

    /// Sends bytes.
    ///
    /// # Errors
    /// If the line is gone.
    fn send(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;

    /// The next byte; `None` once nothing came for as long as this line's patience lasts.
    ///
    /// # Errors
    /// If the line is gone.
    fn receive(&mut self) -> Result<Option<u8>, Self::Error>;
}

impl<T: Transport + ?Sized> Transport for &mut T {
    type Error = T::Error;

    fn send(&mut self, bytes: &[u8]) -> Result<(), Self::Error> {
        (**self).send(bytes)
    }

    fn receive(&mut self) -> Result<Option<u8>, Self::Error> {
        (**self).receive()
    }
}

impl<T: Transport + ?Sized> Transport for Box<T> {
    type Error = T::Error;

    fn send(&mut self, bytes: &[u8]) -> Result<(), Self::Error> {
        (**self).send(bytes)
    }

    fn receive(&mut self) -> Result<Option<u8>, Self::Error> {
        (**self).receive()
    }
}

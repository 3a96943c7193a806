//! Campaigns that made room for another one, with all that was made of them. Nothing is thrown away.

use super::Session;
use crate::workbench::measured::Measured;
use crate::workbench::shelved::Shelved;

impl Session {
    /// Looks at a campaign from now on; the one that was there is set aside.
    pub fn take(&mut self, measured: Measured) {
        let number = 1 + self.shelf.iter().map(|one| one.number).chain([self.campaign]).max().unwrap_or_default();
        self.bring(Shelved { number, measured, models: Vec::new(), current: None });
    }

    /// Brings a campaign back; whether there is such a one.
    pub fn bring_back(&mut self, number: usize) -> bool {
        let found = self.shelf.iter().position(|one| one.number == number);
        if let Some(found) = found {
            let back = self.shelf.remove(found);
            self.bring(back);
        }
        found.is_some() || self.campaign == number
    }

    fn bring(&mut self, Shelved { number, measured, models, current }: Shelved) {
        if let Some(measured) = self.measured.take() {
            let models = std::mem::take(&mut self.models);
            self.shelf.push(Shelved { number: self.campaign, measured, models, current: self.current });
        }
        (self.campaign, self.measured, self.models, self.current) = (number, Some(measured), models, current);
        self.training = None;
    }
}

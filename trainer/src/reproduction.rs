//! The paper's figures and tables, computed again: Huang, Jiang, Zhao and Ding, Micromachines 2022, 13, 1054.
//!
//! Figures 3 and 4 are [`trial::trial`]s of [`contender::Contender`]s over many seeds, with the paper's
//! [`claim::CLAIMS`] counted on them. Tables 1 and 2 are [`judgement::Judgement`]s of [`column::COLUMNS`] beside
//! [`paper::ROWS`]. Whoever has a simulator hands over its truth ([`truth::Truth`]); nothing here knows one.

pub mod claim;
pub mod column;
pub mod contender;
pub mod evolution;
pub mod judgement;
pub mod lesson;
pub mod paper;
pub mod shortfall;
pub mod sweep;
pub mod trial;
pub mod truth;
mod unconstrained;

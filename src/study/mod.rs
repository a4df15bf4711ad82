//! Studies: what they ask for, and what comes of them.

pub mod report;

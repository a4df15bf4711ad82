//! A rehearsal: participants that are a program, and the report of what they did.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::Participating;
use crate::app::PinPose;
use crate::formats::zip_of_files;
use crate::platform;
use crate::session::Notice;
use crate::study::report::ReportFiles;
use crate::study::simulate::{Simulation, simulate};
use crate::study::{Results, results_name};
use crate::ui::study::Rehearsal;

impl Participating {
    /// Only who built the study knows what its samples' poses are.
    pub(super) fn can_rehearse(&self) -> bool {
        self.truth.is_some() && self.ready().is_some_and(super::Ready::is_complete)
    }

    fn rehearse(&self, wanted: Rehearsal) -> Result<(Vec<Results>, ReportFiles), String> {
        let (Some(ready), Some(truth)) = (self.ready(), &self.truth) else {
            return Err("the study is not here yet".to_owned());
        };
        let meshes: BTreeMap<String, Arc<crate::mesh::Mesh>> =
            ready.meshes.iter().map(|(id, asset)| (id.clone(), Arc::new(asset.mesh.clone()))).collect();
        let simulation =
            Simulation { participants: wanted.participants, seed: wanted.seed, began_ms: platform::now_ms() };
        let results = simulate(&ready.files.study, &ready.files.sha256, truth, &meshes, simulation)
            .map_err(|error| error.to_string())?;
        let mut files = ReportFiles::of_study(&ready.files, truth.clone());
        let named = results.iter().map(|results| (file_name(results), results.clone()));
        files.results.extend(named);
        Ok((results, files))
    }
}

/// Its participant's id says that it is simulated, and so does what is in it.
fn file_name(results: &Results) -> String {
    let begun_ms = 0.0;
    let name = results_name(&results.study.id, &results.participant.id, begun_ms);
    // Without the time, which is that of a program.
    format!("{}.json", name.rsplit_once('_').map_or(name.as_str(), |(name, _)| name))
}

impl PinPose {
    /// Makes results of simulated participants: as files, or as the report of them.
    pub(super) fn rehearse(&mut self, wanted: Rehearsal) {
        let Some(study) = &self.study else { return };
        let made = study.rehearse(wanted).and_then(|(results, files)| {
            if wanted.as_files {
                let named = results.iter().map(|one| (file_name(one), one.to_json().into_bytes().into()));
                let zip = zip_of_files(&named.collect::<Vec<_>>()).map_err(|error| error.to_string())?;
                let study = results.first().map_or("study", |one| one.study.id.as_str());
                platform::download(&format!("{study}_simulated.zip"), &zip)?;
            }
            Ok(files)
        });
        match made {
            Ok(_) if wanted.as_files => {}
            Ok(files) => {
                self.leave_preview();
                self.report_of(files);
            }
            Err(problem) => self.notify(Notice::error(format!("No participants were simulated: {problem}"))),
        }
    }
}

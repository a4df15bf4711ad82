//! Links that lead to no study, or to a broken one: the participant is told what to do and whom to write to, the researcher what
//! is wrong.

use anyhow::{Context as _, ensure};

use super::made::Made;
use super::on_screen;
use crate::context::Context;
use crate::host::Host;
use crate::page::Page;

/// One thing that is wrong.
struct Case {
    what: &'static str,
    /// Breaks the study's folder or its host; gives the path of the link.
    breaks: fn(&mut Made, &Host) -> anyhow::Result<String>,
    /// What the participant reads, and the researcher.
    says: [&'static str; 2],
    /// The study's contact is known only where `study.json` could be read.
    names_contact: bool,
}

const STUDY: &str = "study/study.json";

const CASES: &[Case] = &[
    Case {
        what: "a link to nothing",
        breaks: |_, _| Ok("nowhere/study.json".to_owned()),
        says: ["not where it should be", "no such file"],
        names_contact: false,
    },
    Case {
        what: "a host that lets nobody read",
        breaks: |_, host| {
            host.set_open(false);
            Ok(STUDY.to_owned())
        },
        says: ["cannot be reached", "Access-Control-Allow-Origin"],
        names_contact: false,
    },
    Case {
        what: "a page in place of a study",
        breaks: |made, _| {
            std::fs::write(made.study_folder().join("page.json"), "<html></html>")?;
            Ok("study/page.json".to_owned())
        },
        says: ["something that is not a study", "line 1"],
        names_contact: false,
    },
    Case {
        what: "a newer version",
        breaks: |made, _| {
            let newer = made.study.to_json().replacen("\"version\": 1", "\"version\": 2", 1);
            std::fs::write(made.study_folder().join("study.json"), newer)?;
            Ok(STUDY.to_owned())
        },
        says: ["newer version of this page", "version 2"],
        names_contact: false,
    },
    Case {
        what: "a file with other content",
        breaks: |made, _| {
            let path = made.asset(&made.study.objects[0].mesh);
            let mut bytes = std::fs::read(&path)?;
            *bytes.last_mut().context("An empty mesh")? ^= 1;
            std::fs::write(path, bytes)?;
            Ok(STUDY.to_owned())
        },
        says: ["damaged on its way", "another content"],
        names_contact: true,
    },
    Case {
        what: "a missing file",
        breaks: |made, _| {
            std::fs::remove_file(made.asset(&made.study.photos[1].asset))?;
            Ok(STUDY.to_owned())
        },
        says: ["not where it should be", "assets/"],
        names_contact: true,
    },
    Case {
        what: "a file that is larger than it says",
        breaks: |made, _| {
            let path = made.asset(&made.study.photos[0].asset);
            let mut bytes = std::fs::read(&path)?;
            bytes.extend([0; 1000]);
            std::fs::write(path, bytes)?;
            Ok(STUDY.to_owned())
        },
        says: ["larger than it should be", "bytes came"],
        names_contact: true,
    },
    Case {
        what: "a file that says that it is huge",
        breaks: |made, _| {
            made.study.photos[0].asset.bytes = 1 << 40;
            made.write()?;
            Ok(STUDY.to_owned())
        },
        says: ["larger than it should be", "at most"],
        names_contact: false,
    },
];

pub fn bad_links(context: &mut Context) -> anyhow::Result<()> {
    for case in CASES {
        let mut made = Made::new("links", 2, |_| {})?;
        let host = Host::start(&made.folder)?;
        let path = (case.breaks)(&mut made, &host)?;
        let page = context.start(&format!("study={}/{path}&participant=P1", host.url()))?;
        refused(page, case).with_context(|| case.what.to_owned())?;
        println!("   {}: said", case.what);
    }
    Ok(())
}

fn refused(page: &mut Page, case: &Case) -> anyhow::Result<()> {
    on_screen(page, "problem")?;
    let whom = if case.names_contact { "study@example.org" } else { "whoever invited you" };
    page.wait_for_widgets(&[&format!("If this does not help, please write to {whom}.")])?;
    let widgets = page.widgets()?;
    for words in case.says {
        let is_said = widgets.iter().any(|widget| widget.label.contains(words));
        ensure!(is_said, "\"{words}\" is not said, but {widgets:?}");
    }
    // The browser writes what a server refuses into its console.
    page.forget_errors()
}

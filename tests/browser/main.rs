//! The browser suite: a small runner for flows that use the built page with a real mouse and keyboard.
//! `cargo web test [--full] [--only NAME]` builds the page and runs it.

mod api;
mod cdp;
mod context;
mod data;
mod flows;
mod host;
mod input;
mod page;
mod poses;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context as _, bail};
use cdp::Backend;
use context::Context;
use data::Skipped;
use flows::{FLOWS, Flow};

/// Which flows to run.
#[derive(Default)]
struct Choice {
    full: bool,
    only: Option<String>,
}

impl Choice {
    fn parse(mut arguments: impl Iterator<Item = String>) -> anyhow::Result<Choice> {
        let mut choice = Choice::default();
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--full" => choice.full = true,
                "--only" => choice.only = Some(arguments.next().context("--only needs a name")?),
                other => bail!("The browser suite takes --full and --only NAME, not {other}"),
            }
        }
        Ok(choice)
    }

    fn names(&self, flow: &Flow) -> bool {
        self.only.as_ref().is_none_or(|name| flow.name.contains(name))
    }

    /// A flow that is asked for by its name is run even if it is a long one.
    fn runs(&self, flow: &Flow) -> bool {
        !flow.full_only || self.full || self.only.is_some()
    }
}

fn main() -> ExitCode {
    let choice = match Choice::parse(std::env::args().skip(1)) {
        Ok(choice) => choice,
        Err(error) => {
            eprintln!("{error:#}");
            return ExitCode::from(2);
        }
    };
    if let Err(missing) = check_prerequisites() {
        println!("The browser suite was not run: {missing:#}");
        // On a developer's machine the native tests are still worth something; a build server must not be fooled.
        return if std::env::var_os("CI").is_some() { ExitCode::FAILURE } else { ExitCode::SUCCESS };
    }
    run_all(&choice)
}

fn check_prerequisites() -> anyhow::Result<()> {
    pinpose_web::chromium::find()
        .context("Chromium is missing; `cargo web test --install-deps` installs it")?;
    let dist = context::dist_folder();
    if !dist.join("index.html").is_file() {
        bail!("there is no page in {}; `cargo web build` makes it", dist.display());
    }
    Ok(())
}

fn run_all(choice: &Choice) -> ExitCode {
    let (mut passed, mut failed, mut skipped) = (0, 0, 0);
    for flow in FLOWS.iter().filter(|flow| choice.names(flow)) {
        for backend in flow.backends {
            let outcome = if choice.runs(flow) { run_one(flow, *backend) } else { Outcome::Skipped };
            match outcome {
                Outcome::Passed => passed += 1,
                Outcome::Failed => failed += 1,
                Outcome::Skipped => skipped += 1,
            }
        }
    }
    let skipped_too = if skipped > 0 { format!(", {skipped} skipped") } else { String::new() };
    println!("{passed} passed, {failed} failed{skipped_too}");
    if failed == 0 && passed + skipped > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

enum Outcome {
    Passed,
    Failed,
    Skipped,
}

/// Runs a flow in a browser of its own, and says how it went.
fn run_one(flow: &Flow, backend: Backend) -> Outcome {
    let start = Instant::now();
    let (name, backend_name) = (flow.name, backend.name());
    let result = Context::new(name, backend).and_then(|mut context| {
        let result = (flow.run)(&mut context).and_then(|()| check_errors(&mut context));
        // What the page said often explains why the flow failed.
        result.map_err(|error| describe_failure(error, flow, &mut context))
    });
    let seconds = start.elapsed().as_secs_f64();
    match result {
        Ok(()) => {
            println!("ok {name} ({backend_name}) {seconds:.1} s");
            Outcome::Passed
        }
        Err(error) if error.is::<Skipped>() => {
            println!("skipped {name} ({backend_name}): {error}");
            Outcome::Skipped
        }
        Err(error) => {
            println!("FAILED {name} ({backend_name}) {seconds:.1} s: {error:#}");
            Outcome::Failed
        }
    }
}

fn check_errors(context: &mut Context) -> anyhow::Result<()> {
    match context.page()?.errors()? {
        [] => Ok(()),
        errors => bail!("{} error(s) in the console", errors.len()),
    }
}

/// Adds the console's errors and a screenshot to what went wrong.
fn describe_failure(error: anyhow::Error, flow: &Flow, context: &mut Context) -> anyhow::Error {
    if error.is::<Skipped>() {
        return error;
    }
    let backend = context.backend.name();
    let Ok(page) = context.page() else { return error };
    let mut notes: Vec<String> = page.errors().map(<[String]>::to_vec).unwrap_or_default();
    let picture = picture_path(&format!("{}-{backend}.png", flow.name));
    match page.screenshot().and_then(|screenshot| Ok(screenshot.save(&picture)?)) {
        Ok(()) => notes.push(format!("screenshot: {}", picture.display())),
        Err(no_picture) => notes.push(format!("no screenshot: {no_picture:#}")),
    }
    anyhow::anyhow!("{error:#}\n    {}", notes.join("\n    "))
}

/// Cargo's folder for what tests leave behind.
fn picture_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

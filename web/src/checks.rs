//! `cargo web test`: every check of the project in order, each announced and timed, up to the first that fails.

use std::process::Command;
use std::time::Instant;

use anyhow::{Context as _, bail, ensure};

use crate::build::{self, Profile};
use crate::{chromium, python};

/// What the checks need of the system: a browser, a software graphics driver, and NumPy, which results are held against.
const PACKAGES: [&str; 4] = ["chromium", "mesa-vulkan-drivers", "libvulkan1", "python3-numpy"];

/// What to run.
#[derive(Default)]
pub struct Checks {
    /// Install the browser, the software graphics driver and NumPy first, if they are missing.
    pub install: bool,
    /// Run the long browser flows too.
    pub full: bool,
    /// Run nothing but the browser flows with this in their names.
    pub only: Option<String>,
}

/// Runs the checks; an error names the first that failed.
pub fn run(checks: &Checks) -> anyhow::Result<()> {
    if checks.install {
        step("Install the browser, the graphics driver and NumPy", install)?;
    }
    if checks.only.is_none() {
        step("Format", || run_command(crate::cargo().args(["fmt", "--all", "--check"])))?;
        step("Lints", || {
            run_command(&mut lints(&["--workspace", "--all-targets"]))?;
            // The browser suite has `test = false`, and then is no part of "all targets".
            run_command(&mut lints(&["--package", "pinpose", "--test", "browser"]))
        })?;
        step("Native tests", || run_command(&mut native_tests()))?;
    }
    let dist = build::default_folder();
    step("Build the page", || build::page(Profile::Web, &dist))?;
    step("The page in a browser", || run_command(browser_tests(checks).env("PINPOSE_DIST", &dist)))
}

fn step(name: &str, action: impl FnOnce() -> anyhow::Result<()>) -> anyhow::Result<()> {
    println!("── {name}");
    let start = Instant::now();
    let result = action();
    println!(
        "── {name}: {} in {:.1} s\n",
        if result.is_ok() { "done" } else { "FAILED" },
        start.elapsed().as_secs_f64()
    );
    result.with_context(|| format!("{name} failed"))
}

fn lints(targets: &[&str]) -> Command {
    let mut command = crate::cargo();
    command.arg("clippy").args(targets).args(["--", "-D", "warnings"]);
    command
}

fn native_tests() -> Command {
    let mut command = crate::cargo();
    match chromium::find_program("cargo-nextest") {
        Some(_) => command.args(["nextest", "run", "--workspace"]),
        None => command.args(["test", "--workspace"]),
    };
    command
}

fn browser_tests(checks: &Checks) -> Command {
    let mut command = crate::cargo();
    command.args(["test", "--package", "pinpose", "--test", "browser", "--"]);
    if checks.full {
        command.arg("--full");
    }
    if let Some(name) = &checks.only {
        command.args(["--only", name]);
    }
    command
}

fn run_command(command: &mut Command) -> anyhow::Result<()> {
    let program = command.get_program().to_string_lossy().into_owned();
    let status = command.status().with_context(|| format!("Could not start {program}"))?;
    ensure!(status.success(), "{program} ended with {status}");
    Ok(())
}

fn install() -> anyhow::Result<()> {
    if chromium::find().is_some() && chromium::has_software_vulkan() && python::with_numpy().is_some() {
        println!("All are there.");
        return Ok(());
    }
    if chromium::find_program("apt-get").is_none() {
        bail!(
            "Install Chromium, a software Vulkan driver (Mesa's lavapipe) and Python with NumPy with your system's package manager"
        );
    }
    run_command(apt_get()?.arg("update"))?;
    run_command(apt_get()?.args(["install", "-y", "--no-install-recommends"]).args(PACKAGES))
}

/// Through sudo, unless this is root already.
fn apt_get() -> anyhow::Result<Command> {
    let user = Command::new("id").arg("-u").output().context("Could not ask who runs this")?;
    if user.stdout.trim_ascii() == b"0" {
        return Ok(Command::new("apt-get"));
    }
    let mut command = Command::new("sudo");
    command.arg("apt-get");
    Ok(command)
}

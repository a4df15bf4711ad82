//! `cargo web build | serve | test`: reads the arguments and calls the library.

use std::path::PathBuf;
use std::process::{Command, ExitCode};

use anyhow::{Context as _, bail};
use lexopt::prelude::*;
use pinpose_web::build::{self, Profile};
use pinpose_web::checks::{self, Checks};
use pinpose_web::server::Server;

const USAGE: &str = "\
cargo web build [--quick] [--out DIR]
    Builds the page into DIR (dist): a static folder, to be put on any web server.
    --quick  compiles in a fraction of the time, into a larger and slower page
cargo web serve [--quick] [--dir DIR] [--port N] [--open]
    Builds the page and serves it on this machine.
    --dir    serves this folder as it is instead of building
    --port   the port to listen on (8080)
    --open   opens the page in the browser
cargo web test [--install-deps] [--full] [--only NAME]
    Runs every check: format, lints, native tests, the page in a browser.
    --install-deps  installs the browser, a software graphics driver and NumPy first (apt)
    --full          runs the long browser flows too
    --only          runs only the browser flows with NAME in their names
";

const DEFAULT_PORT: u16 = 8080;

enum Verb {
    Build { profile: Profile, out: PathBuf },
    Serve { profile: Profile, ready: Option<PathBuf>, port: u16, open: bool },
    Test(Checks),
    Help,
}

fn main() -> ExitCode {
    let verb = match parse(lexopt::Parser::from_env()) {
        Ok(verb) => verb,
        Err(error) => {
            eprintln!("{error}\n\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match run(verb) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::FAILURE
        }
    }
}

fn parse(mut arguments: lexopt::Parser) -> Result<Verb, lexopt::Error> {
    let Some(first) = arguments.next()? else { return Ok(Verb::Help) };
    match first {
        Value(verb) if verb == "build" => parse_build(arguments),
        Value(verb) if verb == "serve" => parse_serve(arguments),
        Value(verb) if verb == "test" => parse_test(arguments),
        Value(verb) if verb == "help" => Ok(Verb::Help),
        Short('h') | Long("help") => Ok(Verb::Help),
        other => Err(other.unexpected()),
    }
}

fn parse_build(mut arguments: lexopt::Parser) -> Result<Verb, lexopt::Error> {
    let (mut profile, mut out) = (Profile::Web, build::default_folder());
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("quick") => profile = Profile::Quick,
            Long("out") => out = arguments.value()?.into(),
            Short('h') | Long("help") => return Ok(Verb::Help),
            other => return Err(other.unexpected()),
        }
    }
    Ok(Verb::Build { profile, out })
}

fn parse_serve(mut arguments: lexopt::Parser) -> Result<Verb, lexopt::Error> {
    let (mut profile, mut ready, mut port, mut open) = (Profile::Web, None, DEFAULT_PORT, false);
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("quick") => profile = Profile::Quick,
            Long("dir") => ready = Some(arguments.value()?.into()),
            Long("port") => port = arguments.value()?.parse()?,
            Long("open") => open = true,
            Short('h') | Long("help") => return Ok(Verb::Help),
            other => return Err(other.unexpected()),
        }
    }
    Ok(Verb::Serve { profile, ready, port, open })
}

fn parse_test(mut arguments: lexopt::Parser) -> Result<Verb, lexopt::Error> {
    let mut checks = Checks::default();
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("install-deps") => checks.install = true,
            Long("full") => checks.full = true,
            Long("only") => checks.only = Some(arguments.value()?.string()?),
            Short('h') | Long("help") => return Ok(Verb::Help),
            other => return Err(other.unexpected()),
        }
    }
    Ok(Verb::Test(checks))
}

fn run(verb: Verb) -> anyhow::Result<()> {
    match verb {
        Verb::Build { profile, out } => build::page(profile, &out),
        Verb::Serve { profile, ready, port, open } => serve(profile, ready, port, open),
        Verb::Test(checks) => checks::run(&checks),
        Verb::Help => {
            print!("{USAGE}");
            Ok(())
        }
    }
}

fn serve(profile: Profile, ready: Option<PathBuf>, port: u16, open: bool) -> anyhow::Result<()> {
    let folder = match ready {
        Some(folder) if folder.is_dir() => folder,
        Some(folder) => bail!("There is no such folder to serve: {}", folder.display()),
        None => {
            let folder = build::default_folder();
            build::page(profile, &folder)?;
            folder
        }
    };
    let server = Server::start(&folder, port)?;
    println!("PinPose is served on {} (Ctrl+C stops it)", server.url());
    if open {
        open_in_browser(server.url())?;
    }
    loop {
        std::thread::park();
    }
}

fn open_in_browser(url: &str) -> anyhow::Result<()> {
    let (program, arguments): (_, &[_]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("cmd", &["/C", "start", ""]),
        _ => ("xdg-open", &[]),
    };
    let status = Command::new(program).args(arguments).arg(url).status();
    status.with_context(|| format!("Could not start {program} to open {url}"))?;
    Ok(())
}

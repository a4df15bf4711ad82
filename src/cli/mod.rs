//! The command line: one file per verb. Exit code 0 done, 1 bad input (one line on stderr per problem), 2 bad usage.

mod build_study;
mod convert;
mod draw;
mod evaluate;
mod inspect;
mod open;
mod pins;
mod render;
mod report;
mod simulate_study;
mod snap;
mod source;

use std::ffi::OsString;
use std::process::ExitCode;

const USAGE: &str = "\
PinPose, a 6D object pose annotator

pinpose                              open the window
pinpose inspect IN… [--json]         say what files, folders and zips are, what is in them, guessed and missing
pinpose convert IN… OUT              read files or folders, write poses (.json, .csv) or a workspace (.zip)
        [--to json,poses,npy,csv,meshes,bop,masks,visible_masks,depth,nocs,boxes]
        with it OUT is a folder, or a .zip of what is asked for
        [--axes opencv|opengl] [--unit mm|m] [--direction camera_from_object|object_from_camera]
        [--photo NAME]… [--all-poses]   of poses, npy and csv; some photos alone; untouched poses too
pinpose render IN… --out FOLDER      draw each photo with its objects
        [--kind overlay|silhouette|mask|visible_mask|depth] [--json]
        one PNG per photo, for masks and silhouettes one per object
pinpose evaluate --truth T POSES… [--json | --csv]
        how far poses are from the truth: rotation, translation, ADD, ADI, AD, MSSD, MSPD, projection, VSD, CUS;
        --truth may come several times; photos and meshes are given with either
pinpose pins FILE                    2D-3D pairs and a camera (JSON) to a pose, residuals and covariance
pinpose snap IN… [--photo NAME]… [--wide] [--out POSES.json] [--json]
        refine every pose to its photo; scores, poses and covariances; --wide looks twice as far around
pinpose build-study IN… --out FOLDER [--protocol paper] [--id ID] [--title TITLE]
        photos, meshes and true poses as a study: FOLDER/study for a web host, FOLDER/truth.json for you
pinpose simulate-study STUDY --participants N --out FOLDER [--seed S] [--truth T]
        result files of participants that are a program, to see a report before a study runs
pinpose report RESULTS… --truth T --out FOLDER [--margin PERCENT] [--margin-deg DEGREES] [--seed S]
        [--no-pictures] [--no-png] [--json]
        a page, tables (CSV, LaTeX) and figures (SVG, PNG); T is a study's truth.json, with its assets beside it
--mesh-unit mm|cm|m|in               with convert, render, evaluate, snap and build-study: of meshes that do not say theirs
pinpose --help | --version
";

/// What went wrong, by exit code.
enum Failure {
    /// One line per problem.
    Input(Vec<String>),
    Usage(String),
}

type Outcome = Result<(), Failure>;

impl From<lexopt::Error> for Failure {
    fn from(error: lexopt::Error) -> Self {
        Self::Usage(error.to_string())
    }
}

/// Runs the verb that the arguments name; `None` if there is none: a window is wanted.
pub fn run(arguments: impl Iterator<Item = OsString>) -> Option<ExitCode> {
    let mut parser = lexopt::Parser::from_args(arguments);
    let first = match parser.next() {
        Ok(None) => return None,
        Ok(Some(argument)) => argument,
        Err(error) => return Some(exit_code(Err(error.into()))),
    };
    let outcome = match first {
        lexopt::Arg::Long("help") | lexopt::Arg::Short('h') => {
            print!("{USAGE}");
            Ok(())
        }
        lexopt::Arg::Long("version") => {
            println!("PinPose {}", env!("CARGO_PKG_VERSION"));
            Ok(())
        }
        lexopt::Arg::Value(verb) => match verb.to_str() {
            Some("inspect") => inspect::run(parser),
            Some("build-study") => build_study::run(parser),
            Some("convert") => convert::run(parser),
            Some("evaluate") => evaluate::run(parser),
            Some("pins") => pins::run(parser),
            Some("render") => render::run(parser),
            Some("report") => report::run(parser),
            Some("simulate-study") => simulate_study::run(parser),
            Some("snap") => snap::run(parser),
            _ => Err(Failure::Usage(format!("there is no verb \"{}\"", verb.to_string_lossy()))),
        },
        other => Err(other.unexpected().into()),
    };
    Some(exit_code(outcome))
}

fn exit_code(outcome: Outcome) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Input(problems)) => {
            problems.iter().for_each(|problem| eprintln!("pinpose: {problem}"));
            ExitCode::from(1)
        }
        Err(Failure::Usage(message)) => {
            eprint!("pinpose: {message}\n\n{USAGE}");
            ExitCode::from(2)
        }
    }
}

/// The value of an option that counts.
fn whole(parser: &mut lexopt::Parser) -> Result<u64, Failure> {
    let text = parser.value()?.to_string_lossy().into_owned();
    text.parse().map_err(|_| Failure::Usage(format!("\"{text}\" is no whole number")))
}

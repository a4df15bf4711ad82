//! `pinpose report RESULTS… --truth T --out DIR`: a paper's tables and figures from the result files of a study.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::{Failure, Outcome, open};
use crate::formats::NamedFile;
use crate::platform;
use crate::study::report::{
    Cell, Figure, GatherError, PNG_SCALE, Report, ReportFiles, ReportJob, ReportOptions, ReportProgress,
    Table, gather, svg,
};

/// Who made it, for the page's foot.
const GENERATOR: &str = concat!("PinPose ", env!("CARGO_PKG_VERSION"));

/// The folder of meshes and photos in a study's folder, and the study's own where both are in one.
const STUDY_FOLDERS: [&str; 3] = ["assets", "study", "study/assets"];

struct Options {
    results: Vec<PathBuf>,
    truth: Vec<PathBuf>,
    out: PathBuf,
    report: ReportOptions,
    with_pictures: bool,
    with_png: bool,
    as_json: bool,
}

pub fn run(parser: lexopt::Parser) -> Outcome {
    let options = read_options(parser)?;
    let mut files = open::read_files(&options.results)?;
    for truth in &options.truth {
        files.extend(read_truth(truth)?);
    }
    let failed = |error: GatherError| Failure::Input(vec![error.to_string()]);
    let mut found = ReportFiles::read(&files).map_err(failed)?;
    while found.read_next_mesh() {}
    let input = gather(&found).map_err(failed)?;
    input.remarks.iter().for_each(|remark| eprintln!("pinpose: {remark}"));
    let mut job = ReportJob::new(input, options.report, options.with_pictures);
    let report = loop {
        if let ReportProgress::Done(report) = job.step(&mut || true) {
            break report;
        }
    };
    let written = write(&report, &options)?;
    if options.as_json {
        println!("{:#}", json_of(&report, &written));
    } else {
        println!("{}", options.out.join("report.html").display());
    }
    Ok(())
}

/// A truth file, or a folder with one: what is in it and beside it, where a study's meshes and photos lie.
fn read_truth(path: &Path) -> Result<Vec<NamedFile>, Failure> {
    let folder = if path.is_dir() { path } else { path.parent().unwrap_or(Path::new(".")) };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let mut paths: Vec<PathBuf> = STUDY_FOLDERS.iter().map(|name| folder.join(name)).collect();
    paths.retain(|path| path.is_dir());
    let study = folder.join("study.json");
    paths.extend(study.is_file().then_some(study));
    paths.push(if path.is_dir() { folder.join("truth.json") } else { path.to_owned() });
    open::read_files(&paths)
}

/// The names of what was written.
fn write(report: &Report, options: &Options) -> Result<Vec<String>, Failure> {
    let mut files: Vec<(String, Vec<u8>)> =
        report.files(GENERATOR).into_iter().map(|(path, text)| (path, text.into_bytes())).collect();
    if options.with_png {
        files.extend(pictures(&report.figures).map_err(|error| Failure::Input(vec![error]))?);
    }
    for (path, bytes) in &files {
        let path = options.out.join(path);
        let made = path.parent().map_or(Ok(()), fs::create_dir_all);
        made.and_then(|()| fs::write(&path, bytes))
            .map_err(|error| Failure::Input(vec![format!("{}: {error}", path.display())]))?;
    }
    Ok(files.into_iter().map(|(path, _)| path).collect())
}

/// Each figure as PNG: paths and contents.
fn pictures(figures: &[Figure]) -> Result<Vec<(String, Vec<u8>)>, String> {
    let drawn = |figure: &Figure| {
        let path = format!("figures/{}.png", figure.name);
        let svg = svg(&figure.drawing, &figure.title);
        let png = pollster::block_on(platform::png_of_svg(svg, PNG_SCALE));
        png.map(|bytes| (path.clone(), bytes)).map_err(|error| format!("{path}: {error}"))
    };
    figures.iter().map(drawn).collect()
}

fn json_of(report: &Report, written: &[String]) -> Value {
    let analysis = &report.analysis;
    let tables: Map<String, Value> =
        report.tables.iter().map(|table| (table.name.clone(), table_json(table))).collect();
    json!({
        "format": "pinpose-report",
        "version": 1,
        "title": analysis.title,
        "simulated": analysis.simulated,
        "participants": analysis.participants.len(),
        "samples": analysis.samples.len(),
        "trials": analysis.trials.len(),
        "seed": analysis.options.seed,
        "remarks": analysis.remarks,
        "tables": tables,
        "files": written,
    })
}

/// Columns with their units, rows of cells; a mean with its deviation and an interval are lists of two.
fn table_json(table: &Table) -> Value {
    let columns: Vec<Value> =
        table.columns.iter().map(|column| json!({"name": column.name, "unit": column.unit})).collect();
    let cell = |cell: &Cell| match cell {
        Cell::Missing => Value::Null,
        Cell::Text(text) => json!(text),
        Cell::Count(count) => json!(count),
        Cell::Number(number) | Cell::Chance(number) => json!(number),
        Cell::MeanAndDeviation(a, b) | Cell::Between(a, b) => json!([a, b]),
    };
    let rows: Vec<Vec<Value>> = table.rows.iter().map(|row| row.iter().map(cell).collect()).collect();
    json!({"title": table.title, "note": table.note, "columns": columns, "rows": rows})
}

fn read_options(mut parser: lexopt::Parser) -> Result<Options, Failure> {
    let mut out = None;
    let mut options = Options {
        results: Vec::new(),
        truth: Vec::new(),
        out: PathBuf::new(),
        report: ReportOptions::default(),
        with_pictures: true,
        with_png: true,
        as_json: false,
    };
    while let Some(argument) = parser.next()? {
        match argument {
            lexopt::Arg::Long("truth") => options.truth.push(parser.value()?.into()),
            lexopt::Arg::Long("out") => out = Some(PathBuf::from(parser.value()?)),
            lexopt::Arg::Long("margin") => options.report.margin_percent = positive(&mut parser)?,
            lexopt::Arg::Long("margin-deg") => options.report.margin_deg = positive(&mut parser)?,
            lexopt::Arg::Long("seed") => options.report.seed = super::whole(&mut parser)?,
            lexopt::Arg::Long("no-pictures") => options.with_pictures = false,
            lexopt::Arg::Long("no-png") => options.with_png = false,
            lexopt::Arg::Long("json") => options.as_json = true,
            lexopt::Arg::Value(path) => options.results.push(path.into()),
            other => return Err(other.unexpected().into()),
        }
    }
    let (Some(out), false, false) = (out, options.results.is_empty(), options.truth.is_empty()) else {
        return Err(Failure::Usage("report needs result files, --truth T and --out FOLDER".to_owned()));
    };
    options.out = out;
    Ok(options)
}

fn positive(parser: &mut lexopt::Parser) -> Result<f64, Failure> {
    let text = parser.value()?.to_string_lossy().into_owned();
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| Failure::Usage(format!("\"{text}\" is no number above zero")))
}

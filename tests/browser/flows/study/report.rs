//! The researcher's side: result files, truth and study are dropped in the page, and a paper's tables and figures come out.

use std::sync::Arc;

use anyhow::{Context as _, ensure};
use pinpose::formats::Archive;
use pinpose::study::Results;

use super::made::{Made, files_beneath};
use crate::api::PATIENCE;
use crate::context::Context;
use crate::data::File;
use crate::page::Page;

/// No frame of the page takes longer while the report is made, on a machine that draws without a graphics card.
const LONGEST_FRAME_MS: f64 = 1500.0;

pub fn of_both(context: &mut Context, made: &Made, sent: &[Results]) -> anyhow::Result<()> {
    let files: Vec<File> = sent
        .iter()
        .map(|results| File::new(&format!("{}.json", results.participant.id), results.to_json()))
        .collect();
    let page = context.start("empty")?;
    // Result files open the report by themselves; the rest comes after them.
    page.drop_files(&files)?;
    found(page, "2 participants")?;
    let cut = files[0].cut("cut.json", 0.5);
    page.drop_files(&[
        cut,
        File::new("truth.json", made.truth.to_json()),
        File::new("study.zip", made.zip()?),
    ])?;
    found(page, "cut.json: ")?;
    found(page, "another version of the study")?;
    page.eval(WATCH_FRAMES)?;
    page.click_widget("Make the report")?;
    page.wait_for_widgets(&["Download all"])?;
    let longest_ms = page.eval("window.longestFrameMs")?.as_f64().context("No frames")?;
    println!("   the longest frame while the report was made took {longest_ms:.0} ms");
    ensure!(longest_ms < LONGEST_FRAME_MS, "A frame took {longest_ms:.0} ms");
    page.click_widget("Download all")?;
    let zip = page.download(PATIENCE)?;
    check(&zip, made, sent)
}

/// A hundred people's results of the paper's protocol, which are a program's.
pub fn of_a_hundred(context: &mut Context) -> anyhow::Result<()> {
    let made = Made::new("hundred", 10, |_| {})?;
    let results = made.folder.join("results");
    let run = std::process::Command::new(env!("CARGO_BIN_EXE_pinpose"))
        .arg("simulate-study")
        .arg(&made.folder)
        .args(["--participants", "100", "--seed", "1", "--out"])
        .arg(&results)
        .output()?;
    ensure!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let mut files = vec![File::new("truth.json", made.truth.to_json()), File::new("study.zip", made.zip()?)];
    for path in files_beneath(&results)? {
        let name = path.file_name().context("No name")?.to_string_lossy().into_owned();
        files.push(File::new(&name, std::fs::read(&path)?));
    }
    let page = context.start("empty")?;
    page.hand_over(&files)?;
    page.eval(WATCH_FRAMES)?;
    page.drop_handed_over()?;
    found(page, "100 participants, 3000 trials")?;
    let read_ms = page.eval("window.longestFrameMs")?.as_f64().context("No frames")?;
    page.eval("window.longestFrameMs = 0")?;
    let start = std::time::Instant::now();
    page.click_widget("Make the report")?;
    page.wait_for_widgets(&["Download all"])?;
    let took_s = start.elapsed().as_secs_f64();
    let longest_ms = page.eval("window.longestFrameMs")?.as_f64().context("No frames")?;
    println!(
        "   100 people, 3000 trials: read with frames of {read_ms:.0} ms at most, the report was made in {took_s:.1} s with \
         {longest_ms:.0} ms at most"
    );
    ensure!(read_ms.max(longest_ms) < LONGEST_FRAME_MS, "A frame took {:.0} ms", read_ms.max(longest_ms));
    Ok(())
}

/// Waits until some label has these words.
fn found(page: &mut Page, words: &str) -> anyhow::Result<Vec<crate::api::Widget>> {
    let deadline = std::time::Instant::now() + PATIENCE;
    loop {
        let widgets = page.widgets()?;
        if widgets.iter().any(|widget| widget.label.contains(words)) {
            return Ok(widgets);
        }
        ensure!(std::time::Instant::now() < deadline, "\"{words}\" is not shown, but {widgets:?}");
    }
}

/// The longest time between two frames, from now on.
const WATCH_FRAMES: &str = "(() => {
    window.longestFrameMs = 0;
    let last = performance.now();
    const next = () => {
        const now = performance.now();
        window.longestFrameMs = Math.max(window.longestFrameMs, now - last);
        last = now;
        requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
})()";

/// Page, tables and figures, as they are from the command line.
fn check(zip: &File, made: &Made, sent: &[Results]) -> anyhow::Result<()> {
    ensure!(zip.name == "Ten_objects_report.zip", "The download is called {}", zip.name);
    let mut archive = Archive::open(Arc::from(zip.bytes.clone()))?;
    let paths: Vec<String> = archive.listing("report")?.paths().map(str::to_owned).collect();
    let count = |folder: &str, extension: &str| {
        paths.iter().filter(|path| path.starts_with(folder) && path.ends_with(extension)).count()
    };
    let counts = [count("tables/", ".csv"), count("tables/", ".tex"), count("figures/", ".svg")];
    println!(
        "   the report has {} tables, {} of them in LaTeX, and {} figures",
        counts[0], counts[1], counts[2]
    );
    ensure!(counts.iter().all(|count| *count >= 5), "{paths:?}");
    ensure!(count("figures/", ".png") == counts[2], "Not every figure is a PNG: {paths:?}");
    for path in paths.iter().filter(|path| path.ends_with(".png")) {
        let picture = pinpose::photo::decode(&archive.read(path)?)?.pixels;
        let dark = picture.rgba.chunks_exact(4).filter(|pixel| pixel[0] < 128).count();
        ensure!(
            picture.width > 400 && dark > 200,
            "{path} is {}×{}, {dark} dark",
            picture.width,
            picture.height
        );
    }
    let page = String::from_utf8(archive.read("report.html")?.to_vec())?;
    ensure!(page.contains("2 participants") && !page.contains("Simulated participants"), "The page is wrong");
    ensure!(!page.contains("src=\"http") && !page.contains("<script"), "The page fetches something");

    let results = made.folder.join("results");
    std::fs::create_dir_all(&results)?;
    for one in sent {
        std::fs::write(results.join(format!("{}.json", one.participant.id)), one.to_json())?;
    }
    let native = made.folder.join("native");
    let run = std::process::Command::new(env!("CARGO_BIN_EXE_pinpose"))
        .arg("report")
        .arg(&results)
        .arg("--truth")
        .arg(&made.folder)
        .args(["--no-png", "--no-pictures", "--out"])
        .arg(&native)
        .output()?;
    ensure!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    for path in paths.iter().filter(|path| path.ends_with(".csv")) {
        let expected = std::fs::read_to_string(native.join(path)).with_context(|| path.clone())?;
        same_numbers(&String::from_utf8(archive.read(path)?.to_vec())?, &expected)
            .with_context(|| path.clone())?;
    }
    Ok(())
}

/// Equal texts, and numbers equal to what two compilers' sines make of them.
fn same_numbers(found: &str, expected: &str) -> anyhow::Result<()> {
    let cells = |text: &str| text.split([',', '\n']).map(str::to_owned).collect::<Vec<_>>();
    let (found, expected) = (cells(found), cells(expected));
    ensure!(found.len() == expected.len(), "{} cells in place of {}", found.len(), expected.len());
    for (one, other) in found.iter().zip(&expected) {
        let is_same = match (one.parse::<f64>(), other.parse::<f64>()) {
            (Ok(a), Ok(b)) => (a - b).abs() <= 1e-9 * (1.0 + b.abs()),
            _ => one == other,
        };
        ensure!(is_same, "{one} in place of {other}");
    }
    Ok(())
}

//! How the page begins: its renderer, its time, and the example.

use anyhow::{Context as _, ensure};

use crate::api::{PATIENCE, Perf};
use crate::context::{Context, dist_folder};

/// On a software renderer and two cores; what a user waits on a desktop is less.
const LONGEST_START_MS: f64 = 3000.0;

const RUNS: usize = 3;

/// The page draws its first frame with the renderer that was asked for.
pub fn starts(context: &mut Context) -> anyhow::Result<()> {
    let backend = context.backend.name();
    let perf = context.start("")?.perf()?;
    ensure!(perf.backend == backend, "The page draws with {}, not with {backend}", perf.backend);
    println!("   start_ms {:.0}", perf.start_ms);
    Ok(())
}

/// The time to the first frame, beside that of the same wasm with nothing in it.
pub fn startup(context: &mut Context) -> anyhow::Result<()> {
    let (mut page_ms, mut bare_ms) = (Vec::new(), Vec::new());
    for _ in 0..RUNS {
        // In turns, so that whatever else the machine does slows both.
        page_ms.push(start_ms(context, "")?);
        bare_ms.push(start_ms(context, "bare")?);
    }
    let (page, bare) = (median(&mut page_ms), median(&mut bare_ms));
    println!("   start_ms {page:.0}, bare {bare:.0}, ratio {:.2}", page / bare);
    ensure!(page <= LONGEST_START_MS, "The page took {page:.0} ms to its first frame");
    Ok(())
}

fn start_ms(context: &mut Context, query: &str) -> anyhow::Result<f64> {
    let Perf { start_ms, .. } = context.start(query)?.perf()?;
    ensure!(start_ms > 0.0, "?{query} did not measure its start");
    Ok(start_ms)
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The example is one click, or one parameter, away.
pub fn example(context: &mut Context) -> anyhow::Result<()> {
    let file = dist_folder().join("demo/example.zip");
    ensure!(file.is_file(), "The built page has no demo/example.zip");
    let page = context.start("")?;
    page.click_widget("Try the example")?;
    let has_scene = "!state.busy && state.photos.length > 0 && state.objects.length > 0";
    let clicked = page.wait_for_state(has_scene, PATIENCE)?;
    ensure!(clicked.selection.photo.is_some(), "The example shows no photo");
    // `?example` comes before what is saved.
    let page = context.start("example")?;
    let opened = page.wait_for_state(has_scene, PATIENCE)?;
    ensure!(opened.scene() == clicked.scene(), "?example opens another scene than the button");
    Ok(())
}

/// What is shipped names no folder of the machine that built it.
pub fn no_folders(context: &mut Context) -> anyhow::Result<()> {
    context.start("")?;
    let home = std::env::home_dir().context("There is no home folder to look for")?;
    let home = home.into_os_string().into_encoded_bytes();
    let modules = std::fs::read_dir(dist_folder())?.filter_map(|entry| Some(entry.ok()?.path()));
    let modules: Vec<_> = modules.filter(|path| path.extension().is_some_and(|it| it == "wasm")).collect();
    ensure!(!modules.is_empty(), "The built page has no wasm module");
    for module in modules {
        let bytes = std::fs::read(&module)?;
        let at = bytes.windows(home.len()).position(|window| window == home);
        let said = at.map(|at| String::from_utf8_lossy(&bytes[at..bytes.len().min(at + 100)]).into_owned());
        ensure!(said.is_none(), "{} says: {}", module.display(), said.unwrap_or_default());
    }
    Ok(())
}

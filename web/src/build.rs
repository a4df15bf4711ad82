//! Makes the page: compiles the wasm, composes the site around it, compresses it, and swaps it into place.

mod compile;
mod compress;
mod site;

pub use compile::{Profile, Wasm};
pub use site::is_content_hashed;

use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use compress::{Compressed, Sizes};
use site::Site;

/// What the wasm may weigh on the wire, in bytes: a slow connection (10 Mbit/s) loads it in two seconds.
const WASM_BROTLI_BUDGET: usize = 2_500_000;

/// Where `cargo web build` puts the page when it is not told otherwise.
pub fn default_folder() -> PathBuf {
    crate::workspace_root().join("dist")
}

/// Compiles the page and puts it into `out`, which keeps its old content if anything fails.
pub fn page(profile: Profile, out: &Path) -> anyhow::Result<()> {
    check_replaceable(out)?;
    let wasm = compile::wasm(profile)?;
    assemble(&wasm, profile, out)
}

/// Builds the site around a compiled wasm module and puts it into `out`.
pub fn assemble(wasm: &Wasm, profile: Profile, out: &Path) -> anyhow::Result<()> {
    check_replaceable(out)?;
    let root = crate::workspace_root();
    let bindings = compile::bindings(wasm, profile)?;
    let mut site = Site::compose(&site::Sources::read(&root)?, bindings, &wasm.package_version)?;
    site.add_demo(&root.join("examples/demo"))?;
    let compressed = compress::all(&site.files, profile)?;
    let wasm_sizes = compressed.sizes_of(&site.wasm);
    site.files.insert("build.json".into(), build_record(&site, &compressed));
    report(&wasm_sizes, &compressed.total());
    if profile == Profile::Web {
        check_budget(wasm_sizes.brotli)?;
    }
    replace_folder(out, &site, &compressed)?;
    println!("The page is in {}", out.display());
    Ok(())
}

/// `build.json`: what was built and what it weighs, for people and for scripts.
fn build_record(site: &Site, compressed: &Compressed) -> Vec<u8> {
    let sizes = |sizes: Sizes| serde_json::json!({ "bytes": sizes.raw, "gzip_bytes": sizes.gzip, "brotli_bytes": sizes.brotli });
    let files: serde_json::Map<_, _> =
        site.files.keys().map(|name| (name.clone(), sizes(compressed.sizes_of(name)))).collect();
    let wasm = compressed.sizes_of(&site.wasm);
    let record = serde_json::json!({
        "version": site.version,
        "wasm": site.wasm,
        "wasm_bytes": wasm.raw,
        "wasm_gzip_bytes": wasm.gzip,
        "wasm_brotli_bytes": wasm.brotli,
        "total": sizes(compressed.total()),
        "files": files,
    });
    format!("{record:#}\n").into_bytes()
}

fn report(wasm: &Sizes, total: &Sizes) {
    println!("         {:>10} {:>10} {:>10}", "raw", "gzip", "brotli");
    for (name, sizes) in [("wasm", wasm), ("total", total)] {
        let [raw, gzip, brotli] = [sizes.raw, sizes.gzip, sizes.brotli].map(megabytes);
        println!("{name:<8} {raw:>10} {gzip:>10} {brotli:>10}");
    }
}

fn check_budget(wasm_brotli: usize) -> anyhow::Result<()> {
    let line = format!("wasm brotli: {} (budget {})", megabytes(wasm_brotli), megabytes(WASM_BROTLI_BUDGET));
    ensure!(wasm_brotli <= WASM_BROTLI_BUDGET, "The page is too heavy. {line}");
    println!("{line}");
    Ok(())
}

fn megabytes(bytes: usize) -> String {
    format!("{:.2} MB", bytes as f64 / 1e6)
}

/// The whole folder is replaced, so it must be a page that was built earlier, or have nothing in it.
fn check_replaceable(out: &Path) -> anyhow::Result<()> {
    let is_page = out.join("build.json").is_file();
    let is_empty = || out.read_dir().is_ok_and(|mut entries| entries.next().is_none());
    ensure!(
        !out.exists() || is_page || is_empty(),
        "{} holds other files than a page; name a folder of its own",
        out.display()
    );
    Ok(())
}

/// Writes the site beside `out` first and swaps the folders last, so that `out` is never half a page.
fn replace_folder(out: &Path, site: &Site, compressed: &Compressed) -> anyhow::Result<()> {
    let (fresh, stale) = (sibling(out, "new")?, sibling(out, "old")?);
    for leftover in [&fresh, &stale] {
        remove_folder(leftover)?;
    }
    for (name, bytes) in site.files.iter().chain(&compressed.files) {
        write_file(&fresh.join(name), bytes)?;
    }
    if out.exists() {
        std::fs::rename(out, &stale).with_context(|| format!("Could not move away {}", out.display()))?;
    }
    std::fs::rename(&fresh, out).with_context(|| format!("Could not put the page into {}", out.display()))?;
    remove_folder(&stale)
}

/// `dist` → `.dist.new`, in the same folder because a rename cannot cross file systems.
fn sibling(out: &Path, suffix: &str) -> anyhow::Result<PathBuf> {
    let name = out.file_name().with_context(|| format!("{} names no folder", out.display()))?;
    Ok(out.with_file_name(format!(".{}.{suffix}", name.to_string_lossy())))
}

fn remove_folder(folder: &Path) -> anyhow::Result<()> {
    if !folder.exists() {
        return Ok(());
    }
    std::fs::remove_dir_all(folder).with_context(|| format!("Could not remove {}", folder.display()))
}

fn write_file(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let folder = path.parent().unwrap_or(path);
    std::fs::create_dir_all(folder).with_context(|| format!("Could not make {}", folder.display()))?;
    std::fs::write(path, bytes).with_context(|| format!("Could not write {}", path.display()))
}

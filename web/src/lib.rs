//! The build tool behind `cargo web`: makes the page, serves it, and runs every check.
//!
//! | module | |
//! |---|---|
//! | `build` | cargo → wasm → bindings → a static folder that any web server can carry |
//! | `server` | a small local file server; the browser suite starts and stops one |
//! | `chromium` | where the browser is that the suite drives |
//! | `checks` | `cargo web test`: every check of the project, in order |

pub mod build;
pub mod checks;
pub mod chromium;
pub mod python;
pub mod server;

use std::path::PathBuf;

/// The folder with the workspace's `Cargo.toml` and `index.html`.
///
/// Cargo names the package's folder anew at every start. What was compiled in may be another checkout's: two that share a
/// target folder share this program too.
pub fn workspace_root() -> PathBuf {
    let compiled_in = || env!("CARGO_MANIFEST_DIR").into();
    let package = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(compiled_in));
    let root = package.ancestors().find(|folder| folder.join("index.html").is_file());
    root.unwrap_or(&package).to_path_buf()
}

/// A cargo command that works on the workspace, with the cargo that started this tool.
pub fn cargo() -> std::process::Command {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = std::process::Command::new(program);
    command.current_dir(workspace_root());
    command
}

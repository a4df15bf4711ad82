//! From Rust to wasm, and from wasm to the JavaScript module that loads it.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context as _, ensure};
use serde_json::Value;
use wasm_bindgen_cli_support::Bindgen;

use super::site::{Bindings, read_tree};

const TARGET: &str = "wasm32-unknown-unknown";

/// How the page is compiled; each is a cargo profile of the workspace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// What is shipped: small and fast, minutes to compile.
    Web,
    /// For trying things out.
    Quick,
}

impl Profile {
    fn cargo_name(self) -> &'static str {
        match self {
            Profile::Web => "web",
            Profile::Quick => "web-quick",
        }
    }
}

/// A compiled module, before its bindings are made.
pub struct Wasm {
    pub path: PathBuf,
    /// The version of the crate it was compiled from.
    pub package_version: String,
}

/// Compiles the crate for the browser.
pub fn wasm(profile: Profile) -> anyhow::Result<Wasm> {
    install_target()?;
    let mut command = crate::cargo();
    command
        .args(["rustc", "--package", "pinpose", "--lib", "--crate-type", "cdylib"])
        .args(["--profile", profile.cargo_name(), "--target", TARGET])
        .args(["--config", &without_folders(&crate_folders())])
        .arg("--message-format=json-render-diagnostics")
        // An exported RUSTFLAGS speaks of the native machine, and would replace the configuration's flags
        // for wasm, simd128 among them.
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .stderr(Stdio::inherit());
    let output = command.output().context("Could not start cargo")?;
    ensure!(output.status.success(), "The page did not compile");
    let messages = String::from_utf8_lossy(&output.stdout);
    messages.lines().find_map(compiled_wasm).context("Cargo did not say where it put pinpose.wasm")
}

/// Where cargo unpacks the crates that it downloads: a folder for each registry.
fn crate_folders() -> Vec<PathBuf> {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let Some(home) = home.or_else(|| Some(std::env::home_dir()?.join(".cargo"))) else { return Vec::new() };
    let Ok(registries) = home.join("registry/src").read_dir() else { return Vec::new() };
    registries.flatten().map(|registry| registry.path()).collect()
}

/// Flags for the compiler, as a line of cargo's configuration: where a panic can happen the module has the path of its source,
/// and the builder's own folders are nobody's business.
fn without_folders(folders: &[PathBuf]) -> String {
    let flag = |folder: &PathBuf| format!("--remap-path-prefix={}=crates", folder.display());
    let flags: Vec<String> = folders.iter().map(flag).collect();
    format!("target.{TARGET}.rustflags={}", Value::from(flags))
}

/// Reads one of cargo's messages; the one about our module says where it is.
fn compiled_wasm(message: &str) -> Option<Wasm> {
    let message: Value = serde_json::from_str(message).ok()?;
    if message["reason"] != "compiler-artifact" || message["target"]["name"] != "pinpose" {
        return None;
    }
    let files = message["filenames"].as_array()?.iter().filter_map(Value::as_str);
    let path = PathBuf::from(files.into_iter().find(|file| file.ends_with(".wasm"))?);
    // A package id ends in `#version`, or in `#name@version` where the folder has another name.
    let package_version = message["package_id"].as_str()?.rsplit(['#', '@']).next()?.to_owned();
    Some(Wasm { path, package_version })
}

/// Asks rustup for the wasm target. Without rustup, cargo itself says what is missing.
fn install_target() -> anyhow::Result<()> {
    let Ok(installed) = Command::new("rustup").args(["target", "list", "--installed"]).output() else {
        return Ok(());
    };
    if !installed.status.success()
        || String::from_utf8_lossy(&installed.stdout).lines().any(|it| it == TARGET)
    {
        return Ok(());
    }
    let status = Command::new("rustup").args(["target", "add", TARGET]).status();
    ensure!(status.context("Could not start rustup")?.success(), "rustup could not add {TARGET}");
    Ok(())
}

/// Makes the JavaScript module beside the wasm.
pub fn bindings(wasm: &Wasm, profile: Profile) -> anyhow::Result<Bindings> {
    let folder = wasm.path.with_extension("bindings");
    super::remove_folder(&folder)?;
    Bindgen::new()
        .input_path(&wasm.path)
        .web(true)?
        .typescript(false)
        // Function names make a stack trace readable, and a third of the module's raw size.
        .remove_name_section(profile == Profile::Web)
        .out_name("pinpose")
        .generate(&folder)
        .with_context(|| format!("Could not make the bindings of {}", wasm.path.display()))?;
    let mut files = read_tree(&folder)?;
    let mut take = |name: &str| files.remove(name).with_context(|| format!("wasm-bindgen made no {name}"));
    let (wasm, script) = (take("pinpose_bg.wasm")?, take("pinpose.js")?);
    Ok(Bindings { wasm, script, snippets: files })
}

#[cfg(test)]
mod tests {
    use super::{compiled_wasm, without_folders};

    #[test]
    fn folders_of_crates_are_left_out_whatever_they_are_called() {
        assert_eq!(without_folders(&[]), "target.wasm32-unknown-unknown.rustflags=[]");
        assert_eq!(
            without_folders(&[r"C:\a b\src".into()]),
            r#"target.wasm32-unknown-unknown.rustflags=["--remap-path-prefix=C:\\a b\\src=crates"]"#
        );
    }

    #[test]
    fn cargo_says_where_the_module_is_and_which_version() {
        let message = r##"{"reason":"compiler-artifact","package_id":"path+file:///x/pinpose#0.3.1",
            "target":{"name":"pinpose"},"filenames":["/t/pinpose.d","/t/pinpose.wasm"]}"##;
        let wasm = compiled_wasm(message).expect("an artifact");
        assert_eq!(wasm.path.to_str(), Some("/t/pinpose.wasm"));
        assert_eq!(wasm.package_version, "0.3.1");
        assert!(compiled_wasm(&message.replace("x/pinpose#0.3.1", "x/main#pinpose@0.3.1")).is_some());
        assert!(compiled_wasm(r#"{"reason":"build-finished","success":true}"#).is_none());
    }
}

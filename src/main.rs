//! The native entry: a window, or, with a verb, the command line.

use std::process::ExitCode;
use std::rc::Rc;

use pinpose::app::{PinPose, Start, StartWith};
use pinpose::platform::{self, PageCalls};

fn main() -> ExitCode {
    env_logger::init();
    match pinpose::cli::run(std::env::args_os().skip(1)) {
        Some(exit_code) => exit_code,
        None => open_window(),
    }
}

fn open_window() -> ExitCode {
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([800.0, 500.0]),
        ..eframe::NativeOptions::default()
    };
    let create: eframe::AppCreator<'_> = Box::new(|creation| {
        let start = Start {
            // A window has no page that could call.
            calls: PageCalls::new(Rc::new(|| {})),
            storage: platform::default_storage(),
            with: StartWith::LastOpen,
        };
        Ok(Box::new(PinPose::new(creation, start)))
    });
    match eframe::run_native("PinPose", options, create) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("pinpose: the window cannot be opened: {error}");
            ExitCode::FAILURE
        }
    }
}

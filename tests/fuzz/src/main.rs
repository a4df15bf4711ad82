//! Writes the seeds: `corpus/TARGET/N`, small whole files of each format.

use std::fs;
use std::path::Path;

fn main() -> std::io::Result<()> {
    for (target, files) in pinpose_fuzz::seeds::by_target() {
        let folder = Path::new("corpus").join(target);
        fs::create_dir_all(&folder)?;
        for (number, bytes) in files.iter().enumerate() {
            fs::write(folder.join(number.to_string()), bytes)?;
        }
    }
    Ok(())
}

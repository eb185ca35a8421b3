//! Where `-o` has the files of a benchmark.

use crate::failure::Failure;
use std::path::{Path, PathBuf};

pub struct Folder(PathBuf);

impl Folder {
    pub fn create(path: &Path) -> Result<Folder, Failure> {
        std::fs::create_dir_all(path).map_err(|e| failed(path, &e))?;
        Ok(Folder(path.to_owned()))
    }

    pub fn save(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), Failure> {
        std::fs::write(self.0.join(name), content).map_err(|e| failed(&self.0, &e))
    }
}

fn failed(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Usage(format!("cannot write into {}: {error}", path.display()))
}

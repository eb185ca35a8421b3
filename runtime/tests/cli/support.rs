//! Runs `ghyll` in a folder of its own.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A folder for one test; its name must be the test's.
pub struct Folder(PathBuf);

/// How a run ended.
pub struct Ended {
    pub status: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Folder {
    pub fn new(test: &str) -> Folder {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a folder for the test");
        Folder(path)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> &Folder {
        std::fs::write(self.path(name), content).expect("a file in the test's folder");
        self
    }

    /// Runs `ghyll` here with arguments split at blanks.
    pub fn ghyll(&self, arguments: &str) -> Ended {
        let arguments: Vec<&str> = arguments.split_whitespace().collect();
        self.ghyll_with(&arguments)
    }

    pub fn ghyll_with(&self, arguments: &[&str]) -> Ended {
        self.ghyll_in(&[], arguments)
    }

    /// Runs `ghyll` with this on its standard input.
    pub fn ghyll_fed(&self, arguments: &[&str], input: &str) -> Ended {
        let mut child = Command::new(env!("CARGO_BIN_EXE_ghyll"))
            .args(arguments)
            .current_dir(&self.0)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary runs");
        // A program that ends early does not read all of it.
        let _ = child.stdin.take().expect("it is piped").write_all(input.as_bytes());
        ended(child.wait_with_output().expect("it ends"))
    }

    /// Runs `ghyll` with these environment variables added.
    pub fn ghyll_in(&self, environment: &[(&str, &str)], arguments: &[&str]) -> Ended {
        let output = Command::new(env!("CARGO_BIN_EXE_ghyll"))
            .args(arguments)
            .current_dir(&self.0)
            .env("GALLIVM_PERF", "nopt")
            .envs(environment.iter().copied())
            .output()
            .expect("the binary runs");
        ended(output)
    }
}

fn ended(output: Output) -> Ended {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    Ended { status: output.status.code(), out: text(&output.stdout), err: text(&output.stderr) }
}

impl Ended {
    /// What was printed by a run that succeeded.
    #[track_caller]
    pub fn printed(&self) -> &str {
        assert_eq!(self.status, Some(0), "{}", self.err);
        self.out.trim_end()
    }

    /// Checks the status and that the message holds every part.
    #[track_caller]
    pub fn failed(&self, status: i32, parts: &[&str]) {
        assert_eq!(self.status, Some(status), "{}", self.err);
        for part in parts {
            assert!(self.err.contains(part), "no {part:?} in {}", self.err);
        }
    }
}

/// The machines that this computer has.
pub fn machines() -> &'static [&'static str] {
    use ghyll_runtime::gpu::Gpu;
    if Gpu::list().is_empty() { &["oracle", "cpu"] } else { &["oracle", "cpu", "gpu"] }
}

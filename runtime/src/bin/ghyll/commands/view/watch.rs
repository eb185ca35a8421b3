//! Which files belong to the program, and whether one has changed.

use notify::{RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// An editor may write a file in several steps.
const SETTLED: Duration = Duration::from_millis(60);

#[derive(Default)]
pub struct Watch {
    files: BTreeSet<PathBuf>,
    /// Editors replace files, so folders are watched.
    folders: BTreeSet<PathBuf>,
    watcher: Option<(RecommendedWatcher, Receiver<PathBuf>)>,
    changed: Option<Instant>,
}

impl Watch {
    /// Follows these files, and no others.
    pub fn follow(&mut self, files: impl IntoIterator<Item = PathBuf>) {
        self.files = files.into_iter().filter_map(|file| std::path::absolute(file).ok()).collect();
        let folders: BTreeSet<PathBuf> =
            self.files.iter().filter_map(|f| f.parent().map(Path::to_owned)).collect();
        if folders == self.folders && self.watcher.is_some() {
            return;
        }
        self.watcher = match watcher(&folders) {
            Ok(watcher) => Some(watcher),
            Err(error) => {
                eprintln!("cannot follow changes of the program ({error}); R in the window reads it again");
                None
            }
        };
        self.folders = folders;
    }

    /// Whether a file has changed since this was last true, and nothing more has happened to it for a moment.
    pub fn has_changed(&mut self) -> bool {
        if let Some((_, changes)) = &self.watcher {
            while let Ok(path) = changes.try_recv() {
                let same =
                    |file: &PathBuf| *file == path || file.canonicalize().is_ok_and(|file| file == path);
                if self.files.iter().any(same) {
                    self.changed = Some(Instant::now());
                }
            }
        }
        self.changed.take_if(|at| at.elapsed() >= SETTLED).is_some()
    }
}

fn watcher(folders: &BTreeSet<PathBuf>) -> notify::Result<(RecommendedWatcher, Receiver<PathBuf>)> {
    let (to, changes) = channel();
    let mut watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
        let Ok(event) = event else { return };
        if event.kind.is_access() {
            return;
        }
        for path in event.paths {
            // Nobody listens any more when the window is closed.
            let _ = to.send(path);
        }
    })?;
    for folder in folders {
        watcher.watch(folder, RecursiveMode::NonRecursive)?;
    }
    Ok((watcher, changes))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn within(limit: Duration, mut is: impl FnMut() -> bool) -> bool {
        let begin = Instant::now();
        while begin.elapsed() < limit {
            if is() {
                return true;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        false
    }

    #[test]
    fn changes_of_the_files_are_seen_and_no_others() {
        let folder = std::env::temp_dir().join(format!("ghyll-watch-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (own, other) = (folder.join("a.ghyll"), folder.join("b.ghyll"));
        std::fs::write(&own, "1").unwrap();
        let mut watch = Watch::default();
        watch.follow([own.clone()]);
        assert!(!within(Duration::from_millis(200), || watch.has_changed()));
        std::fs::write(&other, "1").unwrap();
        assert!(!within(Duration::from_millis(300), || watch.has_changed()));
        std::fs::write(&own, "2").unwrap();
        assert!(within(Duration::from_secs(10), || watch.has_changed()));
        // As editors do it: a new file takes the name.
        std::fs::write(&other, "3").unwrap();
        std::fs::rename(&other, &own).unwrap();
        assert!(within(Duration::from_secs(10), || watch.has_changed()));
        assert!(!within(Duration::from_millis(200), || watch.has_changed()));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}

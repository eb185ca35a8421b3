//! Which machine is taken, and that it is said why.

use crate::support::Folder;

/// Makes the Vulkan loader find no driver.
const NO_DRIVER: [(&str, &str); 2] =
    [("VK_DRIVER_FILES", "/nonexistent"), ("VK_ICD_FILENAMES", "/nonexistent")];

#[test]
#[cfg(target_os = "linux")]
fn without_a_driver_the_twin_draws_and_says_why() {
    let folder = Folder::new("no_driver");
    let drawn = folder.ghyll_in(&NO_DRIVER, &["render", "--no-bake", "--size", "32x32", "-o", "a.png"]);
    drawn.printed();
    for part in ["CPU twin", "no GPU adapter was found", "ghyll info"] {
        assert!(drawn.err.contains(part), "{}", drawn.err);
    }
    assert!(folder.path("a.png").exists());

    let asked = folder.ghyll("render --on cpu --no-bake --size 32x32 -o b.png");
    assert!(asked.err.contains("as asked for") && !asked.err.contains("no GPU"), "{}", asked.err);
    folder
        .ghyll_in(&NO_DRIVER, &["render", "--on", "gpu", "-o", "c.png"])
        .failed(2, &["no GPU adapter", "--on cpu"]);
}

#[test]
fn a_trace_without_an_end_ends() {
    let folder = Folder::new("endless_trace");
    folder.write("grows.ghyll", "fn f(n: i32) -> i32 = f(n + 1) * f(n - 1) + n; fn main() -> i32 = f(0);");
    folder.ghyll("trace grows.ghyll").failed(3, &["has grown", "recursion"]);
}

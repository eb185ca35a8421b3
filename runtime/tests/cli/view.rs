//! `ghyll view` where there is no display.

use crate::support::Folder;

#[test]
#[cfg(all(unix, not(target_os = "macos")))]
fn without_a_display_it_says_what_to_do() {
    let folder = Folder::new("view_without_display");
    folder.write("p.ghyll", "fn pixel(p: vec2) -> f32 = 0.5;");
    let none = [("DISPLAY", ""), ("WAYLAND_DISPLAY", "")];
    folder.ghyll_in(&none, &["view", "p.ghyll"]).failed(3, &["no display", "ghyll render"]);
    // One that does not answer.
    let dead = [("DISPLAY", ":4711"), ("WAYLAND_DISPLAY", "")];
    folder
        .ghyll_in(&dead, &["view", "p.ghyll", "--on", "cpu"])
        .failed(3, &["cannot open a window", "ghyll render"]);
    let wayland = [("DISPLAY", ""), ("WAYLAND_DISPLAY", "wayland-0")];
    folder.ghyll_in(&wayland, &["view"]).failed(3, &["Xwayland"]);
}

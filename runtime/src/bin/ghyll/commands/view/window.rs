//! The window: what the mouse and the keys do.

use super::picture::{self, Picture};
use super::source;
use super::watch::Watch;
use crate::arguments::View as Arguments;
use crate::failure::Failure;
use ghyll_runtime::image::Image;
use ghyll_runtime::terrain::Orbit;
use minifb::{Key, KeyRepeat, MouseButton, MouseMode, ScaleMode, Window, WindowOptions};
use std::time::{Duration, Instant};

const KEYS: &str = "\
left button   turns the camera about the point in the middle
right button  moves it (also the left one with Shift)
wheel, + -    brings it nearer and farther
arrows        turn it
Home          puts it where it was at first
Tab           the next parameter (Shift: the one before)
Page Up/Down  changes the parameter
R             reads the program again
C             prints the command that renders this picture
H             this list
Esc, Q        closes the window";

/// A picture that takes longer is drawn coarser while the camera moves.
const SMOOTH: Duration = Duration::from_millis(80);
/// After this long without a move the picture is drawn in full.
const STILL: Duration = Duration::from_millis(150);
const COARSEST: u32 = 8;

/// A message where there is no display.
pub fn display() -> Result<(), Failure> {
    let has = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    match cfg!(all(unix, not(target_os = "macos"))) && !has("DISPLAY") {
        true if has("WAYLAND_DISPLAY") => Err(no_window("the X11 display is missing; start Xwayland")),
        true => Err(no_window("there is no display (DISPLAY is not set)")),
        false => Ok(()),
    }
}

fn no_window(why: &str) -> Failure {
    Failure::Run(format!(
        "cannot open a window: {why}; `ghyll render FILE -o out.png` writes the picture to a file"
    ))
}

pub struct Viewer<'a> {
    picture: Picture<'a>,
    watch: Watch,
    arguments: &'a Arguments,
    window: Window,
    /// What is shown, a word a pixel, with its size.
    shown: (Vec<u32>, usize, usize),
    mouse: Option<(f32, f32)>,
    /// The picture is older than camera, parameters or window.
    stale: bool,
    /// When the camera moved last.
    moved: Option<Instant>,
    /// One pixel is drawn for so many, in both directions.
    coarse: u32,
    /// Drawing time of a picture in full size.
    full: Duration,
    title: String,
}

impl<'a> Viewer<'a> {
    pub fn open(picture: Picture<'a>, watch: Watch, arguments: &'a Arguments) -> Result<Viewer<'a>, Failure> {
        let [width, height] = arguments.camera.size.unwrap_or([960, 640]);
        let options =
            WindowOptions { resize: true, scale_mode: ScaleMode::Stretch, ..WindowOptions::default() };
        let mut window = Window::new("ghyll", width as usize, height as usize, options)
            .map_err(|e| no_window(&e.to_string()))?;
        window.set_target_fps(60);
        eprintln!("H in the window lists its keys");
        Ok(Viewer {
            picture,
            watch,
            arguments,
            window,
            shown: (vec![0; (width * height) as usize], width as usize, height as usize),
            mouse: None,
            stale: true,
            moved: None,
            coarse: 1,
            full: Duration::ZERO,
            title: String::new(),
        })
    }

    /// Until the window is closed.
    pub fn run(mut self) -> Result<(), Failure> {
        let mut first = true;
        while self.window.is_open() && !self.closing() {
            self.keys()?;
            self.pointer();
            if self.watch.has_changed() || self.pressed(Key::R) {
                self.reload();
            }
            self.refine();
            if self.stale {
                self.stale = false;
                match self.draw() {
                    Ok(()) => first = false,
                    // Later the last picture stays.
                    Err(failure) if first => return Err(failure),
                    Err(failure) => {
                        failure.tell();
                    }
                }
            }
            let (pixels, width, height) = &self.shown;
            self.window
                .update_with_buffer(pixels, *width, *height)
                .map_err(|e| Failure::Run(e.to_string()))?;
        }
        Ok(())
    }

    fn closing(&self) -> bool {
        self.window.is_key_down(Key::Escape) || self.window.is_key_down(Key::Q)
    }

    fn pressed(&self, key: Key) -> bool {
        self.window.is_key_pressed(key, KeyRepeat::No)
    }

    fn shift(&self) -> bool {
        self.window.is_key_down(Key::LeftShift) || self.window.is_key_down(Key::RightShift)
    }

    /// Pixels of the window.
    fn size(&self) -> (u32, u32) {
        let (width, height) = self.window.get_size();
        ((width as u32).clamp(1, 16384), (height as u32).clamp(1, 16384))
    }

    fn keys(&mut self) -> Result<(), Failure> {
        let held = |key: Key| self.window.is_key_down(key);
        let sign = |less: bool, more: bool| f64::from(u8::from(more)) - f64::from(u8::from(less));
        let across = sign(held(Key::Left), held(Key::Right));
        let down = sign(held(Key::Down), held(Key::Up));
        let nearer = held(Key::Equal) || held(Key::NumPadPlus);
        let farther = held(Key::Minus) || held(Key::NumPadMinus);
        let zoom = sign(nearer, farther);
        if across != 0.0 || down != 0.0 {
            self.move_camera(|orbit, _| orbit.turn(2.0 * across, 2.0 * down));
        }
        if zoom != 0.0 {
            self.move_camera(|orbit, size| orbit.zoom(1.03f64.powf(zoom), size));
        }
        if self.pressed(Key::Home) {
            self.picture.reset();
            self.stale = true;
        }
        if self.pressed(Key::Tab) {
            self.picture.select(!self.shift());
            self.entitle();
        }
        for (key, up) in [(Key::PageUp, true), (Key::PageDown, false)] {
            if self.window.is_key_pressed(key, KeyRepeat::Yes) && self.picture.step(up)? {
                self.stale = true;
            }
        }
        if self.pressed(Key::C) {
            crate::report::line!("{}", self.picture.command());
        }
        if self.pressed(Key::H) {
            eprintln!("{KEYS}");
        }
        Ok(())
    }

    fn pointer(&mut self) {
        let at = self.window.get_mouse_pos(MouseMode::Pass);
        let before = std::mem::replace(&mut self.mouse, at);
        let (width, height) = self.window.get_size();
        if let (Some((x, y)), Some((x0, y0))) = (at, before) {
            let right = f64::from(x - x0) / height.max(1) as f64;
            let down = f64::from(y - y0) / height.max(1) as f64;
            let left_button = self.window.get_mouse_down(MouseButton::Left);
            let moving = self.window.get_mouse_down(MouseButton::Right) || (left_button && self.shift());
            if (right, down) != (0.0, 0.0) {
                if moving {
                    self.move_camera(|orbit, _| orbit.shift(-right, down));
                } else if left_button {
                    // The ground under the pointer goes with it.
                    self.move_camera(|orbit, _| orbit.turn(180.0 * right, 120.0 * down));
                }
            }
        }
        let inside = at.is_some_and(|(x, y)| x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32);
        if let Some((_, turns)) = self.window.get_scroll_wheel().filter(|_| inside) {
            self.move_camera(|orbit, size| {
                orbit.zoom(0.9f64.powf(f64::from(turns).clamp(-10.0, 10.0)), size)
            });
        }
    }

    fn move_camera(&mut self, change: impl FnOnce(&mut Orbit, f64)) {
        let size = self.picture.field_size();
        if let Some(orbit) = &mut self.picture.orbit {
            change(orbit, size);
            self.moved = Some(Instant::now());
            self.stale = true;
        }
    }

    /// Draws in full once the camera stands, and anew in another size.
    fn refine(&mut self) {
        let (width, height) = self.size();
        let still = self.moved.take_if(|at| at.elapsed() > STILL).is_some();
        if still && self.coarse > 1 {
            self.stale = true;
        }
        let (_, shown_width, shown_height) = &self.shown;
        let expected = (width.div_ceil(self.coarse) as usize, height.div_ceil(self.coarse) as usize);
        self.stale |= (*shown_width, *shown_height) != expected;
    }

    /// The resolution that keeps up with the camera.
    fn coarseness(&self) -> u32 {
        let mut coarse = 1;
        if self.moved.is_some() {
            while coarse < COARSEST && self.full / (coarse * coarse) > SMOOTH {
                coarse *= 2;
            }
        }
        coarse
    }

    fn draw(&mut self) -> Result<(), Failure> {
        let (width, height) = self.size();
        self.coarse = self.coarseness();
        let size = (width.div_ceil(self.coarse), height.div_ceil(self.coarse));
        let (image, time) = self.picture.draw(size)?;
        self.show(&image, time);
        Ok(())
    }

    fn show(&mut self, image: &Image, time: Duration) {
        let pixel = |p: &[u8]| u32::from_be_bytes([0, p[0], p[1], p[2]]);
        let pixels = image.rgba8().chunks_exact(4).map(pixel).collect();
        self.shown = (pixels, image.width as usize, image.height as usize);
        self.full = time * self.coarse * self.coarse;
        let name = self.arguments.file.as_ref().map_or("ghyll".into(), |file| file.display().to_string());
        self.title = format!("{name}  {:.1} ms, {}x{}", time.as_secs_f64() * 1e3, image.width, image.height);
        self.entitle();
    }

    fn entitle(&mut self) {
        let knob = self.picture.knob().map(|knob| format!("  {} = {}", knob.name, knob.text()));
        self.window.set_title(&format!("{}{}", self.title, knob.unwrap_or_default()));
    }

    /// Reads the program again. If it is wrong, that is told and the last picture stays.
    fn reload(&mut self) {
        let size = self.size();
        self.coarse = 1;
        let replaced = source(self.arguments).and_then(|source| self.picture.replace(source, size));
        match replaced {
            Ok((image, time)) => {
                self.watch.follow(self.picture.files());
                self.show(&image, time);
                eprintln!("read again");
            }
            Err(failure) => {
                if let Failure::Diagnostics { report, .. } = &failure {
                    // A module that is wrong may be one that the shown program does not use.
                    let files = self.picture.files().into_iter().chain(picture::files(&report.sources));
                    self.watch.follow(files);
                }
                failure.tell();
                eprintln!("the last picture stays");
            }
        }
    }
}

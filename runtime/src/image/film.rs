//! Many pictures in one file: APNG and GIF, written as they come.

use super::write::eight_bit_rgba;
use super::{Image, ImageError};
use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, RgbaImage};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// How the pictures of a film are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmFormat {
    Apng,
    Gif,
}

impl FilmFormat {
    /// The animation that a file's name asks for, if it does.
    pub fn of(file: &Path) -> Option<FilmFormat> {
        let ending = file.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match ending.as_str() {
            "apng" => Some(FilmFormat::Apng),
            "gif" => Some(FilmFormat::Gif),
            _ => None,
        }
    }

    /// The most frames a second that players show, where the format sets a limit.
    pub fn fastest(self) -> Option<f64> {
        match self {
            FilmFormat::Apng => None,
            FilmFormat::Gif => Some(50.0),
        }
    }
}

/// An open file that takes pictures of one size; it plays without end.
pub enum Film {
    Apng(Box<png::Writer<BufWriter<File>>>),
    Gif { encoder: Box<GifEncoder<BufWriter<File>>>, delay: Delay },
}

impl Film {
    /// Begins a film of `frames` pictures, `rate` a second.
    pub fn create(
        file: &Path,
        format: FilmFormat,
        (width, height): (u32, u32),
        frames: u32,
        rate: f64,
    ) -> Result<Film, ImageError> {
        let unwritable = |source| ImageError::Unwritable { file: file.to_owned(), source };
        let out = BufWriter::new(File::create(file).map_err(unwritable)?);
        match format {
            FilmFormat::Apng => {
                let mut encoder = png::Encoder::new(out, width, height);
                encoder.set_color(png::ColorType::Rgba);
                encoder.set_depth(png::BitDepth::Eight);
                encoder.set_animated(frames, 0).map_err(apng)?;
                encoder
                    .set_frame_delay((1000.0 / rate).round().clamp(1.0, 65535.0) as u16, 1000)
                    .map_err(apng)?;
                Ok(Film::Apng(Box::new(encoder.write_header().map_err(apng)?)))
            }
            FilmFormat::Gif => {
                let mut encoder = GifEncoder::new_with_speed(out, 10);
                encoder.set_repeat(Repeat::Infinite)?;
                let delay = Delay::from_numer_denom_ms((1000.0 / rate).round() as u32, 1);
                Ok(Film::Gif { encoder: Box::new(encoder), delay })
            }
        }
    }

    pub fn add(&mut self, picture: &Image) -> Result<(), ImageError> {
        let data = eight_bit_rgba(picture);
        match self {
            Film::Apng(writer) => writer.write_image_data(&data).map_err(apng),
            Film::Gif { encoder, delay } => {
                let pixels = RgbaImage::from_raw(picture.width, picture.height, data);
                let pixels = pixels.ok_or_else(|| ImageError::Film("a picture of another size".into()))?;
                Ok(encoder.encode_frame(Frame::from_parts(pixels, 0, 0, *delay))?)
            }
        }
    }

    /// Ends the file; it is not complete before.
    pub fn finish(self) -> Result<(), ImageError> {
        match self {
            Film::Apng(writer) => writer.finish().map_err(apng),
            Film::Gif { .. } => Ok(()),
        }
    }
}

fn apng(error: png::EncodingError) -> ImageError {
    ImageError::Film(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::AnimationDecoder;
    use image::codecs::{gif::GifDecoder, png::PngDecoder};
    use std::io::BufReader;

    #[test]
    fn films_can_be_read_again() {
        let folder = std::env::temp_dir();
        for (name, format) in [("film.apng", FilmFormat::Apng), ("film.gif", FilmFormat::Gif)] {
            let file = folder.join(format!("ghyll-{}-{name}", std::process::id()));
            assert_eq!(FilmFormat::of(&file), Some(format));
            let mut film = Film::create(&file, format, (3, 2), 3, 20.0).unwrap();
            for i in 0..3 {
                film.add(&Image::new(3, 2, 1, vec![i as f32 / 2.0; 6]).unwrap()).unwrap();
            }
            film.finish().unwrap();
            let read = || BufReader::new(File::open(&file).unwrap());
            let frames = match format {
                FilmFormat::Apng => {
                    PngDecoder::new(read()).unwrap().apng().unwrap().into_frames().collect_frames()
                }
                FilmFormat::Gif => GifDecoder::new(read()).unwrap().into_frames().collect_frames(),
            };
            let frames = frames.unwrap();
            std::fs::remove_file(&file).unwrap();
            let greys: Vec<u8> = frames.iter().map(|f| f.buffer().get_pixel(1, 1)[0]).collect();
            assert_eq!(greys, [0, 128, 255], "{name}");
            assert_eq!(frames[0].delay().numer_denom_ms().0 / frames[0].delay().numer_denom_ms().1, 50);
        }
    }
}

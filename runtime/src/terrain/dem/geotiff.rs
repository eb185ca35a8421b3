//! GeoTIFF: strips and tiles, the compressions and predictors of the `tiff` crate, GDAL's nodata tag, and the
//! georeference of the GeoTIFF standard (OGC 19-008).

use super::geo::metres_per_degree;
use super::grid::{Grid, Values};
use super::{DemError, DemOptions, check_held};
use crate::terrain::field::{Georeference, Terrain};
use crate::terrain::geotags::{
    GEOGRAPHIC_CRS, GeoKeys, MODEL_TYPE, PIXEL_IS_POINT, PROJECTED_CRS, RASTER_TYPE,
};
use std::io::Cursor;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffUnsupportedError};

const GDAL_NODATA: Tag = Tag::Unknown(42113);

const LINEAR_UNITS: u16 = 3076;
const VERTICAL_UNITS: u16 = 4099;

/// Metres in the linear units that occur, by EPSG code.
const UNITS: &[(u16, f64)] = &[(9001, 1.0), (9002, 0.3048), (9003, 1200.0 / 3937.0), (9036, 1000.0)];

/// Sample formats of complex integers and of complex floats.
const COMPLEX: [u16; 2] = [5, 6];

type Tiff<'a> = Decoder<Cursor<&'a [u8]>>;

/// First bytes of a TIFF.
pub(in crate::terrain) const MAGIC: [&[u8]; 4] = [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"];

/// Numbers of all bands, a pixel's side by side, rows as they stand in the file.
pub(in crate::terrain) struct Decoded {
    pub width: u32,
    pub height: u32,
    pub bands: u32,
    pub values: Samples,
    pub nodata: Option<f64>,
    pub place: Option<Place>,
    kind: &'static str,
}

pub(in crate::terrain) enum Samples {
    Bytes(Vec<u8>),
    Numbers(Values),
}

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let Decoded { width, height, bands, values, nodata, place, kind } = decode(file, bytes)?;
    if bands != 1 {
        let what = format!("its pixels have {bands} channels, not one number each");
        return Err(DemError::unsupported(file, what, "give a single-band GeoTIFF of heights"));
    }
    let values = match values {
        Samples::Bytes(data) => Values::I16(data.into_iter().map(i16::from).collect()),
        Samples::Numbers(values) => values,
    };
    let place = place.unwrap_or_default();
    let spacing = match (options.spacing, place.spacing(height)) {
        (Some(spacing), _) => spacing,
        (None, Some(spacing)) => spacing,
        (None, None) => {
            return Err(DemError::unsupported(
                file,
                "it has no georeference",
                "give --spacing dx,dy in metres",
            ));
        }
    };
    Grid {
        width,
        height,
        values,
        nodata: options.nodata.or(nodata),
        scale: place.vertical_unit(),
        offset: 0.0,
        spacing,
        crs: place.georeference(height),
        format: format!("GeoTIFF {kind}"),
        south_first: place.south_first,
    }
    .terrain(file)
}

/// Channels and bits of a sample.
fn channels(file: &str, color: ColorType) -> Result<(u32, u8), DemError> {
    match color {
        ColorType::Gray(bits) => Ok((1, bits)),
        ColorType::GrayA(bits) => Ok((2, bits)),
        ColorType::RGB(bits) => Ok((3, bits)),
        ColorType::RGBA(bits) => Ok((4, bits)),
        ColorType::Multiband { bit_depth, num_samples } => Ok((u32::from(num_samples), bit_depth)),
        other => {
            let what = format!("its pixels are {other:?}");
            Err(DemError::unsupported(file, what, "convert it to grey, RGB or bands of numbers"))
        }
    }
}

pub(in crate::terrain) fn decode(file: &str, bytes: &[u8]) -> Result<Decoded, DemError> {
    let bad = |e: tiff::TiffError| explain(file, e);
    let mut tiff = Decoder::new(Cursor::new(bytes)).map_err(bad)?;
    let (width, height) = tiff.dimensions().map_err(bad)?;
    let (bands, bits) = channels(file, tiff.colortype().map_err(bad)?)?;
    let sample = u64::from(bits).div_ceil(8) * u64::from(bands);
    let tag = |tiff: &mut Tiff, tag| tiff.find_tag_unsigned::<u16>(tag).map_err(bad).map(|t| t.unwrap_or(1));
    let packed = tag(&mut tiff, Tag::Compression)? != 1;
    check_held(file, (width.into(), height.into()), sample, bytes.len() as u64, packed)?;
    if bands > 1 && tag(&mut tiff, Tag::PlanarConfiguration)? != 1 {
        let mend = "write it pixel by pixel (INTERLEAVE=PIXEL)";
        return Err(DemError::unsupported(file, "its bands lie apart", mend));
    }

    let size = (u64::from(width) * u64::from(height) * sample) as usize;
    let mut limits = Limits::default();
    limits.decoding_buffer_size = size.saturating_mul(2).max(1 << 20);
    limits.intermediate_buffer_size = size.saturating_mul(2).max(1 << 20);
    limits.ifd_value_size = bytes.len();
    let mut tiff = tiff.with_limits(limits);
    let nodata = nodata(file, &mut tiff)?;
    let place = place(&mut tiff);
    let numbers = Samples::Numbers;
    let (values, kind) = match tiff.read_image().map_err(bad)? {
        DecodingResult::I8(v) => (numbers(Values::I16(v.into_iter().map(i16::from).collect())), "int8"),
        DecodingResult::U8(v) => (Samples::Bytes(v), "uint8"),
        DecodingResult::I16(v) => (numbers(Values::I16(v)), "int16"),
        DecodingResult::U16(v) => (numbers(Values::U16(v)), "uint16"),
        DecodingResult::I32(v) => (numbers(Values::I32(v)), "int32"),
        DecodingResult::U32(v) => (numbers(Values::U32(v)), "uint32"),
        DecodingResult::I64(v) => (numbers(Values::I64(v)), "int64"),
        DecodingResult::F32(v) => (numbers(Values::F32(v)), "float32"),
        DecodingResult::F64(v) => (numbers(Values::F64(v)), "float64"),
        _ => {
            let mend = "convert it to int16 or float32";
            return Err(DemError::unsupported(file, format!("its samples have {bits} bits"), mend));
        }
    };
    Ok(Decoded { width, height, bands, values, nodata, place, kind })
}

/// The file's fault or ours.
fn explain(file: &str, error: tiff::TiffError) -> DemError {
    match error {
        tiff::TiffError::UnsupportedError(TiffUnsupportedError::UnsupportedSampleFormat(formats))
            if formats.iter().any(|format| COMPLEX.contains(&format.to_u16())) =>
        {
            let mend = "write their real part, or their amount, as float32";
            DemError::unsupported(file, "its samples are complex numbers", mend)
        }
        tiff::TiffError::UnsupportedError(what) => {
            let mend = "rewrite it uncompressed, or with deflate, LZW, packbits or zstd compression";
            DemError::unsupported(file, what, mend)
        }
        tiff::TiffError::LimitsExceeded => {
            DemError::lying(file, "its tags or strips are larger than its picture")
        }
        other => DemError::damaged(file, "TIFF", &other),
    }
}

/// No text of a tag that is used is longer; what says so is damaged, and the decoder would print a note of its own.
const LONGEST_TEXT: u64 = 1 << 16;

fn text(tiff: &mut Tiff, tag: Tag) -> Option<String> {
    let entry = tiff.image_ifd().find_entry(tag)?;
    if entry.count() > LONGEST_TEXT {
        return None;
    }
    tiff.get_tag_ascii_string(tag).ok()
}

fn nodata(file: &str, tiff: &mut Tiff) -> Result<Option<f64>, DemError> {
    let Some(text) = text(tiff, GDAL_NODATA) else { return Ok(None) };
    let text = text.trim_matches(['\0', ' ']);
    if text.is_empty() {
        return Ok(None);
    }
    let value = text.parse().map_err(|_| DemError::lying(file, format!("its nodata value is `{text}`")))?;
    Ok(Some(value))
}

/// Georeference as the tags state it.
#[derive(Default)]
pub(in crate::terrain) struct Place {
    /// In units of the reference system, positive.
    step: Option<[f64; 2]>,
    /// Centre of the first sample.
    first: [f64; 2],
    pub south_first: bool,
    geographic: bool,
    epsg: Option<u32>,
    /// Metres in a unit of a projected system.
    unit: f64,
    /// Metres in a unit of height.
    vertical_unit: f64,
    keys: Option<GeoKeys>,
}

impl Place {
    /// Latitude or northing of the northern row.
    fn north(&self, height: u32) -> f64 {
        let step = self.step.map_or(0.0, |s| s[1]);
        if self.south_first { self.first[1] + f64::from(height - 1) * step } else { self.first[1] }
    }

    fn spacing(&self, height: u32) -> Option<[f64; 2]> {
        let step = self.step?;
        if !self.geographic {
            return Some(step.map(|s| s * self.unit));
        }
        let middle = self.north(height) - 0.5 * f64::from(height - 1) * step[1];
        let [east, north] = metres_per_degree(middle.clamp(-89.9, 89.9));
        Some([step[0] * east, step[1] * north])
    }

    /// Metres in a unit of height; metres themselves where nothing is said.
    fn vertical_unit(&self) -> f64 {
        if self.vertical_unit > 0.0 { self.vertical_unit } else { 1.0 }
    }

    pub fn georeference(&self, height: u32) -> Option<Georeference> {
        let step = self.step?;
        Some(Georeference {
            epsg: self.epsg,
            geographic: self.geographic,
            north_west: [self.first[0], self.north(height)],
            step,
            keys: self.keys.clone(),
        })
    }
}

fn place(tiff: &mut Tiff) -> Option<Place> {
    // Sample (i, j) lies at origin + step * (i, j), the step pointing east and, normally, south.
    let (origin, step) = if let Ok(scale) = tiff.get_tag_f64_vec(Tag::ModelPixelScaleTag) {
        let tie = tiff.get_tag_f64_vec(Tag::ModelTiepointTag).ok()?;
        let (&[sx, sy, ..], &[i, j, _, x, y, ..]) = (scale.as_slice(), tie.as_slice()) else { return None };
        ([x - i * sx, y + j * sy], [sx, -sy])
    } else {
        let matrix = tiff.get_tag_f64_vec(Tag::ModelTransformationTag).ok()?;
        let &[a, b, _, x, d, e, _, y, ..] = matrix.as_slice() else { return None };
        if b != 0.0 || d != 0.0 {
            return None;
        }
        ([x, y], [a, e])
    };
    let sound = origin.iter().chain(&step).all(|v| v.is_finite()) && step[0] > 0.0 && step[1] != 0.0;
    if !sound {
        return None;
    }
    let keys = GeoKeys {
        directory: tiff.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap_or_default(),
        doubles: tiff.get_tag_f64_vec(Tag::GeoDoubleParamsTag).unwrap_or_default(),
        text: text(tiff, Tag::GeoAsciiParamsTag).unwrap_or_default(),
    };
    let key = |id: u16| keys.get(id);
    let code = |id: u16| key(id).filter(|c| *c != 0 && *c != 32767).map(u32::from);
    let geographic = match key(MODEL_TYPE) {
        Some(model) => model == 2,
        None => code(GEOGRAPHIC_CRS).is_some() && code(PROJECTED_CRS).is_none(),
    };
    let half = if key(RASTER_TYPE) == Some(PIXEL_IS_POINT) { 0.0 } else { 0.5 };
    let metres =
        |id: u16| key(id).and_then(|u| UNITS.iter().find(|(code, _)| *code == u)).map_or(1.0, |(_, m)| *m);
    Some(Place {
        step: Some([step[0], step[1].abs()]),
        first: [origin[0] + half * step[0], origin[1] + half * step[1]],
        south_first: step[1] > 0.0,
        geographic,
        epsg: if geographic { code(GEOGRAPHIC_CRS) } else { code(PROJECTED_CRS) },
        unit: metres(LINEAR_UNITS),
        vertical_unit: metres(VERTICAL_UNITS),
        keys: (!keys.directory.is_empty()).then_some(keys),
    })
}

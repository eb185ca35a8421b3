//! ESRI band interleaved by line (.bil): bare samples beside a text header of the same name that ends in .hdr.

use super::geo::metres_per_degree;
use super::grid::{Grid, Values};
use super::{DemError, DemOptions, check_claim};
use crate::terrain::field::{Georeference, Terrain};
use std::path::Path;

pub(super) fn read(file: &str, bytes: &[u8], options: &DemOptions) -> Result<Terrain, DemError> {
    let beside = Path::new(file).with_extension("hdr");
    let text = std::fs::read_to_string(&beside).map_err(|e| {
        let mend = "put the header beside it, which says how many samples it has";
        DemError::unsupported(file, format!("{} cannot be read ({e})", beside.display()), mend)
    })?;
    parse(file, bytes, &text, options)
}

/// The samples with the text of the header.
pub(super) fn parse(
    file: &str,
    bytes: &[u8],
    header: &str,
    options: &DemOptions,
) -> Result<Terrain, DemError> {
    let get = |key: &str| {
        header.lines().find_map(|line| {
            let mut words = line.split_ascii_whitespace();
            words.next().filter(|word| word.eq_ignore_ascii_case(key))?;
            words.next()
        })
    };
    let number = |key: &str| get(key).and_then(|word| word.parse::<f64>().ok());
    let side = |key: &str| {
        let n = get(key).and_then(|word| word.parse::<u32>().ok());
        n.ok_or_else(|| DemError::lying(file, format!("its header has no number `{key}`")))
    };
    let (width, height) = (side("ncols")?, side("nrows")?);
    let kind = get("pixeltype").unwrap_or("unsignedint").to_ascii_lowercase();
    let bits = number("nbits").unwrap_or(8.0) as u64;
    let single = number("nbands").unwrap_or(1.0) == 1.0 && number("skipbytes").unwrap_or(0.0) == 0.0;
    let sample = match (kind.as_str(), bits) {
        ("signedint" | "unsignedint", 16) => 2,
        ("float", 32) => 4,
        _ => 0,
    };
    if sample == 0 || !single {
        let what = format!("its samples are {kind} of {bits} bits");
        return Err(DemError::unsupported(
            file,
            what,
            "convert it to one band of 16-bit integers or 32-bit floats",
        ));
    }
    check_claim(file, (width.into(), height.into()), sample, bytes.len() as u64, false)?;
    let held = bytes.len() as u64 / sample;
    if held > u64::from(width) * u64::from(height) {
        return Err(DemError::too_many(file, held, &[width.into(), height.into()]));
    }
    let data = &bytes[..(u64::from(width) * u64::from(height) * sample) as usize];
    let big = get("byteorder").is_some_and(|order| order.eq_ignore_ascii_case("m"));
    let short =
        |b: &[u8]| if big { u16::from_be_bytes([b[0], b[1]]) } else { u16::from_le_bytes([b[0], b[1]]) };
    let float = |b: &[u8]| {
        let word = [b[0], b[1], b[2], b[3]];
        if big { f32::from_be_bytes(word) } else { f32::from_le_bytes(word) }
    };
    let values = match kind.as_str() {
        "float" => Values::F32(data.chunks_exact(4).map(float).collect()),
        "signedint" => Values::I16(data.chunks_exact(2).map(|b| short(b) as i16).collect()),
        _ => Values::U16(data.chunks_exact(2).map(short).collect()),
    };
    let step = [number("xdim").unwrap_or(1.0), number("ydim").unwrap_or(1.0)];
    if let Some(size) = step.into_iter().find(|size| !(size.is_finite() && *size > 0.0)) {
        let what = format!("its header says that samples are {size} apart");
        return Err(DemError::unsupported(
            file,
            what,
            "correct `xdim` and `ydim` in it: they are distances above 0",
        ));
    }
    let place = number("ulxmap").zip(number("ulymap")).map(|(west, north)| Georeference {
        epsg: None,
        geographic: step[0] < 0.1 && west.abs() <= 360.0 && north.abs() <= 90.0,
        north_west: [west, north],
        step,
        keys: None,
    });
    let spacing = options.spacing.unwrap_or_else(|| match &place {
        Some(place) if place.geographic => {
            let [east, north] =
                metres_per_degree(place.north_west[1] - 0.5 * f64::from(height - 1) * step[1]);
            [step[0] * east, step[1] * north]
        }
        _ => step,
    });
    Grid {
        width,
        height,
        values,
        nodata: options.nodata.or(number("nodata")),
        scale: 1.0,
        offset: 0.0,
        spacing,
        crs: place,
        format: format!("ESRI bil {kind} {bits} bit"),
        south_first: false,
    }
    .terrain(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_says_how_to_read_the_samples() {
        let header = "BYTEORDER M\nNROWS 2\nNCOLS 2\nNBANDS 1\nNBITS 16\nPIXELTYPE SIGNEDINT\nXDIM 30\nYDIM 20\n\
                      NODATA -5\n";
        let bytes: Vec<u8> = [1i16, 2, -5, 4].iter().flat_map(|v| v.to_be_bytes()).collect();
        let terrain = parse("a.bil", &bytes, header, &DemOptions::default()).unwrap();
        assert_eq!(
            (terrain.sample(0, 1), terrain.sample(0, 0), terrain.sample(1, 0)),
            (Some(1.0), None, Some(4.0))
        );
        assert_eq!(terrain.spacing, [30.0, 20.0]);
        assert!(parse("a.bil", &bytes[..7], header, &DemOptions::default()).is_err());
        let odd = header.replace("16", "24");
        assert!(
            parse("a.bil", &bytes, &odd, &DemOptions::default()).unwrap_err().to_string().contains("24 bits")
        );
    }
}

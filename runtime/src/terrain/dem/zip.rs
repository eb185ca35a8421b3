//! The one file of a .zip archive, as SRTM tiles are handed out.

use super::{DemError, MAX_FILE, MAX_RATIO};
use std::io::Read;

/// Signature of a file's local header, and its length without the name.
const MAGIC: &[u8] = b"PK\x03\x04";
const HEADER: usize = 30;

pub(super) fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Name and content of the first file.
pub(super) fn first(file: &str, bytes: &[u8]) -> Result<(String, Vec<u8>), DemError> {
    let short = || DemError::truncated(file, "its archive is cut off");
    let header = bytes.get(..HEADER).ok_or_else(short)?;
    let half = |at: usize| usize::from(u16::from_le_bytes([header[at], header[at + 1]]));
    let word =
        |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]) as usize;
    let (method, packed) = (half(8), word(18));
    let name_end = HEADER + half(26);
    let name = bytes.get(HEADER..name_end).ok_or_else(short)?;
    let name = String::from_utf8_lossy(name).into_owned();
    let data = bytes.get(name_end + half(28)..).ok_or_else(short)?;
    match method {
        0 => Ok((name, data.get(..packed).ok_or_else(short)?.to_vec())),
        8 => {
            let limit = (data.len() as u64).saturating_mul(MAX_RATIO).min(MAX_FILE);
            let mut plain = Vec::new();
            let mut reader = flate2::read::DeflateDecoder::new(data).take(limit + 1);
            let read = reader.read_to_end(&mut plain);
            read.map_err(|e| DemError::truncated(file, format!("its archive is damaged ({e})")))?;
            if plain.len() as u64 > limit {
                return Err(DemError::TooLarge {
                    file: file.to_owned(),
                    what: "it unpacks to too much".to_owned(),
                });
            }
            Ok((name, plain))
        }
        other => {
            let what = format!("its archive uses compression method {other}");
            Err(DemError::unsupported(file, what, "unpack it first"))
        }
    }
}

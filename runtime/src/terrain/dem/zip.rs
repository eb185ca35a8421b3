//! The grid in a .zip archive, as SRTM tiles are handed out.

use super::{DemError, ENDINGS, MAX_FILE, MAX_RATIO};
use std::io::Read;
use std::path::Path;

/// Signatures of a file's local header, of its entry in the directory, and of the directory's end, with their lengths without
/// names.
const LOCAL: (&[u8], usize) = (b"PK\x03\x04", 30);
const ENTRY: (&[u8], usize) = (b"PK\x01\x02", 46);
const END: (&[u8], usize) = (b"PK\x05\x06", 22);

pub(super) fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(LOCAL.0)
}

pub(super) struct Archive<'a> {
    file: &'a str,
    bytes: &'a [u8],
    members: Vec<Member>,
}

struct Member {
    name: String,
    method: usize,
    packed: usize,
    /// Where its local header begins.
    at: usize,
}

fn half(bytes: &[u8], at: usize) -> Option<usize> {
    Some(usize::from(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?)))
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?) as usize)
}

/// The archive's directory, which stands at its end.
fn directory(bytes: &[u8]) -> Option<Vec<Member>> {
    // Only a comment of at most 64 KiB stands behind.
    let from = bytes.len().saturating_sub(END.1 + 0xffff);
    let end = from + bytes[from..].windows(END.0.len()).rposition(|window| window == END.0)?;
    let (count, mut at) = (half(bytes, end + 10)?, word(bytes, end + 16)?);
    let mut members = Vec::new();
    for _ in 0..count {
        let entry = bytes.get(at..).filter(|entry| entry.starts_with(ENTRY.0))?;
        let name_end = ENTRY.1 + half(entry, 28)?;
        members.push(Member {
            name: String::from_utf8_lossy(entry.get(ENTRY.1..name_end)?).into_owned(),
            method: half(entry, 10)?,
            packed: word(entry, 20)?,
            at: word(entry, 42)?,
        });
        at += name_end + half(entry, 30)? + half(entry, 32)?;
    }
    Some(members)
}

/// The first file, of an archive without a directory.
fn first(bytes: &[u8]) -> Option<Vec<Member>> {
    let name = bytes.get(LOCAL.1..LOCAL.1 + half(bytes, 26)?)?;
    let name = String::from_utf8_lossy(name).into_owned();
    Some(vec![Member { name, method: half(bytes, 8)?, packed: word(bytes, 18)?, at: 0 }])
}

impl<'a> Archive<'a> {
    pub fn open(file: &'a str, bytes: &'a [u8]) -> Result<Archive<'a>, DemError> {
        let members = directory(bytes).or_else(|| first(bytes));
        let members = members.ok_or_else(|| DemError::truncated(file, "its archive is cut off"))?;
        Ok(Archive { file, bytes, members })
    }

    /// Name and content of the only grid.
    pub fn grid(&self) -> Result<(&str, Vec<u8>), DemError> {
        let files: Vec<&Member> = self.members.iter().filter(|m| !m.name.ends_with('/')).collect();
        let grids: Vec<&Member> =
            files.iter().filter(|m| is_grid(&m.name) && !m.name.starts_with("__MACOSX/")).copied().collect();
        let list = |members: &[&Member]| {
            let names: Vec<&str> = members.iter().take(5).map(|m| m.name.as_str()).collect();
            names.join(", ") + if members.len() > 5 { ", .." } else { "" }
        };
        let refused = |what, mend| Err(DemError::unsupported(self.file, what, mend));
        match (grids.as_slice(), files.as_slice()) {
            // The first bytes may tell what the name does not.
            ([member], _) | ([], [member]) => Ok((&member.name, self.unpacked(member)?)),
            ([], []) => refused("its archive is empty".to_owned(), "name an archive of elevation data"),
            ([], _) => {
                let what = format!("its archive holds no grid that can be read, only {}", list(&files));
                refused(what, "unpack it and name the file of heights")
            }
            _ => refused(
                format!("its archive holds several grids: {}", list(&grids)),
                "unpack it and name one of them",
            ),
        }
    }

    /// The text of a file beside another: the same name but for the ending.
    pub fn beside(&self, name: &str, ending: &str) -> Result<String, DemError> {
        let wanted = Path::new(name).with_extension(ending);
        let same = |m: &&Member| Path::new(&m.name).as_os_str().eq_ignore_ascii_case(&wanted);
        let Some(member) = self.members.iter().find(same) else {
            let what = format!("its archive holds {name} without {}", wanted.display());
            return Err(DemError::unsupported(self.file, what, "put both into it"));
        };
        Ok(String::from_utf8_lossy(&self.unpacked(member)?).into_owned())
    }

    fn unpacked(&self, member: &Member) -> Result<Vec<u8>, DemError> {
        let short = || DemError::truncated(self.file, "its archive is cut off");
        let local = self.bytes.get(member.at..).ok_or_else(short)?;
        let begin = half(local, 26).zip(half(local, 28)).map(|(name, extra)| LOCAL.1 + name + extra);
        let data = begin.and_then(|begin| local.get(begin..)).ok_or_else(short)?;
        match member.method {
            0 => Ok(data.get(..member.packed).ok_or_else(short)?.to_vec()),
            8 => {
                let limit = (data.len() as u64).saturating_mul(MAX_RATIO).min(MAX_FILE);
                let mut plain = Vec::new();
                let mut reader = flate2::read::DeflateDecoder::new(data).take(limit + 1);
                let read = reader.read_to_end(&mut plain);
                read.map_err(|e| DemError::damaged(self.file, "zip", &e))?;
                if plain.len() as u64 > limit {
                    let what = "it unpacks to too much".to_owned();
                    return Err(DemError::TooLarge { file: self.file.to_owned(), what });
                }
                Ok(plain)
            }
            other => {
                let what = format!("its archive uses compression method {other}");
                Err(DemError::unsupported(self.file, what, "unpack it first"))
            }
        }
    }
}

fn is_grid(name: &str) -> bool {
    let ending = Path::new(name).extension().and_then(|e| e.to_str()).unwrap_or_default();
    ENDINGS.iter().any(|(known, _)| known.eq_ignore_ascii_case(ending))
}

//! NumPy arrays of floats: shape (height, width), with the components behind it if there are several.

use super::Image;

const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";

pub(super) fn encode(image: &Image) -> Vec<u8> {
    let components = if image.components == 1 { String::new() } else { format!(", {}", image.components) };
    let shape = format!("({}, {}{components})", image.height, image.width);
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    // The data begins at a multiple of 64 bytes, behind a line's end.
    let length = (MAGIC.len() + 2 + header.len() + 1).next_multiple_of(64) - MAGIC.len() - 2;
    header.push_str(&" ".repeat(length - header.len() - 1));
    header.push('\n');

    let mut bytes = MAGIC.to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(image.data.iter().flat_map(|x| x.to_le_bytes()));
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::{DemOptions, dem};

    #[test]
    fn what_is_written_is_read_back() {
        let image = Image::new(3, 2, 1, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.5]).unwrap();
        let bytes = encode(&image);
        assert_eq!(bytes.len() % 64, 24);
        let terrain = dem::read("a.npy", &bytes, &DemOptions::default()).unwrap();
        assert_eq!((terrain.sample(0, 1), terrain.sample(2, 0)), (Some(1.0), Some(6.5)));
    }
}

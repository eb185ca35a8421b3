//! What memory a run takes, by resource.

use std::fmt::{self, Display, Formatter};

macro_rules! resources {
    ($($(#[$meta:meta])* $field:ident $name:literal;)*) => {
        /// Bytes by resource.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct Memory { $($(#[$meta])* pub $field: u64),* }

        impl Memory {
            pub const NAMES: &'static [&'static str] = &[$($name),*];

            /// Names with bytes, in the order of [`Memory::NAMES`].
            pub fn parts(&self) -> Vec<(&'static str, u64)> {
                vec![$(($name, self.$field)),*]
            }
        }
    };
}

resources! {
    /// Stream, its order, and what lanes have outgrown; on the CPU their windows too.
    stream "stream";
    /// What the lanes of a round leave behind.
    records "records";
    image "image";
    /// Heights and their pyramid.
    terrain "terrain";
    rasters "rasters";
    /// What baked functions were evaluated to.
    bakes "bakes";
    /// Between the device and the program.
    readback "readback";
}

impl Memory {
    pub fn total(&self) -> u64 {
        self.parts().iter().map(|(_, bytes)| bytes).sum()
    }
}

impl Display for Memory {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let parts = self.parts().into_iter().filter(|(_, bytes)| *bytes > 0);
        let parts: Vec<String> = parts.map(|(name, bytes)| format!("{name} {}", size(bytes))).collect();
        f.write_str(&parts.join(", "))
    }
}

const UNITS: [&str; 5] = ["bytes", "KiB", "MiB", "GiB", "TiB"];

/// Bytes for a reader: three digits and a binary unit.
pub fn size(bytes: u64) -> String {
    let mut value = bytes as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    match unit {
        0 => format!("{bytes} bytes"),
        _ if value < 10.0 => format!("{value:.1} {}", UNITS[unit]),
        _ => format!("{value:.0} {}", UNITS[unit]),
    }
}

/// The least round size that holds so many bytes, as `--max-memory` takes it.
pub fn allowance(bytes: u64) -> String {
    let unit = if bytes < 10 << 20 { (1 << 10, "K") } else { (1 << 20, "M") };
    format!("{}{}", bytes.div_ceil(unit.0), unit.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        assert_eq!(size(12), "12 bytes");
        assert_eq!(size(1536), "1.5 KiB");
        assert_eq!(size(4 << 30), "4.0 GiB");
        assert_eq!(size(64 << 20), "64 MiB");
    }

    #[test]
    fn allowances_are_enough() {
        assert_eq!(allowance(1), "1K");
        assert_eq!(allowance(1025), "2K");
        assert_eq!(allowance((64 << 20) + 1), "65M");
    }

    #[test]
    fn parts_add_up() {
        let memory =
            Memory { stream: 1, records: 2, image: 4, terrain: 8, rasters: 16, bakes: 32, readback: 64 };
        assert_eq!(memory.total(), 127);
        assert_eq!(memory.parts().len(), Memory::NAMES.len());
        assert_eq!(Memory { image: 2048, ..Memory::default() }.to_string(), "image 2.0 KiB");
    }
}

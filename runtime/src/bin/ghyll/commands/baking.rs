//! Whether a picture is worth its bakes: they take an evaluation for each sample of the field.

use ghyll_compiler::compile::Compiled;
use ghyll_runtime::terrain::Terrain;

/// Samples that are baked for any picture: that is soon done.
const FEW: u64 = 1 << 16;
/// Evaluations of a baked sample that are worth one for a pixel: interpolated values are smooth, and other frames may come.
const WORTH: u64 = 4;

/// Why the program's bakes should be called for a picture that has `rays` in all its frames; none if they should be made.
pub fn refusal(compiled: &Compiled, field: Option<&Terrain>, rays: u64) -> Option<String> {
    let field = field.filter(|_| !compiled.bakes.is_empty())?;
    let samples = u64::from(field.width) * u64::from(field.height);
    (!is_worth(samples, rays)).then(|| {
        format!("not baking: the field has {samples} samples, for {rays} rays of the picture; --bake does it all the same")
    })
}

fn is_worth(samples: u64, rays: u64) -> bool {
    samples <= FEW.max(WORTH.saturating_mul(rays))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_fields_are_baked_for_large_pictures_only() {
        assert!(is_worth(256 * 256, 1), "few samples");
        assert!(is_worth(512 * 512, 256 * 256) && !is_worth(512 * 512, 128 * 128));
        assert!(!is_worth(3601 * 3601, 1 << 20));
        assert!(is_worth(3601 * 3601, 4 << 20), "four samples a pixel, or four frames");
        assert!(is_worth(u64::MAX, u64::MAX));
    }
}

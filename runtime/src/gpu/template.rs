//! Templates whose markers must each be there exactly once.

use crate::error::RunError;

/// Replaces the one occurrence of `marker`.
pub fn fill(template: &str, marker: &str, text: &str) -> Result<String, RunError> {
    match template.matches(marker).count() {
        1 => Ok(template.replacen(marker, text, 1)),
        n => Err(RunError::Shader(format!("marker {marker} occurs {n} times in its template"))),
    }
}

#[cfg(test)]
mod tests {
    use super::fill;

    #[test]
    fn marker_once() {
        assert_eq!(fill("a MARK b", "MARK", "x").unwrap(), "a x b");
    }

    #[test]
    fn marker_absent_or_repeated_is_an_error() {
        assert!(fill("a b", "MARK", "x").is_err());
        assert!(fill("MARK MARK", "MARK", "x").is_err());
    }
}

//! From degrees to metres, on the WGS 84 ellipsoid.

/// Metres in a degree of longitude and of latitude, at a latitude in degrees.
pub(super) fn metres_per_degree(latitude: f64) -> [f64; 2] {
    let phi = latitude.to_radians();
    let east = 111412.84 * phi.cos() - 93.5 * (3.0 * phi).cos() + 0.118 * (5.0 * phi).cos();
    let north =
        111132.92 - 559.82 * (2.0 * phi).cos() + 1.175 * (4.0 * phi).cos() - 0.0023 * (6.0 * phi).cos();
    [east.max(0.0), north]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_at_known_latitudes() {
        let [east, north] = metres_per_degree(0.0);
        assert!((east - 111_319.5).abs() < 1.0 && (north - 110_574.3).abs() < 1.0, "{east} {north}");
        let [east, north] = metres_per_degree(45.0);
        assert!((east - 78_846.8).abs() < 1.0 && (north - 111_131.8).abs() < 1.0, "{east} {north}");
    }
}

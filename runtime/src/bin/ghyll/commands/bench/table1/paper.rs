//! The figures of the paper's Table 1: GeForce GTX TITAN, CUDA 7.0, its own terrains and pictures.

/// System overhead to handle stream rewriting, in milliseconds.
pub const OVERHEAD: f64 = 65.0;

pub const TERRAINS: [&str; 4] = ["Terrain1", "Terrain2", "Fuji", "Everest"];

/// Average milliseconds a frame by terrain, geometry (basic, detail) and lighting (static, dynamic).
const AVERAGE: [[[f64; 2]; 2]; 4] = [
    [[99.5, 101.1], [136.5, 136.9]],
    [[98.8, 99.8], [136.4, 136.3]],
    [[99.6, 99.7], [136.6, 137.0]],
    [[99.1, 100.0], [136.4, 136.6]],
];

/// The paper's average for the terrain in the same place of the table.
pub fn average(terrain: usize, detail: bool, dynamic: bool) -> f64 {
    AVERAGE[terrain][usize::from(detail)][usize::from(dynamic)]
}

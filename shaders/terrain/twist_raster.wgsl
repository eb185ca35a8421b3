fn twist_raster_SURFACE(slot: u32, x: f32, y: f32) -> TerrainTexel_SURFACE {
    return terrain_slope_SURFACE(slot, x, y).twist;
}

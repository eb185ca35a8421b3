fn terrain_crest(index: u32) -> f32 {
    return bitcast<f32>(terrain_crests[index]);
}

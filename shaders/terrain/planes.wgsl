// Distances to the planes x = i and y = j: the only expression for them, monotone in i and j.
fn terrain_planes(ray: TerrainRay, planes: vec2<i32>) -> vec2<f32> {
    return (vec2<f32>(planes - ray.cell) - ray.p) * ray.inverse;
}

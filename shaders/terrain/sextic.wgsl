// The first root of a polynomial of degree 6: the height of a straight ray over a bicubic patch. It is isolated in halves by the signs
// of Bernstein coefficients, of which a piece has as many changes as it has roots, or more by an even number (Descartes; Lane and
// Riesenfeld 1981), then closed in on by Newton's method. Twin: `terrain::patch::sextic`.

// Coefficients of 1 to x^3, and of x^4 to x^6.
struct TerrainSextic {
    low: vec4<f32>,
    high: vec3<f32>,
}

// Pieces this short are not cut further; grazing rays are decided by the piece's end.
const TERRAIN_NARROW: f32 = 1e-5;
const TERRAIN_PIECES: u32 = 96u;
const TERRAIN_STEPS: u32 = 32u;

// Value and slope.
fn terrain_sextic_at(c: TerrainSextic, x: f32) -> vec2<f32> {
    var f = vec2<f32>(c.high.z, 0.0);
    f = vec2<f32>(f.x * x + c.high.y, f.y * x + f.x);
    f = vec2<f32>(f.x * x + c.high.x, f.y * x + f.x);
    f = vec2<f32>(f.x * x + c.low.w, f.y * x + f.x);
    f = vec2<f32>(f.x * x + c.low.z, f.y * x + f.x);
    f = vec2<f32>(f.x * x + c.low.y, f.y * x + f.x);
    return vec2<f32>(f.x * x + c.low.x, f.y * x + f.x);
}

// Bernstein coefficients over [a, a + w].
fn terrain_bernstein(c: TerrainSextic, a: f32, w: f32) -> TerrainSextic {
    var c0 = c.low.x;
    var c1 = c.low.y;
    var c2 = c.low.z;
    var c3 = c.low.w;
    var c4 = c.high.x;
    var c5 = c.high.y;
    var c6 = c.high.z;
    // The polynomial about a.
    c5 += a * c6;
    c4 += a * c5;
    c3 += a * c4;
    c2 += a * c3;
    c1 += a * c2;
    c0 += a * c1;
    c5 += a * c6;
    c4 += a * c5;
    c3 += a * c4;
    c2 += a * c3;
    c1 += a * c2;
    c5 += a * c6;
    c4 += a * c5;
    c3 += a * c4;
    c2 += a * c3;
    c5 += a * c6;
    c4 += a * c5;
    c3 += a * c4;
    c5 += a * c6;
    c4 += a * c5;
    c5 += a * c6;
    // Of the share of w, each by what its power counts: 1 / (6 over k).
    let w2 = w * w;
    let w3 = w2 * w;
    c1 *= w * 0.16666667;
    c2 *= w2 * 0.06666667;
    c3 *= w3 * 0.05;
    c4 *= (w2 * w2) * 0.06666667;
    c5 *= (w2 * w3) * 0.16666667;
    c6 *= w3 * w3;
    c6 += c5;
    c5 += c4;
    c4 += c3;
    c3 += c2;
    c2 += c1;
    c1 += c0;
    c6 += c5;
    c5 += c4;
    c4 += c3;
    c3 += c2;
    c2 += c1;
    c6 += c5;
    c5 += c4;
    c4 += c3;
    c3 += c2;
    c6 += c5;
    c5 += c4;
    c4 += c3;
    c6 += c5;
    c5 += c4;
    c6 += c5;
    return TerrainSextic(vec4<f32>(c0, c1, c2, c3), vec3<f32>(c4, c5, c6));
}

// First x in [0, 1] where the value is not above 0, else less than 0.
fn terrain_sextic_first(c: TerrainSextic) -> f32 {
    var a = 0.0;
    var w = 1.0;
    // The only root between `lo` and `hi`, that should be at `x`.
    var lo = 0.0;
    var hi = 0.0;
    var x = TERRAIN_MISS;
    for (var piece = 0u; piece < TERRAIN_PIECES; piece++) {
        let b = terrain_bernstein(c, a, w);
        if b.low.x <= 0.0 {
            return a;
        }
        let low = b.low > vec4<f32>(0.0);
        let high = b.high > vec3<f32>(0.0);
        let changes = dot(
            select(vec3<u32>(0u), vec3<u32>(1u), low.xyz != low.yzw), vec3<u32>(1u),
        ) + dot(select(vec3<u32>(0u), vec3<u32>(1u), vec3<bool>(low.w, high.xy) != high), vec3<u32>(1u));
        let end = a + w;
        if changes == 1u {
            lo = a;
            hi = end;
            // Not at the end itself, where the value may be a rounding above 0 though the root is far before.
            x = a + w * min(b.low.x / (b.low.x - b.high.z), 0.9);
            break;
        }
        if changes > 0u && w >= TERRAIN_NARROW {
            w *= 0.5;
            continue;
        }
        if !high.z {
            return end;
        }
        if end >= 0.999999 {
            break;
        }
        a = end;
        w = min(2.0 * w, 1.0 - end);
    }
    if x < 0.0 {
        return x;
    }
    for (var step = 0u; step < TERRAIN_STEPS; step++) {
        let f = terrain_sextic_at(c, x);
        if f.x > 0.0 {
            lo = x;
        } else {
            hi = x;
        }
        let newton = x + f.x / max(-f.y, 1e-30);
        let next = select(0.5 * (lo + hi), newton, f.y < 0.0 && newton >= lo && newton <= hi);
        let near = abs(next - x) <= 1e-7;
        x = next;
        if near {
            break;
        }
    }
    return x;
}

//! The intrinsics evaluated on the CPU: in single precision for the twin, in double precision for the oracle.

use super::bicubic;
use super::exact::{Field, Surface};
use super::field::Samples;
use super::layout::SceneUniform;
use super::means;
use super::patch::{Bicubic, Bilinear, Subdivided, Triangulated};
use super::pyramid::Bounds;
use super::range;
use super::ray::WorldRay;
use super::scene::Scene;
use super::surface;
use super::view::Projection;
use super::walk::{self, Heights, Heights16, Heights32};
use crate::world::World;
use ghyll_compiler::intrinsics::Intrinsic;

/// What asks for the bounds of the bicubic surface.
const CURVED: &[Intrinsic] = &[
    Intrinsic::TraceBicubic,
    Intrinsic::TraceSubdivided,
    Intrinsic::OccludedBicubic,
    Intrinsic::OccludedSubdivided,
    Intrinsic::Crest,
    Intrinsic::NextCell,
];

impl World for Scene {
    fn bytes(&self) -> u64 {
        let samples = match &self.terrain().samples {
            Samples::I16(data) => size_of_val(data.as_slice()),
            Samples::F32(data) => size_of_val(data.as_slice()),
        };
        // Every program that looks at the field on the host makes the maximum mipmap.
        self.pyramid();
        samples as u64 + self.derived_bytes() + 4 * self.layers().size()
    }

    fn eval_f64(&self, intrinsic: Intrinsic, args: &[f64], out: &mut [f64]) {
        Scene::eval_f64(self, intrinsic, args, out);
    }

    fn eval_f32(&self, intrinsic: Intrinsic, args: &[u32], out: &mut [u32]) {
        Scene::eval_f32(self, intrinsic, args, out);
    }
}

impl Scene {
    /// Evaluates one intrinsic in single precision, with the shaders' arithmetic. Words as in the stream: floats by
    /// their bits, booleans 0 or 1. `args` and `out` are as long as the intrinsic has parameters and results.
    pub fn eval_f32(&self, intrinsic: Intrinsic, args: &[u32], out: &mut [u32]) {
        if let Some((reading, _)) = intrinsic.reading() {
            let [x, y] = [args[1], args[2]].map(f32::from_bits);
            return self.layers().read_f32(reading, args[0], x, y, out);
        }
        let scene = self.uniform();
        let arg = |i: usize| f32::from_bits(args[i]);
        match (intrinsic, &self.terrain().samples) {
            (Intrinsic::MicroRow, _) => return floats(out, &self.micro().row(arg(0), arg(1))),
            (Intrinsic::Means, Samples::I16(samples)) => {
                let heights = Heights16 { samples, bounds: &[], floors: &[], crests: &[] };
                let words = self.mean_words();
                return floats(out, &means::means(scene, &heights, words, true, [0, 1, 2].map(arg)));
            }
            (Intrinsic::Means, Samples::F32(samples)) => {
                let heights = Heights32 { samples, bounds: &[], floors: &[], crests: &[] };
                let words = self.mean_words();
                return floats(out, &means::means(scene, &heights, words, false, [0, 1, 2].map(arg)));
            }
            (Intrinsic::BeamStart, _) => {
                return floats(out, &[self.beams().start(arg(0), arg(1), scene.near)]);
            }
            _ => {}
        }
        let floors = (intrinsic == Intrinsic::Lowest).then(|| &self.floors().bounds);
        let crests = CURVED.contains(&intrinsic).then(|| &self.crests().bounds);
        match (&self.terrain().samples, &self.pyramid().bounds) {
            (Samples::I16(samples), Bounds::I16(bounds)) => {
                let of = |pyramid: Option<_>| pyramid.map_or(&[][..], Bounds::i16s);
                let heights = Heights16 { samples, bounds, floors: of(floors), crests: of(crests) };
                evaluate(scene, &heights, intrinsic, args, out);
            }
            (Samples::F32(samples), Bounds::F32(bounds)) => {
                let of = |pyramid: Option<_>| pyramid.map_or(&[][..], Bounds::f32s);
                let heights = Heights32 { samples, bounds, floors: of(floors), crests: of(crests) };
                evaluate(scene, &heights, intrinsic, args, out);
            }
            _ => unreachable!("a pyramid has the format of its samples"),
        }
    }

    /// Nodes and cells that a ray is tested against on the bilinear surface, and where it meets it.
    pub(super) fn metered(&self, ray: &[f32; 8]) -> (u64, Option<f32>) {
        let (scene, ray, mut steps) = (self.uniform(), world_ray(ray), 0u64);
        let found = match (&self.terrain().samples, &self.pyramid().bounds) {
            (Samples::I16(samples), Bounds::I16(bounds)) => {
                let heights = Heights16 { samples, bounds, floors: &[], crests: &[] };
                walk::metered(scene, &heights, Bilinear, &ray, &mut steps)
            }
            (Samples::F32(samples), Bounds::F32(bounds)) => {
                let heights = Heights32 { samples, bounds, floors: &[], crests: &[] };
                walk::metered(scene, &heights, Bilinear, &ray, &mut steps)
            }
            _ => unreachable!("a pyramid has the format of its samples"),
        };
        (steps, found)
    }

    /// Evaluates one intrinsic in double precision, brute and independent of the walk. Booleans are 0 or 1.
    pub fn eval_f64(&self, intrinsic: Intrinsic, args: &[f64], out: &mut [f64]) {
        if let Some((reading, _)) = intrinsic.reading() {
            return self.layers().read_f64(reading, args[0] as u32, args[1], args[2], out);
        }
        let uniform = self.uniform();
        let field = Field::new(self.terrain(), uniform, self.options().exaggerate);
        let height = |s: Surface| [field.height(s, args[0], args[1])];
        let trace = |s: Surface| {
            let found = field.trace(s, &world_ray(args));
            [f64::from(u8::from(found.is_some())), found.unwrap_or(0.0)]
        };
        let give = |out: &mut [f64], values: &[f64]| {
            let n = out.len().min(values.len());
            out[..n].copy_from_slice(&values[..n]);
        };
        match intrinsic {
            Intrinsic::Extent => {
                let [x, y] = [0, 1].map(|a| f64::from(uniform.size[a] - 1) * f64::from(uniform.spacing[a]));
                give(out, &[x, y]);
            }
            Intrinsic::Texel => give(out, &uniform.spacing.map(f64::from)),
            Intrinsic::Relief => give(out, &uniform.relief.map(f64::from)),
            Intrinsic::Nearest => give(out, &height(Surface::Nearest)),
            Intrinsic::Triangulated => give(out, &height(Surface::Triangulated)),
            Intrinsic::Bilinear => give(out, &height(Surface::Bilinear)),
            Intrinsic::Bicubic => give(out, &[field.bicubic(args[0], args[1], [0, 0])]),
            Intrinsic::GradientBicubic => {
                give(out, &[[1, 0], [0, 1]].map(|order| field.bicubic(args[0], args[1], order)));
            }
            Intrinsic::BendBicubic => {
                give(out, &[[2, 0], [1, 1], [0, 2]].map(|order| field.bicubic(args[0], args[1], order)));
            }
            Intrinsic::Subdivided => give(out, &[field.subdivided(args[0], args[1], args[2], [0, 0])]),
            Intrinsic::GradientSubdivided => {
                let by = |order| field.subdivided(args[0], args[1], args[2], order);
                give(out, &[by([1, 0]), by([0, 1])]);
            }
            Intrinsic::TwistSubdivided => give(out, &[field.subdivided(args[0], args[1], args[2], [1, 1])]),
            Intrinsic::GradientTriangulated => {
                give(out, &field.gradient(Surface::Triangulated, args[0], args[1]));
            }
            Intrinsic::GradientBilinear => give(out, &field.gradient(Surface::Bilinear, args[0], args[1])),
            Intrinsic::TwistBilinear => give(out, &[field.twist(args[0], args[1])]),
            Intrinsic::MicroRow => {
                give(out, &self.micro().row(args[0] as f32, args[1] as f32).map(f64::from));
            }
            Intrinsic::Means => {
                let exaggerate = self.options().exaggerate;
                let low = self.terrain().min * exaggerate;
                let at = [args[0], args[1], args[2]];
                give(out, &self.means().around(self.terrain(), at, (low, exaggerate)));
            }
            Intrinsic::TraceTriangulated => give(out, &trace(Surface::Triangulated)),
            Intrinsic::TraceBilinear => give(out, &trace(Surface::Bilinear)),
            Intrinsic::TraceBicubic => give(out, &trace(Surface::Bicubic)),
            Intrinsic::TraceSubdivided => give(out, &trace(Surface::Subdivided(args[8]))),
            Intrinsic::OccludedBicubic => give(out, &trace(Surface::Bicubic)[..1]),
            Intrinsic::OccludedSubdivided => give(out, &trace(Surface::Subdivided(args[8]))[..1]),
            Intrinsic::OccludedTriangulated => give(out, &trace(Surface::Triangulated)[..1]),
            Intrinsic::OccludedBilinear => give(out, &trace(Surface::Bilinear)[..1]),
            Intrinsic::NextCell => {
                let cell = field.next_cell(&world_ray(args), args[8]);
                out[0] = f64::from(u8::from(cell.is_some()));
                give(&mut out[1..], &cell.unwrap_or([0.0; 3]));
            }
            Intrinsic::PatchAround => give(out, &field.patch_around([0, 1].map(|k| args[k]))),
            Intrinsic::Highest => give(out, &[field.bounds(args)[1]]),
            Intrinsic::Lowest => give(out, &[field.bounds(args)[0]]),
            Intrinsic::Crest => give(out, &[field.crest(args)]),
            Intrinsic::Inclines => give(out, &field.inclines(args)),
            Intrinsic::InclinesBicubic => give(out, &field.inclines_bicubic(args)),
            Intrinsic::Hole => {
                give(out, &[f64::from(u8::from(field.holed(&[args[0], args[1], args[0], args[1]])))])
            }
            Intrinsic::Holed => give(out, &[f64::from(u8::from(field.holed(args)))]),
            Intrinsic::Camera => {
                let (o, d) = self.camera().ray(args[0], args[1]);
                let (near, far) = (f64::from(uniform.near), f64::from(uniform.far));
                give(out, &[o.x, o.y, o.z, d.x, d.y, d.z, near, far]);
            }
            // The oracle's rays all start at the camera: what beams leave out is seen.
            Intrinsic::BeamStart => give(out, &[f64::from(uniform.near)]),
            Intrinsic::PixelWidth => give(out, &self.camera().pixel_width()),
            Intrinsic::Picture => give(out, &self.camera().middle.map(|x| 2.0 * x)),
            Intrinsic::SunDir => give(out, &self.options().sun.dir()),
            Intrinsic::SunColor => give(out, &self.options().sun.color()),
            Intrinsic::Place => {
                let [column, row] = [args[0].floor(), f64::from(uniform.size[1] - 1) - args[1].floor()];
                give(out, &[column * f64::from(uniform.spacing[0]), row * f64::from(uniform.spacing[1])]);
            }
            other => unreachable!("`{}` is answered before", other.name()),
        }
    }
}

fn world_ray<T: Copy>(args: &[T]) -> WorldRay<T> {
    WorldRay {
        origin: [args[0], args[1], args[2]],
        dir: [args[3], args[4], args[5]],
        near: args[6],
        far: args[7],
    }
}

fn evaluate<H: Heights>(
    scene: &SceneUniform,
    heights: &H,
    intrinsic: Intrinsic,
    args: &[u32],
    out: &mut [u32],
) {
    let arg = |i: usize| f32::from_bits(args[i]);
    let ray = || world_ray(&[0, 1, 2, 3, 4, 5, 6, 7].map(arg));
    match intrinsic {
        Intrinsic::Extent => {
            let [x, y] = [0, 1].map(|a| (scene.size[a] - 1) as f32 * scene.spacing[a]);
            floats(out, &[x, y]);
        }
        Intrinsic::Texel => floats(out, &scene.spacing),
        Intrinsic::Relief => floats(out, &scene.relief),
        Intrinsic::Nearest => floats(out, &[surface::nearest(scene, heights, arg(0), arg(1))]),
        Intrinsic::Triangulated => {
            floats(out, &[surface::height::<H, Triangulated>(scene, heights, arg(0), arg(1))]);
        }
        Intrinsic::Bilinear => {
            floats(out, &[surface::height::<H, Bilinear>(scene, heights, arg(0), arg(1))]);
        }
        Intrinsic::Bicubic => floats(out, &[bicubic::bicubic(scene, heights, arg(0), arg(1))]),
        Intrinsic::GradientBicubic => {
            floats(out, &bicubic::gradient_bicubic(scene, heights, arg(0), arg(1)));
        }
        Intrinsic::BendBicubic => floats(out, &bicubic::bend_bicubic(scene, heights, arg(0), arg(1))),
        Intrinsic::Subdivided => floats(out, &[bicubic::subdivided(scene, heights, [0, 1, 2].map(arg))]),
        Intrinsic::GradientSubdivided => {
            floats(out, &bicubic::gradient_subdivided(scene, heights, [0, 1, 2].map(arg)));
        }
        Intrinsic::TwistSubdivided => {
            floats(out, &[bicubic::twist_subdivided(scene, heights, [0, 1, 2].map(arg))]);
        }
        Intrinsic::GradientTriangulated => {
            floats(out, &surface::gradient_triangulated(scene, heights, arg(0), arg(1)));
        }
        Intrinsic::GradientBilinear => {
            floats(out, &surface::gradient_bilinear(scene, heights, arg(0), arg(1)));
        }
        Intrinsic::TwistBilinear => floats(out, &[surface::twist_bilinear(scene, heights, arg(0), arg(1))]),
        Intrinsic::TraceTriangulated => found(out, walk::trace(scene, heights, Triangulated, &ray())),
        Intrinsic::TraceBilinear => found(out, walk::trace(scene, heights, Bilinear, &ray())),
        Intrinsic::TraceBicubic => found(out, walk::trace(scene, heights, Bicubic, &ray())),
        Intrinsic::TraceSubdivided => {
            found(out, walk::trace(scene, heights, Subdivided { parts: arg(8) }, &ray()))
        }
        Intrinsic::OccludedTriangulated => any(out, walk::trace(scene, heights, Triangulated, &ray())),
        Intrinsic::OccludedBilinear => any(out, walk::trace(scene, heights, Bilinear, &ray())),
        Intrinsic::OccludedBicubic => any(out, walk::trace(scene, heights, Bicubic, &ray())),
        Intrinsic::OccludedSubdivided => {
            any(out, walk::trace(scene, heights, Subdivided { parts: arg(8) }, &ray()))
        }
        Intrinsic::NextCell => {
            let cell = walk::next_cell(scene, heights, &ray(), arg(8));
            out[0] = u32::from(cell.is_some());
            floats(&mut out[1..], &cell.unwrap_or([0.0; 3]));
        }
        Intrinsic::PatchAround => floats(out, &bicubic::patch_around(scene, heights, [0, 1].map(arg))),
        Intrinsic::Highest => floats(out, &[range::highest(scene, heights, &[0, 1, 2, 3].map(arg))]),
        Intrinsic::Lowest => floats(out, &[range::lowest(scene, heights, &[0, 1, 2, 3].map(arg))]),
        Intrinsic::Crest => floats(out, &[range::crest(scene, heights, &[0, 1, 2, 3].map(arg))]),
        Intrinsic::InclinesBicubic => {
            floats(out, &range::inclines_bicubic(scene, heights, &[0, 1, 2, 3].map(arg)));
        }
        Intrinsic::Inclines => floats(out, &range::inclines(scene, heights, &[0, 1, 2, 3].map(arg))),
        Intrinsic::Hole => out[0] = u32::from(range::holed(scene, heights, &[0, 1, 0, 1].map(arg))),
        Intrinsic::Holed => out[0] = u32::from(range::holed(scene, heights, &[0, 1, 2, 3].map(arg))),
        Intrinsic::Camera => floats(out, &camera(scene, arg(0), arg(1))),
        Intrinsic::PixelWidth => floats(out, &scene.pixel_width),
        Intrinsic::Picture => floats(out, &scene.middle.map(|x| 2.0 * x)),
        Intrinsic::SunDir => floats(out, &scene.sun_dir),
        Intrinsic::SunColor => floats(out, &scene.sun_color),
        // Twin of `shaders/terrain/place.wgsl`.
        Intrinsic::Place => {
            let [column, row] = [arg(0).floor(), (scene.size[1] - 1) as f32 - arg(1).floor()];
            floats(out, &[column * scene.spacing[0], row * scene.spacing[1]]);
        }
        other => unreachable!("`{}` is answered before", other.name()),
    }
}

fn floats(out: &mut [u32], values: &[f32]) {
    for (word, value) in out.iter_mut().zip(values) {
        *word = value.to_bits();
    }
}

fn found(out: &mut [u32], distance: Option<f32>) {
    out[0] = u32::from(distance.is_some());
    out[1] = distance.unwrap_or(0.0).to_bits();
}

fn any(out: &mut [u32], distance: Option<f32>) {
    out[0] = u32::from(distance.is_some());
}

/// Cosine and sine of a part of a full turn.
fn circle(turn: f32) -> [f32; 2] {
    let quarter = (4.0 * turn).round_ties_even();
    let x = (4.0 * turn - quarter) * std::f32::consts::FRAC_PI_2;
    let q = x * x;
    let sine = x + x * q * (-0.16666667 + q * (0.008333333 + q * (-0.0001984127 + q * 2.7557319e-6)));
    let cosine = 1.0 + q * (-0.5 + q * (0.041666668 + q * (-0.0013888889 + q * 2.4801588e-5)));
    let count = quarter as i32 & 3;
    let [c, s] = if count & 1 != 0 { [-sine, cosine] } else { [cosine, sine] };
    if count & 2 != 0 { [-c, -s] } else { [c, s] }
}

/// Twin of `shaders/terrain/camera.wgsl`.
pub(super) fn camera(scene: &SceneUniform, x: f32, y: f32) -> [f32; 8] {
    let (i, j) = (x - scene.middle[0], y - scene.middle[1]);
    let offset = [0, 1, 2].map(|a| i * scene.across[a] + j * scene.down[a]);
    if scene.projection == Projection::Panorama as u32 {
        let ([ox, oy, oz], [fx, fy, _]) = (scene.eye, scene.forward);
        let a = circle(i * scene.across[0]);
        let e = circle(-(j * scene.down[0]));
        let dx = e[0] * (a[0] * fx + a[1] * fy);
        let dy = e[0] * (a[0] * fy - a[1] * fx);
        return [ox, oy, oz, dx, dy, e[1], scene.near, scene.far];
    }
    if scene.projection == Projection::Orthographic as u32 {
        let [ox, oy, oz] = [0, 1, 2].map(|a| scene.eye[a] + offset[a]);
        let [dx, dy, dz] = scene.forward;
        return [ox, oy, oz, dx, dy, dz, scene.near, scene.far];
    }
    let [ox, oy, oz] = scene.eye;
    let [dx, dy, dz] = [0, 1, 2].map(|a| scene.forward[a] + offset[a]);
    let length = (dx * dx + dy * dy + dz * dz).sqrt();
    [ox, oy, oz, dx / length, dy / length, dz / length, scene.near, scene.far]
}

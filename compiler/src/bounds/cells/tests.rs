//! Over random patches, surfaces in cells keep to what is told of them.

use crate::compile::check;
use crate::core::{Const, Intrinsic, Program};
use crate::interpret::{Host, run};
use crate::lower::{Asked, Settings, lower};
use crate::random::Random;
use crate::source::Source;

const SURFACES: &[&str] = &[
    "bicubic(p) + 4.0 * fbm(p / 6.0, 3)",
    "bicubic(p) - 3.0 * noise(p / vec2(3.0, 5.0)) + 0.02 * p.x * p.y",
    "0.5 + bicubic(p) + sin(0.3 * p.x + noise(p / 4.0))",
    "2.0 * noise(p / 7.0 + 0.4 * vec2(sin(p.y / 3.0), noise(p / 9.0))) + bicubic(p)",
];

const TEXEL: [f32; 2] = [10.0, 7.0];
const CELL: [f32; 2] = [3.0, 2.0];

/// The samples around [`CELL`], rows from south to north, less `base`.
#[derive(Clone)]
struct Field {
    base: f32,
    rows: [[f32; 4]; 4],
}

fn spline([a, b, c, d]: [f64; 4], t: f64, order: u32) -> f64 {
    let [p, q, r] = [0.5 * (c - a), a - 2.5 * b + 2.0 * c - 0.5 * d, 0.5 * (d - a) + 1.5 * (b - c)];
    if order == 0 { b + t * (p + t * (q + t * r)) } else { p + t * (2.0 * q + 3.0 * t * r) }
}

impl Field {
    fn random(random: &mut Random) -> Field {
        let steep = [0.0, 1.0, 30.0, 400.0][random.below(4)];
        let rows: [[f32; 4]; 4] =
            std::array::from_fn(|_| std::array::from_fn(|_| steep * random.below(1001) as f32 / 1000.0));
        let base = rows[1][1];
        Field { base, rows: rows.map(|row| row.map(|z| z - base)) }
    }

    fn at(&self, [x, y]: [f32; 2], order: [u32; 2]) -> f64 {
        let place = |axis: usize, w: f32| f64::from(w) / f64::from(TEXEL[axis]) - f64::from(CELL[axis]);
        let (u, v) = (place(0, x), place(1, y));
        let rows = self.rows.map(|row| spline(row.map(f64::from), u, order[0]));
        let unit = |axis: usize| if order[axis] == 0 { 1.0 } else { f64::from(TEXEL[axis]) };
        let base = if order == [0, 0] { f64::from(self.base) } else { 0.0 };
        base + spline(rows, v, order[1]) / (unit(0) * unit(1))
    }

    fn words(&self) -> Vec<f32> {
        CELL.into_iter().chain([self.base]).chain(self.rows.into_iter().flatten()).collect()
    }
}

impl Host for Field {
    fn intrinsic(&self, intrinsic: Intrinsic, args: &[Const]) -> Option<Vec<Const>> {
        let arg = |i: usize| f32::from_bits(args[i].word());
        let found = match intrinsic {
            Intrinsic::Texel => TEXEL.to_vec(),
            Intrinsic::Bicubic => vec![self.at([arg(0), arg(1)], [0, 0]) as f32],
            Intrinsic::GradientBicubic => {
                [[1, 0], [0, 1]].map(|order| self.at([arg(0), arg(1)], order) as f32).to_vec()
            }
            // Of heights, which nothing here asks for.
            Intrinsic::Lowest | Intrinsic::Highest | Intrinsic::Crest => vec![0.0],
            _ => return None,
        };
        Some(found.into_iter().map(Const::f32).collect())
    }

    fn live(&self, _: u32) -> Option<u32> {
        None
    }
}

struct Surface(Program);

impl Surface {
    fn new(text: &str) -> Surface {
        let text = format!(
            "use terrain;\nfn shape(p: vec2) -> f32 = {text};\n\
             fn main(x: f32) -> bool = occluded(shape, Ray(vec3(x), vec3(0.0, 0.0, 1.0), 0.0, 1e9));"
        );
        let checked = check(Source::new("surface.ghyll", text)).unwrap_or_else(|_| panic!("a wrong text"));
        let entry = checked.module.function("main").expect("the text has one");
        let program = lower(&checked.module, entry, Asked::Plainly, &Settings::default());
        Surface(program.unwrap_or_else(|_| panic!("a wrong program")))
    }

    fn call(&self, name: &str, host: &Field, args: &[f32]) -> Vec<f32> {
        let entry = self.0.functions.iter().position(|f| f.name.ends_with(name));
        let entry = entry.unwrap_or_else(|| panic!("no function {name}")) as u32;
        let args: Vec<Const> = args.iter().map(|x| Const::f32(*x)).collect();
        let program = Program { entry, ..self.0.clone() };
        let words = run(&program, &args, host, 1_000_000).unwrap_or_else(|e| panic!("{name} stopped: {e:?}"));
        words.into_iter().map(|w| f32::from_bits(w.word())).collect()
    }
}

/// By how much a surface breaks what is told of it, in parts of what is allowed: raise, height, slope, greatest slope, second
/// derivatives. `told` are the fields whose patches tell heights and bounds.
fn broken(surface: &Surface, field: &Field, told: [&Field; 2], random: &mut Random) -> [f64; 5] {
    let mut unit = || random.below(10_001) as f32 / 10_000.0;
    let place = |unit: [f32; 2]| [0, 1].map(|k| (CELL[k] + 0.02 + 0.96 * unit[k]) * TEXEL[k]);
    let (a, b) = (place([unit(), unit()]), place([unit(), unit()]));
    let ends = [a[0].min(b[0]), a[1].min(b[1]), a[0].max(b[0]), a[1].max(b[1])];
    let angle = unit() * std::f32::consts::TAU;
    let dir = [angle.cos(), angle.sin()];
    let [heights, bounds] = told.map(Field::words);
    let rise = |p: [f32; 2]| {
        let found = surface.call(".rise", field, &[&p[..], &dir[..], &heights].concat());
        [f64::from(found[0]), f64::from(found[1])]
    };
    let reach = surface.call(".reach", field, &[&ends[..], &dir[..], &bounds].concat());
    let raise = surface.call(".raise", field, &ends);
    let mut most = [0.0f64; 5];
    for _ in 0..6 {
        let p = [0, 1].map(|k| ends[k] + unit() * (ends[k + 2] - ends[k]));
        let beside = |h: f32| [0, 1].map(|k| p[k] + h * dir[k]);
        let height = |p: [f32; 2]| f64::from(surface.call("shape", field, &p)[0]);
        let [z, slope] = rise(p);
        let size = 1.0 + f64::from(field.rows.iter().flatten().fold(0.0f32, |m, z| m.max(z.abs())));
        let h = 0.01;
        let [forth, back] = [h, -h].map(beside);
        let difference = (height(forth) - height(back)) / f64::from(2.0 * h);
        let bend = (rise(forth)[1] - rise(back)[1]) / f64::from(2.0 * h);
        let all = [
            (height(p) - field.at(p, [0, 0]) - f64::from(raise[0])) / (1e-5 * size),
            (z - height(p)).abs() / (1e-5 * size),
            (slope - difference).abs() / (2e-3 * size),
            (slope - f64::from(reach[0])) / (1e-4 * size),
            (bend - f64::from(reach[2])).max(f64::from(reach[1]) - bend) / (2e-3 * size),
        ];
        most.iter_mut().zip(all).for_each(|(most, one)| *most = most.max(one));
    }
    most
}

#[test]
fn surfaces_in_cells_keep_to_their_bounds() {
    for text in SURFACES {
        let surface = Surface::new(text);
        let mut random = Random::new(11);
        for _ in 0..60 {
            let field = Field::random(&mut random);
            let found = broken(&surface, &field, [&field; 2], &mut random);
            assert!(found.iter().all(|x| *x <= 1.0), "{text}: {found:?}, {:?}", field.rows);
        }
    }
}

#[test]
fn planted_patches_break_them() {
    let surface = Surface::new(SURFACES[0]);
    let mut random = Random::new(12);
    let mut most = [[0.0f64; 5]; 2];
    for _ in 0..60 {
        let field = Field::random(&mut random);
        let flat = Field { rows: field.rows.map(|row| row.map(|z| 0.05 * z)), ..field.clone() };
        for (most, told) in most.iter_mut().zip([[&flat, &field], [&field, &flat]]) {
            let found = broken(&surface, &field, told, &mut random);
            most.iter_mut().zip(found).for_each(|(most, one)| *most = most.max(one));
        }
    }
    let [heights, bounds] = most;
    assert!(heights[1] > 10.0 && heights[2] > 10.0, "{heights:?}");
    assert!(bounds[..3].iter().all(|x| *x <= 1.0) && bounds[3] > 10.0 && bounds[4] > 2.0, "{bounds:?}");
}

//! Structs and constants shared with the shaders, compared with what naga reads.

use super::super::code::Code;
use super::super::layout::{self, PAIR_BYTES, Params, State};
use super::super::shader::{Kernel, source};
use super::super::shape::{Shape, Windows};
use super::programs::picture;
use crate::config::Config;

fn parse(kernel: Kernel, code: &Code, shape: &Shape) -> wgpu::naga::Module {
    let text = source(kernel, shape, code).unwrap();
    wgpu::naga::front::wgsl::parse_str(&text)
        .unwrap_or_else(|error| panic!("{}: {}", kernel.name(), error.emit_to_string(&text)))
}

fn sample() -> (Code, Shape) {
    let mut code = picture(1);
    code.functions += "fn shade(x: f32, y: f32) -> vec4<f32> { return vec4<f32>(x, y, 0.0, 1.0); }";
    let shape = Shape::new(&code, &Config::default(), 3, true).unwrap();
    (code, shape)
}

/// Members of a struct with their offsets, and its size.
fn members(module: &wgpu::naga::Module, name: &str) -> (Vec<(String, usize)>, u64) {
    let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let Some((_, wgpu::naga::Type { inner: wgpu::naga::TypeInner::Struct { members, span }, .. })) = found
    else {
        panic!("no struct {name}")
    };
    let list = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize)).collect();
    (list, u64::from(*span))
}

fn owned(fields: &[(&str, usize)]) -> Vec<(String, usize)> {
    fields.iter().map(|(name, offset)| ((*name).to_owned(), *offset)).collect()
}

#[test]
fn structs_have_the_same_members_offsets_and_sizes() {
    let (code, shape) = sample();
    let module = parse(Kernel::Decode, &code, &shape);
    assert_eq!(members(&module, "Params"), (owned(Params::FIELDS), size_of::<Params>() as u64));
    assert_eq!(members(&module, "State"), (owned(State::FIELDS), size_of::<State>() as u64));
    assert_eq!(members(&module, "Pair").1, PAIR_BYTES);
}

#[test]
fn a_planted_difference_of_layouts_is_seen() {
    let (code, shape) = sample();
    let module = parse(Kernel::Decode, &code, &shape);
    let mut fields = owned(Params::FIELDS);
    fields.swap(1, 2);
    assert_ne!(members(&module, "Params").0, fields);
}

fn constant(module: &wgpu::naga::Module, name: &str) -> u32 {
    let found = module.constants.iter().find(|(_, constant)| constant.name.as_deref() == Some(name));
    let Some((_, constant)) = found else { panic!("no constant {name}") };
    match module.global_expressions[constant.init] {
        wgpu::naga::Expression::Literal(wgpu::naga::Literal::U32(value)) => value,
        ref other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn constants_have_the_same_values() {
    let (code, shape) = sample();
    let module = parse(Kernel::Execute, &code, &shape);
    for (name, value) in [
        ("NO_TASK", layout::NO_TASK),
        ("RESUME", layout::RESUME),
        ("RUNNING", layout::RUNNING),
        ("DONE", layout::DONE),
        ("NEEDS_MEMORY", layout::NEEDS_MEMORY),
        ("STUCK", layout::STUCK),
        ("FLAG_MEMORY", layout::FLAG_MEMORY),
        ("FLAG_EXHAUSTED", layout::FLAG_EXHAUSTED),
        ("FLAG_LOOPS", layout::FLAG_LOOPS),
        ("STRIDE", shape.stride()),
        ("RECORD", shape.record()),
    ] {
        assert_eq!(constant(&module, name), value, "{name}");
    }
}

#[test]
fn every_kernel_is_valid_whatever_its_sizes() {
    use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};
    let (mut code, shape) = sample();
    for (can_exhaust, windows) in [(false, Windows::Private), (true, Windows::Workgroup)] {
        let shape = Shape { can_exhaust, windows, lanes: 32, ..shape.clone() };
        for kernel in Kernel::ALL {
            let module = parse(kernel, &code, &shape);
            Validator::new(ValidationFlags::all(), Capabilities::empty())
                .validate(&module)
                .unwrap_or_else(|error| panic!("{}: {error:?}", kernel.name()));
        }
        code.longest_emission = 12;
    }
}

//! Arguments from the command line.

use super::*;
use crate::argument::parse_arguments;
use crate::codes::*;
use crate::typed::{ExprKind, Literal, Type};

const MODULE: &str = "use terrain; struct S(a: f32, b: i32); const K = 3; fn double(x: f32) -> f32 = x * 2;
    fn noise(p: vec2) -> f32 = p.x; raster r: f32;";

#[test]
fn values_of_every_type() {
    let module = accepts(MODULE).module;
    let option = |ty| {
        let at = module.enums.iter().position(|e| e.name == "Option").expect("of the prelude");
        Type::Enum(crate::types::EnumId(at as u32), vec![ty])
    };
    let surface = Type::Fn(vec![Type::Vec(2)], Box::new(Type::F32));
    let strukt = module.structs.iter().position(|s| s.name == "S").expect("of the test");
    for (text, ty) in [
        ("25", Type::I32),
        ("-3", Type::I32),
        ("1.5", Type::F32),
        ("2", Type::F32),
        ("7", Type::U32),
        ("true", Type::Bool),
        ("vec3(1,2,3)", Type::Vec(3)),
        ("Some(3)", option(Type::F32)),
        ("None", option(Type::I32)),
        ("(1, 2.0)", Type::Tuple(vec![Type::I32, Type::F32])),
        ("[1,2]", Type::Array(Box::new(Type::I32), 2)),
        ("double", Type::Fn(vec![Type::F32], Box::new(Type::F32))),
        ("|x| double(x) + 1", Type::Fn(vec![Type::F32], Box::new(Type::F32))),
        ("bilinear", surface.clone()),
        ("noise", surface.clone()),
        ("r", surface),
        ("S(a: 1, b: K)", Type::Struct(crate::types::StructId(strukt as u32), vec![])),
    ] {
        let argument = parse_arguments(&module, text, &ty)
            .unwrap_or_else(|r| panic!("{text}\n{}", crate::report::render(&r, false)));
        assert_eq!(argument.expr.ty, ty, "{text}");
    }
    let user = module.function("noise");
    let noise = parse_arguments(&module, "noise", &Type::Fn(vec![Type::Vec(2)], Box::new(Type::F32)));
    assert!(matches!(noise.expect("checked above").expr.kind, ExprKind::Function(id, _) if Some(id) == user));
    let negative = parse_arguments(&module, "-2147483648", &Type::I32).expect("fits");
    assert!(matches!(negative.expr.kind, ExprKind::Literal(Literal::I32(i32::MIN))));
}

#[test]
fn the_users_names_come_first() {
    let module = accepts("use terrain; enum Mine { None, Other } struct Ray(t: f32);").module;
    let at = module.enums.iter().position(|e| e.name == "Mine").expect("of the test") as u32;
    let mine = Type::Enum(crate::types::EnumId(at), vec![]);
    assert_eq!(parse_arguments(&module, "None", &mine).expect("the user's").expr.ty, mine);
    let ray = module.structs.iter().position(|s| s.name == "Ray" && s.fields.len() == 1).expect("of the test")
        as u32;
    let ray = Type::Struct(crate::types::StructId(ray), vec![]);
    assert_eq!(parse_arguments(&module, "Ray(1)", &ray).expect("the user's").expr.ty, ray);
}

#[test]
fn mistakes_are_reported() {
    let module = accepts(MODULE).module;
    for (text, ty, code) in [
        ("", Type::I32, SYNTAX),
        ("1 2", Type::I32, SYNTAX),
        ("(1", Type::I32, UNCLOSED),
        ("1.5", Type::I32, MISMATCH),
        ("2147483648", Type::I32, LITERAL_RANGE),
        ("doubel", Type::F32, UNKNOWN_NAME),
        ("double", Type::F32, MISMATCH),
        ("fn", Type::F32, SYNTAX),
        // These also point at definitions, which are in another text.
        ("double(1, 2)", Type::F32, ARGUMENTS),
        ("S(a: 1)", Type::F32, MISSING_FIELD),
        ("trace(bilinear)", Type::F32, ARGUMENTS),
    ] {
        let report = parse_arguments(&module, text, &ty).expect_err(text);
        assert_eq!(report.diagnostics[0].code, code, "{text}");
        assert!(crate::report::render(&report, false).contains(code.as_str()));
    }
}

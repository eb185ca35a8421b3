//! Random core programs in text form, for differential tests. The same seed gives the same program.
//!
//! Every function takes its depth first, returns at once when that is not positive, and passes one less to what it
//! calls, so every program ends. Any function may call any other, in branches and loops too.

use std::fmt::Write;

use crate::core::{Const, Intrinsic, Scalar};
use crate::interpret::Host;

/// Small generator of good enough numbers (splitmix64).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.word() % n as u64) as usize
    }

    fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())]
    }
}

/// Answers intrinsics and live words with something that depends on the arguments.
pub struct TestHost;

impl Host for TestHost {
    fn intrinsic(&self, intrinsic: Intrinsic, args: &[Const]) -> Option<Vec<Const>> {
        let mixed = args.iter().fold(intrinsic as u32, |h, c| h.wrapping_mul(31).wrapping_add(c.word()));
        let word = |(i, scalar): (usize, &Scalar)| match scalar {
            Scalar::Bool => Const::Bool(mixed >> (i % 32) & 1 == 1),
            _ => Const::f32((mixed.wrapping_add(i as u32) % 1000) as f32),
        };
        Some(intrinsic.results().iter().enumerate().map(word).collect())
    }

    fn live(&self, word: u32) -> Option<u32> {
        Some(word + 1)
    }
}

const SCALARS: [Scalar; 4] = [Scalar::Bool, Scalar::I32, Scalar::U32, Scalar::F32];

struct Signature {
    name: String,
    params: Vec<Scalar>,
    results: Vec<Scalar>,
}

struct Generator {
    random: Random,
    out: String,
    signatures: Vec<Signature>,
    /// Variables in scope.
    scope: Vec<(String, Scalar)>,
    names: usize,
    /// Statements that the function may still get.
    budget: usize,
    /// Task calls that the function may still get.
    calls: usize,
    /// In the part that only runs for a positive depth, which defines `n`.
    deep: bool,
}

/// A program whose entry `f0` takes `(i32, bool, i32, u32, f32)`.
pub fn program(seed: u64) -> String {
    let mut random = Random::new(seed);
    let mut signatures = Vec::new();
    for i in 0..1 + random.below(4) {
        let mut params = vec![Scalar::I32];
        match i {
            0 => params.extend(SCALARS),
            _ => params.extend((0..random.below(4)).map(|_| random.pick(&SCALARS))),
        }
        let results = (0..1 + random.below(3)).map(|_| random.pick(&SCALARS)).collect();
        signatures.push(Signature { name: format!("f{i}"), params, results });
    }
    let out = "live l: (i32, f32)\nentry f0\n".to_string();
    let (scope, names) = (Vec::new(), 0);
    let mut generator = Generator { random, out, signatures, scope, names, budget: 0, calls: 0, deep: false };
    for i in 0..generator.signatures.len() {
        generator.function(i);
    }
    generator.out
}

impl Generator {
    fn function(&mut self, i: usize) {
        let params = self.signatures[i].params.clone();
        let results = self.signatures[i].results.clone();
        self.scope.clear();
        self.names = 0;
        self.budget = 25;
        self.calls = 3;
        let params: Vec<_> = params.into_iter().map(|s| self.define(s)).collect();
        let mark = self.random.pick(&["", "", "@task ", "@inline "]);
        let kinds: Vec<_> = results.iter().map(|s| s.name()).collect();
        let _ = writeln!(self.out, "{mark}fn f{i}({}) -> ({}) {{", params.join(", "), kinds.join(", "));
        self.out += "end: bool = le.i32(v0, 0)\n";
        let outer = self.scope.len();
        let dst = self.defines(&results);
        let inner = self.scope.split_off(outer);
        let _ = writeln!(self.out, "{} = if end {{", dst.join(", "));
        self.yields(&results);
        self.out += "} else {\nn: i32 = sub.i32(v0, 1)\n";
        self.deep = true;
        let before = self.scope.len();
        self.stmts(0);
        self.yields_digest(&results);
        self.scope.truncate(before);
        self.deep = false;
        self.out += "}\n";
        self.scope.extend(inner);
        self.stmts(1);
        match self.random.one_in(2) {
            true => self.yields_digest(&results),
            // Nothing after the `if`, so that calls in it may be tail calls.
            false => self.yields(&results),
        }
        self.out += "}\n";
    }

    fn define(&mut self, scalar: Scalar) -> String {
        let name = format!("v{}", self.names);
        self.names += 1;
        self.scope.push((name.clone(), scalar));
        format!("{name}: {}", scalar.name())
    }

    fn defines(&mut self, scalars: &[Scalar]) -> Vec<String> {
        scalars.iter().map(|s| self.define(*s)).collect()
    }

    fn atom(&mut self, scalar: Scalar) -> String {
        let found: Vec<_> = self.scope.iter().filter(|(_, s)| *s == scalar).map(|(n, _)| n.clone()).collect();
        if found.is_empty() || self.random.one_in(6) {
            return match scalar {
                Scalar::Bool => self.random.pick(&["true", "false"]),
                Scalar::I32 => self.random.pick(&["0", "1", "-1", "2", "7", "-2147483648"]),
                Scalar::U32 => self.random.pick(&["0u", "1u", "3u", "4294967295u"]),
                Scalar::F32 => self.random.pick(&["0.0", "-0.0", "1.0", "0.5", "-3.25", "nan", "1e20"]),
            }
            .into();
        }
        // Rather a late one, so that much of a program matters to its results.
        let n = found.len();
        found[self.random.below(n).max(self.random.below(n)).max(self.random.below(n))].clone()
    }

    fn atoms(&mut self, scalars: &[Scalar]) -> String {
        scalars.iter().map(|s| self.atom(*s)).collect::<Vec<_>>().join(", ")
    }

    fn yields(&mut self, scalars: &[Scalar]) {
        let atoms = self.atoms(scalars);
        let _ = writeln!(self.out, "yield {atoms}");
    }

    /// Yields words that depend on the last few variables, so that most of a program matters.
    fn yields_digest(&mut self, scalars: &[Scalar]) {
        let mut hash = "1u".to_string();
        for (name, scalar) in self.scope.iter().rev().take(6).cloned().collect::<Vec<_>>() {
            let id = self.names;
            self.names += 1;
            let steps = match scalar {
                Scalar::F32 => format!("x{id}: i32 = to_i32.f32({name}) w{id}: u32 = to_u32.i32(x{id})"),
                _ => format!("w{id}: u32 = to_u32.{}({name})", scalar.name()),
            };
            self.out +=
                &format!("{steps} m{id}: u32 = mul.u32({hash}, 31u) h{id}: u32 = add.u32(m{id}, w{id})\n");
            hash = format!("h{id}");
        }
        let mut results = Vec::new();
        for scalar in scalars {
            let id = self.names;
            self.names += 1;
            self.out += &match scalar {
                Scalar::Bool => {
                    format!("l{id}: u32 = and.u32({hash}, 4u) r{id}: bool = to_bool.u32(l{id})\n")
                }
                Scalar::I32 => format!("r{id}: i32 = to_i32.u32({hash})\n"),
                Scalar::U32 => format!("r{id}: u32 = xor.u32({hash}, {id}u)\n"),
                Scalar::F32 => {
                    format!("l{id}: u32 = and.u32({hash}, 1023u) r{id}: f32 = to_f32.u32(l{id})\n")
                }
            };
            results.push(format!("r{id}"));
        }
        let _ = writeln!(self.out, "yield {}", results.join(", "));
    }

    /// Statements and results; leaves the scope as it was.
    fn block(&mut self, results: &[Scalar], depth: usize) {
        let outer = self.scope.len();
        self.stmts(depth);
        self.yields(results);
        self.scope.truncate(outer);
    }

    fn stmts(&mut self, depth: usize) {
        for _ in 0..self.random.below(7) {
            if self.budget > 0 {
                self.budget -= 1;
                self.stmt(depth);
            }
        }
    }

    fn stmt(&mut self, depth: usize) {
        match self.random.below(10) {
            0 | 1 if depth < 3 => self.branch(depth),
            2 if depth < 2 => self.looped(depth),
            3..=5 if self.calls > 0 && self.deep => self.call(),
            6 if self.random.one_in(3) => self.host_call(),
            _ => self.prim(),
        }
    }

    fn prim(&mut self) {
        let row = &crate::core::prims::PRIMS[self.random.below(crate::core::prims::PRIMS.len())];
        let on = self.random.pick(row.on);
        let n = match row.operands {
            crate::core::prims::Operands::Same(n) => n as usize,
            crate::core::prims::Operands::Select => 3,
            crate::core::prims::Operands::Index => 2 + self.random.below(3),
        };
        let scalars: Vec<_> = (0..n).map(|i| row.prim.operand(on, i)).collect();
        let args = self.atoms(&scalars);
        let dst = self.define(row.prim.result(on));
        let _ = writeln!(self.out, "{dst} = {}.{}({args})", row.name, on.name());
    }

    fn host_call(&mut self) {
        if self.random.one_in(2) {
            let dst = self.define(Scalar::F32);
            let _ = writeln!(self.out, "{dst} = live(1)");
            return;
        }
        let intrinsic = self.random.pick(Intrinsic::ALL);
        let args = self.atoms(intrinsic.params());
        let dst = self.defines(intrinsic.results()).join(", ");
        let _ = writeln!(self.out, "{dst} = @{}({args})", intrinsic.name());
    }

    fn call(&mut self) {
        self.calls -= 1;
        let callee = self.random.below(self.signatures.len());
        let (params, results) =
            (self.signatures[callee].params.clone(), self.signatures[callee].results.clone());
        let args = self.atoms(&params[1..]);
        let dst = self.defines(&results).join(", ");
        let name = self.signatures[callee].name.clone();
        let comma = if params.len() > 1 { ", " } else { "" };
        let _ = writeln!(self.out, "{dst} = call {name}(n{comma}{args})");
    }

    fn branch(&mut self, depth: usize) {
        let results: Vec<_> = (0..1 + self.random.below(2)).map(|_| self.random.pick(&SCALARS)).collect();
        let cond = self.atom(Scalar::Bool);
        let outer = self.scope.len();
        let dst = self.defines(&results);
        let inner = self.scope.split_off(outer);
        let _ = writeln!(self.out, "{} = if {cond} {{", dst.join(", "));
        self.block(&results, depth + 1);
        self.out += "} else {\n";
        self.block(&results, depth + 1);
        self.out += "}\n";
        self.scope.extend(inner);
    }

    fn looped(&mut self, depth: usize) {
        let kind = self.random.pick(&["fold", "sum"]);
        let accumulator = if kind == "sum" { Scalar::I32 } else { self.random.pick(&SCALARS) };
        let limit = self.random.pick(&["0", "1", "3", "n3"]);
        let id = self.names;
        if limit == "n3" {
            let x = self.atom(Scalar::I32);
            let _ = writeln!(self.out, "k{id}: i32 = and.i32({x}, 3)");
        }
        let limit = if limit == "n3" { format!("k{id}") } else { limit.into() };
        let init = self.atom(accumulator);
        let outer = self.scope.len();
        let dst = self.defines(&[Scalar::I32, accumulator]);
        let after = self.scope.split_off(outer);
        let _ = writeln!(
            self.out,
            "{} = loop {kind} (i{id}: i32 = 0, a{id}: {} = {init}) while {{ c{id}: bool = lt.i32(i{id}, {limit}) yield c{id} }} do {{",
            dst.join(", "),
            accumulator.name()
        );
        self.scope.push((format!("i{id}"), Scalar::I32));
        if kind == "fold" {
            self.scope.push((format!("a{id}"), accumulator));
        }
        self.stmts(depth + 1);
        let word = self.atom(accumulator);
        let _ = writeln!(self.out, "j{id}: i32 = add.i32(i{id}, 1)");
        if kind == "sum" {
            let _ = writeln!(self.out, "b{id}: i32 = add.i32(a{id}, {word})\nyield j{id}, b{id}\n}}");
        } else {
            let _ = writeln!(self.out, "yield j{id}, {word}\n}}");
        }
        self.scope.truncate(outer);
        self.scope.extend(after);
    }
}

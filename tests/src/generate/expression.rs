//! Expressions of random programs: every answer 0 is a leaf, so that missing genes end the tree.

use super::{COST_LIMIT, COUNTER_LIMIT, Generator, Span, Type};

/// What an expression may use.
pub(super) struct Scope {
    /// Types of the names `v0`, `v1`, ..
    locals: Vec<Type>,
    /// The function around it, where it may call itself: name, parameters, result.
    pub own: Option<(String, Vec<Type>, Type)>,
    pub own_calls: usize,
    /// Lambdas capture nothing that holds functions: what this place yields comes round to it again, and a function value
    /// that captures itself over and over has no size.
    pub closed: bool,
    /// How often this place is evaluated in one call.
    weight: f64,
    pub cost: f64,
}

impl Scope {
    pub fn new(params: impl IntoIterator<Item = Type>) -> Scope {
        Scope {
            locals: params.into_iter().collect(),
            own: None,
            own_calls: 0,
            closed: false,
            weight: 1.0,
            cost: 0.0,
        }
    }

    /// Runs `inner` with more names bound, evaluated `times` times; the function itself is out of reach where that
    /// is more than once.
    pub(super) fn within<T>(&mut self, bound: &[Type], times: f64, inner: impl FnOnce(&mut Scope) -> T) -> T {
        let (names, weight) = (self.locals.len(), self.weight);
        let own = if times > 1.0 { self.own.take() } else { None };
        self.locals.extend_from_slice(bound);
        self.weight *= times;
        let result = inner(self);
        self.locals.truncate(names);
        self.weight = weight;
        self.own = own.or_else(|| self.own.take());
        result
    }

    /// Runs `inner` where values that hold functions are only what the place itself makes.
    fn closed<T>(&mut self, closed: bool, inner: impl FnOnce(&mut Scope) -> T) -> T {
        let before = self.closed;
        self.closed |= closed;
        let result = inner(self);
        self.closed = before;
        result
    }

    pub(super) fn next_name(&self) -> String {
        format!("v{}", self.locals.len())
    }

    /// One more node.
    pub fn count(&mut self) {
        self.cost += self.weight;
    }

    pub(super) fn locals_len(&self) -> usize {
        self.locals.len()
    }

    fn affords(&self, cost: f64) -> bool {
        self.cost + self.weight * cost < COST_LIMIT
    }
}

impl Generator<'_> {
    /// An expression of the type that needs no parentheses around it as an argument.
    pub(super) fn expression(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        let from = self.genes.taken;
        let text = self.node(ty, depth, scope);
        self.spans.push(Span { from, to: self.genes.taken, ty: ty.clone() });
        text
    }

    fn node(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        scope.cost += scope.weight;
        if depth == 0 || !scope.affords(10.0) {
            return self.leaf(ty, scope);
        }
        match self.genes.pick(15) {
            0 => self.leaf(ty, scope),
            1..=4 => self.operation(ty, depth, scope),
            5 => {
                let c = self.expression(&Type::Bool, depth - 1, scope);
                let yes = self.expression(ty, depth - 1, scope);
                let no = self.expression(ty, depth - 1, scope);
                format!("(if {c} {{ {yes} }} else {{ {no} }})")
            }
            6 => self.let_block(ty, depth, scope),
            7 => self.match_on(ty, depth, scope),
            8 | 9 => self.call(ty, depth, scope).unwrap_or_else(|| self.leaf(ty, scope)),
            10 => self.own_call(ty, depth, scope).unwrap_or_else(|| self.leaf(ty, scope)),
            11 => self.fold(ty, depth, scope),
            12 | 13 => self.form(ty, depth, scope),
            _ => self.projection(ty, depth, scope),
        }
    }

    // ---- leaves ----

    pub(super) fn leaf(&mut self, ty: &Type, scope: &mut Scope) -> String {
        let known: Vec<usize> = (0..scope.locals.len()).filter(|i| scope.locals[*i] == *ty).collect();
        if !known.is_empty() && !self.genes.chance(25) {
            return format!("v{}", self.genes.one(&known));
        }
        match ty {
            Type::I32 => self.genes.one(I32S).to_string(),
            Type::F32 => self.genes.one(F32S).to_string(),
            Type::U32 => {
                // A literal would be read as u32 here, and a negative one refused.
                let variables: Vec<usize> =
                    (0..scope.locals.len()).filter(|i| scope.locals[*i] == Type::I32).collect();
                if variables.is_empty() || self.genes.chance(60) {
                    return self.genes.one(U32S).to_string();
                }
                format!("u32(v{})", self.genes.one(&variables))
            }
            Type::Bool => {
                let (a, b) = (self.leaf(&Type::I32, scope), self.leaf(&Type::I32, scope));
                format!("{a} {} {b}", self.genes.one(&["==", "<", ">=", "!=", ">", "<="]))
            }
            Type::Vec2 => format!("vec2({}, {})", self.leaf(&Type::F32, scope), self.leaf(&Type::F32, scope)),
            Type::Fn(of) => {
                let name = scope.next_name();
                let body = self.lambda_body(of, scope, |g, s| g.leaf(of, s));
                format!("|{name}: {}| {body}", self.type_name(of))
            }
            _ => self.construction(ty, 0, scope),
        }
    }

    /// A tuple, array, struct or variant.
    pub(super) fn construction(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        match ty {
            Type::Tuple(items) => format!("({})", self.arguments(items, depth, scope)),
            Type::Array(item) => {
                let items = vec![(**item).clone(); 3];
                format!("[{}]", self.arguments(&items, depth, scope))
            }
            Type::Struct(index) => {
                let fields = self.types.structs[*index].clone();
                let fields = self.arguments(&fields, depth, scope);
                format!("S{index}_{}({fields})", self.id)
            }
            Type::Enum(index) => {
                let variant = self.genes.pick(self.types.enums[*index].len());
                let fields = self.types.enums[*index][variant].clone();
                let name = self.variant_name(*index, variant);
                match fields.len() {
                    0 => name,
                    _ => format!("{name}({})", self.arguments(&fields, depth, scope)),
                }
            }
            plain => self.leaf(plain, scope),
        }
    }

    fn arguments(&mut self, types: &[Type], depth: usize, scope: &mut Scope) -> String {
        let depth = depth.saturating_sub(1);
        let items: Vec<String> = types.iter().map(|t| self.expression(t, depth, scope)).collect();
        items.join(", ")
    }

    // ---- operations ----

    fn operation(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        match ty {
            Type::I32 => self.integer("i32", &Type::I32, depth, scope),
            Type::U32 => self.integer("u32", &Type::U32, depth, scope),
            Type::F32 => self.float(depth, scope),
            Type::Bool => self.condition(depth, scope),
            Type::Vec2 => {
                let (a, b) = self.two(&Type::Vec2, depth, scope);
                match self.genes.pick(6) {
                    5 => self.gradient(depth, scope),
                    0 => format!("({a}).yx"),
                    1 => format!("grid2(({a}) + ({b}))"),
                    2 => format!("grid2(({a}) - ({b}))"),
                    3 => format!("grid2(({a}) * ({b}))"),
                    _ => format!("grid2(({a}) * {})", self.leaf(&Type::F32, scope)),
                }
            }
            Type::Fn(of) => self.function_value(of, depth, scope),
            Type::Struct(index) if self.genes.chance(40) => {
                let field = self.genes.pick(self.types.structs[*index].len());
                let field_type = self.types.structs[*index][field].clone();
                let base = self.expression(ty, depth - 1, scope);
                let value = self.expression(&field_type, depth - 1, scope);
                format!("(({base}) with (f{field}: {value}))")
            }
            other => self.construction(other, depth, scope),
        }
    }

    pub(super) fn two(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> (String, String) {
        (self.expression(ty, depth - 1, scope), self.expression(ty, depth - 1, scope))
    }

    fn integer(&mut self, name: &str, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        match self.genes.pick(18) {
            13 => format!("{name}({})", self.expression(&Type::Bool, depth - 1, scope)),
            14 => format!("{name}({})", self.expression(&Type::F32, depth - 1, scope)),
            15 if name == "i32" => format!("-({})", self.expression(ty, depth - 1, scope)),
            15 | 16 => format!("!({})", self.expression(ty, depth - 1, scope)),
            17 => self.sum(ty, depth, scope),
            chosen => {
                let (a, b) = self.two(ty, depth, scope);
                match INTEGER_OPERATIONS.get(chosen) {
                    Some(op) => format!("(({a}) {op} ({b}))"),
                    None => format!("{}({a}, {b})", if chosen % 2 == 0 { "min" } else { "max" }),
                }
            }
        }
    }

    fn float(&mut self, depth: usize, scope: &mut Scope) -> String {
        match self.genes.pick(10) {
            9 => self.derivative(depth, scope),
            6 => format!("grid(f32(i32({})))", self.expression(&Type::I32, depth - 1, scope)),
            7 => format!("grid(sqrt(abs({})))", self.expression(&Type::F32, depth - 1, scope)),
            8 => format!("f32({})", self.expression(&Type::Bool, depth - 1, scope)),
            chosen => {
                let (a, b) = self.two(&Type::F32, depth, scope);
                match chosen {
                    0 => format!("grid(({a}) + ({b}))"),
                    1 => format!("grid(({a}) - ({b}))"),
                    2 => format!("grid(({a}) * ({b}))"),
                    3 => format!("grid(({a}) / (1.0 + abs({b})))"),
                    4 => format!("min({a}, {b})"),
                    _ => format!("max({a}, floor({b}))"),
                }
            }
        }
    }

    fn condition(&mut self, depth: usize, scope: &mut Scope) -> String {
        match self.genes.pick(8) {
            0..=2 => {
                let ty = self.genes.one(&[Type::I32, Type::U32, Type::F32]).clone();
                let (a, b) = self.two(&ty, depth, scope);
                format!("(({a}) {} ({b}))", self.genes.one(&["<", "==", ">=", "!=", "<=", ">"]))
            }
            3 => {
                let (a, b) = self.two(&Type::Bool, depth, scope);
                format!("(({a}) && ({b}))")
            }
            4 => {
                let (a, b) = self.two(&Type::Bool, depth, scope);
                format!("(({a}) || ({b}))")
            }
            5 => format!("!({})", self.expression(&Type::Bool, depth - 1, scope)),
            6 => {
                let ty = self.comparable_type();
                let (a, b) = self.two(&ty, depth, scope);
                format!("(({a}) == ({b}))")
            }
            _ => {
                let op = self.genes.one(&["any", "all"]).to_string();
                self.range(&op, &Type::Bool, depth, scope)
            }
        }
    }

    // ---- binding ----

    fn let_block(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        let bound = self.param_type();
        let value = self.expression(&bound, depth - 1, scope);
        let annotation = format!(": {}", self.type_name(&bound));
        let first = scope.locals.len();
        if let (Type::Tuple(items), true) = (&bound, self.genes.chance(60)) {
            let names: Vec<String> = (0..items.len()).map(|i| format!("v{}", first + i)).collect();
            let body = scope.within(items, 1.0, |s| self.expression(ty, depth - 1, s));
            return format!("{{ let ({}){annotation} = {value}; {body} }}", names.join(", "));
        }
        let body = scope.within(std::slice::from_ref(&bound), 1.0, |s| self.expression(ty, depth - 1, s));
        format!("{{ let v{first}{annotation} = {value}; {body} }}")
    }

    fn match_on(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        if self.types.enums.is_empty() || self.genes.chance(35) {
            return self.match_on_number(ty, depth, scope);
        }
        let of = self.genes.pick(self.types.enums.len());
        let scrutinee = self.expression(&Type::Enum(of), depth - 1, scope);
        let mut arms = Vec::new();
        for (index, fields) in self.types.enums[of].clone().iter().enumerate() {
            let first = scope.locals.len();
            let names: Vec<String> = (0..fields.len()).map(|i| format!("v{}", first + i)).collect();
            let fields_text =
                if names.is_empty() { String::new() } else { format!("({})", names.join(", ")) };
            let value = scope.within(fields, 1.0, |s| self.expression(ty, depth - 1, s));
            arms.push(format!("{}{fields_text} => {value}", self.variant_name(of, index)));
        }
        format!("(match {scrutinee} {{ {} }})", arms.join(", "))
    }

    fn match_on_number(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        let scrutinee = self.expression(&Type::I32, depth - 1, scope);
        let name = scope.next_name();
        let first = self.expression(ty, depth - 1, scope);
        let (guard, second) = scope.within(&[Type::I32], 1.0, |s| {
            (self.expression(&Type::Bool, depth - 1, s), self.expression(ty, depth - 1, s))
        });
        let third = self.expression(ty, depth - 1, scope);
        format!(
            "(match {scrutinee} {{ 0 | -1 | 7 => {first}, {name} if {guard} => {second}, _ => {third} }})"
        )
    }

    // ---- calls ----

    fn call(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> Option<String> {
        let values: Vec<usize> = (0..scope.locals.len())
            .filter(|i| matches!(&scope.locals[*i], Type::Fn(of) if **of == *ty))
            .collect();
        if !values.is_empty() && self.genes.chance(50) {
            let f = *self.genes.one(&values);
            scope.cost += scope.weight * 50.0;
            return Some(format!("v{f}({})", self.expression(ty, depth - 1, scope)));
        }
        if scope.closed && ty.holds_function(&self.types) {
            // It might capture what it is given.
            return None;
        }
        let fitting: Vec<usize> = (0..self.functions.len())
            .filter(|i| self.functions[*i].result == *ty && scope.affords(self.functions[*i].cost))
            .collect();
        if fitting.is_empty() {
            return None;
        }
        let f = *self.genes.one(&fitting);
        scope.cost += scope.weight * self.functions[f].cost;
        let (name, params) = (self.functions[f].name.clone(), self.functions[f].params.clone());
        let mut list = Vec::new();
        for (index, param) in params.iter().enumerate() {
            list.push(match index {
                0 if self.functions[f].recursive => self.genes.pick(COUNTER_LIMIT).to_string(),
                _ => self.expression(param, depth - 1, scope),
            });
        }
        Some(format!("{name}({})", list.join(", ")))
    }

    /// A call of the function itself with a smaller counter.
    fn own_call(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> Option<String> {
        let (name, params, result) = scope.own.clone()?;
        if result != *ty || scope.own_calls >= 2 {
            return None;
        }
        scope.own_calls += 1;
        let mut list = vec!["v0 - 1".to_string()];
        for (index, param) in params.iter().enumerate().skip(1) {
            let holds_function = param.holds_function(&self.types);
            list.push(match holds_function && !self.genes.chance(50) {
                true => format!("v{index}"),
                false => scope.closed(holds_function, |s| self.expression(param, depth - 1, s)),
            });
        }
        Some(format!("{name}({})", list.join(", ")))
    }

    fn function_value(&mut self, of: &Type, depth: usize, scope: &mut Scope) -> String {
        if let (true, Some(text)) = (self.genes.chance(25), self.partial_application(of, scope)) {
            return text;
        }
        let name = scope.next_name();
        let body = self.lambda_body(of, scope, |g, s| g.expression(of, depth - 1, s));
        format!("(|{name}: {}| {body})", self.type_name(of))
    }

    /// A cheap function with all but one of its arguments.
    fn partial_application(&mut self, of: &Type, scope: &mut Scope) -> Option<String> {
        let fits = |f: &super::Function| {
            f.result == *of
                && f.cost < 40.0
                && f.params[usize::from(f.recursive)..].contains(of)
                && !f.params.iter().any(|t| t.holds_function(&self.types))
        };
        let fitting: Vec<usize> = (0..self.functions.len()).filter(|i| fits(&self.functions[*i])).collect();
        if fitting.is_empty() {
            return None;
        }
        let f = *self.genes.one(&fitting);
        let (name, params) = (self.functions[f].name.clone(), self.functions[f].params.clone());
        let counter = usize::from(self.functions[f].recursive);
        let hole = counter + params[counter..].iter().position(|t| t == of)?;
        let mut list = Vec::new();
        for (index, param) in params.iter().enumerate() {
            list.push(match index {
                _ if index == hole => "_".into(),
                0 if counter == 1 => self.genes.pick(COUNTER_LIMIT).to_string(),
                _ => self.leaf(param, scope),
            });
        }
        Some(format!("{name}({})", list.join(", ")))
    }

    /// The body of a lambda, which sees what it may capture.
    fn lambda_body(
        &mut self,
        of: &Type,
        scope: &mut Scope,
        body: impl FnOnce(&mut Self, &mut Scope) -> String,
    ) -> String {
        let locals = scope.locals.clone();
        if scope.closed {
            for ty in scope.locals.iter_mut().filter(|t| t.holds_function(&self.types)) {
                // No expression is asked for of this type.
                *ty = Type::Tuple(Vec::new());
            }
        }
        let text = scope.within(std::slice::from_ref(of), 4.0, |s| body(self, s));
        scope.locals = locals;
        text
    }

    // ---- ranges ----

    fn bounds(&mut self, scope: &mut Scope) -> String {
        match self.genes.pick(4) {
            0 => "0..3".into(),
            1 => "-2..2".into(),
            2 => "2..1".into(),
            _ => format!("0..({} & 3)", self.leaf(&Type::I32, scope)),
        }
    }

    fn sum(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        self.range("sum", ty, depth, scope)
    }

    fn range(&mut self, op: &str, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        let bounds = self.bounds(scope);
        let name = scope.next_name();
        let body = scope.within(&[Type::I32], 4.0, |s| self.expression(ty, depth - 1, s));
        format!("{op}({bounds}, |{name}| {body})")
    }

    fn fold(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        let bounds = self.bounds(scope);
        let init = self.expression(ty, depth - 1, scope);
        let first = scope.locals.len();
        let holds_function = ty.holds_function(&self.types);
        let body = scope.closed(holds_function, |s| {
            s.within(&[ty.clone(), Type::I32], 4.0, |s| self.expression(ty, depth - 1, s))
        });
        let annotation = self.type_name(ty);
        format!("fold({bounds}, {init}, |v{first}: {annotation}, v{}| {body})", first + 1)
    }

    // ---- parts of values ----

    fn projection(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> String {
        match self.genes.pick(4) {
            0 if *ty == Type::F32 => {
                let v = self.expression(&Type::Vec2, depth - 1, scope);
                format!("({v}).{}", self.genes.one(&["x", "y"]))
            }
            1 => {
                let array = self.expression(&Type::Array(Box::new(ty.clone())), depth - 1, scope);
                let index = self.expression(&Type::I32, depth - 1, scope);
                format!("({array})[{index}]")
            }
            2 => self.field(ty, depth, scope).unwrap_or_else(|| self.leaf(ty, scope)),
            _ => {
                let pair = self.expression(&Type::Tuple(vec![ty.clone(), Type::I32]), depth - 1, scope);
                format!("({pair}).0")
            }
        }
    }

    fn field(&mut self, ty: &Type, depth: usize, scope: &mut Scope) -> Option<String> {
        let found: Vec<(usize, usize)> = self
            .types
            .structs
            .iter()
            .enumerate()
            .flat_map(|(s, fields)| fields.iter().enumerate().map(move |(f, t)| (s, f, t)))
            .filter(|(_, _, t)| *t == ty)
            .map(|(s, f, _)| (s, f))
            .collect();
        if found.is_empty() {
            return None;
        }
        let (of, field) = *self.genes.one(&found);
        Some(format!("({}).f{field}", self.expression(&Type::Struct(of), depth - 1, scope)))
    }
}

const I32S: &[&str] =
    &["0", "1", "-1", "2", "7", "-3", "100", "2147483647", "(-2147483647 - 1)", "33", "65537"];
const U32S: &[&str] = &["0u", "1u", "3u", "31u", "4294967295u", "2147483648u", "65535u"];
const F32S: &[&str] = &["0.0", "1.0", "-1.0", "0.5", "-2.25", "100.0", "3.75", "-0.00390625"];
const INTEGER_OPERATIONS: &[&str] = &["+", "-", "*", "&", "|", "^", "/", "%", "<<", ">>"];

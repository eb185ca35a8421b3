//! Where lines end and how far they are indented.
//!
//! A pair of brackets is *broken* if its content stands on lines of its own. Inside, an element begins at the indentation of the
//! pair's line and one more; a line that goes on with an element has one more again. A pair that is not broken has no say, so what is broken
//! within it is indented by its own line only.

use super::WIDTH;
use super::lines::{INDENT, Line, Lines, text};
use super::spaces::space;
use super::tokens::{Role, Token};
use crate::lexer::Lexeme::*;

/// A pair of brackets.
#[derive(Clone, Debug)]
struct Pair {
    open: usize,
    close: usize,
    kind: Kind,
    broken: bool,
    /// Every element has a line of its own.
    each: bool,
    /// The pair around it.
    outer: Option<usize>,
    depth: usize,
    /// Commas at its own level.
    commas: usize,
    /// The next block of the same `if`.
    otherwise: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    List,
    Block,
    /// Arms of a match, variants of an enum.
    Cases,
}

/// The text of the tokens. Line ends that are added to long lines are noted in them.
pub fn layout(tokens: &mut [Token]) -> String {
    let mut pairs = pairs(tokens);
    breaks(tokens, &mut pairs);
    // Each turn breaks every long line once, so it is bounded by how brackets nest.
    for _ in 0..200 {
        let lines = lay(tokens, &pairs);
        let mut changed = false;
        for line in lines.iter().filter(|line| line.width() > WIDTH) {
            changed |= shorten(line, tokens, &mut pairs);
        }
        if !changed {
            return text(&lines);
        }
        chains(&mut pairs);
        outward(&mut pairs);
    }
    text(&lay(tokens, &pairs))
}

/// All pairs in the order of their opening brackets.
fn pairs(tokens: &[Token]) -> Vec<Pair> {
    let mut pairs: Vec<Pair> = Vec::new();
    let mut around: Vec<usize> = Vec::new();
    let mut of_token = vec![usize::MAX; tokens.len()];
    for (i, token) in tokens.iter().enumerate() {
        match token.lexeme {
            RParen | RBracket | RBrace => {
                around.pop();
            }
            Comma | FatArrow if token.role != Role::Inner => {
                if let Some(pair) = around.last().map(|p| &mut pairs[*p]) {
                    pair.commas += usize::from(token.lexeme == Comma);
                    if pair.kind == Kind::Block {
                        pair.kind = Kind::Cases;
                    }
                }
            }
            _ => {}
        }
        if let Some(close) = token.close {
            let kind = if token.lexeme == LBrace { Kind::Block } else { Kind::List };
            of_token[i] = pairs.len();
            let (outer, depth) = (around.last().copied(), around.len());
            around.push(pairs.len());
            let (broken, each) = (false, kind != Kind::List);
            pairs.push(Pair { open: i, close, kind, broken, each, outer, depth, commas: 0, otherwise: None });
        }
    }
    for pair in &mut pairs {
        if tokens[pair.close + 1].lexeme == Else {
            // `else {` or `else if condition {`, whose condition may have braces in brackets only or before `else`.
            let mut at = pair.close + 2;
            while at < tokens.len() && tokens[at].lexeme != LBrace {
                at = tokens[at].close.map_or(at, |close| close) + 1;
            }
            pair.otherwise = of_token.get(at).copied().filter(|p| *p != usize::MAX);
        }
    }
    pairs
}

/// Breaks what the writer has broken, and what is always broken.
fn breaks(tokens: &[Token], pairs: &mut [Pair]) {
    let ends_line = |token: &Token| token.comments.iter().any(|c| c.line);
    for pair in pairs.iter_mut() {
        let (first, last) = (&tokens[pair.open + 1], &tokens[pair.close]);
        let opened = first.lines > 0 || first.comments.iter().any(|c| c.lines > 0 || c.line);
        let closed = ends_line(last) || (pair.kind != Kind::List && last.lines > 0);
        pair.broken = pair.close > pair.open + 1 && (opened || closed) || ends_line(last);
    }
    // At the level of each block: `;` behind a name, line ends between arms, comments.
    let mut around: Vec<usize> = Vec::new();
    let mut next = 0;
    for (i, token) in tokens.iter().enumerate() {
        if matches!(token.lexeme, RParen | RBracket | RBrace) {
            around.pop();
        }
        if let Some(pair) = around.last().map(|p| &mut pairs[*p]) {
            pair.broken |= match pair.kind {
                Kind::List => ends_line(token) && declares(tokens, pair.open),
                Kind::Block => token.lexeme == Semi || ends_line(token),
                Kind::Cases => token.lines > 0 || ends_line(token),
            };
        }
        if token.close.is_some() {
            debug_assert_eq!(pairs[next].open, i);
            around.push(next);
            next += 1;
        }
    }
    outward(pairs);
    chains(pairs);
    outward(pairs);
}

/// Whether a bracket opens the fields of a struct or the parameters of a function, whose comments want lines of their own.
fn declares(tokens: &[Token], open: usize) -> bool {
    let before = tokens[..open].iter().rev().skip_while(|token| token.role != Role::GenericClose).skip(1);
    let generic = tokens[..open].last().is_some_and(|token| token.role == Role::GenericClose);
    let name = match generic {
        true => before.take_while(|token| token.role != Role::GenericOpen).count() + 2,
        false => 0,
    };
    let at = |back: usize| open.checked_sub(name + back).map(|at| tokens[at].lexeme);
    matches!(at(1), Some(Ident(_))) && matches!(at(2), Some(Struct | Fn))
}

/// Whether the comments before a token from `at` on stand on its line, before it.
fn leads(token: &Token, at: usize) -> bool {
    let comments = &token.comments[at..];
    token.lines == 0
        && comments.iter().all(|comment| !comment.line && !comment.text.contains('\n'))
        && comments.iter().skip(1).all(|comment| comment.lines == 0)
}

/// Braces around broken braces are broken.
fn outward(pairs: &mut [Pair]) {
    for at in (0..pairs.len()).rev() {
        if !(pairs[at].broken && pairs[at].kind != Kind::List) {
            continue;
        }
        let mut outer = pairs[at].outer;
        while let Some(pair) = outer.map(|o| &mut pairs[o]) {
            if pair.kind != Kind::List {
                pair.broken = true;
                break;
            }
            outer = pair.outer;
        }
    }
}

/// All blocks of an `if` are broken or none.
fn chains(pairs: &mut [Pair]) {
    for at in (0..pairs.len()).rev() {
        if let Some(next) = pairs[at].otherwise {
            pairs[at].broken |= pairs[next].broken;
        }
    }
    for at in 0..pairs.len() {
        if let Some(next) = pairs[at].otherwise {
            pairs[next].broken |= pairs[at].broken;
        }
    }
}

/// Breaks a long line at its outermost brackets, braces first, or behind `=`; false if it has none.
fn shorten(line: &Line, tokens: &mut [Token], pairs: &mut [Pair]) -> bool {
    let (from, to) = line.tokens;
    let first = pairs.partition_point(|p| p.open < from);
    let inside: Vec<usize> = (first..pairs.len())
        .take_while(|p| pairs[*p].open < to)
        .filter(|p| !pairs[*p].broken && pairs[*p].close < to && pairs[*p].close > pairs[*p].open + 1)
        .collect();
    let Some(depth) = inside.iter().map(|p| pairs[*p].depth).min() else { return false };
    let outermost = || inside.iter().copied().filter(|p| pairs[*p].depth == depth);
    if let Some(brace) = outermost().find(|p| pairs[*p].kind != Kind::List) {
        pairs[brace].broken = true;
        return true;
    }
    let assigned = (from..to).find(|i| tokens[*i].lexeme == Assign).map(|i| i + 1);
    if let Some(value) = assigned.filter(|v| tokens[*v].lines == 0 && *v < to)
        && ends_with_element(tokens, to)
        && INDENT * (line.indent + 1) + width(&tokens[value..to]) <= WIDTH
        && !matches!(tokens[value].lexeme, Match | If | LBracket | LParen)
        && outermost().all(|p| !(pairs[p].open < value && value < pairs[p].close))
    {
        tokens[value].lines = 1;
        return true;
    }
    let longest = outermost().max_by_key(|p| (pairs[*p].close - pairs[*p].open, *p));
    let Some(chosen) = longest else { return false };
    pairs[chosen].broken = true;
    pairs[chosen].each = true;
    true
}

/// Columns of tokens on one line.
fn width(tokens: &[Token]) -> usize {
    let blanks = tokens.windows(2).filter(|pair| space(&pair[0], &pair[1])).count();
    tokens.iter().map(|token| token.text.chars().count()).sum::<usize>() + blanks
}

/// Whether the token before `to` ends an item or a `let`.
fn ends_with_element(tokens: &[Token], to: usize) -> bool {
    tokens[to - 1].lexeme == Semi
}

/// What holds between a pair of brackets.
struct Frame {
    /// The pair; none for the whole text.
    pair: Option<usize>,
    broken: bool,
    indent: usize,
    /// Of the line with the closing bracket.
    closing: usize,
}

fn lay(tokens: &[Token], pairs: &[Pair]) -> Vec<Line> {
    let mut lines = Lines::default();
    let mut frames = vec![Frame { pair: None, broken: true, indent: 0, closing: 0 }];
    let mut next_pair = 0;
    // Something on the line ends it.
    let mut ended = false;
    for (i, token) in tokens.iter().enumerate() {
        let end = i + 1 == tokens.len();
        let before = i.checked_sub(1).map(|b| &tokens[b]);
        let closes = matches!(token.lexeme, RParen | RBracket | RBrace);
        let frame = frames.last().expect("brackets are paired");
        let opened = before.is_none_or(|b| b.close.is_some() && frame.pair.is_some());
        let fresh = frame.broken && (opened || starts_element(tokens, i, frame.pair.is_none()));
        let first = fresh || end || closes || token.lexeme == Else || follows_attribute(tokens, i);
        let indent = if first { frame.indent } else { frame.indent + 1 };
        let comma = closes && frame.pair.is_some_and(|p| needs_comma(tokens, &pairs[p], i));
        if comma {
            lines.current.code.push(',');
        }
        let pair = frame.pair.map(|p| &pairs[p]);
        // Comments
        let element =
            fresh && !closes && (!opened || frame.pair.is_none()) && pair.is_none_or(|pair| pair.each);
        let leading = token.comments.iter().enumerate().position(|(at, _)| element && leads(token, at));
        for (at, comment) in token.comments.iter().enumerate() {
            let first = i == 0 && at == 0;
            let alone = ended || first || comment.lines > 0 || leading == Some(at);
            if alone {
                let apart = comment.lines > 1 && !(opened && at == 0);
                lines.begin(indent, apart, i);
                lines.comment(comment.text);
            } else if comment.line {
                lines.current.comment = Some(comment.text.to_owned());
            } else {
                if !lines.current.code.is_empty() {
                    lines.current.code.push(' ');
                }
                lines.comment(comment.text);
            }
            ended = comment.line;
        }
        if end {
            break;
        }
        // The line's end before the token
        let joined =
            token.lexeme == Else || matches!(token.lexeme, Comma | Semi | Colon) || (closes && !frame.broken);
        let forced = frame.broken
            && (closes || (opened && frame.pair.is_some()) || (fresh && pair.is_none_or(|pair| pair.each)));
        let dropped = token.lexeme == Comma && pair.is_some_and(|pair| drops_comma(pair, i));
        if dropped {
            continue;
        }
        if leading.is_none() && (ended || forced || (token.lines > 0 && !joined)) {
            let commented = !token.comments.is_empty();
            let apart = token.lines > 1 && !closes && (!opened || commented);
            let indent = if closes { frame.closing } else { indent };
            let open_before = opened && !commented;
            lines.begin(indent, apart && !open_before, i);
        } else if leading.is_some() {
            lines.current.code.push(' ');
        } else if let Some(before) = before
            && !lines.current.code.is_empty()
            && match token.comments.is_empty() {
                true => space(before, token),
                false => !matches!(token.lexeme, Comma | Semi | Colon | Dot | RParen | RBracket),
            }
        {
            lines.current.code.push(' ');
        }
        ended = false;
        lines.current.code.push_str(token.text);
        lines.current.tokens.1 = i + 1;
        // Brackets
        if closes {
            frames.pop();
        } else if token.close.is_some() {
            let pair = &pairs[next_pair];
            let line = lines.current.indent;
            let inner = if pair.broken { line + 1 } else { frame.indent };
            frames.push(Frame { pair: Some(next_pair), broken: pair.broken, indent: inner, closing: line });
            next_pair += 1;
        }
    }
    lines.finish()
}

/// Whether an element, a `let`, an arm or an item begins with this token, which is not the first.
fn starts_element(tokens: &[Token], i: usize, top: bool) -> bool {
    let before = &tokens[i - 1];
    match before.lexeme {
        Comma => !top && before.role != Role::Inner,
        Semi => true,
        _ if tokens[i].after_arm => true,
        RBrace if top => {
            matches!(tokens[i].lexeme, Use | Const | Param | Raster | Struct | Enum | Type | Fn | At)
        }
        _ => false,
    }
}

/// What follows an attribute, which may have a line of its own.
fn follows_attribute(tokens: &[Token], i: usize) -> bool {
    i >= 2 && tokens[i - 2].lexeme == At
}

/// A list whose bracket closes on a line of its own has a comma behind its last element.
fn needs_comma(tokens: &[Token], pair: &Pair, close: usize) -> bool {
    let last = tokens[close - 1].lexeme;
    pair.broken
        && pair.kind != Kind::Block
        && pair.commas > 0
        && last != Comma
        && (pair.kind == Kind::List || last != RBrace)
        && tokens[close].comments.iter().all(|c| c.line || c.lines > 0)
}

/// A list on one line has none.
fn drops_comma(pair: &Pair, comma: usize) -> bool {
    !pair.broken && comma + 1 == pair.close && pair.commas > 1
}

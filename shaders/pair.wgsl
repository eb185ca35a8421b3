// The tokens of a pair of neighbouring blocks, addressed as one sequence.

struct Span {
    first: u32,       // address of the first block's words
    first_size: u32,
    second: u32,
    size: u32,        // of both
}

fn span_of(pair: u32) -> Span {
    let first_size = pairs[pair].first_size;
    return Span(
        pairs[pair].first_block * STRIDE,
        first_size,
        pairs[pair].second_block * STRIDE,
        first_size + pairs[pair].second_size,
    );
}

fn token_at(span: Span, position: u32) -> u32 {
    return arena[select(span.second + position - span.first_size, span.first + position, position < span.first_size)];
}

fn is_function_at(span: Span, position: u32) -> bool {
    let in_first = position < span.first_size;
    let offset = select(position - span.first_size, position, in_first);
    let bits = arena[select(span.second, span.first, in_first) + BLOCK + (offset >> 5u)];
    return ((bits >> (offset & 31u)) & 1u) != 0u;
}

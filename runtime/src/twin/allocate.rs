//! Stage allocate: from the sizes of all outputs, what is granted and how long the stream becomes. A redex that
//! is not granted stays as it is: any subset of the redexes may be rewritten.

use super::execute::{Output, Record};

/// Bytes that a token takes in the stream, its mask bit included.
pub const TOKEN_BYTES: u64 = 5;

/// Where a record's tokens are, if they replace it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grant {
    /// Output and the range in its tokens.
    pub output: usize,
    pub from: usize,
    pub to: usize,
}

pub struct Allocation {
    /// One for each record of the queue.
    pub grants: Vec<Option<Grant>>,
    /// Tokens of the new stream.
    pub length: u64,
}

/// Tokens that a stream may have within `bytes`; a quarter is left to the lanes' windows.
pub fn room(bytes: u64) -> u64 {
    bytes / 4 * 3 / TOKEN_BYTES
}

/// Grants in stream order as long as the stream, `length` tokens before, stays within `room` tokens; what does
/// not make it longer is always granted.
pub fn allocate(queue: &[Record], outputs: &[Output], length: u64, room: u64) -> Allocation {
    let mut places = places(outputs);
    let mut length = length;
    let mut grant = |record: &Record| {
        let place = places.next().flatten()?;
        let before = (record.redex.to - record.redex.from) as u64;
        let after = (place.to - place.from) as u64;
        let granted = after <= before || length + after - before <= room;
        if granted {
            length = length + after - before;
        }
        granted.then_some(place)
    };
    let grants = queue.iter().map(&mut grant).collect();
    Allocation { grants, length }
}

/// The ranges of all records' tokens, in the queue's order; none for those that were left for later.
fn places(outputs: &[Output]) -> impl Iterator<Item = Option<Grant>> + '_ {
    outputs.iter().enumerate().flat_map(|(output, part)| {
        let starts = std::iter::once(0).chain(part.ends.iter().copied());
        let done = starts.zip(&part.ends).map(move |(from, to)| Some(Grant { output, from, to: *to }));
        done.chain(std::iter::repeat_n(None, part.left))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::twin::decode::Redex;
    use crate::twin::tokens::Tokens;

    #[test]
    fn grants_stop_where_the_room_ends() {
        let record = |from, at| Record { pair: 0, redex: Redex { from, at, task: 0, to: at + 1 } };
        let mut tokens = Tokens::default();
        tokens.push_literals(&[0; 9]);
        let outputs = [Output { tokens, ends: vec![4, 8, 9], ..Output::default() }];
        let queue = [record(0, 1), record(2, 3), record(4, 5)];
        let all = allocate(&queue, &outputs, 6, 100);
        assert!(all.grants.iter().all(Option::is_some));
        assert_eq!(all.length, 9);
        // The second would make it 10, the third makes it shorter.
        let some = allocate(&queue, &outputs, 6, 9);
        assert_eq!(some.grants.iter().map(Option::is_some).collect::<Vec<_>>(), [true, false, true]);
        assert_eq!(some.length, 7);
        let [mut all] = outputs;
        (all.ends, all.left) = (vec![4], 1);
        let second = Output { ends: vec![0], ..Output::default() };
        let later = allocate(&queue, &[all, second], 6, 100).grants;
        let grant = |output, to| Some(Grant { output, from: 0, to });
        assert_eq!(later, [grant(0, 4), None, grant(1, 0)]);
    }
}

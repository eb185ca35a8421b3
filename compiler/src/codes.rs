//! THE table of diagnostic codes: one row and one page in `docs/errors/` a code. Codes are stable; a retired one is
//! never used again.
//!
//! E01 lexical and syntax, E02 names and modules, E03 types, E04 patterns, E05 items and recursion,
//! W06 warnings, E09 not supported yet.

use std::fmt;

/// Stable identifier of a kind of diagnostic, such as `E0301`. Only this table makes one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Code(&'static str);

impl Code {
    pub const fn as_str(self) -> &'static str {
        self.0
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(self.0)
    }
}

macro_rules! codes {
    ($($name:ident $code:literal $title:literal;)*) => {
        $(pub const $name: Code = Code($code);)*

        /// Every code with what it is about.
        pub const ALL: &[(Code, &str)] = &[$((Code($code), $title)),*];
    };
}

codes! {
    BAD_CHARACTER "E0101" "a character that the language does not use";
    UNTERMINATED "E0102" "a comment or text that is never closed";
    BAD_NUMBER "E0103" "a malformed number";
    SYNTAX "E0104" "something else was expected here";
    TOO_DEEP "E0105" "nesting deeper than the compiler accepts";
    CHAINED "E0106" "comparisons cannot be chained";
    BLOCK_VALUE "E0107" "a block that does not end with its value";
    UNUSED_VALUE "E0108" "a value that nothing uses";
    IF_WITHOUT_ELSE "E0109" "an `if` without `else`";
    BAD_TUPLE "E0110" "a tuple or array with too few components";
    MISPLACED_HOLE "E0111" "a hole `_` outside a call's arguments";
    MISPLACED_RANGE "E0112" "a range outside the forms that take one";
    UNKNOWN_ATTRIBUTE "E0113" "an attribute that does not exist, stands twice or contradicts another";
    UNSTATED_TYPE "E0114" "a top-level function without stated types";
    MISPLACED_REST "E0115" "`..` that is not the last field of a pattern";
    TOO_LONG "E0116" "a source text that is too long";
    TOO_MANY "E0117" "more errors than are shown";
    ASSIGNMENT "E0118" "an assignment";
    FOREIGN_WORD "E0119" "a statement of another language";
    FOREIGN_OPERATOR "E0120" "an operator of another language";
    TYPE_FIRST "E0121" "a declaration that begins with its type";
    FIELD_BRACES "E0122" "fields in braces";
    CAST "E0123" "a cast";
    TEXT "E0124" "a text where a value belongs";
    PATH "E0125" "a name with `::`";
    BRANCH_BRACES "E0126" "a branch without braces";
    LOCAL_FUNCTION "E0127" "a function within a function";
    NOT_AN_ITEM "E0128" "something at top level that is no item";
    NO_VALUE "E0129" "a definition without its value";
    NOT_A_LAMBDA "E0130" "a lambda as other languages write it";
    REFERENCE "E0131" "a reference or pointer";
    UNCLOSED "E0132" "a bracket that is never closed";
    UNOPENED "E0133" "a bracket that closes nothing";
    FOREIGN_PATTERN "E0134" "a pattern of another language";

    DUPLICATE "E0201" "two definitions of one name";
    UNKNOWN_NAME "E0202" "a name that nothing defines";
    UNKNOWN_TYPE "E0203" "a type that nothing defines";
    UNKNOWN_MODULE "E0204" "a module that does not exist";
    UNKNOWN_FIELD "E0205" "a field that does not exist";
    DUPLICATE_FIELD "E0206" "a field given twice";
    MISSING_FIELD "E0207" "a field that is not given";
    NAMED_ARGUMENT "E0208" "named arguments where positions are needed";
    NEEDS_MODULE "E0209" "a name whose module is not in use";
    METHOD "E0210" "a call of a method";
    UNREADABLE_MODULE "E0211" "a module whose file cannot be read";
    MODULE_CYCLE "E0212" "modules that use each other in a circle";

    MISMATCH "E0301" "a value of another type than its place needs";
    LITERAL_RANGE "E0302" "a literal that does not fit its type";
    OPERATOR "E0303" "an operator that the operands' types do not have";
    BUILTIN "E0304" "a built-in function that the arguments' types do not have";
    ARGUMENTS "E0305" "the wrong number of arguments";
    NOT_A_FUNCTION "E0306" "a call of something that is not a function";
    UNKNOWN_TYPE_HERE "E0307" "a type that cannot be inferred";
    INFINITE_TYPE "E0308" "a type that would contain itself";
    TOO_LARGE "E0309" "a type of too many stream words";
    EQUALITY "E0310" "a comparison of functions";
    BAD_INDEX "E0311" "an index into something without elements";
    GENERIC_ARGUMENTS "E0312" "the wrong number of type arguments";
    ARRAY_LENGTH "E0313" "an array length that is not a positive integer constant";
    FORM_AS_VALUE "E0314" "a built-in form used as a value";
    NOT_A_STRUCT "E0315" "an update of something that is not a struct";

    MISSING_CASE "E0401" "a match that leaves cases out";
    REFUTABLE "E0402" "a pattern that may fail where it must fit";
    OR_PATTERN "E0403" "alternatives that bind different names";
    PATTERN_FIELDS "E0404" "a pattern with the wrong number of fields";
    TOO_COMPLEX "E0405" "a match too complex to check";
    NOT_A_CONSTRUCTOR "E0406" "a pattern that names neither a struct nor a variant";

    RECURSIVE_TYPE "E0501" "a data type that contains itself";
    CYCLIC_ALIAS "E0502" "a type alias that stands for itself";
    CYCLIC_CONSTANT "E0503" "a constant or parameter that needs its own value";
    POLYMORPHIC_RECURSION "E0504" "a generic function that calls itself with ever larger types";
    CONSTANT_PARAM "E0505" "a constant that reads a parameter";
    PARAM_RANGE "E0506" "a range on a parameter that has no order, or that leaves its default out";
    BAKED_SHAPE "E0507" "a baked function of the wrong shape";
    RASTER_TYPE "E0508" "a raster of a type it cannot hold";
    EMPTY_ITEM "E0509" "a struct or enum without anything in it";
    INLINE_RECURSION "E0510" "a recursive function that must be inlined";
    GROWING_FUNCTION "E0511" "a function value that captures itself over and over";
    NEVER_YIELDS "E0512" "a function that never yields its function value";
    TOO_MUCH_CODE "E0513" "a program that specialisation makes too large";
    NO_DERIVATIVE "E0515" "a derivative of something that has none";
    ENDLESS_DERIVATIVE "E0516" "a derivative that needs its own derivative";
    UNBOUNDED_SURFACE "E0517" "a traced surface without an upper bound";
    NOT_AN_ENTRY "E0514" "a function that cannot be an entry";

    UNREACHABLE_ARM "W0601" "an arm that can never be reached";
    MANY_WARNINGS "W0602" "more warnings than are shown";
    UNUSED_NAME "W0603" "a name that nothing uses";
    UNUSED_FUNCTION "W0604" "a function that no entry leads to";
    UNUSED_MODULE "W0605" "a module that nothing is taken from";
    UNUSED_PARAM "W0606" "a parameter that nothing reads";
    LOOKALIKE "W0607" "a new name in a pattern that reads like a variant or constant";

    LIVE_FUNCTION "E0906" "a live parameter whose functions cannot be replaced";
}

#[cfg(test)]
mod tests {
    use super::ALL;
    use std::collections::HashSet;

    #[test]
    fn codes_are_unique() {
        let codes: HashSet<_> = ALL.iter().map(|(code, _)| code).collect();
        assert_eq!(codes.len(), ALL.len());
    }
}

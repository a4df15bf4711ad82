//! Names for files: what a person knows the thing by, safe on every system, and each only once.

use std::collections::BTreeSet;

/// The name with everything that a file system or a shell may trip over replaced by underscores.
pub fn safe_file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect()
}

/// Safe names in the same order; what would come twice, in upper or lower case, gets a number.
pub(super) fn unique_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let mut free = |name: String| taken.insert(name.to_lowercase()).then_some(name);
    let mut unique = Vec::new();
    for name in names {
        let safe = safe_file_name(name);
        let candidates =
            std::iter::once(safe.clone()).chain((2_u32..).map(|number| format!("{safe}-{number}")));
        unique.extend(candidates.filter_map(&mut free).next());
    }
    unique
}

/// Numbers for things that have names: the number that a name ends in, so that a dataset that was opened here keeps its own,
/// else the first free one from `first` on.
pub(super) fn numbers_of<'a>(names: impl IntoIterator<Item = &'a str>, first: u32) -> Vec<u32> {
    let mut taken = BTreeSet::new();
    let own: Vec<Option<u32>> = names
        .into_iter()
        .map(|name| number_at_end(name).filter(|number| *number >= first && taken.insert(*number)))
        .collect();
    own.into_iter()
        .map(|own| {
            own.unwrap_or_else(|| {
                let free = (first..).find(|number| !taken.contains(number)).unwrap_or(first);
                taken.insert(free);
                free
            })
        })
        .collect()
}

/// Of `000019` or `obj_000005`; a name such as `mug 2` or `IMG_1234` counts too.
fn number_at_end(name: &str) -> Option<u32> {
    let digits = name.len() - name.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    // BOP's ids have six digits.
    name.get(name.len() - digits..).filter(|digits| (1..=6).contains(&digits.len()))?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_safe_and_come_once() {
        let names = unique_names(["a b/c", "a_b_c", "A_B_C", "größe", "a_b_c"]);
        assert_eq!(names, ["a_b_c", "a_b_c-2", "A_B_C-3", "größe", "a_b_c-4"]);
    }

    #[test]
    fn numbers_are_kept_where_there_are_some() {
        assert_eq!(numbers_of(["obj_000005", "mug", "obj_000001", "x5"], 1), [5, 2, 1, 3]);
        assert_eq!(numbers_of(["000764", "photo", "000000"], 0), [764, 1, 0]);
        assert_eq!(numbers_of(["IMG_20260101123000", "0"], 1), [1, 2], "a date is no id, and 0 no object");
    }
}

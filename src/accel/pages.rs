//! Lists in large pages of memory. A ray that goes anywhere mostly waits for memory, and if the pages are
//! small, also for the tables that say where they are.

use std::{fmt, marker::PhantomData, ops::Deref};

use memmap2::MmapMut;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// A type that any bytes are a value of.
pub(crate) trait Plain: Clone + FromBytes + IntoBytes + Immutable + KnownLayout {}

impl<T: Clone + FromBytes + IntoBytes + Immutable + KnownLayout> Plain for T {}

/// Number of bytes from which a list gets large pages; tests use less.
const LARGE: usize = if cfg!(test) { 1 << 12 } else { 1 << 22 };

/// A list whose length is fixed.
pub(crate) enum Pages<T> {
    /// The memory and the number of values in use.
    Mapped(MmapMut, usize, PhantomData<T>),
    Small(Vec<T>),
}

impl<T: Plain> Pages<T> {
    /// Creates a list of this many values whose bytes are all 0.
    pub(crate) fn zeroed(len: usize) -> Self {
        let bytes = len * size_of::<T>();
        match mapped(bytes) {
            Some(memory) => Self::Mapped(memory, len, PhantomData),
            None => Self::Small(vec![T::new_zeroed(); len]),
        }
    }

    /// Creates a list of some values, at most this many.
    pub(crate) fn collect(most: usize, values: impl Iterator<Item = T>) -> Self {
        let mut pages = Self::zeroed(most);
        let mut len = 0;
        let mut places = pages.as_mut().iter_mut();
        values.for_each(|value| {
            if let Some(to) = places.next() {
                *to = value;
                len += 1;
            }
        });
        match &mut pages {
            Self::Mapped(_, used, _) => *used = len,
            Self::Small(list) => list.truncate(len),
        }
        pages
    }

    /// Returns all of it.
    pub(crate) fn as_mut(&mut self) -> &mut [T] {
        match self {
            Self::Mapped(memory, len, _) => match <[T]>::mut_from_prefix_with_elems(memory, *len) {
                Ok((list, _)) => list,
                Err(_) => &mut [],
            },
            Self::Small(list) => list,
        }
    }
}

/// Returns memory in large pages; `None` if that is not worth while or not to be had.
fn mapped(bytes: usize) -> Option<MmapMut> {
    let memory = (bytes >= LARGE).then(|| MmapMut::map_anon(bytes))?.ok()?;
    #[cfg(target_os = "linux")]
    memory.advise(memmap2::Advice::HugePage).ok()?;
    Some(memory)
}

impl<T: Plain> From<Vec<T>> for Pages<T> {
    fn from(list: Vec<T>) -> Self {
        let mut pages = Self::zeroed(list.len());
        pages.as_mut().clone_from_slice(&list);
        pages
    }
}

impl<T: Plain> Deref for Pages<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        match self {
            // By the number of values: one of bytes would be divided each time.
            Self::Mapped(memory, len, _) => match <[T]>::ref_from_prefix_with_elems(memory, *len) {
                Ok((list, _)) => list,
                Err(_) => &[],
            },
            Self::Small(list) => list,
        }
    }
}

impl<T: Plain> Clone for Pages<T> {
    fn clone(&self) -> Self {
        let mut pages = Self::zeroed(self.len());
        pages.as_mut().clone_from_slice(self);
        pages
    }
}

impl<T: Plain + fmt::Debug> fmt::Debug for Pages<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&**self, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_hold_what_a_list_holds() {
        for len in [0, 1, 1000, 5000] {
            let list: Vec<[u32; 2]> = (0..len).map(|number| [number, 7]).collect();
            let pages = Pages::from(list.clone());
            let is_mapped = matches!(pages, Pages::Mapped(..));
            assert_eq!(is_mapped, len >= 1000, "{len}");
            assert_eq!(*pages, *list);
            let part = Pages::collect(list.len() + 7, list.iter().copied());
            assert_eq!(*part, *list);
            let mut copy = pages.clone();
            copy.as_mut().reverse();
            assert_eq!((pages.last(), copy.first()), (list.last(), list.last()));
            assert!(
                Pages::<[u32; 2]>::zeroed(len as usize)
                    .iter()
                    .all(|it| *it == [0; 2])
            );
        }
    }
}

//! The index of a shape of many parts, which is built once, when rays come.

use std::{fmt, sync::OnceLock};

/// An index, unless it is not built yet.
pub(crate) struct Indexed<I: ?Sized>(OnceLock<Box<I>>);

impl<I: ?Sized> Indexed<I> {
    /// Creates the place of an index.
    pub(super) const fn none() -> Self {
        Self(OnceLock::new())
    }

    /// Returns the index.
    #[inline(always)]
    pub(super) fn get(&self) -> Option<&I> {
        self.0.get().map(|index| &**index)
    }

    /// Answers with an index from now on, unless there is one already.
    pub(super) fn build(&self, build: impl FnOnce() -> Option<Box<I>>) {
        if self.0.get().is_none()
            && let Some(index) = build()
        {
            // Another thread may have been faster. It did not wait for this one, which would be a
            // deadlock if it ran a part of this work.
            drop(self.0.set(index));
        }
    }
}

/// A copy of a shape has no index yet.
impl<I: ?Sized> Clone for Indexed<I> {
    fn clone(&self) -> Self {
        Self::none()
    }
}

impl<I: fmt::Debug + ?Sized> fmt::Debug for Indexed<I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.get().fmt(f)
    }
}

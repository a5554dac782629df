//! Which axis: a typed index into [`AXES`], and containers with one entry for each axis.

use super::{AXES, Axis};
use std::ops::{Index, IndexMut};

/// An axis, as its position in [`AXES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AxisId(usize);

impl AxisId {
    /// The axis at a position of the list, for the constants beside it.
    pub(super) const fn from_position(position: usize) -> Self {
        Self(position)
    }

    /// The position of the axis in [`AXES`].
    pub(super) fn position(self) -> usize {
        self.0
    }

    /// Finds an axis by its name in files and tables.
    pub fn find(name: &str) -> Option<Self> {
        AXES.ids().find(|axis| AXES[*axis].name == name)
    }
}

/// The list of all axes.
pub struct Axes(pub(super) &'static [Axis]);

impl Axes {
    pub fn iter(&self) -> std::slice::Iter<'static, Axis> {
        self.0.iter()
    }

    pub fn ids(
        &self,
    ) -> impl ExactSizeIterator<Item = AxisId> + DoubleEndedIterator + Clone + use<> {
        (0..self.0.len()).map(AxisId)
    }

    pub fn entries(&self) -> impl DoubleEndedIterator<Item = (AxisId, &'static Axis)> + use<> {
        self.ids().zip(self.0)
    }

    #[expect(clippy::len_without_is_empty, reason = "the list is never empty")]
    pub fn len(&self) -> usize {
        self.0.len()
    }
}

impl Index<AxisId> for Axes {
    type Output = Axis;

    fn index(&self, axis: AxisId) -> &Axis {
        &self.0[axis.0]
    }
}

impl IntoIterator for &Axes {
    type Item = &'static Axis;
    type IntoIter = std::slice::Iter<'static, Axis>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// One entry for each axis, in the order of [`AXES`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct PerAxis<T>(Vec<T>);

impl<T> PerAxis<T> {
    /// The entry of each axis.
    pub fn from_fn(entry: impl FnMut(AxisId) -> T) -> Self {
        Self(AXES.ids().map(entry).collect())
    }

    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.0.iter()
    }

    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
        self.0.iter_mut()
    }
}

impl<T> FromIterator<T> for PerAxis<T> {
    fn from_iter<I: IntoIterator<Item = T>>(entries: I) -> Self {
        let entries: Vec<T> = entries.into_iter().collect();
        assert_eq!(entries.len(), AXES.len(), "one entry for each axis");
        Self(entries)
    }
}

impl<T> Index<AxisId> for PerAxis<T> {
    type Output = T;

    fn index(&self, axis: AxisId) -> &T {
        &self.0[axis.0]
    }
}

impl<T> IndexMut<AxisId> for PerAxis<T> {
    fn index_mut(&mut self, axis: AxisId) -> &mut T {
        &mut self.0[axis.0]
    }
}

impl<'a, T> IntoIterator for &'a PerAxis<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a, T> IntoIterator for &'a mut PerAxis<T> {
    type Item = &'a mut T;
    type IntoIter = std::slice::IterMut<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

impl<T: Default> Default for PerAxis<T> {
    fn default() -> Self {
        Self::from_fn(|_| T::default())
    }
}

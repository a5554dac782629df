//! Bounded caches of what passes share: a sweep of thousands of cells must not grow.

/// The most recently used values by key, at most `capacity` of them.
pub(super) struct Recent<K, V> {
    capacity: usize,
    /// The most recent last.
    entries: Vec<(K, V)>,
}

impl<K: PartialEq, V: Clone> Recent<K, V> {
    pub(super) fn new(capacity: usize) -> Self {
        Self { capacity, entries: Vec::new() }
    }

    pub(super) fn clear(&mut self) {
        self.entries.clear();
    }

    /// The value of `key`, if it is there.
    pub(super) fn get(&mut self, key: &K) -> Option<V> {
        let index = self.entries.iter().position(|(known, _)| known == key)?;
        let entry = self.entries.remove(index);
        let value = entry.1.clone();
        self.entries.push(entry);
        Some(value)
    }

    /// The value of `key`, made by `make` if it is not there.
    pub(super) fn get_or_make<E>(&mut self, key: K, make: impl FnOnce() -> Result<V, E>) -> Result<V, E> {
        if let Some(value) = self.get(&key) {
            return Ok(value);
        }
        // The old value goes first, so that both never take memory at once.
        if self.entries.len() == self.capacity {
            self.entries.remove(0);
        }
        let value = make()?;
        self.entries.push((key, value.clone()));
        Ok(value)
    }
}

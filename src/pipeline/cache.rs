//! Bounded caches of what passes share: a sweep of thousands of cells must not grow, nor must a window in which somebody turns sizes.

/// What one cache holds at most beside its newest value, bytes. A software driver takes it from the memory of the host.
pub const CACHE_BYTES: u64 = 1 << 29;

/// The most recently used values by key, at most `capacity` of them.
pub struct Recent<K, V> {
    capacity: usize,
    bytes_of: fn(&V) -> u64,
    /// The most recent last.
    entries: Vec<(K, V)>,
}

impl<K: PartialEq, V: Clone> Recent<K, V> {
    /// Of values that are small.
    pub fn new(capacity: usize) -> Self {
        Self::weighed(capacity, |_| 0)
    }

    /// Of values that take `bytes_of` each.
    pub fn weighed(capacity: usize, bytes_of: fn(&V) -> u64) -> Self {
        Self { capacity, bytes_of, entries: Vec::new() }
    }

    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// The value of `key`, if it is there.
    pub fn get(&mut self, key: &K) -> Option<V> {
        let index = self.entries.iter().position(|(known, _)| known == key)?;
        let entry = self.entries.remove(index);
        let value = entry.1.clone();
        self.entries.push(entry);
        Some(value)
    }

    /// The value of `key`, made by `make` if it is not there.
    pub fn get_or_make<E>(&mut self, key: K, make: impl FnOnce() -> Result<V, E>) -> Result<V, E> {
        if let Some(value) = self.get(&key) {
            return Ok(value);
        }
        // Old values go first, so that both never take memory at once.
        let bytes = |entries: &[(K, V)]| entries.iter().map(|(_, value)| (self.bytes_of)(value)).sum::<u64>();
        while self.entries.len() == self.capacity || bytes(&self.entries) > CACHE_BYTES {
            self.entries.remove(0);
        }
        let value = make()?;
        self.entries.push((key, value.clone()));
        Ok(value)
    }
}

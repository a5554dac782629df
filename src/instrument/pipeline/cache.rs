//! Bounded caches of shared results, for sweeps of thousands of cells and windows with many sizes.

/// Most bytes of one cache without its newest value. A software driver takes them from the host's
/// memory.
pub const CACHE_BYTES: u64 = 1 << 29;

/// The most recently used values by key, at most `capacity` of them.
pub struct Recent<K, V> {
    capacity: usize,
    bytes_of: fn(&V) -> u64,
    /// The most recent last.
    entries: Vec<(K, V)>,
}

impl<K: PartialEq, V: Clone> Recent<K, V> {
    /// Makes a cache of small values.
    pub fn new(capacity: usize) -> Self {
        Self::weighed(capacity, |_| 0)
    }

    /// Makes a cache of values of `bytes_of` bytes each.
    pub fn weighed(capacity: usize, bytes_of: fn(&V) -> u64) -> Self {
        Self {
            capacity,
            bytes_of,
            entries: Vec::new(),
        }
    }

    pub fn clear(&mut self) {
        self.entries.clear();
    }

    pub fn get(&mut self, key: &K) -> Option<V> {
        let index = self.entries.iter().position(|(known, _)| known == key)?;
        let entry = self.entries.remove(index);
        let value = entry.1.clone();
        self.entries.push(entry);
        Some(value)
    }

    /// Returns the value of `key`, calling `make` if it is missing.
    pub fn get_or_make<E>(&mut self, key: K, make: impl FnOnce() -> Result<V, E>) -> Result<V, E> {
        if let Some(value) = self.get(&key) {
            return Ok(value);
        }
        // Old values are removed first, so that both never take memory at once.
        let bytes = |entries: &[(K, V)]| {
            entries
                .iter()
                .map(|(_, value)| (self.bytes_of)(value))
                .sum::<u64>()
        };
        while self.entries.len() == self.capacity || bytes(&self.entries) > CACHE_BYTES {
            self.entries.remove(0);
        }
        let value = make()?;
        self.entries.push((key, value.clone()));
        Ok(value)
    }
}

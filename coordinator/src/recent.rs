//! Recent: the values that were asked for lately, so that they are not read and decoded again.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, PoisonError};

/// Cache of at most `capacity` values; the least recently used goes first.
pub struct Recent<K, V> {
    capacity: usize,
    values: Mutex<Values<K, V>>,
}

struct Values<K, V> {
    asked: u64,
    by_key: HashMap<K, (u64, Arc<V>)>,
}

impl<K: Eq + Hash + Clone, V> Recent<K, V> {
    /// Empty.
    pub fn new(capacity: usize) -> Self {
        Self {
            capacity: capacity.max(1),
            values: Mutex::new(Values {
                asked: 0,
                by_key: HashMap::new(),
            }),
        }
    }

    /// The value of this key, if it is here.
    pub fn get(&self, key: &K) -> Option<Arc<V>> {
        let mut values = self.values.lock().unwrap_or_else(PoisonError::into_inner);
        values.asked += 1;
        let ask_number = values.asked;
        let (asked, value) = values.by_key.get_mut(key)?;
        *asked = ask_number;
        Some(Arc::clone(value))
    }

    /// The value of this key; where it is not here, this one is kept.
    pub fn get_or_keep(&self, key: K, value: impl FnOnce() -> V) -> Arc<V> {
        let mut values = self.values.lock().unwrap_or_else(PoisonError::into_inner);
        values.asked += 1;
        let asked = values.asked;
        let kept = values.by_key.entry(key);
        let (last_asked, value) = kept.or_insert_with(|| (asked, Arc::new(value())));
        *last_asked = asked;
        let value = Arc::clone(value);
        values.remove_oldest(self.capacity);
        value
    }

    /// Keeps a value.
    pub fn keep(&self, key: K, value: Arc<V>) {
        let mut values = self.values.lock().unwrap_or_else(PoisonError::into_inner);
        values.asked += 1;
        let ask_number = values.asked;
        values.by_key.insert(key, (ask_number, value));
        values.remove_oldest(self.capacity);
    }
}

impl<K: Eq + Hash + Clone, V> Values<K, V> {
    /// Removes the value that was asked for longest ago, where there are more than `capacity`.
    fn remove_oldest(&mut self, capacity: usize) {
        if self.by_key.len() > capacity {
            let oldest = self.by_key.iter().min_by_key(|(_, (asked, _))| *asked);
            if let Some(key) = oldest.map(|(key, _)| key.clone()) {
                self.by_key.remove(&key);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_asked_for_goes_first() {
        let recent = Recent::new(2);
        recent.keep(1, Arc::new("a"));
        recent.keep(2, Arc::new("b"));
        assert!(recent.get(&1).is_some());
        recent.keep(3, Arc::new("c"));
        assert_eq!(recent.get(&2), None);
        assert_eq!(recent.get(&1).as_deref(), Some(&"a"));
        assert_eq!(recent.get(&3).as_deref(), Some(&"c"));
        assert_eq!(*recent.get_or_keep(3, || "another"), "c");
        assert_eq!(*recent.get_or_keep(4, || "d"), "d");
        assert_eq!(recent.get(&1), None);
    }
}

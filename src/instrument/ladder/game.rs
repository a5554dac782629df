//! Cooperative games in which some players need others: the contribution of each player to the
//! whole.

use std::fmt::{self, Binary, Formatter};
use std::ops::BitOr;

/// A set of players, at most 32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Coalition(u32);

impl Coalition {
    pub const EMPTY: Self = Self(0);

    /// Returns the coalition of these players.
    pub const fn from_players(players: &[usize]) -> Self {
        let mut bits = 0;
        let mut index = 0;
        while index < players.len() {
            bits |= 1 << players[index];
            index += 1;
        }
        Self(bits)
    }

    /// Returns the coalition of the first `count` players.
    pub const fn first(count: usize) -> Self {
        Self((1 << count) - 1)
    }

    pub const fn contains(self, player: usize) -> bool {
        self.0 >> player & 1 == 1
    }

    /// Returns whether every player of `other` is in this coalition.
    pub const fn contains_all(self, other: Self) -> bool {
        other.0 & !self.0 == 0
    }

    pub const fn with(self, player: usize) -> Self {
        Self(self.0 | 1 << player)
    }

    /// Returns the players that are also in `other`.
    pub const fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Lists the subsets of the coalition, each after its own subsets.
    pub fn subsets(self) -> impl Iterator<Item = Self> {
        (0..=self.0)
            .map(Self)
            .filter(move |subset| self.contains_all(*subset))
    }

    /// Returns the number of players.
    pub const fn len(self) -> u32 {
        self.0.count_ones()
    }

    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Returns the position of the coalition in a list of all `2^count` coalitions of `count`
    /// players. A coalition comes after its subsets.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

impl BitOr for Coalition {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl FromIterator<usize> for Coalition {
    fn from_iter<I: IntoIterator<Item = usize>>(players: I) -> Self {
        players.into_iter().fold(Self::EMPTY, Self::with)
    }
}

/// One digit a player, the first player last.
impl Binary for Coalition {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        Binary::fmt(&self.0, formatter)
    }
}

/// The rules of a game: which coalitions can form.
#[derive(Clone, Debug)]
pub struct Game {
    /// The players that each player needs, by player.
    needs: Vec<Coalition>,
}

impl Game {
    /// Makes a game from the players that each player needs.
    pub fn new(needs: Vec<Coalition>) -> Self {
        Self { needs }
    }

    pub fn player_count(&self) -> usize {
        self.needs.len()
    }

    /// Returns the coalition of all players.
    pub fn everybody(&self) -> Coalition {
        Coalition::first(self.player_count())
    }

    /// Returns whether every player in the coalition has the players it needs.
    pub fn is_feasible(&self, coalition: Coalition) -> bool {
        self.needs
            .iter()
            .enumerate()
            .all(|(player, need)| !coalition.contains(player) || coalition.contains_all(*need))
    }

    /// Lists every feasible coalition, each after its subsets.
    pub fn coalitions(&self) -> Vec<Coalition> {
        self.all_coalitions()
            .filter(|coalition| self.is_feasible(*coalition))
            .collect()
    }

    fn all_coalitions(&self) -> impl DoubleEndedIterator<Item = Coalition> + use<> {
        (0..1 << self.player_count()).map(Coalition)
    }

    /// Returns all players that this one needs, directly or not: the smallest coalition that it can
    /// join.
    pub fn smallest_before(&self, player: usize) -> Coalition {
        let mut required = self.needs[player];
        loop {
            let extended = (0..self.player_count())
                .filter(|other| required.contains(*other))
                .fold(required, |all, other| all | self.needs[other]);
            if extended == required {
                return required;
            }
            required = extended;
        }
    }

    /// Returns all players but this one and those that need it: the largest coalition without it.
    pub fn largest_without(&self, player: usize) -> Coalition {
        (0..self.player_count())
            .filter(|other| *other != player && !self.smallest_before(*other).contains(player))
            .collect()
    }

    /// Returns whether a player can be the next to join a coalition.
    pub fn can_join(&self, coalition: Coalition, player: usize) -> bool {
        !coalition.contains(player) && coalition.contains_all(self.needs[player])
    }

    /// Lists the players that can be the next to join a coalition.
    fn next_players(&self, coalition: Coalition) -> impl Iterator<Item = usize> {
        (0..self.player_count()).filter(move |player| self.can_join(coalition, *player))
    }

    /// Computes Shapley values: a player's contribution averaged over all orders in which each
    /// player comes after those it needs [Shapley53; FaigleKern92 for players with needs]. They sum
    /// to the value of all minus the value of none.
    pub fn shapley(&self, value: impl Fn(Coalition) -> f64) -> Vec<f64> {
        // Number of orders from the empty coalition to each, and from each to all.
        let mut orders_to = vec![0.0; 1 << self.player_count()];
        let mut orders_from = vec![0.0; 1 << self.player_count()];
        orders_to[Coalition::EMPTY.index()] = 1.0;
        orders_from[self.everybody().index()] = 1.0;
        for coalition in self.all_coalitions() {
            for player in self.next_players(coalition) {
                orders_to[coalition.with(player).index()] += orders_to[coalition.index()];
            }
        }
        for coalition in self.all_coalitions().rev() {
            for player in self.next_players(coalition) {
                orders_from[coalition.index()] += orders_from[coalition.with(player).index()];
            }
        }
        let order_count = orders_from[Coalition::EMPTY.index()];
        let mut values = vec![0.0; self.player_count()];
        for coalition in self.coalitions() {
            for player in self.next_players(coalition) {
                let joined = coalition.with(player);
                let orders =
                    orders_to[coalition.index()] * orders_from[joined.index()] / order_count;
                values[player] += orders * (value(joined) - value(coalition));
            }
        }
        values
    }
}

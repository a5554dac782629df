//! Cooperative games in which some players need others: the contribution of each player to the
//! whole.

/// A set of players, one bit each.
pub type Coalition = u32;

/// Returns whether every player in the coalition has the players it needs.
pub fn is_feasible(coalition: Coalition, needs: &[Coalition]) -> bool {
    let is_served = |(player, need): (usize, &Coalition)| {
        coalition >> player & 1 == 0 || need & !coalition == 0
    };
    needs.iter().enumerate().all(is_served)
}

/// Lists every feasible coalition in ascending order.
pub fn coalitions(needs: &[Coalition]) -> Vec<Coalition> {
    (0..1 << needs.len())
        .filter(|coalition| is_feasible(*coalition, needs))
        .collect()
}

/// Returns all players that this one needs, directly or not: the smallest coalition that it can
/// join.
pub fn before(player: usize, needs: &[Coalition]) -> Coalition {
    let mut all = needs[player];
    loop {
        let more = (0..needs.len())
            .filter(|other| all >> other & 1 == 1)
            .fold(all, |all, other| all | needs[other]);
        if more == all {
            return all;
        }
        all = more;
    }
}

/// Returns all players but this one and those that need it: the largest coalition without it.
pub fn without(player: usize, needs: &[Coalition]) -> Coalition {
    let stays = |other: &usize| *other != player && before(*other, needs) >> player & 1 == 0;
    (0..needs.len())
        .filter(stays)
        .fold(0, |all, other| all | 1 << other)
}

/// Computes Shapley values: a player's contribution averaged over all orders in which each player
/// comes after those it needs [Shapley53; FaigleKern92 for players with needs]. They sum to the
/// value of all minus the value of none.
pub fn shapley(needs: &[Coalition], value: impl Fn(Coalition) -> f64) -> Vec<f64> {
    let (count, all) = (needs.len(), (1 << needs.len()) - 1);
    let can_join = |coalition: Coalition, player: usize| {
        coalition >> player & 1 == 0 && needs[player] & !coalition == 0
    };
    // Number of orders from the empty coalition to each, and from each to all.
    let mut to = vec![0.0; 1 << count];
    let mut from = vec![0.0; 1 << count];
    (to[0], from[all as usize]) = (1.0, 1.0);
    for coalition in 0..=all {
        for player in (0..count).filter(|player| can_join(coalition, *player)) {
            to[(coalition | 1 << player) as usize] += to[coalition as usize];
        }
    }
    for coalition in (0..=all).rev() {
        for player in (0..count).filter(|player| can_join(coalition, *player)) {
            from[coalition as usize] += from[(coalition | 1 << player) as usize];
        }
    }
    let mut values = vec![0.0; count];
    for coalition in coalitions(needs) {
        for player in (0..count).filter(|player| can_join(coalition, *player)) {
            let joined = coalition | 1 << player;
            let orders = to[coalition as usize] * from[joined as usize] / from[0];
            values[player] += orders * (value(joined) - value(coalition));
        }
    }
    values
}

//! Which solids are joined first: what grows on something with it, and few at a time, so that an
//! edit of one thing joins little again.

use sapwood_geom::{Digest, Member};

use super::gathered::Gathered;

/// Up to so many members are joined in one go.
const FEW: usize = 6;

/// One of so many members, on the average, is the first of a group.
const SHARE: u64 = 4;

/// A member, with the number of its first solid.
type Held = (u32, Member);

/// What is joined first: where something below a place is solid itself and something else
/// below it holds solids too, as a stem and what grows on it, they are a group. All that is left
/// is the last group.
pub(super) fn of(gathered: &Gathered) -> Vec<Vec<Member>> {
    let Gathered { above, places_of, .. } = gathered;
    let mut groups = Vec::new();
    // Of each place what is below it and in no group yet; whether it has solids itself; how many
    // places right below hold any; and whether one of these has them itself.
    let mut members: Vec<Vec<Held>> = vec![Vec::new(); above.len()];
    for (solid, place) in (0..).zip(places_of) {
        members[*place as usize].push((solid, Member::Solid(solid)));
    }
    let is_solid: Vec<bool> = members.iter().map(|own| !own.is_empty()).collect();
    let mut n_below = vec![0; members.len()];
    let mut is_on_solid = vec![false; members.len()];
    let mut all = Vec::new();
    // Places come after the ones above them.
    for place in (0..members.len()).rev() {
        let mut held = std::mem::take(&mut members[place]);
        if held.is_empty() {
            continue;
        }
        held.sort_unstable_by_key(|(first, _)| *first);
        if is_on_solid[place] && n_below[place] > 1 {
            held = vec![grouped(gathered, held, &mut groups)];
        }
        let above = above[place] as usize;
        if above == place {
            all.append(&mut held);
        } else {
            n_below[above] += 1;
            is_on_solid[above] |= is_solid[place];
            members[above].append(&mut held);
        }
    }
    all.sort_unstable_by_key(|(first, _)| *first);
    if !matches!(&all[..], [(_, Member::Group(_))]) {
        groups.push(all.into_iter().map(|(_, member)| member).collect());
    }
    groups
}

/// Makes a group of what is held, and before that groups of neighbours, and groups of those, until
/// few are left: then an edit of one member joins as many groups again as lie above each other.
///
/// Which member begins a group is told by its own content, so that a member more or less leaves all
/// groups alone but those around it.
fn grouped(gathered: &Gathered, mut held: Vec<Held>, groups: &mut Vec<Vec<Member>>) -> Held {
    let has_groups = held.iter().any(|(_, member)| matches!(member, Member::Group(_)));
    let group = |members: Vec<Held>, groups: &mut Vec<Vec<Member>>| {
        let first = members[0].0;
        groups.push(members.into_iter().map(|(_, member)| member).collect());
        (first, Member::Group(groups.len() as u32 - 1))
    };
    let mut divisor = 1;
    while has_groups && held.len() > FEW && divisor < u64::MAX / SHARE {
        let is_first = |(first, _): &Held| {
            let of = Digest::of(&gathered.solids[*first as usize].shape).bits() as u64;
            (of / divisor).is_multiple_of(SHARE)
        };
        let mut next: Vec<Held> = Vec::new();
        let mut run: Vec<Held> = Vec::new();
        let mut close = |run: &mut Vec<Held>| match run.len() {
            0 => {}
            1 => next.append(run),
            _ => next.push(group(std::mem::take(run), groups)),
        };
        for member in held {
            if is_first(&member) {
                close(&mut run);
            }
            run.push(member);
        }
        close(&mut run);
        held = next;
        divisor *= SHARE;
    }
    match held[..] {
        [one] => one,
        _ => group(held, groups),
    }
}

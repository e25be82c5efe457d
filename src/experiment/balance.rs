//! How many shards make sense: few cost little to start, many keep all workers busy where runs differ in time.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::time::Duration;

use super::shard::dealt;

/// What a shard takes beside its runs: a tenth of a second for the process, the rest for the scheduler.
const START: Duration = Duration::from_millis(500);

/// By how much the wall time may be above the least, as a share of it.
const CLOSE: f64 = 0.05;

/// Most shards for each worker that are considered.
const MOST_EACH: usize = 32;

/// Most shards in all, unless there are more workers: Slurm takes arrays of 1000 tasks unless told otherwise.
const MOST: usize = 1000;

/// Numbers of shards that make sense for some workers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Sensible {
    /// The least number with which all end about as soon as can be.
    pub fewest: usize,
    /// The largest such number. As true times differ from those estimated, it is the safest.
    pub most: usize,
    /// Share of the workers' time that is idle with one shard for each.
    pub idle_with_one_each: f64,
}

/// The numbers of shards with which so many workers, of `jobs` runs at a time each, do runs of these times, in the order of the
/// plan, about as soon as can be. There are never more shards than runs.
pub(super) fn sensible(runs: &[Duration], workers: usize, jobs: usize) -> Sensible {
    let largest = runs.len().min(workers.saturating_mul(MOST_EACH)).min(MOST.max(workers)).max(1);
    let doubled = std::iter::successors(Some(workers), |count| count.checked_mul(2));
    let counts: Vec<usize> =
        doubled.take_while(|count| *count < largest).chain([largest]).collect();
    let timed = |count: &usize| Schedule::of(&loads(runs, *count, jobs), workers);
    let schedules: Vec<Schedule> = counts.iter().map(timed).collect();
    let least = schedules.iter().map(|schedule| schedule.wall).min().unwrap_or_default();
    let is_close =
        |schedule: &Schedule| schedule.wall.as_secs_f64() <= least.as_secs_f64() * (1.0 + CLOSE);
    let mut close = counts.iter().zip(&schedules).filter(|(_, schedule)| is_close(schedule));
    let fewest = close.next().map_or(largest, |(count, _)| *count);
    let most = close.next_back().map_or(fewest, |(count, _)| *count);
    Sensible { fewest, most, idle_with_one_each: schedules[0].idle }
}

/// What each shard takes: its start, and its runs, so many at a time.
fn loads(runs: &[Duration], count: usize, jobs: usize) -> Vec<Duration> {
    let mut sums = vec![(0.0, Duration::ZERO); count];
    for (place, run) in runs.iter().enumerate() {
        let (sum, longest) = &mut sums[dealt(place, count)];
        *sum += run.as_secs_f64();
        *longest = (*longest).max(*run);
    }
    let load = |(sum, longest): (f64, Duration)| {
        let shared = Duration::try_from_secs_f64(sum / jobs as f64).unwrap_or(Duration::MAX);
        shared.max(longest).saturating_add(START)
    };
    sums.into_iter().map(load).collect()
}

/// What comes of workers each of which takes the next shard when it has done one.
struct Schedule {
    /// Time until the last has ended.
    wall: Duration,
    /// Share of the workers' time in which they had nothing to do.
    idle: f64,
}

impl Schedule {
    fn of(loads: &[Duration], workers: usize) -> Self {
        let mut free: BinaryHeap<Reverse<Duration>> = vec![Reverse(Duration::ZERO); workers].into();
        for load in loads {
            let Reverse(time) = free.pop().unwrap_or_default();
            free.push(Reverse(time.saturating_add(*load)));
        }
        let wall = free.iter().map(|Reverse(time)| *time).max().unwrap_or_default();
        let busy: f64 = loads.iter().map(Duration::as_secs_f64).sum();
        Self { wall, idle: 1.0 - busy / (workers as f64 * wall.as_secs_f64()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(all: &[u64]) -> Vec<Duration> {
        all.iter().map(|seconds| Duration::from_secs(*seconds)).collect()
    }

    /// Three workers take shards of 4, 3, 2, 2 and 1 s: the third is free after 2 s, the second after 3, the third again after 4.
    #[test]
    fn a_worker_takes_the_next_shard_when_it_is_free() {
        let schedule = Schedule::of(&seconds(&[4, 3, 2, 2, 1]), 3);
        assert_eq!(schedule.wall, Duration::from_secs(4));
        assert!((schedule.idle - 0.0).abs() < 1e-12);
        // 12 of 3 × 5 s.
        let schedule = Schedule::of(&seconds(&[1, 2, 4, 5]), 3);
        assert_eq!(schedule.wall, Duration::from_secs(6));
        assert!((schedule.idle - (1.0 - 12.0 / 18.0)).abs() < 1e-12);
    }

    /// Of 48 runs of 1 s and 16 of 100 s after them each of four shards has a quarter.
    #[test]
    fn a_shard_takes_its_start_and_its_runs() {
        let runs = [seconds(&[1; 48]), seconds(&[100; 16])].concat();
        assert_eq!(loads(&runs, 4, 1), [Duration::from_millis(412_500); 4]);
        assert_eq!(loads(&runs, 4, 2), [Duration::from_millis(206_500); 4]);
        // Not below its longest run.
        assert_eq!(loads(&runs, 64, 8)[63], Duration::from_millis(100_500));
    }

    /// Equal runs need no more shards than workers. 256 of 1 s on four workers take 64 s; 4 shards add half a second to that, 16 add
    /// 2, 32 add 4, which is too much.
    #[test]
    fn starts_limit_the_number_of_shards() {
        let Sensible { fewest, most, idle_with_one_each } = sensible(&seconds(&[1; 256]), 4, 1);
        assert_eq!((fewest, most), (4, 16));
        assert!(idle_with_one_each.abs() < 1e-12);
    }

    #[test]
    fn there_are_no_more_shards_than_runs() {
        assert_eq!(sensible(&seconds(&[60; 6]), 8, 1).most, 6);
        assert_eq!(sensible(&seconds(&[60; 6]), 4, 1).most, 6);
        assert_eq!(sensible(&[], 4, 1).most, 1);
        let many = vec![Duration::from_hours(1); 100_000];
        assert_eq!(sensible(&many, 64, 1).most, 1000);
        assert_eq!(sensible(&many, 4000, 1).most, 4000);
        assert_eq!(sensible(&[Duration::MAX; 64], 4, 1).fewest, 4);
    }

    /// Four instances, two optimisers of which one takes a hundred times as long, ten seeds. Computed in Python: with 8, 16, 32, 64
    /// and 80 shards eight workers need 604.5, 605, 512, 513 and 519 s and are idle for 16.4, 16.4, 1.0, 0.8 and 1.7 % of them.
    #[test]
    fn runs_that_differ_want_more_shards_than_workers() {
        let instance = [seconds(&[1; 10]), seconds(&[100; 10])].concat();
        let Sensible { fewest, most, idle_with_one_each } = sensible(&instance.repeat(4), 8, 1);
        assert_eq!((fewest, most), (32, 80));
        assert!((idle_with_one_each - 0.164).abs() < 5e-4, "{idle_with_one_each}");
    }
}

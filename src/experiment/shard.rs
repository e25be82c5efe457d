//! Parts of an experiment, each for a process of its own: which one, the user says or a scheduler.

use std::fmt;
use std::str::FromStr;

/// What Slurm sets in the tasks of an array: the task's number, the least number, the step from one
/// number to the next, and how many tasks there are.
const SLURM: [&str; 4] = [
    "SLURM_ARRAY_TASK_ID",
    "SLURM_ARRAY_TASK_MIN",
    "SLURM_ARRAY_TASK_STEP",
    "SLURM_ARRAY_TASK_COUNT",
];

/// Where schedulers put a task's number and what they call the first, the innermost scheduler first: the workers of `HyperQueue` and
/// the commands of GNU parallel are jobs of another one.
const NUMBERS: [(&str, usize); 8] = [
    ("HQ_TASK_ID", 0),
    ("PARALLEL_SEQ", 1),
    ("JOB_COMPLETION_INDEX", 0),
    ("FLUX_JOB_CC", 0),
    (SLURM[0], 0),
    ("PBS_ARRAY_INDEX", 0),
    ("SGE_TASK_ID", 1),
    ("LSB_JOBINDEX", 1),
];

/// What Grid Engine and LSF set where a job is no task of an array.
const NO_TASK: [(&str, &str); 2] = [("SGE_TASK_ID", "undefined"), ("LSB_JOBINDEX", "0")];

/// A disjoint part of an experiment, `index` of `count`, counted from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    count: usize,
}

impl Shard {
    /// One of so many parts, counted from zero; none where there is no such part.
    pub fn new(index: usize, count: usize) -> Option<Self> {
        (index < count).then_some(Self { index, count })
    }

    /// Whether the run at this place of a plan belongs to the shard.
    pub fn holds(self, place: usize) -> bool {
        dealt(place, self.count) == self.index
    }
}

/// Which of so many shards the run at this place of a plan belongs to. Runs are dealt out in rounds, one to each shard, and every
/// round begins at another shard: otherwise a plan whose slow runs recur every so many places would have them all in one shard.
/// Multiples of the golden ratio spread the beginnings evenly.
pub(super) fn dealt(place: usize, count: usize) -> usize {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    let round = (place / count) as u64;
    let begin = (u128::from(round.wrapping_mul(GOLDEN)) * count as u128) >> 64;
    (place % count + begin as usize) % count
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// How much of a shard's name is given, and how much a scheduler has to tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShardChoice {
    /// `I/N`: index and count are given.
    Given(Shard),
    /// `/N`: the count is given.
    OfCount(usize),
    /// Nothing is given.
    Scheduled,
}

impl FromStr for ShardChoice {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const EXPECTED: &str = "expected I/N such as 0/4, or /N, or nothing where a scheduler tells; \
                                an experiment file stands before --shard";
        if text.is_empty() {
            return Ok(Self::Scheduled);
        }
        let (index, count) = text.split_once('/').ok_or(EXPECTED)?;
        let count = count.parse().map_err(|_| EXPECTED)?;
        if count == 0 {
            return Err("expected at least one part");
        }
        if index.is_empty() {
            return Ok(Self::OfCount(count));
        }
        let shard = Shard::new(index.parse().map_err(|_| EXPECTED)?, count);
        shard.map(Self::Given).ok_or("expected I/N with I from 0 to N - 1")
    }
}

impl ShardChoice {
    /// The shard meant, and the variable that told its index, if one did. `variable` looks up what
    /// the scheduler set in the environment.
    pub fn resolve(
        self,
        variable: impl Fn(&str) -> Option<String>,
    ) -> Result<(Shard, Option<&'static str>), ShardError> {
        let given = match self {
            Self::Given(shard) => return Ok((shard, None)),
            Self::OfCount(count) => Some(count),
            Self::Scheduled => None,
        };
        let tells = |(name, _): &(&str, usize)| {
            variable(name).is_some_and(|value| !NO_TASK.contains(&(*name, &*value)))
        };
        let (name, first) = NUMBERS.into_iter().find(tells).ok_or(ShardError::NoScheduler)?;
        let shard = match given {
            Some(count) => {
                let number = whole(name, &variable)?;
                let shard = number.checked_sub(first).and_then(|index| Shard::new(index, count));
                shard.ok_or(ShardError::OutOfRange { name, number, first, count })?
            }
            None if name == SLURM[0] => slurm(&variable)?,
            None => return Err(ShardError::NoCount(name)),
        };
        Ok((shard, Some(name)))
    }
}

/// The shard of a task of a Slurm array.
fn slurm(variable: &impl Fn(&str) -> Option<String>) -> Result<Shard, ShardError> {
    let [id, min, step, count] = SLURM.map(|name| whole(name, variable));
    let (id, min, step, count) = (id?, min?, step?, count?);
    let index = id.checked_sub(min).filter(|from_min| step > 0 && from_min % step == 0);
    let shard = index.and_then(|from_min| Shard::new(from_min / step, count));
    shard.ok_or(ShardError::Gap { id, min, step, count })
}

fn whole(
    name: &'static str,
    variable: &impl Fn(&str) -> Option<String>,
) -> Result<usize, ShardError> {
    let value = variable(name).ok_or(ShardError::NotSet(name))?;
    value.parse().map_err(|_| ShardError::NotANumber { name, value })
}

/// Why it is not known which shard is meant.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShardError {
    /// No variable is set.
    #[error("no scheduler tells which shard this is: none of {} is set", NUMBERS.map(|(name, _)| name).join(", "))]
    NoScheduler,
    /// The scheduler does not tell how many tasks there are.
    #[error("{0} tells which shard this is, but not of how many")]
    NoCount(&'static str),
    /// One of several variables is missing.
    #[error("{} tells which shard this is, but {} is not set", SLURM[0], .0)]
    NotSet(&'static str),
    /// A variable holds something else than a number.
    #[error("{name} is `{value}`, expected a whole number from 0")]
    NotANumber {
        /// The variable.
        name: &'static str,
        /// Its value.
        value: String,
    },
    /// The task's number is not below the count given.
    #[error("{name} is {number}, but {count} tasks are numbered from {first} to {}", .first + .count - 1)]
    OutOfRange {
        /// The variable.
        name: &'static str,
        /// Its value.
        number: usize,
        /// The first task's.
        first: usize,
        /// How many shards there are.
        count: usize,
    },
    /// The task's number is none that an array without gaps has.
    #[error("{} is {id}, which is none of {count} numbers from {min} in steps of {step}", SLURM[0])]
    Gap {
        /// The task's number.
        id: usize,
        /// The least number.
        min: usize,
        /// The step from one number to the next.
        step: usize,
        /// How many tasks there are.
        count: usize,
    },
}

impl ShardError {
    /// What to write instead.
    pub fn help(&self) -> &'static str {
        match self {
            Self::NoScheduler | Self::NotANumber { .. } => {
                "write --shard I/N, such as --shard 0/4 for the first of four"
            }
            Self::NoCount(_) => "write --shard /N, such as --shard /4 in each of four tasks",
            Self::NotSet(_) => "write --shard /N, such as --shard /4 in an array numbered 0-3",
            Self::OutOfRange { first: 0, .. } => {
                "number the tasks from 0, such as 0-3 with --shard /4"
            }
            Self::OutOfRange { .. } => "number the tasks from 1, such as 1-4 with --shard /4",
            Self::Gap { .. } => {
                "where an array has gaps write --shard /N, such as --shard /4 in tasks of an array \
                 numbered 0-3"
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What `--shard` with this value makes of these variables.
    fn resolve(value: &str, variables: &[(&str, &str)]) -> Result<String, ShardError> {
        let look_up = |name: &str| {
            let found = variables.iter().find(|(variable, _)| *variable == name);
            found.map(|(_, value)| (*value).to_owned())
        };
        let choice: ShardChoice = value.parse().unwrap();
        let (shard, name) = choice.resolve(look_up)?;
        Ok(name.map_or_else(|| shard.to_string(), |name| format!("{shard} {name}")))
    }

    fn array<'a>(
        id: &'a str,
        min: &'a str,
        step: &'a str,
        count: &'a str,
    ) -> [(&'a str, &'a str); 4] {
        [(SLURM[0], id), (SLURM[1], min), (SLURM[2], step), (SLURM[3], count)]
    }

    #[test]
    fn shards_are_disjoint_and_leave_nothing_out() {
        for count in 1..6 {
            let shards: Vec<_> = (0..count).map(|i| Shard::new(i, count).unwrap()).collect();
            for place in 0..20 {
                assert_eq!(shards.iter().filter(|shard| shard.holds(place)).count(), 1);
            }
        }
    }

    /// Slow runs that recur with the period of the deal: one of two optimisers on 24 instances with one seed, the first of
    /// four instances in turn with 16 seeds, all of one seed of 15. Each shard has its share of them, give or take one.
    #[test]
    fn no_shard_gets_all_the_slow_runs() {
        type Slow = fn(usize) -> bool;
        let cases: [(usize, usize, Slow, usize); 4] = [
            (48, 2, |place| place % 2 == 0, 12),
            (48, 4, |place| place % 2 == 0, 6),
            (48 * 16, 64, |place| place / 16 % 4 == 0, 3),
            (600, 15, |place| place % 15 == 14, 3),
        ];
        for (runs, count, is_slow, share) in cases {
            let slow = |i| {
                let shard = Shard::new(i, count).unwrap();
                (0..runs).filter(|&place| is_slow(place) && shard.holds(place)).count()
            };
            let slow: Vec<usize> = (0..count).map(slow).collect();
            assert!(slow.iter().all(|slow| slow.abs_diff(share) <= 1), "{count}: {slow:?}");
        }
    }

    /// `sbatch --array=` 0-3, 1-4, 1-7:2, 10-30:10 and 2.
    #[test]
    fn slurm_arrays_tell_index_and_count() {
        for ([id, min, step, count], shard) in [
            (["2", "0", "1", "4"], "2/4"),
            (["4", "1", "1", "4"], "3/4"),
            (["5", "1", "2", "4"], "2/4"),
            (["10", "10", "10", "3"], "0/3"),
            (["2", "2", "1", "1"], "0/1"),
        ] {
            let told = resolve("", &array(id, min, step, count));
            assert_eq!(told, Ok(format!("{shard} SLURM_ARRAY_TASK_ID")));
        }
    }

    /// `sbatch --array=0,2`: the second task is not the third of two; with a count it is the third
    /// of four.
    #[test]
    fn arrays_with_gaps_need_a_count() {
        let task = array("2", "0", "1", "2");
        assert_eq!(resolve("", &task), Err(ShardError::Gap { id: 2, min: 0, step: 1, count: 2 }));
        assert_eq!(resolve("/4", &task), Ok("2/4 SLURM_ARRAY_TASK_ID".to_owned()));
        for broken in
            [array("1", "2", "1", "4"), array("3", "0", "2", "4"), array("1", "0", "0", "4")]
        {
            assert!(matches!(resolve("", &broken), Err(ShardError::Gap { .. })));
        }
    }

    #[test]
    fn the_innermost_scheduler_tells() {
        let slurm = array("1", "0", "1", "4");
        let kubernetes = [&[("JOB_COMPLETION_INDEX", "2")][..], &slurm].concat();
        let all = [&[("HQ_TASK_ID", "3")][..], &kubernetes].concat();
        for (variables, told) in [
            (&slurm[..], "1/4 SLURM_ARRAY_TASK_ID"),
            (&kubernetes, "2/4 JOB_COMPLETION_INDEX"),
            (&all, "3/4 HQ_TASK_ID"),
        ] {
            assert_eq!(resolve("/4", variables), Ok(told.to_owned()));
            assert_eq!(resolve("0/7", variables), Ok("0/7".to_owned()));
        }
        // The count of the array outside is not that of the tasks inside.
        assert_eq!(resolve("", &all), Err(ShardError::NoCount("HQ_TASK_ID")));
        assert_eq!(resolve("", &kubernetes), Err(ShardError::NoCount("JOB_COMPLETION_INDEX")));
    }

    /// Grid Engine, LSF and GNU parallel count from 1, PBS as the user says, Flux from 0; what the first two set
    /// outside of arrays is no task.
    #[test]
    fn other_schedulers_tell_the_index() {
        for (name, value, shard) in [
            ("PARALLEL_SEQ", "1", "0/4"),
            ("SGE_TASK_ID", "4", "3/4"),
            ("LSB_JOBINDEX", "2", "1/4"),
            ("PBS_ARRAY_INDEX", "2", "2/4"),
            ("FLUX_JOB_CC", "0", "0/4"),
        ] {
            assert_eq!(resolve("/4", &[(name, value)]), Ok(format!("{shard} {name}")));
            assert_eq!(resolve("", &[(name, value)]), Err(ShardError::NoCount(name)));
        }
        let none = [("SGE_TASK_ID", "undefined"), ("LSB_JOBINDEX", "0")];
        assert_eq!(resolve("/4", &none), Err(ShardError::NoScheduler));
        let (name, number, first, count) = ("SGE_TASK_ID", 5, 1, 4);
        let error = ShardError::OutOfRange { name, number, first, count };
        assert_eq!(error.to_string(), "SGE_TASK_ID is 5, but 4 tasks are numbered from 1 to 4");
        assert_eq!(resolve("/4", &[(name, "5")]), Err(error));
    }

    #[test]
    fn what_is_not_told_is_an_error() {
        for value in ["", "/4"] {
            assert_eq!(resolve(value, &[]), Err(ShardError::NoScheduler));
        }
        let name = "HQ_TASK_ID";
        for (text, error) in [
            ("4", ShardError::OutOfRange { name, number: 4, first: 0, count: 4 }),
            ("-1", ShardError::NotANumber { name, value: "-1".to_owned() }),
            ("", ShardError::NotANumber { name, value: String::new() }),
        ] {
            assert_eq!(resolve("/4", &[(name, text)]), Err(error));
        }
        assert_eq!(resolve("", &[(SLURM[0], "1")]), Err(ShardError::NotSet(SLURM[1])));
    }
}

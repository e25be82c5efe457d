//! `driftless animate`.

#[cfg(feature = "harness")]
use std::path::Path;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use clap::Args;
use serde_json::json;

use super::kind::{Kind, read_or};
use super::progress::Bar;
use super::replay::TrajectoryOptions;
use super::{CliError, say_json, start_worker_threads, watch};
use crate::film::{Film, FilmFormat, Size, View, write_film};
use crate::output::{check_folder_writable, check_writable};
use crate::reorientation::{GivenTrajectory, Motion, MotionFilm, Published, ReplayFile, Replayed};
use crate::task::Task;
use crate::words::plural;

/// Most frames of a film.
const MOST_FRAMES: f64 = 100_000.0;

/// Intervals of a motion that is drawn, at least.
const LEAST_INTERVALS: usize = 200;

/// Draw a motion as a film
#[derive(Debug, Args)]
pub(super) struct Animate {
    /// Motion as `replay` reads it: a file with a [motion] table, or a trajectory in .yaml, .json, .csv or .parquet; or a folder of
    /// results, for its best motion; without one, the motion published by Xiao et al. (2023)
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    #[command(flatten)]
    reading: TrajectoryOptions,
    /// Instance whose best motion is drawn, of a folder of results [default: the first]
    #[arg(long, value_name = "LABEL")]
    instance: Option<String>,
    /// File to write: .gif, .apng or .png (animated), .mp4 or .webm (where ffmpeg is installed); or a folder, for a PNG of each
    /// frame
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Width and height [pixels]
    #[arg(long, value_name = "SIZE", default_value_t = Size::FULL_HD)]
    size: Size,
    /// Frames per second
    #[arg(long, value_name = "N", default_value_t = 30.0, allow_negative_numbers = true, value_parser = fps)]
    fps: f64,
    /// Seconds of the motion in a second of the film
    #[arg(long, value_name = "N", default_value_t = 1.0, allow_negative_numbers = true, value_parser = speed)]
    speed: f64,
    /// Where it is seen from, in inertial axes: angle from x towards y, angle above both [degrees]
    #[arg(
        long,
        value_name = "AZIMUTH,ELEVATION",
        default_value_t = View::default(),
        allow_hyphen_values = true
    )]
    view: View,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

fn fps(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|fps| (1.0..=240.0).contains(fps));
    found.ok_or_else(|| "expected a number from 1 to 240".to_owned())
}

fn speed(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|speed| (1e-3..=1e3).contains(speed));
    found.ok_or_else(|| "expected a number from 0.001 to 1000".to_owned())
}

impl Animate {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let format = self.format()?;
        start_worker_threads()?;
        match self.file.as_deref() {
            #[cfg(feature = "harness")]
            Some(folder) if folder.is_dir() => self.draw_best(folder, format),
            Some(file) if GivenTrajectory::has_name(file) => {
                self.check_instance()?;
                let (task, trajectory) = self.reading.read(file)?;
                let replayed = Replayed::new(&task, &trajectory.points);
                let duration = trajectory.points.duration();
                self.draw(&task, duration, format, |intervals| replayed.sample(intervals))
            }
            #[cfg(not(feature = "harness"))]
            Some(folder) if folder.is_dir() => {
                let message = "this build leaves out folders of results".to_owned();
                Err(CliError::Usage { message, help: None })
            }
            file => {
                self.check_instance()?;
                self.reading.check_unused()?;
                let document = read_or(file, Kind::Motion, ReplayFile::paper)?;
                let published = ReplayFile::read(&document)?.build(&document)?;
                let Published { problem, coefficients, duration, .. } = &published;
                let sample = |intervals| problem.sample(coefficients, *duration, intervals);
                self.draw(problem.task(), *duration, format, sample)
            }
        }
    }

    /// The format, where all is as that takes it.
    fn format(&self) -> Result<FilmFormat, CliError> {
        let usage = |message: String| CliError::Usage { message, help: None };
        let format = FilmFormat::of(&self.out).ok_or_else(|| {
            let endings = FilmFormat::ENDINGS;
            usage(format!(
                "cannot tell the format of {}, expected a name in {endings}",
                self.out.display()
            ))
        })?;
        let most = format.most_per_second();
        if self.fps > most {
            let fps = self.fps;
            return Err(usage(format!(
                "--fps: found {fps}, and viewers show at most {most} frames of a GIF per second"
            )));
        }
        format.check()?;
        match format {
            FilmFormat::Stills => check_folder_writable(&self.out)?,
            _ => check_writable(&self.out)?,
        }
        Ok(format)
    }

    /// Refuses an instance of what is not a folder of results.
    fn check_instance(&self) -> Result<(), CliError> {
        if self.instance.is_some() {
            let message = "found --instance, which is for a folder of results".to_owned();
            return Err(CliError::Usage { message, help: None });
        }
        Ok(())
    }

    #[cfg(feature = "harness")]
    fn draw_best(&self, folder: &Path, format: FilmFormat) -> Result<(), CliError> {
        use super::results::start_all_threads;
        use crate::experiment::{Folder, load};
        use crate::reorientation::best_motions;

        self.reading.check_unused()?;
        start_all_threads()?;
        let folder = Folder::open(folder, &crate::registry::registry())?;
        let runs = load(&folder.plan, &folder.store)?;
        super::warnings::warn_of_damage(&folder.store);
        let all = best_motions(&folder.plan.results(&runs));
        let mut chosen = all.iter();
        let best = match &self.instance {
            None => chosen.next(),
            Some(label) => chosen.find(|best| best.instance.label == *label),
        };
        if let Some(best) = best {
            let label = &best.instance.label;
            let of = if label.is_empty() { String::new() } else { format!(" of `{label}`") };
            note!("note: the best motion{of}, by {}, seed {}", best.optimiser, best.run.seed);
            let sample = |intervals: usize| best.sample(intervals);
            return self.draw(best.problem.task(), best.duration, format, sample);
        }
        let (Some(asked), false) = (&self.instance, all.is_empty()) else {
            let message = format!(
                "{} has no motions: its problems have none, or no run is stored",
                folder.path().display()
            );
            return Err(CliError::Usage { message, help: None });
        };
        let labels: Vec<&str> = all.iter().map(|best| &*best.instance.label).collect();
        Err(CliError::Usage {
            message: format!("--instance: found no motion of an instance `{asked}`"),
            help: Some(format!("instances with a motion: {}", labels.join(", "))),
        })
    }

    fn draw(
        &self,
        task: &Task,
        duration: f64,
        format: FilmFormat,
        sample: impl FnOnce(usize) -> Motion,
    ) -> Result<(), CliError> {
        let frames = duration / self.speed * self.fps;
        if frames > MOST_FRAMES {
            let message = format!(
                "found {frames:.0} frames of a motion of {duration:.3} s, expected {MOST_FRAMES} or fewer"
            );
            let help = Some("a larger --speed or a smaller --fps takes fewer".to_owned());
            return Err(CliError::Usage { message, help });
        }
        let intervals = frames.round().max(1.0) as usize;
        // Few frames still show a smooth path of the tool.
        let finer = LEAST_INTERVALS.div_ceil(intervals);
        let motion = sample(intervals * finer);
        let film = Film { size: self.size, count: intervals + 1, per_second: self.fps };
        let drawn = MotionFilm::new(task, &motion, self.view, self.size);
        let watch = watch();
        let done = Arc::new(AtomicU64::new(0));
        {
            let count = done.clone();
            let _bar =
                Bar::counting(film.count as u64, "frames", move || count.load(Ordering::Relaxed));
            let draw = |i| drawn.picture(i * finer);
            let (go_on, count) = (
                || !watch.is_interrupted(),
                || {
                    done.fetch_add(1, Ordering::Relaxed);
                },
            );
            write_film(&self.out, format, film, &draw, &go_on, &count)?;
        }
        let (file, seconds) = (self.out.display(), film.seconds(format));
        if self.json {
            return say_json(&json!({
                "file": file.to_string(),
                "frames": film.count,
                "duration_s": seconds,
                "motion_duration_s": duration,
            }));
        }
        say!("{file}: {}, {seconds:.2} s", plural(film.count, "frame"));
        Ok(())
    }
}

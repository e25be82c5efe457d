//! `driftless animate`: films of motions that come with the program, and what is wrong with what it is given.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// Runs `driftless` in a folder.
fn run(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_driftless"));
    command.args(args).current_dir(folder).env("LC_ALL", "C.UTF-8").env("NO_COLOR", "1");
    command.output().unwrap()
}

fn said(output: &Output) -> String {
    // Long messages are wrapped.
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    text.replace(['│', '╰', '─', '▶'], " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The published motion takes 6.3407 s: at ten pictures per second 63 intervals.
#[test]
fn a_gif_of_the_published_motion() {
    let folder = TempDir::new().unwrap();
    let small = ["--size", "160x90", "--fps", "10"];
    for name in ["a.gif", "b.gif"] {
        let output = run(folder.path(), &[&["animate", "--out", name], &small[..]].concat());
        assert!(output.status.success(), "{}", said(&output));
        assert!(String::from_utf8_lossy(&output.stdout).contains("64 frames, 7.40 s"));
    }
    let [bytes, again] = ["a.gif", "b.gif"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert!(bytes == again, "two films of one motion differ");
    let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
    assert_eq!((decoder.width(), decoder.height()), (160, 90));
    let mut delays = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        delays.push(frame.delay);
    }
    // The last picture stays a second longer.
    assert_eq!((delays.len(), delays[0], delays[63]), (64, 10, 110));
    let other = [&["animate", "--out", "c.gif", "--view", "-20,-30"], &small[..]].concat();
    assert!(run(folder.path(), &other).status.success());
    assert!(fs::read(folder.path().join("c.gif")).unwrap() != bytes);
}

/// A trajectory of one of the shipped robots, faster, as a folder of pictures.
#[test]
fn pictures_of_a_trajectory() {
    let folder = TempDir::new().unwrap();
    let plan = ["plan", "ur5e", "--budget", "50", "--motion", "m.csv"];
    assert!(run(folder.path(), &plan).status.success());
    let args = ["animate", "m.csv", "--task", "ur5e", "--out", "frames/", "--size", "64x64"];
    let output = run(folder.path(), &[&args[..], &["--fps", "2", "--speed", "4"]].concat());
    assert!(output.status.success(), "{}", said(&output));
    let files = fs::read_dir(folder.path().join("frames")).unwrap().count();
    assert!((2..20).contains(&files), "{files}");
    let bytes = fs::read(folder.path().join("frames/frame-1.png")).unwrap();
    let reader = png::Decoder::new(&bytes[..]).read_info().unwrap();
    assert_eq!((reader.info().width, reader.info().height), (64, 64));
}

#[test]
fn what_is_wrong_is_told() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("task.toml", "[task]\nrobot = 'ur5e'\n");
    write("bad.csv", "time,elbow_rad\n0,0\n1,1\n");
    write(
        "long.toml",
        "[motion]\nalpha6 = [0, 0, 0, 0, 0, 0]\nalpha7 = [0, 0, 0, 0, 0, 0]\nt_f = 1e7\n",
    );
    for (args, expected) in [
        (&["--out", "film.avi"][..], "cannot tell the format of film.avi, expected a name in .gif"),
        (&["--out", "film.gif", "--fps", "60"], "found 60, and viewers show at most 50"),
        (&["--out", "film.gif", "--size", "0x0"], "expected a width and a height of 64 to 7680"),
        (&["--out", "film.gif", "--size", "99999x99999"], "expected a width and a height"),
        (&["--out", "film.gif", "--speed", "0"], "expected a number from 0.001 to 1000"),
        (&["--out", "film.gif", "--view", "1,200"], "expected azimuth and elevation"),
        (&["--out", "film.gif", "task.toml"], "is a task file, expected a motion file"),
        (&["--out", "film.gif", "--task", "task.toml"], "found --task, which is for a trajectory"),
        (&["--out", "film.gif", "--task", "task.toml", "bad.csv"], "bad.csv"),
        (&["--out", "film.gif", "long.toml"], "frames of a motion of 10000000.000 s"),
        (&["--out", "film.gif", "gone.toml"], "cannot read gone.toml"),
    ] {
        let output = run(folder.path(), &[&["animate"], args].concat());
        let text = said(&output);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {text}");
        assert!(text.contains(expected), "{args:?}: {text}");
        assert!(!folder.path().join("film.gif").exists(), "{args:?}");
    }
    let output = run(folder.path(), &["animate", "--out", "gone/film.gif"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("cannot write gone/film.gif"), "{}", said(&output));
}

/// Videos are written by ffmpeg: without one that is told, and where it fails, what it says.
#[cfg(unix)]
#[test]
fn videos_are_for_ffmpeg() {
    use std::os::unix::fs::PermissionsExt as _;

    let folder = TempDir::new().unwrap();
    let bin = folder.path().join("bin");
    fs::create_dir(&bin).unwrap();
    let animate = |out: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_driftless"));
        command.args(["animate", "--out", out, "--size", "64x64", "--fps", "2"]);
        command.current_dir(folder.path()).env("NO_COLOR", "1");
        // Beside the program under test nothing but a shell's own commands are needed.
        command.env("PATH", format!("{}:/usr/bin:/bin", bin.display()));
        command
    };
    let ffmpeg = |script: &str| {
        let path = bin.join("ffmpeg");
        fs::write(&path, format!("#!/bin/sh\n[ \"$1\" = -version ] && exit 0\n{script}\n"))
            .unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    };
    let output = animate("film.mp4").env("PATH", &bin).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains(".mp4 is written by ffmpeg, which could not be started"));
    assert!(said(&output).contains("write .gif, .apng or a folder"), "{}", said(&output));
    // What stands for ffmpeg writes how many bytes it was given: 14 pictures of 64 × 64 pixels of three.
    ffmpeg("for last; do :; done\nwc -c > \"$last\"");
    let output = animate("film.webm").output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let bytes = fs::read_to_string(folder.path().join("film.webm")).unwrap();
    assert_eq!(bytes.trim(), (14 * 64 * 64 * 3).to_string());
    // One that ends before it has all pictures has not written a film, whatever it says.
    ffmpeg("exec <&-; sleep 1; exit 0");
    let output = animate("short.mp4").output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("ended before it had all pictures"), "{}", said(&output));
    assert!(!folder.path().join("short.mp4").exists());
    ffmpeg("echo no such codec >&2; exit 1");
    let output = animate("film.mp4").output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("ffmpeg failed: no such codec"), "{}", said(&output));
    assert!(!folder.path().join("film.mp4").exists());
}

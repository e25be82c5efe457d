//! A task that is served to whoever asks.

use std::fs;
use std::io::{BufRead, BufReader, Read as _, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};

/// Starts `driftless serve`.
fn serve(args: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_driftless"));
    command.arg("serve").args(args).env("NO_COLOR", "1").env_remove("DRIFTLESS_TOKEN");
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// The next line.
fn hear(lines: &mut impl BufRead) -> Value {
    let mut line = String::new();
    lines.read_line(&mut line).unwrap();
    serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: `{line}`"))
}

fn say(lines: &mut impl Write, message: &Value) {
    writeln!(lines, "{message}").unwrap();
    lines.flush().unwrap();
}

/// Spends a budget of 100 in two batches; what the search has come to.
fn spend(from: &mut impl BufRead, to: &mut impl Write) -> Value {
    let opening = hear(from);
    assert_eq!(
        (&opening["driftless"], &opening["role"], &opening["budget"], &opening["seed"]),
        (&json!(1), &json!("optimiser"), &json!(100), &json!(7))
    );
    let dimension = opening["problem"]["dimension"].as_u64().unwrap();
    assert_eq!(dimension, 12);
    say(to, &json!({ "hello": { "name": "mine" } }));
    let point = |i: u64| (0..dimension).map(|k| 0.0004 * (i * k) as f64).collect::<Vec<f64>>();
    let batch: Vec<_> = (0..64).map(point).collect();
    say(to, &json!({ "id": "a", "x": batch }));
    let first = hear(from);
    let costs = |answer: &Value| answer["cost"].as_array().unwrap().len();
    assert_eq!((&first["id"], costs(&first), &first["left"]), (&json!("a"), 64, &json!(36)));
    say(to, &json!({ "x": batch }));
    let second = hear(from);
    assert_eq!((costs(&second), &second["left"]), (36, &json!(0)));
    // The same points cost the same.
    let all = first["cost"].as_array().unwrap();
    assert_eq!(second["cost"].as_array().unwrap()[..], all[..36]);
    assert_eq!(hear(from), json!({ "stop": "budget" }));
    let result = hear(from)["result"].take();
    let least = all.iter().map(|cost| cost.as_f64().unwrap()).fold(f64::INFINITY, f64::min);
    let found = result["j"].as_f64().unwrap();
    // The best motion is evaluated again with finer steps.
    assert!((found - least).abs() < 1e-6 * least, "{found} {least}");
    assert_eq!(
        (&result["optimiser"], &result["evaluations"], &result["interrupted"]),
        (&json!("mine"), &json!(100), &json!(false))
    );
    result
}

#[test]
fn a_task_is_served_on_standard_streams() {
    let folder = tempfile::tempdir().unwrap();
    let motion = folder.path().join("motion.csv");
    let mut served =
        serve(&["--budget", "100", "--seed", "7", "--motion", motion.to_str().unwrap()]);
    let mut from = BufReader::new(served.stdout.take().unwrap());
    let mut to = served.stdin.take().unwrap();
    let result = spend(&mut from, &mut to);
    let mut rest = String::new();
    from.read_to_string(&mut rest).unwrap();
    assert_eq!(rest, "");
    let output = served.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    assert!(said.contains("the paper's task by mine, seed 7"), "{said}");
    // What is written is the motion that was told.
    let last = fs::read_to_string(motion).unwrap();
    let end = last.lines().last().unwrap().split(',').next().unwrap().parse::<f64>().unwrap();
    assert!((end - result["t_f"].as_f64().unwrap()).abs() < 1e-9, "{end} {result}");
}

/// Who does not know the token is sent away, and who does is served after that.
#[test]
fn a_task_is_served_over_a_socket() {
    let mut served = serve(&["--budget", "100", "--seed", "7", "--listen"]);
    let mut errors = BufReader::new(served.stderr.take().unwrap());
    let mut line = String::new();
    while !line.starts_with("listening on ") {
        line.clear();
        assert!(errors.read_line(&mut line).unwrap() > 0, "never listens");
    }
    let words: Vec<&str> = line.split([' ', ',', '\n']).collect();
    let (address, token) = (words[2], words[5]);
    let connect = |token: &str| {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(Duration::from_mins(1))).unwrap();
        let mut to = stream.try_clone().unwrap();
        say(&mut to, &json!({ "token": token }));
        (BufReader::new(stream), to)
    };
    for wrong in ["", "0123456789abcdef0123456789abcdef"] {
        let (mut from, _to) = connect(wrong);
        let refusal = hear(&mut from);
        assert_eq!(refusal["stop"], json!("failed"));
        assert!(refusal["error"].as_str().unwrap().contains("DRIFTLESS_TOKEN"), "{refusal}");
    }
    let (mut from, mut to) = connect(token);
    spend(&mut from, &mut to);
    assert!(served.wait().unwrap().success());
}

/// What a client does wrong is said, with status 1, and it is told that its search has failed.
#[test]
fn mistakes_of_a_client_are_told() {
    for (sent, told) in [
        ("", "closed its output before it was done"),
        ("{\"x\": [0]}\n", "said something before it said `hello`"),
        ("{\"hello\": {}}\n{\"x\": [0]}\n", "sent a point with 1 variable, expected 12"),
        ("{\"hello\": {}}\n{\"done\": true}\n", "no cost was asked for"),
        ("{\"hello\": {}}\nready?\n{'x': 0}\n", "JSON has double quotes"),
    ] {
        let mut served = serve(&[]);
        served.stdin.take().unwrap().write_all(sent.as_bytes()).unwrap();
        let output = served.wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap().replace(['│', '\n'], " ");
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains(told), "{sent}: {said}");
        let last = String::from_utf8(output.stdout).unwrap();
        let last: Value = serde_json::from_str(last.lines().last().unwrap()).unwrap();
        assert_eq!(last["stop"], json!("failed"));
        assert!(last["error"].as_str().unwrap().contains(told), "{last}");
    }
    let output = serve(&["--formulation", "polar"]).wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("no formulation `polar`, expected raw, scaled or time-free"), "{said}");
}

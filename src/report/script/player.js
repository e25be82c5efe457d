// Playing a motion: time, controls, and what they say.

/** From which share of a limit on it counts as reached. */
const AT_LIMIT = 0.99;

/** A pose between two frames. */
function poseAt(frames, share) {
  const place = Math.min(Math.max(share, 0), 1) * (frames.length - 1);
  const i = Math.min(Math.floor(place), frames.length - 2);
  const [a, b, rest] = [frames[i], frames[i + 1], place - i];
  const all = (key) => a[key].map((from, k) => between(from, b[key][k], rest));
  return {
    position: between(a.position, b.position, rest),
    attitude: attitudeBetween(a.attitude, b.attitude, rest),
    origins: all("origins"),
    tips: all("tips"),
    axes: all("axes"),
    jaw: between(a.jaw, b.jaw, rest),
  };
}

/** A joint's position, rate, acceleration and jerk between two frames. */
function stateAt(states, share) {
  const place = share * (states.length - 1);
  const i = Math.min(Math.floor(place), states.length - 2);
  return between(states[i], states[i + 1], place - i);
}

/** A number between two frames. */
function valueAt(values, share) {
  return stateAt(values.map((value) => [value]), share)[0];
}

/** How much of a limit is used; all of it where bodies that are to keep a distance touch. */
function shareOf({ limit, is_least }, value) {
  if (!is_least) return value / limit;
  return value > 0 ? limit / value : 1;
}

/** Which bodies come closest, and when. */
function closestSentence({ between: [one, other], distance, at }) {
  const far = distance < 0 ? `overlap by ${(-distance).toFixed(3)} m` : `come within ${distance.toFixed(3)} m of each other`;
  return `${one} and ${other} ${far} (at ${at.toFixed(2)} s); the red line joins what is nearest.`;
}

/** How much of what it may do a joint does: of its range to either side of the middle, and of its limits. */
function shares({ range: [low, high], limits }, [angle, ...derivatives]) {
  const ofRange = Math.abs(angle - (low + high) / 2) / ((high - low) / 2);
  return [ofRange, ...derivatives.map((value, k) => Math.abs(value) / limits[k])];
}

class Player {
  constructor(section, scenes) {
    const part = (name) => section.querySelector(`[data-part="${name}"]`);
    this.scenes = scenes;
    this.view = new View(part("canvas"));
    this.recorder = new Recorder(part("canvas"));
    this.parts = Object.fromEntries(
      ["canvas", "play", "scrub", "speed", "loop", "reset", "record", "instance", "about", "time", "yaw", "pitch", "roll", "error", "joints", "limits", "limited", "marks"]
        .map((name) => [name, part(name)]),
    );
    this.listen();
    this.choose(0);
  }

  listen() {
    const { canvas, play, scrub, reset, record, instance } = this.parts;
    play.addEventListener("click", () => this.toggle());
    record.hidden = !this.recorder.type;
    record.addEventListener("click", () => this.record());
    canvas.addEventListener("keydown", (event) => {
      if (event.key !== " ") return;
      event.preventDefault();
      this.toggle();
    });
    scrub.addEventListener("input", () => {
      this.pause();
      this.go(Number(scrub.value) / Number(scrub.max));
    });
    reset.addEventListener("click", () => {
      this.view.camera.reset();
      this.view.draw();
    });
    instance?.addEventListener("change", () => this.choose(instance.selectedIndex));
  }

  /** Begins with another motion. */
  choose(index) {
    this.pause();
    this.scene = this.scenes[index];
    const { optimiser, seed, cost, duration, joints, largest_turn, largest_turn_at, closest, limited = [] } = this.scene;
    this.parts.about.textContent =
      `Found by ${optimiser} with seed ${seed}: J = ${significant(cost)}, ${significant(duration)} s. ` +
      `On the way the base is up to ${largest_turn.toFixed(1)}° from where it started (at ${largest_turn_at.toFixed(2)} s).` + (closest ? ` ${closestSentence(closest)}` : "");
    this.parts.canvas.ariaLabel =
      `The robot seen from outside, in inertial axes: the base and ${joints.length} ` +
      "joints of arms that turn it, the way of the tool, the base’s axes, and the base at its goal as a dashed outline. " +
      "Arrow keys turn the view, plus and minus zoom, Home resets, space plays and pauses.";
    this.rows = joints.map((joint) => jointRow(joint));
    this.parts.joints.replaceChildren(...this.rows.map(({ row }) => row));
    this.limits = limited.map((one) => limitRow(one, () => this.jump(one.worst_at)));
    this.parts.marks.replaceChildren(...limited.map((one) => mark(one, duration)));
    this.parts.limits.hidden = limited.length === 0;
    this.parts.limited.replaceChildren(...this.limits.map(({ row }) => row));
    this.view.show(this.scene);
    this.go(0);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  /** Plays the motion from its start, once, and offers what was seen as a file. */
  record() {
    if (this.recorder.isRecording) return this.pause();
    this.pause();
    this.go(0);
    this.recorder.start("motion.webm");
    this.parts.record.textContent = "Stop";
    this.play();
  }

  play() {
    if (this.share >= 1) this.share = 0;
    this.playing = true;
    this.parts.play.textContent = "Pause";
    let before = performance.now();
    const step = (now) => {
      const share = this.share + (Math.max(0, now - before) / 1000 / this.scene.duration) * Number(this.parts.speed.value);
      before = now;
      const ends = share >= 1 && (this.recorder.isRecording || !this.parts.loop.checked);
      this.go(ends ? 1 : share % 1);
      if (ends) this.pause();
      else this.frame = requestAnimationFrame(step);
    };
    this.frame = requestAnimationFrame(step);
  }

  pause() {
    this.playing = false;
    // Else a frame that was asked for already would go on beside those of the next start.
    cancelAnimationFrame(this.frame);
    this.parts.play.textContent = "Play";
    this.recorder.stop();
    this.parts.record.textContent = "Save film";
  }

  /** Stops at a time. */
  jump(time) {
    this.pause();
    this.go(time / this.scene.duration);
  }

  /** Shows the motion at a share of its time. */
  go(share) {
    this.share = share;
    const { scene, parts } = this;
    const pose = poseAt(scene.frames, share);
    const [now, all] = [(share * scene.duration).toFixed(2), scene.duration.toFixed(2)];
    parts.scrub.value = share * Number(parts.scrub.max);
    parts.scrub.ariaValueText = `${now} s of ${all} s`;
    parts.time.textContent = `${now} of ${all} s`;
    const angles = yawPitchRoll(pose.attitude);
    ["yaw", "pitch", "roll"].forEach((name, k) => (parts[name].textContent = degrees(angles[k])));
    parts.error.textContent = degrees(angleBetween(pose.attitude, scene.goal.attitude));
    scene.joints.forEach((joint, i) => this.rows[i].tell(stateAt(joint.states, share)));
    (scene.limited ?? []).forEach((one, i) => this.limits[i].tell(valueAt(one.values, share)));
    this.view.at(pose, share);
  }
}

/** An angle to hundredths. */
function degrees(angle) {
  return `${decimals(angle, 2)}°`;
}

/** A number with so many decimals, with a minus that is as wide as a digit, and no minus before nothing. */
function decimals(number, count) {
  const text = number.toFixed(count);
  return Number(text) === 0 ? (0).toFixed(count) : text.replace("-", "−");
}

const MEASURES = ["position", "rate", "acceleration", "jerk"];

/** A joint's row of the table, and how to tell it the joint's state. */
function jointRow(joint) {
  const row = document.createElement("tr");
  const name = document.createElement("th");
  name.scope = "row";
  name.textContent = joint.name;
  const angle = document.createElement("td");
  angle.className = "real";
  const gauges = MEASURES.map((measure) => gauge(`${measure} of ${joint.name}, share of its limit`));
  row.append(name, angle, ...gauges.map(({ cell }) => cell));
  const tell = (state) => {
    angle.textContent = joint.unit === "m" ? `${decimals(state[0], 3)} m` : degrees(state[0]);
    shares(joint, state).forEach((share, k) => gauges[k].tell(share));
  };
  return { row, tell };
}

/** Where on the time line most of a limit is used. */
function mark({ worst_at }, duration) {
  const span = document.createElement("span");
  span.style.left = `${(100 * worst_at) / duration}%`;
  return span;
}

/** A row for what has a limit on the way, and how to tell it the value now. Its worst moment is a button that calls `jump`. */
function limitRow(limited, jump) {
  const { name, unit, limit, is_least, worst, worst_at } = limited;
  const row = document.createElement("tr");
  const head = document.createElement("th");
  head.scope = "row";
  head.textContent = name;
  const cells = [0, 1, 2].map(() => Object.assign(document.createElement("td"), { className: "real" }));
  const text = (value) => (unit ? `${Number(value.toPrecision(3))} ${unit}` : `${Math.round(100 * value)} %`).replace(/ °$/, "°").replace("-", "−");
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = `${text(worst)} at ${worst_at.toFixed(2)} s`;
  button.ariaLabel = `Show ${name} at its worst: ${button.textContent}`;
  button.addEventListener("click", jump);
  cells[1].append(button);
  cells[2].textContent = `${is_least ? "≥" : "≤"} ${text(limit)}`;
  const { cell, tell } = gauge(`${name}, share of its limit`);
  row.append(head, ...cells, cell);
  return {
    row,
    tell: (value) => {
      cells[0].textContent = text(value);
      tell(shareOf(limited, value));
    },
  };
}

/** A cell with a bar and its share in words. */
function gauge(label) {
  const cell = document.createElement("td");
  const meter = Object.assign(document.createElement("meter"), { min: 0, max: 1, low: 0, high: AT_LIMIT, optimum: 0.5 });
  meter.ariaLabel = label;
  const text = document.createElement("span");
  cell.className = "gauge";
  cell.append(meter, text);
  const tell = (share) => {
    const full = share >= AT_LIMIT;
    meter.value = Math.min(share, 1);
    text.textContent = full ? `${Math.round(100 * share)} % limit` : `${Math.round(100 * share)} %`;
    cell.classList.toggle("full", full);
  };
  return { cell, tell };
}

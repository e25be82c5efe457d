// The picture: everything in inertial axes, sorted by distance, drawn from back to front.

const LIGHT = {
  sky: ["#f4f6f8", "#e3e8ed"], star: "#9aa7b4", grid: "#b9c3cd", ghost: "#0b5c8f", past: "#b4500f", ahead: "#c9b8a8",
  text: "#1c1e21", x: "#b54708", y: "#00704f", z: "#005a96",
  near: "#b3261e", keepOut: [196, 120, 150], body: [214, 205, 184], front: [214, 138, 66], panel: [58, 84, 138], joint: [92, 100, 110], link: [236, 238, 240], tool: [70, 76, 84],
};
const DARK = {
  sky: ["#10141b", "#05070a"], star: "#8793a5", grid: "#2b3440", ghost: "#7cc0ee", past: "#f0a35e", ahead: "#5a4a3c",
  text: "#e8eaed", x: "#f08a4b", y: "#3cc79b", z: "#62b0ee",
  near: "#ff8a80", keepOut: [176, 104, 136], body: [190, 180, 156], front: [222, 146, 74], panel: [66, 96, 160], joint: [104, 112, 124], link: [222, 226, 230], tool: [120, 128, 138],
};

/** Where the light comes from, and how much reaches what it does not. */
const SUN = unit([0.6, -0.25, 0.85]);
const AMBIENT = 0.42;

/** Directions spread evenly over the sky, shaken so that they look like stars; the same ones every time. */
const STAR_COUNT = 1500;
const STARS = Array.from({ length: STAR_COUNT }, (_, i) => {
  const noise = (k) => ((Math.sin(i * 12.9898 + k * 78.233) * 43758.5453) % 1 + 1) % 1;
  const [height, angle] = [1 - (2 * (i + noise(1))) / STAR_COUNT, i * 2.39996 + noise(2)];
  const ring = Math.sqrt(Math.max(0, 1 - height * height));
  return { direction: [ring * Math.cos(angle), ring * Math.sin(angle), height], size: 0.6 + 1.4 * noise(3) ** 3 };
});

class View {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.camera = new Camera();
    this.pose = null;
    handle(canvas, this.camera, () => this.draw());
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** Shows a motion: fits the camera to all that it passes through. */
  show(scene) {
    this.scene = scene;
    this.palette = null;
    const corners = baseCorners(scene);
    const places = [...scene.frames, scene.goal].flatMap(({ position, attitude, origins, tips }) =>
      [...corners, ...origins, ...tips].map((point) => add(position, turn(attitude, point))),
    );
    const afloat = (scene.keep_outs ?? []).filter(({ on_base }) => !on_base);
    places.push(...afloat.flatMap((solid) => solidFaces(solid).flatMap(({ points }) => points)));
    this.camera.fit(places);
    this.floor = places.reduce((least, place) => Math.min(least, place[2]), Infinity) - 0.1 * this.camera.radius;
    this.trace = scene.frames.map(({ position, attitude, origins }) => add(position, turn(attitude, origins.at(-1))));
    this.radius = 0.03 * (reachOf(scene) || this.camera.radius);
  }

  /** Shows a motion at a share of its time. */
  at(pose, share) {
    this.pose = pose;
    this.share = share;
    this.draw();
  }

  draw() {
    const { canvas, context, camera } = this;
    const density = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!this.pose || !width) return;
    const [columns, rows] = [Math.round(width * density), Math.round(height * density)];
    if (canvas.width !== columns || canvas.height !== rows) Object.assign(canvas, { width: columns, height: rows });
    context.setTransform(density, 0, 0, density, 0, 0);
    this.choosePalette();
    camera.aim(width, height);
    this.drawSky(width, height);
    const place = (point) => add(this.pose.position, turn(this.pose.attitude, point));
    const items = [...this.gridLines(), ...this.traceLines(), ...this.faces(place)];
    for (const item of items.filter(Boolean).sort((a, b) => b.depth - a.depth)) item.draw();
    this.drawGhost();
    this.drawNearest();
    this.drawAxes(place);
  }

  choosePalette() {
    const palette = isDark() ? DARK : LIGHT;
    if (palette === this.palette) return;
    this.palette = palette;
    const solids = (onBase) =>
      (this.scene.keep_outs ?? []).filter(({ on_base }) => on_base === onBase).flatMap((solid) => solidFaces(solid, palette.keepOut));
    this.body = [...baseFaces(this.scene, palette), ...solids(true)];
    this.afloat = solids(false);
  }

  drawSky(width, height) {
    const { context, camera, palette } = this;
    const sky = context.createLinearGradient(0, 0, 0, height);
    palette.sky.forEach((colour, i) => sky.addColorStop(i, colour));
    context.fillStyle = sky;
    context.fillRect(0, 0, width, height);
    context.fillStyle = palette.star;
    for (const { direction, size } of STARS) {
      const at = camera.projectSky(direction);
      if (at) context.fillRect(at[0], at[1], size, size);
    }
  }

  /** A line as something to be sorted; null where it is not in view. */
  line(from, to, colour, width, alpha = 1) {
    const [a, b] = [this.camera.project(from), this.camera.project(to)];
    if (!a || !b) return null;
    const draw = () => {
      const { context } = this;
      context.globalAlpha = alpha;
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.lineCap = "round";
      context.beginPath();
      context.moveTo(a[0], a[1]);
      context.lineTo(b[0], b[1]);
      context.stroke();
      context.globalAlpha = 1;
    };
    return { depth: (a[2] + b[2]) / 2, draw };
  }

  /** A grid at rest below the robot. */
  gridLines() {
    const { target, radius } = this.camera;
    const [cells, step] = [8, (2.4 * radius) / 8];
    const at = (i, j) => [target[0] + (i - cells / 2) * step, target[1] + (j - cells / 2) * step, this.floor];
    const lines = [];
    for (let i = 0; i <= cells; i++) {
      for (let j = 0; j < cells; j++) {
        lines.push(this.line(at(i, j), at(i, j + 1), this.palette.grid, 1));
        lines.push(this.line(at(j, i), at(j + 1, i), this.palette.grid, 1));
      }
    }
    return lines;
  }

  /** The way of the tool, the part behind it stronger than what is to come. */
  traceLines() {
    const { trace, palette } = this;
    const now = this.share * (trace.length - 1);
    return trace.slice(1).map((to, i) =>
      i < now
        ? this.line(trace[i], i + 1 <= now ? to : this.tip(), palette.past, 2.2)
        : this.line(trace[i], to, palette.ahead, 1.4),
    );
  }

  tip() {
    return add(this.pose.position, turn(this.pose.attitude, this.pose.origins.at(-1)));
  }

  /** A line between the bodies that are nearest now; it may be short, so nothing hides it. */
  drawNearest() {
    const points = this.scene.closest?.points;
    if (!points) return;
    const [from, to] = points[Math.round(this.share * (points.length - 1))];
    this.line(from, to, this.palette.near, 3)?.draw();
  }

  /** All faces that look towards the eye, shaded. */
  faces(place) {
    const { pose, palette } = this;
    const { carriers, tip_carriers } = this.scene;
    const arm = armFaces({ ...pose, carriers, tip_carriers, radius: this.radius }, palette);
    const turned = (normal) => turn(pose.attitude, normal);
    return [...this.shaded([...this.body, ...arm], place, turned), ...this.shaded(this.afloat, (point) => point, (normal) => normal)];
  }

  shaded(faces, place, turned) {
    const { camera } = this;
    return faces.map(({ points, colour, normal }) => {
      const corners = points.map(place);
      const centre = mean(corners);
      const toEye = unit(subtract(camera.eye, centre));
      let outward = normal
        ? turned(normal)
        : unit(cross(subtract(corners[1], corners[0]), subtract(corners[2], corners[0])));
      if (!normal && dot(outward, toEye) < 0) outward = scale(outward, -1);
      if (normal && dot(outward, toEye) <= 0) return null;
      const flat = corners.map((corner) => camera.project(corner));
      if (flat.some((corner) => !corner)) return null;
      const brightness = AMBIENT + (1 - AMBIENT) * Math.max(0, dot(outward, SUN)) + 0.1 * dot(outward, toEye);
      return { depth: length(subtract(camera.eye, centre)), draw: () => this.fill(flat, colour, brightness, !normal) };
    });
  }

  fill(corners, colour, brightness, isCell) {
    const { context } = this;
    const shaded = `rgb(${colour.map((part) => Math.min(255, Math.round(part * brightness))).join(" ")})`;
    context.beginPath();
    corners.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
    context.closePath();
    context.fillStyle = shaded;
    context.fill();
    // A stroke of the same colour closes the hairlines between neighbours; a lighter one parts solar cells.
    context.strokeStyle = isCell ? "rgb(176 190 214)" : shaded;
    context.lineWidth = isCell ? 0.7 : 0.8;
    context.lineJoin = "round";
    context.stroke();
  }

  /** The base as it is to end, in outline. */
  drawGhost() {
    const { context, palette } = this;
    const { goal } = this.scene;
    const place = (point) => add(goal.position, turn(goal.attitude, point));
    context.setLineDash([5, 4]);
    for (const [from, to] of baseEdges(this.scene)) this.line(place(from), place(to), palette.ghost, 1.3, 0.85)?.draw();
    context.setLineDash([]);
  }

  /** The base's axes, with letters. */
  drawAxes(place) {
    const { context, palette, camera } = this;
    const extent = 1.9 * baseSize(this.scene);
    context.font = "600 14px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    ["x", "y", "z"].forEach((name, k) => {
      const end = [0, 1, 2].map((i) => (i === k ? extent : 0));
      this.line(place([0, 0, 0]), place(end), palette[name], 2.4)?.draw();
      const letter = camera.project(place(scale(end, 1.12)));
      context.fillStyle = palette[name];
      if (letter) context.fillText(name, letter[0], letter[1]);
    });
  }
}

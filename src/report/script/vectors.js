// Vectors [x, y, z] and unit quaternions [w, x, y, z], which turn vectors from one frame's axes into another's.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(...a);
const unit = (a) => scale(a, 1 / (length(a) || 1));
const mean = (points) => scale(points.reduce(add), 1 / points.length);

/** Between two lists of numbers of any length. */
const between = (a, b, share) => a.map((from, i) => from + (b[i] - from) * share);

/** A unit vector at a right angle to another. */
function perpendicular([x, y, z]) {
  return unit(Math.abs(z) < 0.9 * Math.hypot(x, y, z) ? [-y, x, 0] : [0, -z, y]);
}

/** Turns a vector by a quaternion. */
function turn([w, ...q], v) {
  const t = scale(cross(q, v), 2);
  return add(add(v, scale(t, w)), cross(q, t));
}

/** Between two attitudes that are close to each other. */
function attitudeBetween(a, b, share) {
  const sign = a.reduce((sum, value, i) => sum + value * b[i], 0) < 0 ? -1 : 1;
  const q = between(a, b.map((value) => sign * value), share);
  return q.map((value) => value / Math.hypot(...q));
}

/** The angle of the turn from one attitude to another [°]. */
function angleBetween(a, b) {
  const cosine = a.reduce((sum, value, i) => sum + value * b[i], 0);
  const [v, u] = [a.slice(1), b.slice(1)];
  const sine = subtract(subtract(scale(u, a[0]), scale(v, b[0])), cross(v, u));
  return (2 * Math.atan2(length(sine), Math.abs(cosine)) * 180) / Math.PI;
}

/** Yaw, pitch and roll of an attitude, turns about z, y and x in this order [°]. */
function yawPitchRoll([w, x, y, z]) {
  const yaw = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  const pitch = Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x))));
  const roll = Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
  return [yaw, pitch, roll].map((angle) => (angle * 180) / Math.PI);
}

// Solids as lists of small flat faces, in metres; small ones can be drawn from back to front without a fuss.
// A face is { points, colour, normal }; the normal points out of the solid, and a sheet's has none.

/** A parallelogram in `columns` × `rows` faces. */
function patch(corner, across, up, columns, rows, colour, normal) {
  const at = (i, j) => add(corner, add(scale(across, i / columns), scale(up, j / rows)));
  const faces = [];
  for (let i = 0; i < columns; i++) {
    for (let j = 0; j < rows; j++) {
      faces.push({ points: [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], colour, normal });
    }
  }
  return faces;
}

/** A box along the axes, with half its edges; `colours` by axis and side, such as `colours["+x"]`, else `other`. */
function box(centre, half, colours, divisions) {
  return [0, 1, 2].flatMap((k) =>
    [1, -1].flatMap((side) => {
      const along = (axis, amount) => [0, 1, 2].map((i) => (i === axis ? amount : 0));
      const [i, j] = [(k + 1) % 3, (k + 2) % 3];
      const corner = add(centre, add(along(k, side * half[k]), add(along(i, -half[i]), along(j, -half[j]))));
      const colour = colours[(side > 0 ? "+" : "-") + "xyz"[k]] ?? colours.other;
      return patch(corner, along(i, 2 * half[i]), along(j, 2 * half[j]), divisions, divisions, colour, along(k, side));
    }),
  );
}

/** The twelve edges of a box, each a pair of points. */
function boxEdges(centre, half) {
  const corner = (a, b, c) => add(centre, [a * half[0], b * half[1], c * half[2]]);
  const signs = [[-1, -1], [-1, 1], [1, -1], [1, 1]];
  return signs.flatMap(([a, b]) => [
    [corner(-1, a, b), corner(1, a, b)],
    [corner(a, -1, b), corner(a, 1, b)],
    [corner(a, b, -1), corner(a, b, 1)],
  ]);
}

/** A cone's trunk between two points, with its ends closed; the far one may have a colour of its own. */
function tube(from, to, radii, colour, { sides = 12, segments = 1, end = colour } = {}) {
  const axis = subtract(to, from);
  const [u, along] = [perpendicular(axis), unit(axis)];
  const v = cross(along, u);
  const outward = (k) => {
    const angle = (2 * Math.PI * k) / sides;
    return add(scale(u, Math.cos(angle)), scale(v, Math.sin(angle)));
  };
  const directions = Array.from({ length: sides }, (_, k) => outward(k));
  const middles = Array.from({ length: sides }, (_, k) => outward(k + 0.5));
  const ring = (share) => {
    const radius = radii[0] + (radii[1] - radii[0]) * share;
    return directions.map((direction) => add(add(from, scale(axis, share)), scale(direction, radius)));
  };
  const faces = [];
  for (let s = 0; s < segments; s++) {
    const [near, far] = [ring(s / segments), ring((s + 1) / segments)];
    middles.forEach((normal, k) => {
      const next = (k + 1) % sides;
      faces.push({ points: [near[k], near[next], far[next], far[k]], colour, normal });
    });
  }
  faces.push({ points: ring(0), colour, normal: scale(along, -1) });
  faces.push({ points: ring(1), colour: end, normal: along });
  return faces;
}

/** A direction along a box's edges, in the axes that the box stands in. */
function turned(axes, [x, y, z]) {
  return add(add(scale(axes[0], x), scale(axes[1], y)), scale(axes[2], z));
}

/** The faces of a box or a capsule, in the axes that it stands in. */
function solidFaces({ ends, radius, centre, half, axes }, colour) {
  if (ends) return capsule(ends, radius, colour);
  return box([0, 0, 0], half, { other: colour }, 6).map(({ points, normal }) => ({
    points: points.map((point) => add(centre, turned(axes, point))),
    colour,
    normal: turned(axes, normal),
  }));
}

/** Whether a shape is a sheet. */
function isFlat({ half }) {
  const [thinnest, middle] = [...(half ?? [1, 1])].sort((a, b) => a - b);
  return thinnest < 0.05 * middle;
}

/** Points of a shape between which it lies. */
function cornersOf({ ends, radius, centre, half, axes }) {
  const signs = [-1, 1];
  if (ends) return ends.flatMap((end) => [0, 1, 2].flatMap((k) => signs.map((side) => end.map((x, i) => x + (i === k ? side * radius : 0)))));
  const corner = (sides) => add(centre, turned(axes, sides.map((side, k) => side * half[k])));
  return signs.flatMap((a) => signs.flatMap((b) => signs.map((c) => corner([a, b, c]))));
}

/** Points between which the base lies, in its axes. */
function baseCorners({ base, satellite }) {
  if (base) return base.flatMap(cornersOf);
  const body = { centre: [0, 0, 0], half: satellite.half, axes: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] };
  return [...cornersOf(body), ...satellite.panels.flatMap(outlineOf)];
}

/** A circle's chords about a middle, in the plane of two of the axes. */
function circle(middle, radius, [i, j]) {
  const at = (k) => middle.map((x, axis) => x + radius * (axis === i ? Math.cos((Math.PI * k) / 8) : axis === j ? Math.sin((Math.PI * k) / 8) : 0));
  return Array.from({ length: 16 }, (_, k) => [at(k), at(k + 1)]);
}

/** The edges of the base in its axes, each a pair of points. */
function baseEdges({ base, satellite }) {
  const loop = (points) => points.map((from, i) => [from, points[(i + 1) % points.length]]);
  if (!base) return [...boxEdges([0, 0, 0], satellite.half), ...satellite.panels.map(outlineOf).flatMap(loop)];
  return base.flatMap(({ ends, radius, centre, half, axes }) => {
    if (!ends) return boxEdges([0, 0, 0], half).map((edge) => edge.map((point) => add(centre, turned(axes, point))));
    if (length(subtract(...ends)) < 1e-9) return [[0, 1], [1, 2], [2, 0]].flatMap((plane) => circle(ends[0], radius, plane));
    const sides = tube(...ends, [radius, radius]).slice(0, -2);
    return sides.flatMap(({ points: [near, next, far, last] }, k) => [[near, next], [far, last], ...(k % 3 ? [] : [[near, last]])]);
  });
}

/** The farthest that the base's body reaches along an axis, of several shapes the one nearest to its origin [m]. */
function baseSize({ base, satellite }) {
  if (!base) return Math.max(...satellite.half);
  const middle = ({ ends, centre }) => length(centre ?? mean(ends));
  const body = base.reduce((a, b) => (middle(b) < middle(a) ? b : a));
  return Math.max(...cornersOf(body).flat().map(Math.abs));
}

/** All within a distance of a segment: a tube whose radius falls to nothing at its ends. */
function capsule([from, to], radius, colour) {
  const rings = 4;
  const step = subtract(to, from);
  const along = length(step) < 1e-9 ? [0, 0, 1] : unit(step);
  const faces = tube(from, to, [radius, radius], colour).slice(0, -2);
  for (const [end, side] of [[from, -1], [to, 1]]) {
    for (let k = 0; k < rings; k++) {
      const [near, far] = [k, k + 1].map((ring) => (ring * Math.PI) / (2 * rings));
      const at = (angle) => add(end, scale(along, side * radius * Math.sin(angle)));
      const radii = [radius * Math.cos(near), radius * Math.cos(far)];
      const dome = tube(at(near), at(far), radii, colour).slice(0, -2);
      faces.push(...dome.map((face) => ({ ...face, normal: unit(subtract(mean(face.points), end)) })));
    }
  }
  return faces;
}

/** The corners of a solar panel, base axes. */
function outlineOf({ corner, edges: [out, across] }) {
  return [corner, add(corner, out), add(add(corner, out), across), add(corner, across)];
}

/** The base in its axes: its stated shapes, flat ones as panels, or a made-up satellite whose front is along x. */
function baseFaces({ base, satellite }, colours) {
  if (base) return base.flatMap((shape) => solidFaces(shape, isFlat(shape) ? colours.panel : colours.body));
  const { half } = satellite;
  const nose = 0.28 * Math.min(half[1], half[2]);
  const faces = box([0, 0, 0], half, { "+x": colours.front, other: colours.body }, 8);
  faces.push(...tube([half[0], 0, 0], [half[0] + 0.9 * nose, 0, 0], [0.55 * nose, 1.5 * nose], colours.front, { sides: 18, segments: 3, end: colours.tool }));
  for (const { boom, corner, edges } of satellite.panels) {
    faces.push(...tube(...boom, [0.06 * half[0], 0.06 * half[0]], colours.joint, { sides: 6 }));
    faces.push(...patch(corner, ...edges, 8, 3, colours.panel));
  }
  return faces;
}

/** How many joints are between the base and each of the joints and the tool. */
function depthsOf(carriers) {
  const depths = [];
  for (const carrier of carriers) depths.push(carrier === null ? 0 : depths[carrier] + 1);
  return depths;
}

/** The length of the longest branch, from its first joint to its end, at the start of a motion. */
function reachOf({ carriers, tip_carriers, frames: [{ origins, tips }] }) {
  const ways = [];
  const way = (end, carrier) => (carrier === null ? 0 : ways[carrier] + length(subtract(end, origins[carrier])));
  origins.forEach((origin, i) => ways.push(way(origin, carriers[i])));
  return Math.max(...ways, ...tips.map((tip, i) => way(tip, tip_carriers[i])));
}

/** The arms in base axes: a cylinder along every joint's axis, a tapered link to what it carries, a gripper at the tool. */
function armFaces({ origins, tips, carriers, tip_carriers, axes, jaw, radius }, colours) {
  const count = origins.length - 1;
  const depths = depthsOf(carriers);
  const deepest = Math.max(1, ...depths);
  const size = (depth) => radius * (1 - (0.45 * depth) / deepest);
  const faces = [];
  const link = (end, carrier) => {
    const step = carrier === null ? 0 : length(subtract(end, origins[carrier]));
    if (step < 1e-9) return;
    const segments = Math.max(1, Math.min(10, Math.round(step / (2 * radius))));
    const radii = [0.72 * size(depths[carrier]), 0.62 * size(depths[carrier] + 1)];
    faces.push(...tube(origins[carrier], end, radii, colours.link, { sides: 10, segments }));
  };
  for (let i = 0; i < count; i++) {
    const own = size(depths[i]);
    const half = scale(axes[i], 1.15 * own);
    faces.push(...tube(subtract(origins[i], half), add(origins[i], half), [own, own], colours.joint));
  }
  origins.forEach((origin, i) => link(origin, carriers[i]));
  tips.forEach((tip, i) => link(tip, tip_carriers[i]));
  return faces.concat(gripperFaces(origins[count], axes[count], jaw, size(depths[count]), colours));
}

/** A palm and two fingers that end a little beyond the tool's origin. */
function gripperFaces(tip, approach, jaw, size, colours) {
  const palm = add(tip, scale(approach, 0.5 * size));
  const faces = tube(subtract(tip, scale(approach, 0.3 * size)), palm, [1.1 * size, 1.1 * size], colours.tool);
  for (const side of [-1, 1]) {
    const root = add(palm, scale(jaw, 0.8 * side * size));
    faces.push(...tube(root, add(root, scale(approach, 1.8 * size)), [0.34 * size, 0.2 * size], colours.tool, { sides: 6 }));
  }
  return faces;
}

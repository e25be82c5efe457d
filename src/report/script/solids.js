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

/** The corners of a solar panel, base axes. */
function outlineOf({ corner, edges: [out, across] }) {
  return [corner, add(corner, out), add(add(corner, out), across), add(corner, across)];
}

/** The satellite in base axes; the arm's mount and the front, along x, can be told from the rest. */
function satelliteFaces(satellite, colours) {
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

/** The arm in base axes: a cylinder along every joint's axis, a tapered link to the next, a gripper at the tool. */
function armFaces({ origins, axes, jaw, radius }, colours) {
  const count = origins.length - 1;
  const size = (i) => radius * (1 - (0.45 * i) / count);
  const faces = [];
  for (let i = 0; i < count; i++) {
    const half = scale(axes[i], 1.15 * size(i));
    faces.push(...tube(subtract(origins[i], half), add(origins[i], half), [size(i), size(i)], colours.joint));
    const step = length(subtract(origins[i + 1], origins[i]));
    if (step > 1e-9) {
      const segments = Math.max(1, Math.min(10, Math.round(step / (2 * radius))));
      const radii = [0.72 * size(i), 0.62 * size(i + 1)];
      faces.push(...tube(origins[i], origins[i + 1], radii, colours.link, { sides: 10, segments }));
    }
  }
  return faces.concat(gripperFaces(origins[count], axes[count], jaw, size(count), colours));
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

// A camera that circles the robot, and the hands that turn it.

/** Tangent of half the angle that the camera sees. */
const HALF_VIEW = 0.2;

/** Free share around what is seen at first. */
const MARGIN = 1.08;

const START = { azimuth: -0.95, elevation: 0.42, zoom: 1 };

class Camera {
  /** Looks at `target` from `distance`, among things of the size of `radius`. */
  constructor() {
    this.target = [0, 0, 0];
    this.radius = 1;
    this.distance = 5;
    this.reset();
  }

  /** Goes where all of these places are in view from the first direction, in a square picture. */
  fit(places) {
    const extreme = (pick) => [0, 1, 2].map((k) => places.map((place) => place[k]).reduce((a, b) => pick(a, b)));
    this.target = scale(add(extreme(Math.min), extreme(Math.max)), 0.5);
    const most = (of) => places.reduce((most, place) => Math.max(most, of(place)), 0);
    this.radius = most((place) => length(subtract(place, this.target)));
    this.face(START);
    const needed = (place) => {
      const from = subtract(place, this.target);
      const aside = Math.max(Math.abs(dot(from, this.right)), Math.abs(dot(from, this.up)));
      return (MARGIN * aside) / HALF_VIEW + dot(from, this.backward);
    };
    this.distance = most(needed);
  }

  /** Looks along a direction. */
  face({ azimuth, elevation }) {
    const [ca, sa] = [Math.cos(azimuth), Math.sin(azimuth)];
    const [ce, se] = [Math.cos(elevation), Math.sin(elevation)];
    this.backward = [ce * ca, ce * sa, se];
    this.right = [-sa, ca, 0];
    this.up = cross(this.backward, this.right);
  }

  reset() {
    Object.assign(this, START);
  }

  /** Turns by angles [rad]; never over the poles. */
  orbit(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation = Math.max(-1.5, Math.min(1.5, this.elevation + elevation));
  }

  magnify(factor) {
    this.zoom = Math.max(0.3, Math.min(8, this.zoom * factor));
  }

  /** Makes ready to project onto a picture of this size [px]. */
  aim(width, height) {
    this.face(this);
    this.eye = add(this.target, scale(this.backward, this.distance / this.zoom));
    this.middle = [width / 2, height / 2];
    this.focal = Math.min(width, height) / 2 / HALF_VIEW;
  }

  /** Place on the picture [px] and distance in front of the eye [m]; null for what is behind it. */
  project(point) {
    const from = subtract(point, this.eye);
    const depth = -dot(from, this.backward);
    if (depth < 0.02 * this.radius) return null;
    const factor = this.focal / depth;
    return [this.middle[0] + dot(from, this.right) * factor, this.middle[1] - dot(from, this.up) * factor, depth];
  }

  /** Where a direction of the sky is seen [px], whatever the camera's place. */
  projectSky(direction) {
    const depth = -dot(direction, this.backward);
    if (depth < 0.05) return null;
    const factor = this.focal / depth;
    return [this.middle[0] + dot(direction, this.right) * factor, this.middle[1] - dot(direction, this.up) * factor];
  }
}

/** Turn of an arrow key [rad], and what + and − magnify by. */
const KEY_TURN = 0.12;
const KEY_ZOOM = 1.15;

const KEYS = {
  ArrowLeft: (camera) => camera.orbit(-KEY_TURN, 0),
  ArrowRight: (camera) => camera.orbit(KEY_TURN, 0),
  ArrowUp: (camera) => camera.orbit(0, KEY_TURN),
  ArrowDown: (camera) => camera.orbit(0, -KEY_TURN),
  "+": (camera) => camera.magnify(KEY_ZOOM),
  "=": (camera) => camera.magnify(KEY_ZOOM),
  "-": (camera) => camera.magnify(1 / KEY_ZOOM),
  Home: (camera) => camera.reset(),
};

/** Lets mouse, touch and keys on a canvas move its camera; `moved` is called after each move. */
function handle(canvas, camera, moved) {
  const pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const apart = spread();
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (pointers.size === 1) {
      const perPixel = Math.PI / canvas.clientHeight;
      camera.orbit((before.x - event.clientX) * perPixel, (event.clientY - before.y) * perPixel);
    } else if (apart > 0) {
      camera.magnify(spread() / apart);
    }
    moved();
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener("wheel", (event) => {
    // Without a key the wheel moves the page.
    if (!event.ctrlKey && document.activeElement !== canvas) return;
    event.preventDefault();
    camera.magnify(Math.exp(-event.deltaY * 0.0015));
    moved();
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const move = KEYS[event.key];
    if (!move || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    move(camera);
    moved();
  });
}

// Plays the recorded walk in the page: clock, controls, and the moving point in the plane of z.
"use strict";

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** [r, g, b] in 0..1 of a custom property that holds #rrggbb. */
function channels(name) {
  const hex = colour(name).slice(1);
  return [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
}

/** The walk at a time: poses between two frames, and the frame before it. */
function moment(walk, time) {
  const place = Math.min(time / walk.frame_s, walk.poses.length - 1);
  const frame = Math.min(Math.floor(place), Math.max(0, walk.poses.length - 2));
  const share = place - frame, next = Math.min(frame + 1, walk.poses.length - 1);
  const flat = walk.poses[frame].map((p, i) => p + share * (walk.poses[next][i] - p));
  const poses = [];
  for (let i = 0; i < flat.length; i += 3) poses.push(flat.slice(i, i + 3));
  return { frame: share > 0.5 ? next : frame, poses };
}

/** Where the ground pushes, and how hard in leg lengths a body weight. */
function arrowAt(walk, { frame, poses }) {
  const foot = walk.contacts[walk.leg[frame]], [x, z, angle] = poses[foot.body];
  const s = Math.sin(angle), k = Math.cos(angle), [a, b, c] = foot.pos;
  const from = [x + k * a + s * c, b, z + k * c - s * a - foot.radius];
  const unit = (0.45 * walk.leg_length_m) / walk.weight_n;
  return { from, force: walk.force_n[frame].map((f) => f * unit) };
}

/** Distance of two labels of an axis; those one above the other need less room. */
function tickFor(low, high, upright) {
  const step = 10 ** Math.floor(Math.log10(high - low)), steps = (high - low) / step;
  const [few, some, many] = upright ? [5, 2, 1] : [2, 1, 0.5];
  return steps > 5 ? step / many : steps > 2 ? step / some : step / few;
}

/** The tube, the trace so far and the moving point, in the plane of z. */
class Portrait {
  constructor(canvas, walk) {
    this.canvas = canvas; this.walk = walk;
    const rows = [...walk.tube.lower, ...walk.tube.upper, ...walk.z];
    this.span = [0, 1].map((i) => {
      const values = rows.map((row) => row[i]);
      const low = Math.min(...values), high = Math.max(...values), edge = 0.06 * (high - low);
      return [low - edge, high + edge];
    });
  }

  draw(frame) {
    const { canvas, walk } = this, ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight, c = canvas.getContext("2d");
    canvas.width = width * ratio; canvas.height = height * ratio;
    c.scale(ratio, ratio);
    const [left, bottom] = [44, 40], inner = [width - left - 10, height - bottom - 10];
    const at = (z) => [0, 1].map((i) => {
      const share = (z[i] - this.span[i][0]) / (this.span[i][1] - this.span[i][0]);
      return i ? 10 + inner[1] * (1 - share) : left + inner[0] * share;
    });
    const line = (rows) => { c.beginPath(); rows.forEach((row) => c.lineTo(...at(row))); };
    line([...walk.tube.lower, ...[...walk.tube.upper].reverse()]);
    c.fillStyle = colour("--tube"); c.fill();
    this.axes(c, at, left, height - bottom, width);
    this.trace(c, line, frame);
    const [x, y] = at(walk.z[frame]);
    c.beginPath(); c.arc(x, y, 6, 0, 2 * Math.PI);
    c.fillStyle = colour("--point"); c.fill();
    c.lineWidth = 2; c.strokeStyle = colour("--page"); c.stroke();
  }

  /** Steps as lines, touchdowns as dotted jumps between them. */
  trace(c, line, frame) {
    const { z, leg } = this.walk;
    c.strokeStyle = colour("--trace");
    for (let from = 0; from <= frame;) {
      let to = from;
      while (to < frame && leg[to + 1] === leg[from]) to += 1;
      c.setLineDash([]); c.lineWidth = 1.5;
      line(z.slice(from, to + 1)); c.stroke();
      if (to < frame) {
        c.setLineDash([2, 4]); c.lineWidth = 1;
        line(z.slice(to, to + 2)); c.stroke();
      }
      from = to + 1;
    }
    c.setLineDash([]);
  }

  axes(c, at, left, floor, width) {
    c.fillStyle = c.strokeStyle = colour("--quiet");
    c.font = "12px system-ui, sans-serif"; c.lineWidth = 1; c.textAlign = "center";
    c.strokeRect(left, 10, width - left - 10, floor - 10);
    for (const i of [0, 1]) {
      const [low, high] = this.span[i], tick = tickFor(low, high, i === 1);
      for (let k = Math.ceil(low / tick); k * tick <= high; k++) {
        const v = Number((k * tick).toPrecision(6));
        const [x, y] = at(i ? [this.span[0][0], v] : [v, this.span[1][0]]);
        const label = String(v).replace("-", "−");
        c.textAlign = i ? "right" : "center";
        c.fillText(label, i ? x - 5 : x, i ? y + 4 : y + 15);
      }
    }
    c.textAlign = "center";
    c.fillText("z1: hip ahead of the foot [m]", (left + width - 10) / 2, floor + 32);
    c.save(); c.translate(11, (10 + floor) / 2); c.rotate(-Math.PI / 2);
    c.fillText("z2: angular momentum [kg m²/s]", 0, 0);
    c.restore();
  }
}

/** Drag, pinch, wheel and keys turn the view; `changed` is called after each. */
function steer(canvas, scene, changed) {
  const down = new Map();
  const spread = () => {
    const [a, b] = [...down.values()];
    return Math.hypot(a[0] - b[0], a[1] - b[1]);
  };
  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    down.set(e.pointerId, [e.clientX, e.clientY]);
  });
  canvas.addEventListener("pointermove", (e) => {
    const last = down.get(e.pointerId);
    if (!last) return;
    const before = down.size > 1 ? spread() : 0;
    down.set(e.pointerId, [e.clientX, e.clientY]);
    if (down.size > 1) scene.orbit(0, 0, before / Math.max(1, spread()));
    else scene.orbit(-0.008 * (e.clientX - last[0]), 0.008 * (e.clientY - last[1]), 1);
    changed();
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (e) => down.delete(e.pointerId));
  }
  canvas.addEventListener("wheel", (e) => {
    const { distance } = scene.view;
    scene.orbit(0, 0, Math.exp(0.0012 * e.deltaY));
    // At the end of the zoom the page scrolls on.
    if (scene.view.distance !== distance) { e.preventDefault(); changed(); }
  }, { passive: false });
  const keys = { ArrowLeft: [-0.1, 0, 1], ArrowRight: [0.1, 0, 1], ArrowUp: [0, 0.1, 1],
    ArrowDown: [0, -0.1, 1], "+": [0, 0, 0.9], "=": [0, 0, 0.9], "-": [0, 0, 1.1] };
  canvas.addEventListener("keydown", (e) => {
    if (!keys[e.key]) return;
    e.preventDefault();
    scene.orbit(...keys[e.key]); changed();
  });
}

function play(walk) {
  const find = (id) => document.getElementById(id);
  const canvas = find("robot"), slider = find("time"), button = find("play");
  const portrait = new Portrait(find("portrait"), walk);
  const length = (walk.poses.length - 1) * walk.frame_s;
  let scene = null, time = 0, last = null, stale = true, visible = true;
  let playing = !window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  try {
    scene = new Scene(canvas, walk.shapes, walk.leg_length_m);
  } catch (error) {
    find("no-picture").hidden = false;
    find("no-picture").textContent = `No 3-D picture: ${error.message}.`;
    canvas.hidden = true;
  }
  const initial = scene && { ...scene.view };
  const changed = () => { stale = true; };

  function show() {
    const now = moment(walk, time), steps = walk.leg.slice(1, now.frame + 1);
    const walked = steps.filter((leg, i) => leg !== walk.leg[i]).length;
    const arrow = find("forces")?.checked ? arrowAt(walk, now) : null;
    scene?.draw(now.poses, arrow, [walk.floor_m[now.frame], walk.slope],
      { sky: channels("--sky"), tile: channels("--tile") });
    portrait.draw(now.frame);
    const push = walk.force_n && Math.round(walk.force_n[now.frame][1]);
    const force = walk.force_n ? `; the ground pushes up with ${push} N` : "";
    find("reading").textContent =
      `${(walk.first_s + Math.min(time, length)).toFixed(2)} s, touchdowns: ${walked}${force}`;
    slider.value = time;
  }

  function label() {
    button.textContent = playing ? "Pause" : "Play";
    last = null;
  }

  function tick(clock) {
    if (playing && visible) {
      if (last !== null) time += (Number(find("speed").value) * (clock - last)) / 1000;
      last = clock; stale = true;
      // The last frame stays for a moment: it may be a fall.
      if (time > length + 0.8) time = 0;
    }
    if (stale) { stale = false; show(); }
    window.requestAnimationFrame(tick);
  }

  slider.max = length;
  slider.addEventListener("input", () => {
    time = Number(slider.value); playing = false; stale = true; label();
  });
  button.addEventListener("click", () => {
    playing = !playing;
    if (playing && time >= length) time = 0;
    label();
  });
  find("reset").addEventListener("click", () => {
    if (scene) Object.assign(scene.view, initial);
    changed();
  });
  find("forces")?.addEventListener("change", changed);
  window.addEventListener("resize", changed);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
  new IntersectionObserver((entries) => {
    visible = entries[entries.length - 1].isIntersecting; last = null;
  }).observe(find("portrait").parentElement);
  if (scene) steer(canvas, scene, changed);
  label();
  window.requestAnimationFrame(tick);
}

const recorded = document.getElementById("recording");
if (recorded) play(JSON.parse(recorded.textContent));

// The robot, its shadow, the floor and the ground force in WebGL 2. Knows nothing of time:
// draw(poses, arrow) shows one moment. Lengths in m, +x forward, +z up.
"use strict";

const VERTEX = `#version 300 es
in vec3 position; in vec3 normal; in vec3 colour;
uniform mat4 camera; uniform vec3 offset; uniform vec3 scale; uniform float angle;
uniform vec4 flatten;  // light, and 1 to throw a shadow on the floor
uniform vec2 floorLine;  // height at x = 0, slope
out vec3 n; out vec3 c; out vec3 world;
vec3 turn(vec3 v) {
  float s = sin(angle), k = cos(angle);
  return vec3(k * v.x + s * v.z, v.y, k * v.z - s * v.x);
}
void main() {
  vec3 p = turn(position * scale) + offset;
  if (flatten.w > 0.5) {
    float above = p.z - floorLine.x - floorLine.y * p.x;
    p -= flatten.xyz * above / (flatten.z - floorLine.y * flatten.x);
  }
  n = turn(normal / scale); c = colour; world = p;
  gl_Position = camera * vec4(p, 1.0);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec3 n; in vec3 c; in vec3 world;
uniform vec3 eye; uniform vec3 sky; uniform vec3 tile; uniform vec2 centre; uniform int kind;
out vec4 seen;
float checker(vec2 p) {
  vec2 w = fwidth(p) + 0.001, s = 2.0 * abs(fract(p * 0.5) - 0.5);
  vec2 a = clamp((s - 0.5) / w + 0.5, 0.0, 1.0);
  return a.x * (1.0 - a.y) + a.y * (1.0 - a.x);
}
void main() {
  if (kind == 1) {  // the floor fades into the sky
    vec3 tiles = mix(tile, mix(tile, sky, 0.55), checker(world.xy * 4.0));
    seen = vec4(mix(tiles, sky, smoothstep(1.2, 3.6, length(world.xy - centre))), 1.0);
  } else if (kind == 2) {
    seen = vec4(0.0, 0.0, 0.0, 0.28 * (1.0 - smoothstep(1.2, 3.6, length(world.xy - centre))));
  } else {
    vec3 m = normalize(n), l = normalize(vec3(-0.35, -0.55, 1.0)), v = normalize(eye - world);
    float glint = pow(max(dot(m, normalize(l + v)), 0.0), 40.0);
    // Before a dark sky, a dark body is lighter than it is.
    vec3 grey = vec3(0.3, 0.6, 0.1);
    float lift = 0.6 * (1.0 - smoothstep(0.2, 0.6, dot(sky, grey))) * (1.0 - smoothstep(0.2, 0.45, dot(c, grey)));
    vec3 body = mix(c, vec3(0.75), lift);
    seen = vec4(body * (0.5 + 0.15 * m.z + 0.5 * max(dot(m, l), 0.0)) + 0.18 * glint, 1.0);
  }
}`;

const LIGHT = [0.3, 0.45, 1.0];  // horizontal metres a shadow moves for each metre of height

/** Vertices [position, normal] of a surface of revolution about z; profile rows: r, z, nr, nz. */
function lathe(profile, around = 24) {
  const out = [];
  const at = ([r, z, nr, nz], i) => {
    const a = (2 * Math.PI * i) / around, k = Math.cos(a), s = Math.sin(a);
    return [r * k, r * s, z, nr * k, nr * s, nz];
  };
  for (let j = 0; j + 1 < profile.length; j++) {
    for (let i = 0; i < around; i++) {
      const [a, b] = [at(profile[j], i), at(profile[j], i + 1)];
      const [d, e] = [at(profile[j + 1], i), at(profile[j + 1], i + 1)];
      out.push(a, b, e, a, e, d);
    }
  }
  return out;
}

function arc(radius, centre, from, to) {
  const points = [];
  for (let i = 0; i <= 8; i++) {
    const a = from + ((to - from) * i) / 8, k = Math.cos(a), s = Math.sin(a);
    points.push([radius * k, centre + radius * s, k, s]);
  }
  return points;
}

function box([a, b, c]) {
  const out = [], half = [a, b, c];
  for (const axis of [0, 1, 2]) for (const side of [-1, 1]) {
    const corner = (u, v) => {
      const p = [0, 0, 0], n = [0, 0, 0];
      p[axis] = side * half[axis]; n[axis] = side;
      p[(axis + 1) % 3] = u * half[(axis + 1) % 3];
      p[(axis + 2) % 3] = v * half[(axis + 2) % 3];
      return [...p, ...n];
    };
    const [p, q, r, s] = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
    out.push(p, q, r, p, r, s);
  }
  return out;
}

/** Vertices of a shape of the robot, in its own frame. Half lengths, as in MuJoCo. */
function surface({ kind, size }) {
  const [r, h] = size, quarter = Math.PI / 2;
  if (kind === "box") return box(size);
  if (kind === "cylinder") {
    return lathe([[0, -h, 0, -1], [r, -h, 0, -1], [r, -h, 1, 0], [r, h, 1, 0], [r, h, 0, 1],
      [0, h, 0, 1]]);
  }
  if (kind === "capsule") {
    return lathe([...arc(r, -h, -quarter, 0), ...arc(r, h, 0, quarter)]);
  }
  const unit = lathe([...arc(1, 0, -quarter, 0), ...arc(1, 0, 0, quarter)]);
  const s = kind === "ellipsoid" ? size : [r, r, r];
  return unit.map((v) => v.map((x, i) => (i < 3 ? x * s[i] : x / s[i - 3])));
}

function rotate([w, x, y, z], [a, b, c]) {
  const t = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * t[0] + y * t[2] - z * t[1], b + w * t[1] + z * t[0] - x * t[2],
    c + w * t[2] + x * t[1] - y * t[0]];
}

/** [position, normal, colour] rows of a shape in the frame of its body. */
function placed(shape) {
  return surface(shape).map((v) => {
    const p = rotate(shape.quat, v.slice(0, 3)), n = rotate(shape.quat, v.slice(3));
    return [p[0] + shape.pos[0], p[1] + shape.pos[1], p[2] + shape.pos[2], ...n, ...shape.colour];
  });
}

function cameraMatrix(eye, target, aspect) {
  const sub = (a, b) => a.map((x, i) => x - b[i]);
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => a.map((x) => x / Math.hypot(...a));
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const back = unit(sub(eye, target)), right = unit(cross([0, 0, 1], back));
  const up = cross(back, right), near = 0.05, far = 60, f = 1 / Math.tan(0.32);
  // A narrow picture keeps the width in view, not the height.
  const fy = f * Math.min(1, aspect * 1.1), fx = fy / aspect;
  const a = (far + near) / (near - far), b = (2 * far * near) / (near - far);
  const rows = [[fx, right], [fy, up], [a, back], [-1, back]];
  const out = new Float32Array(16);
  rows.forEach(([s, axis], row) => {
    axis.forEach((x, column) => { out[4 * column + row] = s * x; });
    out[12 + row] = -s * dot(axis, eye) + (row === 2 ? b : 0);
  });
  return out;
}

class Scene {
  /** Throws if the browser gives no WebGL 2. */
  constructor(canvas, shapes, legLength) {
    const options = { alpha: false, antialias: true, stencil: true, preserveDrawingBuffer: true };
    const gl = canvas.getContext("webgl2", options);
    if (!gl) throw new Error("this browser gives no WebGL 2");
    this.gl = gl; this.canvas = canvas; this.legLength = legLength;
    this.view = { azimuth: -1.22, elevation: 0.16, distance: 3.7 * legLength };
    this.program = this.link();
    this.at = new Proxy({}, { get: (_, name) => gl.getUniformLocation(this.program, name) });
    const bodies = Math.max(...shapes.map((s) => s.body)) + 1;
    this.bodies = Array.from({ length: bodies }, (_, body) =>
      this.mesh(shapes.filter((s) => s.body === body).flatMap(placed)));
    const far = 6 * legLength, grey = [0, 0, 1, 1, 1, 1];
    this.ground = this.mesh([[-far, -far, 0], [far, -far, 0], [far, far, 0], [-far, -far, 0],
      [far, far, 0], [-far, far, 0]].map((p) => [...p, ...grey]));
    const r = 0.011, arrow = [[0, 0, 0, -1], [r, 0, 1, 0], [r, 0.82, 1, 0], [2.8 * r, 0.82, 0, -1],
      [2.8 * r, 0.82, 1, 0.3], [0, 1, 1, 0.3]];
    this.arrow = this.mesh(lathe(arrow, 16).map((v) => [...v, 0.78, 0.13, 0.33]));
  }

  link() {
    const gl = this.gl, program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text); gl.compileShader(shader); gl.attachShader(program, shader);
    }
    ["position", "normal", "colour"].forEach((name, i) => gl.bindAttribLocation(program, i, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error("WebGL 2 does not start");
    return program;
  }

  mesh(rows) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(rows.flat()), gl.STATIC_DRAW);
    for (const i of [0, 1, 2]) {
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, 3, gl.FLOAT, false, 36, 12 * i);
    }
    return { array, count: rows.length };
  }

  /** Turn by angles [rad] and zoom by a factor; stays above the floor. */
  orbit(turn, tilt, zoom) {
    const v = this.view;
    v.azimuth += turn;
    v.elevation = Math.min(1.5, Math.max(0.02, v.elevation + tilt));
    v.distance = Math.min(12, Math.max(0.8, (v.distance * zoom) / this.legLength)) * this.legLength;
  }

  /** poses: [x, z, angle] a body; arrow: {from: [x, y, z], force: [fx, fz] in leg lengths} or null;
   *  floor: [height at x = 0, slope]; colours: {sky, tile}, each [r, g, b]. */
  draw(poses, arrow, floor, colours) {
    const { gl, canvas, view, at } = this, ratio = Math.min(2, window.devicePixelRatio || 1);
    canvas.width = Math.round(canvas.clientWidth * ratio);
    canvas.height = Math.round(canvas.clientHeight * ratio);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...colours.sky, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.useProgram(this.program);
    gl.enable(gl.DEPTH_TEST);
    const [x] = poses[0], under = floor[0] + floor[1] * x;
    const target = [x, 0, under + 0.84 * this.legLength], flat = Math.cos(view.elevation);
    const eye = [target[0] + view.distance * flat * Math.cos(view.azimuth),
      target[1] + view.distance * flat * Math.sin(view.azimuth),
      target[2] + view.distance * Math.sin(view.elevation)];
    gl.uniformMatrix4fv(at.camera, false, cameraMatrix(eye, target, canvas.width / canvas.height));
    gl.uniform3fv(at.eye, eye); gl.uniform3fv(at.sky, colours.sky);
    gl.uniform3fv(at.tile, colours.tile); gl.uniform2f(at.centre, x, 0);
    gl.uniform2f(at.floorLine, floor[0], floor[1]);
    const put = (mesh, kind, offset, angle, scale = [1, 1, 1]) => {
      gl.uniform1i(at.kind, kind); gl.uniform3fv(at.offset, offset);
      gl.uniform1f(at.angle, angle); gl.uniform3fv(at.scale, scale);
      gl.uniform4f(at.flatten, ...LIGHT, kind === 2 ? 1 : 0);
      gl.bindVertexArray(mesh.array);
      gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
    };
    put(this.ground, 1, [x, 0, under], -Math.atan(floor[1]));
    // A shadow is dark once, however many shapes throw it.
    gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.enable(gl.STENCIL_TEST); gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    gl.disable(gl.DEPTH_TEST);
    poses.forEach((p, i) => put(this.bodies[i], 2, [p[0], 0, p[1]], p[2]));
    gl.disable(gl.STENCIL_TEST); gl.disable(gl.BLEND); gl.enable(gl.DEPTH_TEST);
    poses.forEach((p, i) => put(this.bodies[i], 0, [p[0], 0, p[1]], p[2]));
    if (arrow) {
      const [fx, fz] = arrow.force;
      gl.disable(gl.DEPTH_TEST);  // seen through the leg it runs along
      put(this.arrow, 0, arrow.from, Math.atan2(fx, fz), [1, 1, Math.hypot(fx, fz) || 1e-6]);
    }
  }
}

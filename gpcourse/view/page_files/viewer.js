"use strict";
const scene = JSON.parse(document.getElementById("scene").textContent);
const canvas = document.getElementById("gl"), over = document.getElementById("over");
const said = document.getElementById("said"), slider = document.getElementById("frame");
const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
const ink = over.getContext("2d");
const home = () => ({ turn: [1, 0, 0, 0, 1, 0, 0, 0, 1], zoom: 1, pan: [0, 0] });
let camera = home(), current = 0, bytes, waiting = false, playing = null;
const show = { wire: false, flat: null, lines: false };
const BOTTOM = 30, TOP = 22;

/* Undo pack_array: byte planes, then differences down each column. */
function numbers([offset, rows, columns, item]) {
  const n = rows * columns, type = { 1: Uint8Array, 2: Uint16Array, 4: Uint32Array }[item], out = new type(n);
  for (let c = 0, i = 0; c < columns; c++) {
    let sum = 0;
    for (let r = 0; r < rows; r++, i++) {
      let step = 0;
      for (let b = 0; b < item; b++) step |= bytes[offset + b * n + i] << (8 * b);
      out[r * columns + c] = sum = (sum + step) >>> 0;
    }
  }
  return out;
}
const places = (layer) => Float32Array.from(numbers(layer.at), (x, i) => layer.low[i % 3] + x * layer.step[i % 3]);
const singles = (where) => new Float32Array(numbers(where).buffer);

const HEAD = `#version 300 es
precision highp float;
uniform mat3 axes; uniform vec3 centre; uniform vec2 scale, pan, size; uniform float reach;
vec4 seen(vec3 p) { vec3 q = axes * (p - centre); return vec4(q.xy * scale + pan, -q.z / (4. * reach), 1.); }
`;
const SHADE = `#version 300 es
precision highp float;
uniform sampler2D map; uniform float low, high, valued, wire, edges, flatly, iso;
`;
const SURFACE = [HEAD + `
in vec3 at, normal; in vec4 colour; in float value, real;
out vec3 place, facing, middle; out vec4 tint; out float worth; flat out float sides;
void main() {
  gl_Position = seen(at); place = axes * (at - centre); facing = axes * normal;
  tint = colour; worth = value; sides = real; int k = gl_VertexID % 3;
  middle = vec3(k == 0, k == 1, k == 2);
}`, SHADE + `
in vec3 place, facing, middle; in vec4 tint; in float worth; flat in float sides; out vec4 pixel;
void main() {
  vec3 across = normalize(cross(dFdx(place), dFdy(place)));
  float front = gl_FrontFacing ? 1. : -1.;
  vec3 n = flatly > .5 ? across : normalize(facing) * front;
  vec3 width = fwidth(middle), near = middle / width;
  vec3 on = vec3(mod(sides, 2.), mod(floor(sides / 2.), 2.), floor(sides / 4.));
  near += (1. - on) * 1e4;
  float edge = 1. - smoothstep(.4, 1.1, min(near.x, min(near.y, near.z)));
  if (wire > .5 && edge < .2) discard;
  vec3 base = tint.rgb, grey = vec3(.725, .737, .753);
  if (valued > .5) {
    bool known = worth == worth;
    float t = (worth - low) / (high - low);
    base = known ? texture(map, vec2(clamp(t, 0., 1.) * 63. / 64. + .5 / 64., .5)).rgb : grey;
    float line = abs(fract(t * 12. + .5) - .5) / fwidth(t * 12.);
    if (iso > .5 && known && line < 1.) base *= .35;
  }
  if (front < 0.) base = valued > .5 ? mix(base, grey, .45) : vec3(.941, .78, .58);
  float ambient = valued > .5 ? .72 : .56;
  vec3 to = normalize(vec3(-.35, .5, 1.));
  base *= min(ambient + (1. - ambient) * max(dot(n, to) + .3, 0.) / (to.z + .3), 1.);
  if (edges + wire > .5) base = mix(base, wire > .5 ? vec3(.4, .46, .54) : base * .45, edge * .85);
  pixel = vec4(base, 1.);
}`];
const LINE = [HEAD + `
in vec3 from, to; in vec4 colour; uniform float width, arrow; out vec4 tint;
void main() {
  vec4 a = seen(from), b = seen(to); vec2 d = (b.xy - a.xy) * size, n;
  float l = max(length(d), 1e-6); d /= l; n = vec2(-d.y, d.x);
  float head = arrow * min(width * 4. + 3., l * .5); int k = gl_VertexID; vec4 p; vec2 q;
  vec4 neck = mix(b, a, head / l);
  if (k < 6) { bool end = k == 1 || k == 2 || k == 4; float s = (k == 0 || k == 1 || k == 3) ? 1. : -1.;
    if (k == 3) { end = true; s = 1.; } if (k == 4) { end = true; s = -1.; } if (k == 5) { end = false; s = -1.; }
    if (k == 2) { end = false; s = -1.; }
    p = end ? neck : a; q = n * s * width * .5; }
  else { p = k == 6 ? b : neck; q = k == 6 ? vec2(0.) : n * (k == 7 ? 1. : -1.) * head * .42; }
  p.xy += q / size; p.z -= .004; gl_Position = p; tint = colour;
}`, `#version 300 es
precision highp float; in vec4 tint; out vec4 pixel; uniform float opacity;
void main() { pixel = vec4(tint.rgb, opacity); }`];
const DOT = [HEAD + `
in vec3 at; in vec4 colour; in float value; uniform float across; out vec4 tint; out float worth;
void main() { gl_Position = seen(at); gl_Position.z -= .005; gl_PointSize = across; tint = colour; worth = value; }`,
SHADE + `in vec4 tint; in float worth; out vec4 pixel; uniform float opacity;
void main() {
  if (length(gl_PointCoord - .5) > .5) discard;
  float t = (worth - low) / (high - low);
  vec3 c = valued < .5 ? tint.rgb : worth == worth ? texture(map, vec2(clamp(t, 0., 1.) * 63. / 64. + .5 / 64., .5)).rgb : vec3(.73);
  pixel = vec4(c, opacity);
}`];

function program([vertex, fragment]) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text); gl.compileShader(shader); gl.attachShader(made, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  }
  gl.linkProgram(made);
  return made;
}
function feed(prog, parts, instanced) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  for (const [name, data, n] of parts) {
    const at = gl.getAttribLocation(prog, name);
    if (at < 0) continue;
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(at);
    const eight = data instanceof Uint8Array;
    gl.vertexAttribPointer(at, n, eight ? gl.UNSIGNED_BYTE : gl.FLOAT, eight, 0, 0);
    if (instanced) gl.vertexAttribDivisor(at, 1);
  }
  return array;
}
function rgba(colours, count) {
  const out = new Uint8Array(4 * count).fill(255), one = colours.length === 3;
  for (let i = 0; i < count; i++) for (let k = 0; k < 3; k++) out[4 * i + k] = colours[one ? k : 3 * i + k];
  return out;
}
function surface(layer) {
  const points = places(layer), corners = numbers(layer.corners), triangles = [], face = [], real = [];
  const sizes = typeof layer.sizes === "number" ? null : numbers(layer.sizes);
  for (let i = 0, f = 0; i < corners.length; f++) {
    const n = sizes ? sizes[f] : layer.sizes;
    for (let k = 1; k < n - 1; k++) {
      triangles.push(corners[i], corners[i + k], corners[i + k + 1]); face.push(f);
      real.push(1 + (k === n - 2 ? 2 : 0) + (k === 1 ? 4 : 0));
    }
    i += n;
  }
  const m = triangles.length, at = new Float32Array(3 * m), normal = new Float32Array(3 * m);
  const sums = new Float32Array(points.length), tint = numbers(layer.colour), one = tint.length === 3;
  const value = new Float32Array(m), colours = new Uint8Array(4 * m), sides = new Float32Array(m);
  const values = layer.values && singles(layer.values);
  for (let t = 0; t < m; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[t + k]);
    const u = [0, 1, 2].map((k) => points[b + k] - points[a + k]), v = [0, 1, 2].map((k) => points[c + k] - points[a + k]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    for (const p of [a, b, c]) for (let k = 0; k < 3; k++) sums[p + k] += n[k];
  }
  for (let i = 0; i < m; i++) {
    const p = triangles[i], f = face[(i / 3) | 0];
    for (let k = 0; k < 3; k++) {
      at[3 * i + k] = points[3 * p + k]; normal[3 * i + k] = sums[3 * p + k];
      colours[4 * i + k] = tint[one ? k : 3 * f + k];
    }
    if (values) value[i] = values[layer.on === "vertices" ? p : f];
    sides[i] = real[(i / 3) | 0];
  }
  const parts = [["at", at, 3], ["normal", normal, 3], ["colour", colours, 4], ["value", value, 1], ["real", sides, 1]];
  return { points, triangles, face, values, count: m, array: feed(programs.mesh, parts) };
}
function ready(layer) {
  if (layer.made) return layer.made;
  if (layer.kind === "mesh") return (layer.made = surface(layer));
  const points = places(layer), n = points.length / 3;
  if (layer.kind === "labels") return (layer.made = { points });
  if (layer.kind === "points") {
    const values = layer.values && singles(layer.values);
    const parts = [["at", points, 3], ["colour", rgba(numbers(layer.colours), n), 4], ["value", values || new Float32Array(n), 1]];
    return (layer.made = { points, values, count: n, array: feed(programs.points, parts) });
  }
  const from = new Float32Array(1.5 * n), to = new Float32Array(1.5 * n);
  for (let i = 0; i < n / 2; i++) { from.set(points.subarray(6 * i, 6 * i + 3), 3 * i); to.set(points.subarray(6 * i + 3, 6 * i + 6), 3 * i); }
  const parts = [["from", from, 3], ["to", to, 3], ["colour", rgba(numbers(layer.colours), n / 2), 4]];
  return (layer.made = { points, count: n / 2, array: feed(programs.lines, parts, true) });
}
const times = (a, b) => Array.from({ length: 9 }, (_, i) => [0, 1, 2].reduce((s, k) => s + a[3 * ((i / 3) | 0) + k] * b[3 * k + (i % 3)], 0));

/* Where each panel lies, in CSS pixels, and how its space is mapped; all frames are framed alike. */
function views() {
  const W = canvas.clientWidth, H = canvas.clientHeight - BOTTOM, panels = scene.frames[current].panels;
  const columns = Math.min(4, panels.length), rows = Math.ceil(panels.length / columns);
  return panels.map((panel, i) => {
    const w = W / columns, h = H / rows, left = w * (i % columns), top = h * Math.floor(i / columns);
    const all = scene.frames.map((f) => f.panels[i] || panel);
    const half = [0, 1].map((k) => Math.max(...all.map((p) => p.half[k])));
    const room = panel.scale ? 62 : 0, first = all[0];
    const pixels = Math.min((w - 24 - room) / 2 / half[0], (h - TOP - 20) / 2 / half[1]) * camera.zoom;
    const pan = [(2 * camera.pan[0] * pixels) / w * half[0] - room / w, (2 * camera.pan[1] * pixels) / h * half[1] - TOP / h];
    return { panel, left, top, w, h, pan, centre: first.centre, axes: times(camera.turn, first.axes.flat()),
      scale: [(2 * pixels) / w, (2 * pixels) / h], reach: Math.max(...all.map((p) => p.reach)) * 2, half, pixels };
  });
}
function project(view, p, i) {
  const d = [0, 1, 2].map((k) => p[3 * i + k] - view.centre[k]), a = view.axes;
  const q = [0, 3, 6].map((r) => a[r] * d[0] + a[r + 1] * d[1] + a[r + 2] * d[2]);
  return [view.left + (q[0] * view.scale[0] + view.pan[0] + 1) * view.w / 2, view.top + (1 - q[1] * view.scale[1] - view.pan[1]) * view.h / 2, q[2]];
}
const programs = {};
function paint() {
  waiting = false;
  const sharp = Math.min(devicePixelRatio || 1, 2), dark = document.documentElement.classList.contains("dark");
  for (const c of [canvas, over]) { const w = Math.round(c.clientWidth * sharp), h = Math.round(c.clientHeight * sharp);
    if (c.width !== w || c.height !== h) { c.width = w; c.height = h; } }
  gl.disable(gl.SCISSOR_TEST);
  gl.clearColor(...(dark ? [0.086, 0.098, 0.114] : [1, 1, 1]), 1);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.SCISSOR_TEST); gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  ink.setTransform(sharp, 0, 0, sharp, 0, 0); ink.clearRect(0, 0, over.width, over.height);
  for (const view of views()) drawPanel(view, sharp, dark ? "#e6e9ed" : "#1b1f24");
  document.body.classList.add("drawn"); document.body.dataset.drawn = current;
}
function drawPanel(view, sharp, text) {
  const box = [view.left, canvas.clientHeight - view.top - view.h, view.w, view.h].map((x) => Math.round(x * sharp));
  gl.viewport(...box); gl.scissor(...box);
  const s = view.panel.scale;
  if (s && !s.texture) {
    s.texture = gl.createTexture(); gl.bindTexture(gl.TEXTURE_2D, s.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 64, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, rgba(s.colours, 64));
    for (const p of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, p, gl.LINEAR);
    for (const p of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, p, gl.CLAMP_TO_EDGE);
  }
  if (s) gl.bindTexture(gl.TEXTURE_2D, s.texture);
  const layers = view.panel.layers;
  for (const layer of [...layers].sort((a, b) => (b.kind === "mesh") - (a.kind === "mesh"))) {
    const made = ready(layer);
    if (layer.kind === "labels") continue;
    const prog = programs[layer.kind], set = (n, x) => gl.uniform1f(gl.getUniformLocation(prog, n), x);
    gl.useProgram(prog); gl.bindVertexArray(made.array);
    gl.uniformMatrix3fv(gl.getUniformLocation(prog, "axes"), true, view.axes);
    gl.uniform3fv(gl.getUniformLocation(prog, "centre"), view.centre);
    gl.uniform2fv(gl.getUniformLocation(prog, "scale"), view.scale);
    gl.uniform2fv(gl.getUniformLocation(prog, "pan"), view.pan);
    gl.uniform2f(gl.getUniformLocation(prog, "size"), box[2] / 2, box[3] / 2);
    set("reach", view.reach); set("valued", layer.values && s ? 1 : 0); set("low", s ? s.low : 0); set("high", s ? s.high : 1);
    set("wire", show.wire); set("edges", layer.edges); set("flatly", show.flat === null ? !layer.smooth : show.flat); set("iso", show.lines);
    set("width", (layer.width || 1) * 1.33 * sharp); set("arrow", layer.arrow); set("across", (layer.size || 1) * 1.33 * sharp);
    const draw = () => layer.kind === "mesh" ? gl.drawArrays(gl.TRIANGLES, 0, made.count)
      : layer.kind === "points" ? gl.drawArrays(gl.POINTS, 0, made.count)
      : gl.drawArraysInstanced(gl.TRIANGLES, 0, layer.arrow ? 9 : 6, made.count);
    gl.enable(gl.DEPTH_TEST); gl.depthFunc(gl.LEQUAL); gl.depthMask(true);
    if (layer.hidden === "show") gl.disable(gl.DEPTH_TEST);
    if (layer.hidden === "fade") { set("opacity", 0.2); gl.depthMask(false); gl.depthFunc(gl.GREATER); draw(); gl.depthMask(true); gl.depthFunc(gl.LEQUAL); }
    set("opacity", 1); draw();
  }
  words(view, s, text);
}
function words(view, s, text) {
  ink.font = "600 13px system-ui, sans-serif"; ink.textAlign = "center"; ink.textBaseline = "middle"; ink.fillStyle = text;
  ink.fillText(view.panel.title, view.left + view.w / 2, view.top + 12, view.w - 8);
  ink.font = "12px system-ui, sans-serif";
  for (const layer of view.panel.layers) {
    const texts = layer.texts || [], made = layer.made, n = layer.kind === "lines" ? 2 : 1;
    texts.forEach((word, i) => {
      let [x, y, z] = project(view, made.points, n * i);
      if (n === 2) { const [u, v] = project(view, made.points, 2 * i + 1); x = (x + u) / 2; y = (y + v) / 2; }
      const behind = layer.hidden !== "show" && covered(view, x, y, z);
      if (behind && layer.hidden === "hide") return;
      ink.globalAlpha = behind ? 0.35 : 1;
      if (layer.place === "beside") { x += 8; y -= 8; }
      ink.lineWidth = layer.place === "badge" ? 9 : 3; ink.lineJoin = "round"; ink.strokeStyle = "#ffffffd0"; ink.strokeText(word, x, y);
      ink.fillStyle = (layer.inks && (layer.inks[i] || layer.inks[0])) || "#1b1f24"; ink.fillText(word, x, y); ink.globalAlpha = 1;
    });
  }
  if (!s) return;
  const x = view.left + view.w - 62, h = Math.min(180, view.h - TOP - 40), y = view.top + TOP + (view.h - TOP - h) / 2;
  for (let i = 0; i < h; i++) { const k = 3 * Math.round(63 * (1 - i / h)); ink.fillStyle = `rgb(${s.colours.slice(k, k + 3)})`; ink.fillRect(x, y + i, 10, 1.5); }
  ink.textAlign = "left"; ink.fillStyle = text;
  for (let i = 0; i <= 4; i++) ink.fillText(digits(s.low + ((s.high - s.low) * i) / 4, 3), x + 14, y + h * (1 - i / 4));
  ink.textAlign = "right"; ink.fillText(s.name, view.left + view.w - 6, y - 14, view.w - 12);
}
const digits = (x, n = 4) => Number.isFinite(x) ? String(+x.toPrecision(n)).replace("-", "\u2212") : "not finite";
const inside = (a, b, x, y) => (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);

/* The nearest triangle under a place on the page. */
function under(view, x, y) {
  let best = null;
  for (const layer of view.panel.layers) if (layer.kind === "mesh") {
    const made = ready(layer), key = JSON.stringify([view.axes, view.pan, view.scale, view.w, view.h]);
    if (made.key !== key) { made.key = key; made.seen = Array.from({ length: made.points.length / 3 }, (_, i) => project(view, made.points, i)); }
    for (let t = 0; t < made.triangles.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => made.seen[made.triangles[t + k]]);
      const u = inside(b, c, x, y), v = inside(c, a, x, y), w = inside(a, b, x, y), sum = u + v + w;
      if (!sum || Math.min(u / sum, v / sum, w / sum) < 0) continue;
      const z = (u * a[2] + v * b[2] + w * c[2]) / sum;
      if (!best || z > best.z) best = { z, layer, made, t };
    }
  }
  return best;
}
function covered(view, x, y, z) { const hit = under(view, x, y); return hit !== null && hit.z > z + 0.02 * view.reach; }
function tell(x, y) {
  const view = views().find((v) => x >= v.left && x < v.left + v.w && y >= v.top && y < v.top + v.h);
  const hit = view && under(view, x, y);
  let message = "";
  if (hit) {
    const far = (i) => Math.hypot(hit.made.seen[i][0] - x, hit.made.seen[i][1] - y);
    const v = hit.made.triangles.slice(hit.t, hit.t + 3).reduce((a, b) => (far(b) < far(a) ? b : a)), f = hit.made.face[hit.t / 3];
    message = `vertex ${v}, face ${f}`;
    if (hit.made.values) message += `: ${digits(hit.made.values[hit.layer.on === "vertices" ? v : f])}`;
  }
  said.textContent = message;
}
function redraw() { if (!waiting) { waiting = true; requestAnimationFrame(paint); } }
function turn(dx, dy) {
  const [a, b] = [dx, dy], c = Math.cos, s = Math.sin;
  camera.turn = times(times([1, 0, 0, 0, c(b), -s(b), 0, s(b), c(b)], [c(a), 0, s(a), 0, 1, 0, -s(a), 0, c(a)]), camera.turn);
}
function move(dx, dy) { const v = views()[0]; camera.pan[0] += dx / v.pixels / v.half[0]; camera.pan[1] -= dy / v.pixels / v.half[1]; }
function zoom(by) { camera.zoom = Math.min(50, Math.max(0.1, camera.zoom * by)); }
function go(i) { current = Math.max(0, Math.min(scene.frames.length - 1, i)); slider.value = current; slider.setAttribute("aria-valuetext", scene.frames[current].name); document.getElementById("name").textContent = scene.frames[current].name; redraw(); }
const fingers = new Map();
canvas.addEventListener("pointerdown", (e) => { fingers.set(e.pointerId, e); canvas.setPointerCapture(e.pointerId); });
for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (e) => fingers.delete(e.pointerId));
canvas.addEventListener("pointermove", (e) => {
  const before = fingers.get(e.pointerId);
  if (!before) return tell(e.offsetX, e.offsetY);
  const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
  const other = [...fingers.values()].find((f) => f.pointerId !== e.pointerId);
  if (other) {
    const gap = (f) => Math.hypot(f.clientX - other.clientX, f.clientY - other.clientY);
    zoom(gap(e) / Math.max(1, gap(before))); move(dx / 2, dy / 2);
  } else if (e.shiftKey || e.buttons & 6) move(dx, dy); else turn(dx / 120, dy / 120);
  fingers.set(e.pointerId, e); redraw();
});
canvas.addEventListener("contextmenu", (e) => e.preventDefault());
canvas.addEventListener("wheel", (e) => { if (document.activeElement !== canvas && !e.ctrlKey) return; e.preventDefault(); zoom(Math.exp(-e.deltaY / 500)); redraw(); }, { passive: false });
const acts = {
  reset() { camera = home(); }, wire() { show.wire = !show.wire; }, lines() { show.lines = !show.lines; },
  flat() { show.flat = !(show.flat === null ? !scene.frames[current].panels[0].layers.some((l) => l.smooth) : show.flat); },
  dark() { document.documentElement.classList.toggle("dark"); },
  full() { document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen().catch(() => { said.textContent = "full screen is not allowed here"; }); },
  play() { if (playing) { clearInterval(playing); playing = null; } else playing = setInterval(() => go((current + 1) % scene.frames.length), 250); },
};
for (const button of document.querySelectorAll("button")) button.addEventListener("click", () => {
  acts[button.id]();
  const on = { wire: show.wire, lines: show.lines, play: playing !== null }[button.id];
  if (on !== undefined) button.setAttribute("aria-pressed", on);
  redraw();
});
canvas.addEventListener("keydown", (e) => {
  const far = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[e.key];
  if (far) e.shiftKey ? move(15 * far[0], 15 * far[1]) : turn(far[0] / 8, far[1] / 8);
  else if (e.key === "+" || e.key === "=") zoom(1.2); else if (e.key === "-") zoom(1 / 1.2); else if (e.key === "0") acts.reset(); else return;
  e.preventDefault(); redraw();
});
slider.addEventListener("input", () => go(+slider.value));
async function start() {
  const raw = Uint8Array.from(atob(scene.data), (c) => c.charCodeAt(0));
  bytes = new Uint8Array(await new Response(new Blob([raw]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
  programs.mesh = program(SURFACE); programs.lines = program(LINE); programs.points = program(DOT);
  if (matchMedia("(prefers-color-scheme: dark)").matches) document.documentElement.classList.add("dark");
  canvas.setAttribute("aria-label", scene.alt);
  const many = scene.frames.length > 1;
  for (const id of ["frame", "play", "name"]) document.getElementById(id).hidden = !many;
  slider.max = scene.frames.length - 1;
  document.getElementById("lines").hidden = !scene.frames.some((f) => f.panels.some((p) => p.scale));
  addEventListener("resize", redraw);
  if (many) go(0); else redraw();
}
if (gl) start();

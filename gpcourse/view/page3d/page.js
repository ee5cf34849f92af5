"use strict";
/* Draws the packed scenes of packing.py with WebGL2. Orthographic; one camera turns all panels. */
const boot = async (kept) => {
  const stopped = new AbortController(), until = { signal: stopped.signal };
  const $ = (id) => document.getElementById(id);
  const header = JSON.parse($("header").textContent), extra = JSON.parse($("extra").textContent);
  const make = (tag, parent, props) => parent.appendChild(Object.assign(document.createElement(tag), props || {}));
  const canvas = make("canvas", document.body, { tabIndex: 0 });
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", header.alt);
  const marks = make("canvas", document.body, { id: "marks" });
  const said = make("div", document.body, { id: "said" });
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) {
    // The static picture lies under this page: let it be seen.
    canvas.remove();
    return { stop: () => kept };
  }

  // ---- unpacking
  const bytes = new Uint8Array(await inflated("block"));
  const numbers = ({ at, n, w }) => {
    const out = w === 2 ? new Uint16Array(n) : w === 4 ? new Uint32Array(n) : new Uint8Array(n);
    for (let i = 0; i < n; i++) {
      let x = 0;
      for (let k = w - 1; k >= 0; k--) x = x * 256 + bytes[at + k * n + i];
      out[i] = x;
    }
    return out;
  };
  const places = (entry, box) => {
    const code = numbers(entry), out = new Float32Array(code.length), s = box.size / 65535;
    for (let i = 0; i < code.length; i++) out[i] = code[i] * s + box.low[i % 3];
    return out;
  };
  const values = ({ codes, low, high }) =>
    Float32Array.from(numbers(codes), (c) => (c === 65535 ? NaN : low + ((high - low) * c) / 65534));
  const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

  // ---- programs
  const program = (vertex, fragment) => {
    const p = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, "#version 300 es\nprecision highp float;\n" + source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(p, shader);
    }
    gl.linkProgram(p);
    const places = {};
    return { p, at: (name) => (places[name] ??= gl.getUniformLocation(p, name)), use() { gl.useProgram(p); } };
  };
  const SEEN = `uniform mat3 axes; uniform vec3 focus; uniform vec2 scale; uniform float reach;
    vec3 seen(vec3 x) { vec3 y = (x - focus) * axes; return vec3(y.xy * scale, -y.z / reach); }`;
  const surface = program(
    SEEN + `in vec3 x; in vec3 normal; in vec3 colour; in float value; out vec3 n; out vec3 y; out vec3 c; out float v;
    void main() { gl_Position = vec4(seen(x), 1.0); y = (x - focus) * axes; n = normal * axes; c = colour; v = value; }`,
    `in vec3 n; in vec3 y; in vec3 c; in float v; out vec4 o;
    uniform bool flat_, valued, lines; uniform vec2 range; uniform sampler2D lookup; uniform vec3 back;
    void main() {
      vec3 g = normalize(cross(dFdx(y), dFdy(y)));
      vec3 m = flat_ || dot(n, n) < 1e-12 ? g : normalize(n);
      if (m.z < 0.0) m = -m;
      vec3 base = c;
      float t = (v - range.x) / (range.y - range.x);
      bool known = v == v;
      if (valued) base = known ? texture(lookup, vec2(clamp(t, 0.0, 1.0), 0.5)).rgb : vec3(0.73, 0.735, 0.75);
      if (!gl_FrontFacing) base = valued ? mix(base, vec3(0.73), 0.45) : back;
      float ambient = valued ? 0.72 : 0.56;
      float light = ambient + (1.0 - ambient) * max(dot(m, vec3(-0.299, 0.427, 0.854)) + 0.3, 0.0) / 1.154;
      vec3 shown = base * min(light, 1.0);
      float gloss = 0.5 * max(light - 1.0, 0.0);
      shown = shown * (1.0 - gloss) + gloss;
      if (lines && valued && known) {
        float s = t * 12.0, d = abs(fract(s - 0.5) - 0.5) / max(fwidth(s), 1e-6);
        shown = mix(vec3(0.08), shown, clamp(d - 0.3, 0.0, 1.0));
      }
      o = vec4(shown, 1.0);
    }`);
  const edge = program(
    SEEN + "in vec3 x; void main() { gl_Position = vec4(seen(x), 1.0); gl_Position.z -= 2e-4; }",
    "uniform vec4 colour; out vec4 o; void main() { o = colour; }");
  const stroke = program(
    SEEN + `in vec3 a; in vec3 b; in vec3 colour; uniform vec2 pixels; uniform float width; uniform bool head; out vec3 c;
    void main() {
      vec3 p = seen(a), q = seen(b);
      vec2 d = (q.xy - p.xy) * pixels; float l = max(length(d), 1e-6); d /= l;
      vec2 across = vec2(-d.y, d.x);
      vec3 at; vec2 off;
      if (head) {
        float size = min(5.0 * width + 3.0, 0.6 * l);
        at = q; off = gl_VertexID == 0 ? vec2(0.0) : -d * size + across * size * (gl_VertexID == 1 ? 0.42 : -0.42);
      } else {
        at = gl_VertexID < 2 ? p : q; off = across * width * 0.5 * (gl_VertexID % 2 == 0 ? 1.0 : -1.0);
      }
      gl_Position = vec4(at.xy + off / pixels, at.z - 4e-4, 1.0); c = colour;
    }`,
    "in vec3 c; out vec4 o; void main() { o = vec4(c, 1.0); }");
  const dot = program(
    SEEN + `in vec3 x; in vec3 colour; uniform float size; out vec3 c;
    void main() { gl_Position = vec4(seen(x), 1.0); gl_Position.z -= 6e-4; gl_PointSize = size; c = colour; }`,
    `in vec3 c; out vec4 o;
    void main() { vec2 d = gl_PointCoord * 2.0 - 1.0; float r = dot(d, d); if (r > 1.0) discard; o = vec4(c * (1.0 - 0.25 * r), 1.0); }`);

  // ---- buffers
  const buffer = (array, target) => {
    const b = gl.createBuffer();
    gl.bindBuffer(target || gl.ARRAY_BUFFER, b);
    gl.bufferData(target || gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
    return b;
  };
  const attribute = (prog, name, array, size, divisor) => {
    const at = gl.getAttribLocation(prog.p, name);
    if (at < 0) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, array instanceof WebGLBuffer ? array : buffer(array));
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
    if (divisor) gl.vertexAttribDivisor(at, divisor);
  };
  const array = (fill) => { const v = gl.createVertexArray(); gl.bindVertexArray(v); fill(); gl.bindVertexArray(null); return v; };
  const repeated = (colours, n) => {
    const known = colours.map(rgb), out = new Float32Array(3 * n);
    for (let i = 0; i < n; i++) out.set(known[i % known.length], 3 * i);
    return out;
  };
  const lookup = (scale) => {
    const data = new Uint8Array(4 * scale.colours.length);
    scale.colours.forEach((hex, i) => data.set([...rgb(hex).map((x) => Math.round(255 * x)), 255], 4 * i));
    const t = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, t);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, scale.colours.length, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, data);
    for (const [k, v] of [[gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_MAG_FILTER, gl.LINEAR], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
      gl.texParameteri(gl.TEXTURE_2D, k, v);
    return t;
  };
  const colourOf = (v, scale) => {
    if (!(v === v)) return rgb("#b9bcc0");
    const t = Math.min(Math.max((v - scale.low) / (scale.high - scale.low), 0), 1);
    return rgb(scale.colours[Math.round(t * (scale.colours.length - 1))]);
  };

  const prepareMesh = (layer, box) => {
    const at = places(layer.at, box), corners = numbers(layer.corners), wide = layer.corners.w === 2 ? 65536 : 4294967296;
    for (let i = 3; i < corners.length; i++) corners[i] = (corners[i] + corners[i - 3]) % wide;
    const many = typeof layer.sizes === "number" ? null : numbers(layer.sizes);
    const count = many ? many.length : layer.sizes ? corners.length / layer.sizes : 0;
    const triangles = [], owner = [], ends = new Set(), lines = [], n = at.length / 3;
    for (let f = 0, start = 0; f < count; f++) {
      const k = many ? many[f] : layer.sizes;
      for (let j = 0; j < k; j++) {
        const a = corners[start + j], b = corners[start + ((j + 1) % k)], key = a < b ? a * n + b : b * n + a;
        if (!ends.has(key)) { ends.add(key); lines.push(a, b); }
        if (j > 1) { triangles.push(corners[start], corners[start + j - 1], corners[start + j]); owner.push(f); }
      }
      start += k;
    }
    const normal = new Float32Array(at.length);
    for (let t = 0; t < triangles.length; t += 3) {
      const [i, j, k] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
      const u = [0, 1, 2].map((d) => at[j + d] - at[i + d]), w = [0, 1, 2].map((d) => at[k + d] - at[i + d]);
      const g = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
      for (const c of [i, j, k]) for (let d = 0; d < 3; d++) normal[c + d] += g[d];
    }
    for (let i = 0; i < normal.length; i += 3) {
      const l = Math.hypot(normal[i], normal[i + 1], normal[i + 2]) || 1;
      for (let d = 0; d < 3; d++) normal[i + d] /= l;
    }
    const v = layer.values ? values(layer.values) : null, onFaces = layer.on === "faces";
    const m = triangles.length, X = new Float32Array(3 * m), N = new Float32Array(3 * m), C = new Float32Array(3 * m), V = new Float32Array(m);
    const plain = rgb(layer.colour), palette = (layer.palette || []).map(rgb), painted = layer.painted ? numbers(layer.painted) : null;
    for (let c = 0; c < m; c++) {
      const i = triangles[c], f = owner[(c / 3) | 0], paint = painted ? palette[painted[f]] : plain;
      for (let d = 0; d < 3; d++) { X[3 * c + d] = at[3 * i + d]; N[3 * c + d] = normal[3 * i + d]; C[3 * c + d] = paint[d]; }
      if (v) V[c] = v[onFaces ? f : i];
    }
    const ordered = new Uint32Array(lines), xb = buffer(at);
    return {
      kind: "mesh", at, triangles: new Uint32Array(triangles), owner, v, onFaces, unit: layer.unit || "value", smooth: layer.smooth, edges: layer.edges, m, k: lines.length, valued: !!v,
      body: array(() => { attribute(surface, "x", X, 3); attribute(surface, "normal", N, 3); attribute(surface, "colour", C, 3); attribute(surface, "value", V, 1); }),
      wire: array(() => { attribute(edge, "x", xb, 3); buffer(ordered, gl.ELEMENT_ARRAY_BUFFER); }),
    };
  };
  const strokes = (a, b, colours) => {
    const n = a.length / 3;
    const fill = () => { attribute(stroke, "a", a, 3, 1); attribute(stroke, "b", b, 3, 1); attribute(stroke, "colour", colours, 3, 1); };
    return { n, vao: array(fill) };
  };
  const prepare = (layer, box, scale) => {
    if (layer.kind === "mesh") return prepareMesh(layer, box);
    if (layer.kind === "points") {
      const at = places(layer.at, box), n = at.length / 3, v = layer.values ? values(layer.values) : null;
      const colours = repeated(layer.colours, n);
      if (v && scale) for (let i = 0; i < n; i++) colours.set(colourOf(v[i], scale), 3 * i);
      return { kind: "points", at, v, n, unit: "value", size: layer.size, vao: array(() => { attribute(dot, "x", at, 3); attribute(dot, "colour", colours, 3); }) };
    }
    if (layer.kind === "arrows") {
      const a = places(layer.tails, box), b = places(layer.heads, box);
      const middle = a.map((x, i) => (x + b[i]) / 2);
      return { kind: "strokes", width: layer.width, heads: true, ...strokes(a, b, repeated(layer.colours, a.length / 3)), at: middle, texts: layer.texts, colours: layer.colours };
    }
    if (layer.kind === "curves") {
      const at = places(layer.at, box), a = [], b = [], c = [];
      let start = 0;
      layer.lengths.forEach((n, line) => {
        for (let i = start; i + 1 < start + n; i++) { a.push(...at.slice(3 * i, 3 * i + 3)); b.push(...at.slice(3 * i + 3, 3 * i + 6)); c.push(...rgb(layer.colours[line % layer.colours.length])); }
        start += n;
      });
      return { kind: "strokes", width: layer.width, heads: false, ...strokes(Float32Array.from(a), Float32Array.from(b), Float32Array.from(c)), texts: [] };
    }
    return { kind: "labels", at: places(layer.at, box), texts: layer.texts, colours: layer.colours, beside: layer.beside };
  };
  const ready = new Map();
  const shown = (f) => {
    if (!ready.has(f))
      ready.set(f, header.frames[f].map((panel, i) => ({
        title: panel.title, scale: panel.scale, lookup: panel.scale ? lookup(panel.scale) : null,
        layers: panel.layers.map((layer) => prepare(layer, header.boxes[i], panel.scale)),
      })));
    return ready.get(f);
  };

  // ---- state
  const state = { frame: 0, turn: [1, 0, 0, 0, 1, 0, 0, 0, 1], zoom: 1, pan: [0, 0], wire: null, smooth: null, lines: false, ...kept };
  const times = (a, b) => [0, 1, 2].flatMap((i) => [0, 1, 2].map((j) => a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j]));
  const turning = (dx, dy) => {
    const [c, s, e, t] = [Math.cos(dx), Math.sin(dx), Math.cos(dy), Math.sin(dy)];
    return times([1, 0, 0, 0, e, -t, 0, t, e], [c, 0, s, 0, 1, 0, -s, 0, c]);
  };
  const cells = () => {
    const n = header.cameras.length, w = innerWidth, h = innerHeight;
    const columns = n === 1 || w < 1.2 * h ? (w < 1.2 * h && n > 1 ? 1 : n) : Math.min(n, 4), rows = Math.ceil(n / columns);
    return header.cameras.map((_, i) => ({ x: ((i % columns) * w) / columns, y: (Math.floor(i / columns) * h) / rows, w: w / columns, h: h / rows }));
  };
  const BAR = 64, TOP = 24, MARGIN = 8;
  const view = (i, cell) => {
    const camera = header.cameras[i], bar = header.frames[state.frame][i].scale ? BAR : 0;
    const w = Math.max(cell.w - bar - 2 * MARGIN, 20), h = Math.max(cell.h - TOP - 2 * MARGIN, 20);
    const k = Math.min(w / (2 * camera.half[0]), h / (2 * camera.half[1])) * state.zoom;
    return { axes: times(state.turn, camera.axes), focus: camera.focus, k, cx: cell.x + MARGIN + w / 2 + state.pan[0], cy: cell.y + TOP + MARGIN + h / 2 + state.pan[1], reach: 2 * camera.reach, w, h, bar };
  };
  const project = (x, i, look) => {
    const d = [x[3 * i] - look.focus[0], x[3 * i + 1] - look.focus[1], x[3 * i + 2] - look.focus[2]], A = look.axes;
    return [look.cx + look.k * (A[0] * d[0] + A[1] * d[1] + A[2] * d[2]), look.cy - look.k * (A[3] * d[0] + A[4] * d[1] + A[5] * d[2]), A[6] * d[0] + A[7] * d[1] + A[8] * d[2]];
  };

  // ---- drawing
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const draw = () => {
    const ratio = devicePixelRatio || 1, W = innerWidth, H = innerHeight;
    for (const c of [canvas, marks]) if (c.width !== Math.round(W * ratio) || c.height !== Math.round(H * ratio)) { c.width = Math.round(W * ratio); c.height = Math.round(H * ratio); }
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(...(dark.matches ? rgb("#14171a") : [1, 1, 1]), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST); gl.enable(gl.SCISSOR_TEST); gl.depthFunc(gl.LEQUAL);
    const pen = marks.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0); pen.clearRect(0, 0, W, H);
    const panels = shown(state.frame);
    cells().forEach((cell, i) => {
      const look = view(i, cell), panel = panels[i];
      gl.viewport((look.cx - cell.w / 2) * ratio, (H - look.cy - cell.h / 2) * ratio, cell.w * ratio, cell.h * ratio);
      gl.scissor(cell.x * ratio, (H - cell.y - cell.h) * ratio, cell.w * ratio, cell.h * ratio);
      const set = (prog) => {
        prog.use();
        gl.uniformMatrix3fv(prog.at("axes"), false, look.axes); gl.uniform3fv(prog.at("focus"), look.focus);
        gl.uniform2f(prog.at("scale"), (2 * look.k) / cell.w, (2 * look.k) / cell.h); gl.uniform1f(prog.at("reach"), look.reach);
        gl.uniform2f(prog.at("pixels"), cell.w / 2, cell.h / 2);
      };
      for (const l of panel.layers) {
        if (l.kind === "mesh") {
          set(surface);
          gl.uniform1i(surface.at("flat_"), !(state.smooth ?? l.smooth)); gl.uniform1i(surface.at("valued"), l.valued && !!panel.scale); gl.uniform1i(surface.at("lines"), state.lines);
          gl.uniform3fv(surface.at("back"), rgb("#f0c794"));
          if (panel.scale) { gl.uniform2f(surface.at("range"), panel.scale.low, panel.scale.high); gl.bindTexture(gl.TEXTURE_2D, panel.lookup); }
          gl.bindVertexArray(l.body); gl.drawArrays(gl.TRIANGLES, 0, l.m);
          if (state.wire ?? l.edges) {
            set(edge); gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
            gl.uniform4f(edge.at("colour"), 0.11, 0.13, 0.16, l.k > 12000 ? 0.25 : 0.55);
            gl.bindVertexArray(l.wire); gl.drawElements(gl.LINES, l.k, gl.UNSIGNED_INT, 0); gl.disable(gl.BLEND);
          }
        } else if (l.kind === "strokes" && l.n) {
          set(stroke); gl.uniform1f(stroke.at("width"), 1.4 * l.width); gl.uniform1i(stroke.at("head"), false);
          gl.bindVertexArray(l.vao); gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, l.n);
          if (l.heads) { gl.uniform1i(stroke.at("head"), true); gl.drawArraysInstanced(gl.TRIANGLES, 0, 3, l.n); }
        } else if (l.kind === "points") {
          set(dot); gl.uniform1f(dot.at("size"), Math.max(1.5 * l.size, 2) * ratio); gl.bindVertexArray(l.vao); gl.drawArrays(gl.POINTS, 0, l.n);
        }
      }
      gl.bindVertexArray(null);
      write(pen, panel, look, cell);
    });
  };
  const write = (pen, panel, look, cell) => {
    pen.save(); pen.beginPath(); pen.rect(cell.x, cell.y, cell.w, cell.h); pen.clip();
    pen.font = "11px system-ui, sans-serif"; pen.textBaseline = "middle"; pen.lineWidth = 3; pen.lineJoin = "round";
    const mesh = panel.layers.find((l) => l.kind === "mesh"), many = mesh && mesh.owner.length > 4000;
    for (const l of panel.layers) {
      if (!l.texts || !l.texts.length || !l.at) continue;
      for (let i = 0; i < l.texts.length; i++) {
        const [x, y, z] = project(l.at, i, look);
        const hit = mesh && !many ? under(mesh, look, x, y) : null;
        if (hit && hit.z > z + 0.02 * look.reach) continue;
        pen.textAlign = l.beside ? "left" : "center";
        pen.strokeStyle = dark.matches ? "#14171a" : "#fff"; pen.fillStyle = dark.matches && l.colours[i % l.colours.length] === "#1b1f24" ? "#e6e9ec" : l.colours[i % l.colours.length];
        pen.strokeText(l.texts[i], x + (l.beside ? 5 : 0), y - (l.beside ? 6 : 0)); pen.fillText(l.texts[i], x + (l.beside ? 5 : 0), y - (l.beside ? 6 : 0));
      }
    }
    pen.restore();
  };
  let waiting = false;
  const redraw = () => { if (!waiting) { waiting = true; requestAnimationFrame(() => { waiting = false; draw(); }); } };

  // ---- what is under the pointer
  const under = (mesh, look, px, py) => {
    let best = null;
    const T = mesh.triangles, P = projected(mesh, look);
    for (let t = 0; t < T.length; t += 3) {
      const a = 3 * T[t], b = 3 * T[t + 1], c = 3 * T[t + 2];
      const d = (P[b] - P[a]) * (P[c + 1] - P[a + 1]) - (P[c] - P[a]) * (P[b + 1] - P[a + 1]);
      if (d === 0) continue;
      const u = ((px - P[a]) * (P[c + 1] - P[a + 1]) - (P[c] - P[a]) * (py - P[a + 1])) / d;
      const v = ((P[b] - P[a]) * (py - P[a + 1]) - (px - P[a]) * (P[b + 1] - P[a + 1])) / d;
      if (u < 0 || v < 0 || u + v > 1) continue;
      const z = P[a + 2] * (1 - u - v) + P[b + 2] * u + P[c + 2] * v;
      if (!best || z > best.z) best = { z, face: mesh.owner[t / 3], vertex: T[t + (u > v && u > 1 - u - v ? 1 : v > 1 - u - v ? 2 : 0)] };
    }
    return best;
  };
  const projected = (mesh, look) => {
    const key = JSON.stringify([look.axes, look.k, look.cx, look.cy]);
    if (mesh.key !== key) {
      mesh.key = key; mesh.P = new Float32Array(mesh.at.length);
      for (let i = 0; i < mesh.at.length / 3; i++) mesh.P.set(project(mesh.at, i, look), 3 * i);
    }
    return mesh.P;
  };
  const shortly = (v) => (v !== v ? "not finite" : String(Number(v.toPrecision(4))).replace("-", "−"));
  const ask = (px, py) => {
    const i = cells().findIndex((c) => px >= c.x && px < c.x + c.w && py >= c.y && py < c.y + c.h);
    if (i < 0) return "";
    const look = view(i, cells()[i]), panel = shown(state.frame)[i], lines = [];
    for (const l of panel.layers) {
      if (l.kind === "points") {
        let near = -1, least = 64;
        for (let k = 0; k < l.n; k++) { const [x, y] = project(l.at, k, look), d = (x - px) ** 2 + (y - py) ** 2; if (d < least) { least = d; near = k; } }
        if (near >= 0) lines.push(`point ${near}` + (l.v ? `\n${(panel.scale && panel.scale.name) || "value"} ${shortly(l.v[near])}` : ""));
      } else if (l.kind === "mesh") {
        const hit = under(l, look, px, py);
        if (hit) lines.push(`vertex ${hit.vertex}, face ${hit.face}` + (l.v ? `\n${(panel.scale && panel.scale.name) || "value"} ${shortly(l.v[l.onFaces ? hit.face : hit.vertex])}` : ""));
      }
    }
    return lines.join("\n");
  };

  // ---- words around the drawing
  const furniture = make("div", document.body);
  const furnish = () => {
    furniture.replaceChildren();
    header.frames[state.frame].forEach((panel, i) => {
      const cell = cells()[i];
      if (panel.title) make("div", furniture, { className: "title", textContent: panel.title }).style.cssText = `left:${cell.x}px;width:${cell.w}px;top:${cell.y + 4}px`;
      if (!panel.scale) return;
      const high = Math.min(Math.max(cell.h * 0.6, 60), 220), bar = make("div", furniture, { className: "bar" });
      bar.style.cssText = `left:${cell.x + cell.w - BAR}px;top:${cell.y + (cell.h - high) / 2 + 8}px;height:${high}px;background:linear-gradient(to top,${panel.scale.colours.join(",")})`;
      if (panel.scale.name) make("b", bar, { textContent: panel.scale.name }).style.cssText = "right:auto;left:0";
      const { low, high: top } = panel.scale, span = top - low, rough = span / 4, power = 10 ** Math.floor(Math.log10(rough));
      const step = [1, 2, 2.5, 5, 10].map((s) => s * power).find((s) => s >= rough);
      for (let t = Math.ceil(low / step - 1e-9) * step; t <= top + 1e-9 * span; t += step)
        make("span", bar, { textContent: shortly(Math.abs(t) < 1e-12 * span ? 0 : t) }).style.top = `${(100 * (top - t)) / span}%`;
    });
  };
  const tools = make("div", document.body, { id: "tools" });
  const button = (text, title, action) => { const b = make("button", tools, { type: "button", textContent: text, title }); b.addEventListener("click", () => { action(b); redraw(); }); return b; };
  const first = () => shown(state.frame).flatMap((p) => p.layers).find((l) => l.kind === "mesh");
  const actions = {
    w: () => { state.wire = !(state.wire ?? (first() || {}).edges); },
    s: () => { state.smooth = !(state.smooth ?? (first() || {}).smooth); },
    i: () => { state.lines = !state.lines; },
    r: () => { Object.assign(state, { turn: [1, 0, 0, 0, 1, 0, 0, 0, 1], zoom: 1, pan: [0, 0], wire: null, smooth: null, lines: false }); },
    f: () => { if (document.fullscreenElement) document.exitFullscreen(); else document.documentElement.requestFullscreen?.().catch(() => {}); },
  };
  const has = header.frames[0].some((p) => p.layers.some((l) => l.kind === "mesh"));
  if (has) { button("edges", "Edges on or off (w)", actions.w); button("smooth", "Smooth or flat shading (s)", actions.s); }
  if (header.frames.some((f) => f.some((p) => p.scale && p.layers.some((l) => l.kind === "mesh" && l.values)))) button("isolines", "Lines of equal value (i)", actions.i);
  button("reset", "As it was (r)", actions.r); button("full screen", "Full screen (f)", actions.f);
  const show = (f) => { state.frame = f; furnish(); redraw(); };
  if (extra.chooser === "slider" && header.frames.length > 1) {
    tools.classList.add("stay");
    const word = make("span", tools), slider = make("input", tools, { type: "range", min: 0, max: header.frames.length - 1, step: 1, value: state.frame, title: "Frames" });
    const say = () => { word.textContent = extra.names[state.frame] || `${state.frame + 1} of ${header.frames.length}`; };
    slider.setAttribute("aria-label", "frame");
    slider.addEventListener("input", () => { show(Number(slider.value)); say(); });
    say();
  } else if (extra.chooser === "menu" && header.frames.length > 1) {
    tools.classList.add("stay");
    const menu = make("select", tools, { title: "What the colours show" });
    extra.names.forEach((name, i) => make("option", menu, { value: i, textContent: name }));
    menu.value = state.frame;
    menu.addEventListener("change", () => show(Number(menu.value)));
  }

  // ---- mouse, touch, keyboard
  const fingers = new Map();
  canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); fingers.set(e.pointerId, [e.clientX, e.clientY]); said.style.display = "none"; });
  for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (e) => fingers.delete(e.pointerId));
  canvas.addEventListener("pointermove", (e) => {
    const before = fingers.get(e.pointerId);
    if (!before) {
      const text = ask(e.clientX, e.clientY);
      Object.assign(said.style, { display: text ? "block" : "none", left: `${Math.min(e.clientX + 12, innerWidth - 150)}px`, top: `${Math.min(e.clientY + 12, innerHeight - 40)}px` });
      said.textContent = text;
      return;
    }
    const dx = e.clientX - before[0], dy = e.clientY - before[1];
    if (fingers.size === 2) {
      const [other] = [...fingers].filter(([id]) => id !== e.pointerId).map(([, p]) => p);
      const far = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      state.zoom *= far([e.clientX, e.clientY]) / far(before);
      state.pan = [state.pan[0] + dx / 2, state.pan[1] + dy / 2];
    } else if (e.shiftKey || e.buttons & 6) state.pan = [state.pan[0] + dx, state.pan[1] + dy];
    else state.turn = times(turning(dx / 120, dy / 120), state.turn);
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    redraw();
  });
  canvas.addEventListener("pointerleave", () => { said.style.display = "none"; });
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  // A page that scrolls stays one: the wheel zooms only what has been clicked, or with Ctrl.
  canvas.addEventListener("wheel", (e) => { if (document.activeElement === canvas || e.ctrlKey) { e.preventDefault(); state.zoom = Math.min(Math.max(state.zoom * Math.exp(-e.deltaY / 500), 0.05), 200); redraw(); } }, { passive: false });
  canvas.addEventListener("keydown", (e) => {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[e.key];
    if (arrows && e.shiftKey) state.pan = [state.pan[0] + 12 * arrows[0], state.pan[1] + 12 * arrows[1]];
    else if (arrows) state.turn = times(turning(arrows[0] / 10, arrows[1] / 10), state.turn);
    else if (e.key === "+" || e.key === "=") state.zoom *= 1.15;
    else if (e.key === "-") state.zoom /= 1.15;
    else if (actions[e.key] && !e.ctrlKey && !e.metaKey) actions[e.key]();
    else return;
    e.preventDefault(); redraw();
  });
  addEventListener("resize", () => { furnish(); redraw(); }, until);
  dark.addEventListener("change", redraw, until);
  furnish(); draw();
  document.documentElement.classList.add("drawn");
  document.body.dataset.after = performance.now();
  document.body.dataset.drawn = "yes";
  return {
    stop() {
      stopped.abort(); gl.getExtension("WEBGL_lose_context")?.loseContext();
      for (const part of [canvas, marks, said, furniture, tools]) part.remove();
      document.documentElement.classList.remove("drawn"); delete document.body.dataset.drawn;
      return state;
    },
  };
};

/* A browser draws about sixteen such pictures at a time: this one lives while it can be seen. */
let live = null, memory = {}, wanted = false, busy = false;
const settle = async () => {
  if (busy) return;
  busy = true;
  try {
    while (wanted !== !!live) {
      if (wanted) live = await boot(memory);
      else { memory = live.stop(); live = null; }
    }
  } catch (error) {
    document.body.dataset.fault = error.message;  // the static picture below stays to be seen
    console.error("This picture cannot be drawn here: " + error.message);
  }
  busy = false;
};
new IntersectionObserver((seen) => { wanted = seen[seen.length - 1].isIntersecting; settle(); }).observe(document.documentElement);

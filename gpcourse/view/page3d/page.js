"use strict";
/* Draws the packed scenes of packing.py with WebGL2. Orthographic; one camera turns all panels. */
const boot = async (kept) => {
  const stopped = new AbortController(), until = { signal: stopped.signal };
  const $ = (id) => document.getElementById(id);
  const read = async (id) => JSON.parse(new TextDecoder().decode(await inflated(id)));
  const header = await read("header"), extra = await read("extra");
  const make = (tag, parent, props) => parent.appendChild(Object.assign(document.createElement(tag), props || {}));
  const canvas = make("canvas", document.body, { tabIndex: 0 });
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", header.alt);
  const marks = make("canvas", document.body, { id: "marks" });
  const said = make("div", document.body, { id: "said" });
  said.setAttribute("role", "status");
  const tools = make("div", document.body, { id: "tools" });
  if (matchMedia("(hover: none)").matches) tools.classList.add("stay");
  const gl = canvas.getContext("webgl2", { alpha: false, antialias: true, preserveDrawingBuffer: true });
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
  /* In the unit cube, as cameras are: 32 bits would not do for a small mesh far away. */
  const places = (entry) => Float32Array.from(numbers(entry), (c) => c / 65535);
  const values = ({ codes, low, high }) =>
    Float32Array.from(numbers(codes), (c) => (c === 65535 ? NaN : low + ((high - low) * c) / 65534));

  // ---- programs
  const program = ([vertex, fragment]) => {
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
  const surface = program(SHADERS.surface), edge = program(SHADERS.edge), stroke = program(SHADERS.stroke), dot = program(SHADERS.dot);

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

  /* Values came in 65,535 steps: what is finer than a step is not said. */
  const grain = ({ low, high }) => (high > low ? 10 ** Math.ceil(Math.log10((high - low) / 65534)) : 0);
  const edgesOf = (at, corners, count, many, size) => {
    const n = at.length / 3, ends = new Set(), lines = [];
    for (let f = 0, start = 0; f < count; f++) {
      const k = many ? many[f] : size;
      for (let j = 0; j < k; j++) {
        const a = corners[start + j], b = corners[start + ((j + 1) % k)], key = a < b ? a * n + b : b * n + a;
        if (!ends.has(key)) { ends.add(key); lines.push(a, b); }
      }
      start += k;
    }
    const few = lines.length <= 24000;
    const ends_ = (first) => Float32Array.from({ length: 1.5 * lines.length }, (_, i) => at[3 * lines[2 * ((i / 3) | 0) + first] + (i % 3)]);
    let long = 0;
    for (let i = 0; i < lines.length; i += 2) long += Math.hypot(...[0, 1, 2].map((d) => at[3 * lines[i] + d] - at[3 * lines[i + 1] + d])) / (lines.length / 2);
    return {
      k: lines.length, long,
      wire: few ? null : array(() => { attribute(edge, "x", at, 3); buffer(new Uint32Array(lines), gl.ELEMENT_ARRAY_BUFFER); }),
      rods: few ? array(() => { attribute(stroke, "a", ends_(0), 3, 1); attribute(stroke, "b", ends_(1), 3, 1); }) : null,
    };
  };
  const prepareMesh = (layer) => {
    const at = places(layer.at), corners = numbers(layer.corners), wide = layer.corners.w === 2 ? 65536 : 4294967296;
    for (let i = 3; i < corners.length; i++) corners[i] = (corners[i] + corners[i - 3]) % wide;
    const many = typeof layer.sizes === "number" ? null : numbers(layer.sizes);
    const count = many ? many.length : layer.sizes ? corners.length / layer.sizes : 0;
    const total = corners.length - 2 * count, triangles = new Uint32Array(3 * total), owner = new Uint32Array(total);
    for (let f = 0, start = 0, t = 0; f < count; f++) {
      const k = many ? many[f] : layer.sizes;
      for (let j = 2; j < k; j++, t++) {
        triangles[3 * t] = corners[start]; triangles[3 * t + 1] = corners[start + j - 1]; triangles[3 * t + 2] = corners[start + j];
        owner[t] = f;
      }
      start += k;
    }
    const normal = new Float32Array(at.length);
    for (let t = 0; t < triangles.length; t += 3) {
      const i = 3 * triangles[t], j = 3 * triangles[t + 1], k = 3 * triangles[t + 2];
      const ux = at[j] - at[i], uy = at[j + 1] - at[i + 1], uz = at[j + 2] - at[i + 2];
      const wx = at[k] - at[i], wy = at[k + 1] - at[i + 1], wz = at[k + 2] - at[i + 2];
      const gx = uy * wz - uz * wy, gy = uz * wx - ux * wz, gz = ux * wy - uy * wx;
      normal[i] += gx; normal[i + 1] += gy; normal[i + 2] += gz;
      normal[j] += gx; normal[j + 1] += gy; normal[j + 2] += gz;
      normal[k] += gx; normal[k + 1] += gy; normal[k + 2] += gz;
    }
    for (let i = 0; i < normal.length; i += 3) {
      const l = Math.hypot(normal[i], normal[i + 1], normal[i + 2]) || 1;
      for (let d = 0; d < 3; d++) normal[i + d] /= l;
    }
    const v = layer.values ? values(layer.values) : null, onFaces = layer.on === "faces";
    const m = triangles.length, X = new Float32Array(3 * m), N = new Float32Array(3 * m), C = new Float32Array(3 * m), V = new Float32Array(m);
    const plain = rgb(layer.colour), palette = (layer.palette || []).map(rgb), painted = layer.painted ? numbers(layer.painted) : null, blended = layer.blended ? numbers(layer.blended) : null;
    for (let c = 0; c < m; c++) {
      const i = triangles[c], f = owner[(c / 3) | 0], paint = painted ? palette[painted[f]] : plain;
      for (let d = 0; d < 3; d++) {
        X[3 * c + d] = at[3 * i + d]; N[3 * c + d] = normal[3 * i + d];
        C[3 * c + d] = blended ? blended[3 * i + d] / 255 : paint[d];
      }
      if (v) V[c] = v[onFaces ? f : i];
    }
    /* The edges are many, and most large meshes are shown without: they are found when they are wanted. */
    let found = null;
    const rims = () => (found ??= edgesOf(at, corners, count, many, layer.sizes));
    return {
      kind: "mesh", at, triangles, owner, v, grain: v && grain(layer.values), onFaces, unit: layer.unit || "value", smooth: layer.smooth, edges: layer.edges, behind: layer.behind, m, rims, valued: !!v,
      body: array(() => { attribute(surface, "x", X, 3); attribute(surface, "normal", N, 3); attribute(surface, "colour", C, 3); attribute(surface, "value", V, 1); }),
    };
  };
  const strokes = (a, b, colours) => {
    const n = a.length / 3;
    const fill = () => { attribute(stroke, "a", a, 3, 1); attribute(stroke, "b", b, 3, 1); attribute(stroke, "colour", colours, 3, 1); };
    return { n, vao: array(fill) };
  };
  const prepare = (layer, scale) => {
    if (layer.kind === "mesh") return prepareMesh(layer);
    if (layer.kind === "points") {
      const at = places(layer.at), n = at.length / 3, v = layer.values ? values(layer.values) : null;
      const colours = repeated(layer.colours, n);
      if (v && scale) for (let i = 0; i < n; i++) colours.set(colourOf(v[i], scale), 3 * i);
      return { kind: "points", at, v, grain: v && grain(layer.values), n, unit: "value", size: layer.size, hidden: layer.hidden, vao: array(() => { attribute(dot, "x", at, 3); attribute(dot, "colour", colours, 3); }) };
    }
    if (layer.kind === "arrows") {
      const a = places(layer.tails), b = places(layer.heads);
      const middle = a.map((x, i) => (x + b[i]) / 2), sides = layer.sides && Float32Array.from(numbers(layer.sides), (c) => c - 127);
      return { kind: "strokes", width: layer.width, hidden: layer.hidden, heads: true, ...strokes(a, b, repeated(layer.colours, a.length / 3)), a, b, sides, at: middle, texts: layer.texts, colours: layer.colours };
    }
    if (layer.kind === "curves") {
      const at = places(layer.at), a = [], b = [], c = [];
      let start = 0;
      layer.lengths.forEach((n, line) => {
        for (let i = start; i + 1 < start + n; i++) { a.push(...at.slice(3 * i, 3 * i + 3)); b.push(...at.slice(3 * i + 3, 3 * i + 6)); c.push(...rgb(layer.colours[line % layer.colours.length])); }
        start += n;
      });
      return { kind: "strokes", width: layer.width, hidden: layer.hidden, heads: false, ...strokes(Float32Array.from(a), Float32Array.from(b), Float32Array.from(c)), texts: [] };
    }
    return { kind: "labels", at: places(layer.at), texts: layer.texts, colours: layer.colours, place: layer.place, hidden: layer.hidden };
  };
  const ready = new Map();
  const shown = (f) => {
    if (!ready.has(f))
      ready.set(f, header.frames[f].map((panel) => ({
        title: panel.title, scale: panel.scale, lookup: panel.scale ? lookup(panel.scale) : null,
        layers: panel.layers.map((layer) => prepare(layer, panel.scale)),
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
  const oneBar = () => header.frames[state.frame].some((p) => p.scale && !p.bar);  // for all panels, at the right
  const cells = () => {
    const n = header.cameras.length, w = innerWidth - (oneBar() ? barRoom() : 0), h = innerHeight - (tools.classList.contains("stay") ? tools.offsetHeight + 6 : 0);
    const columns = n === 1 || w < 1.2 * h ? (w < 1.2 * h && n > 1 ? 1 : n) : Math.min(n, 4), rows = Math.ceil(n / columns);
    return header.cameras.map((_, i) => ({ x: ((i % columns) * w) / columns, y: (Math.floor(i / columns) * h) / rows, w: w / columns, h: h / rows }));
  };
  const wide = (text, font) => { const pen = marks.getContext("2d"); pen.font = `${font} system-ui, sans-serif`; return pen.measureText(text).width; };
  const barRoom = () => Math.max(64, ...header.frames[state.frame].map((p) => (p.bar && p.scale.name ? wide(p.scale.name, "500 12px") + 10 : 0)));
  /* Titles stand over their panels; the longest decides how many lines they all get. */
  const titleRoom = (w) => Math.max(...header.frames[state.frame].map((p) => (p.title ? 8 + 19 * Math.ceil(wide(p.title, "600 14px") / Math.max(w - 16, 40)) : 0)));
  const view = (i, cell) => {
    const camera = header.cameras[i], panel = header.frames[state.frame][i], bar = panel.bar && !oneBar() ? barRoom() : 0, TOP = titleRoom(cell.w);
    const MARGIN = panel.layers.some((l) => l.texts && l.texts.length) ? 25 : 8;  // numbers lie around what they name
    const w = Math.max(cell.w - bar - 2 * MARGIN, 20), h = Math.max(cell.h - TOP - 2 * MARGIN, 20);
    const k = Math.min(w / (2 * camera.half[0]), h / (2 * camera.half[1])) * state.zoom;
    return { axes: times(state.turn, camera.axes), focus: camera.focus, k, cx: cell.x + MARGIN + w / 2 + state.pan[0], cy: cell.y + TOP + MARGIN + h / 2 + state.pan[1], reach: 2 * camera.reach, w, h, bar, top: TOP };
  };
  const project = (x, i, look) => {
    const d = [x[3 * i] - look.focus[0], x[3 * i + 1] - look.focus[1], x[3 * i + 2] - look.focus[2]], A = look.axes;
    return [look.cx + look.k * (A[0] * d[0] + A[1] * d[1] + A[2] * d[2]), look.cy - look.k * (A[3] * d[0] + A[4] * d[1] + A[5] * d[2]), A[6] * d[0] + A[7] * d[1] + A[8] * d[2]];
  };

  // ---- drawing
  /* What lies behind a surface is left out, drawn faintly, or drawn as if nothing were before it. */
  const passes = (hidden, run) => {
    if (hidden === "fade") {
      gl.depthFunc(gl.GREATER); gl.depthMask(false); gl.enable(gl.BLEND);
      run(0.35);
      gl.disable(gl.BLEND); gl.depthMask(true);
    }
    gl.depthFunc(hidden === "show" ? gl.ALWAYS : gl.LEQUAL);
    run(1);
    gl.depthFunc(gl.LEQUAL);
  };
  const draw = () => {
    const ratio = devicePixelRatio || 1, W = innerWidth, H = innerHeight, dark = isDark();
    document.documentElement.classList.toggle("dark", dark);
    for (const c of [canvas, marks]) if (c.width !== Math.round(W * ratio) || c.height !== Math.round(H * ratio)) { c.width = Math.round(W * ratio); c.height = Math.round(H * ratio); }
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(...rgb(dark ? "#14171a" : "#ffffff"), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST); gl.enable(gl.SCISSOR_TEST); gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    const pen = marks.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0); pen.clearRect(0, 0, W, H);
    const panels = shown(state.frame);
    cells().forEach((cell, i) => {
      const look = view(i, cell), panel = panels[i];
      gl.viewport((look.cx - cell.w / 2) * ratio, (H - look.cy - cell.h / 2) * ratio, cell.w * ratio, cell.h * ratio);
      gl.scissor(cell.x * ratio, (H - cell.y - cell.h) * ratio, cell.w * ratio, (cell.h - look.top) * ratio);  // titles stay free
      const meshes = panel.layers.filter((l) => l.kind === "mesh"), lift = dark && !meshes.length ? 0.6 : 0;
      const set = (prog, floats = {}) => {
        prog.use();
        gl.uniformMatrix3fv(prog.at("axes"), false, look.axes); gl.uniform3fv(prog.at("focus"), look.focus);
        gl.uniform2f(prog.at("scale"), (2 * look.k) / cell.w, (2 * look.k) / cell.h); gl.uniform1f(prog.at("reach"), look.reach);
        gl.uniform2f(prog.at("pixels"), cell.w / 2, cell.h / 2);
        for (const name in floats) gl.uniform1f(prog.at(name), floats[name]);
      };
      const near = 0.012 / Math.max(1, state.zoom);  // what is drawn on a surface is not hidden by it
      for (const l of meshes) drawMesh(l, panel, look, set);
      for (const [rank, l] of panel.layers.entries()) {
        if (l.kind === "strokes" && l.n) passes(l.hidden, (alpha) => {
          set(stroke, { width: 1.5 * l.width, alpha, lift, bias: near, tip: l.heads ? 6.5 * Math.sqrt(l.width) + 2.5 : 0 });
          gl.bindVertexArray(l.vao); gl.uniform1i(stroke.at("head"), false); gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, l.n);
          if (l.heads) { gl.uniform1i(stroke.at("head"), true); gl.drawArraysInstanced(gl.TRIANGLES, 0, 3, l.n); }
        });
        else if (l.kind === "points") passes(l.hidden, (alpha) => {
          set(dot, { size: Math.max(1.5 * l.size, 2) * ratio, alpha, lift: l.v ? 0 : lift, bias: (1.2 + 0.1 * rank) * near });
          gl.enable(gl.BLEND); gl.bindVertexArray(l.vao); gl.drawArrays(gl.POINTS, 0, l.n); gl.disable(gl.BLEND);
        });
      }
      gl.bindVertexArray(null);
      write(pen, panel, { look, cell, dark, project, under });
    });
  };
  const drawMesh = (l, panel, look, set) => {
    set(surface);
    gl.uniform1i(surface.at("flat_"), !(state.smooth ?? l.smooth)); gl.uniform1i(surface.at("valued"), l.valued && !!panel.scale); gl.uniform1i(surface.at("lines"), state.lines);
    gl.uniform3fv(surface.at("back"), rgb("#f0c794"));
    if (panel.scale) { gl.uniform2f(surface.at("range"), panel.scale.low, panel.scale.high); gl.uniform1f(surface.at("spacing"), ticks(panel.scale).step / 2); gl.bindTexture(gl.TEXTURE_2D, panel.lookup); }
    gl.bindVertexArray(l.body); gl.drawArrays(gl.TRIANGLES, 0, l.m);
    if (!(state.wire ?? l.edges)) return;
    const { k, long, wire, rods } = l.rims();
    if (!k) return;
    if (rods) {
      gl.vertexAttrib3f(gl.getAttribLocation(stroke.p, "colour"), 0.26, 0.3, 0.37);
      gl.bindVertexArray(rods);
      passes(l.behind ? "fade" : "hide", (alpha) => {
        set(stroke, { width: Math.min(Math.max(0.03 * long * look.k, 0.45), 1.3), alpha, lift: 0, bias: 1e-3 / Math.max(1, state.zoom), tip: 0 });
        gl.uniform1i(stroke.at("head"), false); gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, k / 2);
      });
    } else {
      set(edge, { bias: 1e-3 / Math.max(1, state.zoom) }); gl.enable(gl.BLEND);
      gl.uniform4f(edge.at("colour"), 0.11, 0.13, 0.16, 0.3);
      gl.bindVertexArray(wire); gl.drawElements(gl.LINES, k, gl.UNSIGNED_INT, 0); gl.disable(gl.BLEND);
    }
  };
  let waiting = false, running = 0;
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
  const ticks = ({ low, high }) => {
    const rough = (high - low) / 4, power = 10 ** Math.floor(Math.log10(rough)), step = [1, 2, 2.5, 5, 10].map((s) => s * power).find((s) => s >= rough * (1 - 1e-9));
    const at = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * (high - low); k++) at.push(k * step);
    return { step, at };
  };
  const shortly = (v, unit = 0) => (v !== v ? "not finite" : String(Number((unit ? Math.round(v / unit) * unit : v).toPrecision(4)) || 0).replace("-", "−"));
  const ask = (px, py) => {
    const i = cells().findIndex((c) => px >= c.x && px < c.x + c.w && py >= c.y && py < c.y + c.h);
    if (i < 0) return "";
    const look = view(i, cells()[i]), panel = shown(state.frame)[i], lines = [];
    for (const l of panel.layers) {
      if (l.kind === "points") {
        let near = -1, least = 64;
        for (let k = 0; k < l.n; k++) { const [x, y] = project(l.at, k, look), d = (x - px) ** 2 + (y - py) ** 2; if (d < least) { least = d; near = k; } }
        if (near >= 0) lines.push(`point ${near}` + (l.v ? `\n${(panel.scale && panel.scale.name) || "value"} ${shortly(l.v[near], l.grain)}` : ""));
      } else if (l.kind === "mesh") {
        const hit = under(l, look, px, py);
        if (hit) lines.push(`vertex ${hit.vertex}, face ${hit.face}` + (l.v ? `\n${(panel.scale && panel.scale.name) || "value"} ${shortly(l.v[l.onFaces ? hit.face : hit.vertex], l.grain)}` : ""));
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
      if (!panel.bar) return;
      const whole = oneBar() ? { x: 0, y: 0, w: innerWidth, h: cell.y + cell.h } : cell;
      const high = Math.min(Math.max(whole.h * 0.6, 60), 220), bar = make("div", furniture, { className: "bar" });
      bar.style.cssText = `left:${whole.x + whole.w - barRoom() + 2}px;top:${whole.y + (whole.h - high) / 2 + 8}px;height:${high}px;background:linear-gradient(to top,${panel.scale.colours.join(",")})`;
      if (panel.scale.name) make("b", bar, { textContent: panel.scale.name }).style.cssText = "right:auto;left:0";
      for (const t of ticks(panel.scale).at) make("span", bar, { textContent: shortly(t) }).style.top = `${(100 * (panel.scale.high - t)) / (panel.scale.high - panel.scale.low)}%`;
    });
  };
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
    const play = button("play", "Play or stop (space)", () => actions[" "]());
    const word = make("span", tools), slider = make("input", tools, { type: "range", min: 0, max: header.frames.length - 1, step: 1, value: state.frame, title: "Frames" });
    const say = () => { word.textContent = extra.names[state.frame] || `${state.frame + 1} of ${header.frames.length}`; };
    slider.setAttribute("aria-label", "frame");
    const go = (f) => { slider.value = f; show(f); say(); };
    slider.addEventListener("input", () => { halt(); go(Number(slider.value)); });
    const halt = () => { clearInterval(running); running = 0; play.textContent = "play"; };
    actions[" "] = () => {
      if (running) return halt();
      if (state.frame === header.frames.length - 1) go(0);
      play.textContent = "stop";
      running = setInterval(() => { go(state.frame + 1); if (state.frame === header.frames.length - 1) halt(); }, 400);
    };
    say();
  } else if (extra.chooser === "menu" && header.frames.length > 1) {
    tools.classList.add("stay");
    const menu = make("select", tools, { title: "What the colours show" });
    extra.names.forEach((name, i) => make("option", menu, { value: i, textContent: name }));
    menu.value = state.frame;
    menu.addEventListener("change", () => show(Number(menu.value)));
  }

  // ---- mouse, touch, keyboard
  let moved = 0;
  const zoomBy = (factor) => { state.zoom = Math.min(Math.max(state.zoom * factor, 0.05), 200); };
  const fingers = new Map();
  const tell = (x, y) => {
    const text = ask(x, y);
    said.textContent = text; said.style.display = text ? "block" : "none";
    const { width, height } = said.getBoundingClientRect();
    Object.assign(said.style, { left: `${Math.max(0, Math.min(x + 12, innerWidth - width - 4))}px`, top: `${y + 14 + height > innerHeight ? Math.max(0, y - height - 10) : y + 14}px` });
  };
  canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); fingers.set(e.pointerId, [e.clientX, e.clientY]); moved = 0; said.style.display = "none"; });
  for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (e) => { fingers.delete(e.pointerId); if (kind === "pointerup" && moved < 5) tell(e.clientX, e.clientY); });
  canvas.addEventListener("pointermove", (e) => {
    const before = fingers.get(e.pointerId);
    if (!before) return tell(e.clientX, e.clientY);
    const dx = e.clientX - before[0], dy = e.clientY - before[1];
    moved += Math.hypot(dx, dy);
    if (fingers.size === 2) {
      const [other] = [...fingers].filter(([id]) => id !== e.pointerId).map(([, p]) => p);
      const far = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      zoomBy(far([e.clientX, e.clientY]) / far(before));
      state.pan = [state.pan[0] + dx / 2, state.pan[1] + dy / 2];
    } else if (e.shiftKey || e.buttons & 6) state.pan = [state.pan[0] + dx, state.pan[1] + dy];
    else state.turn = times(turning(dx / 120, dy / 120), state.turn);
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    redraw();
  });
  canvas.addEventListener("pointerleave", () => { said.style.display = "none"; });
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  // A page that scrolls stays one: the wheel zooms only what has been clicked, or with Ctrl.
  canvas.addEventListener("wheel", (e) => { if (document.activeElement === canvas || e.ctrlKey) { e.preventDefault(); zoomBy(Math.exp(-e.deltaY / 500)); redraw(); } }, { passive: false });
  canvas.addEventListener("keydown", (e) => {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[e.key];
    if (arrows && e.shiftKey) state.pan = [state.pan[0] + 12 * arrows[0], state.pan[1] + 12 * arrows[1]];
    else if (arrows) state.turn = times(turning(arrows[0] / 10, arrows[1] / 10), state.turn);
    else if (e.key === "+" || e.key === "=") zoomBy(1.15);
    else if (e.key === "-") zoomBy(1 / 1.15);
    else if (e.key === "Enter") return tell(innerWidth / 2, innerHeight / 2);
    else if (actions[e.key] && !e.ctrlKey && !e.metaKey) actions[e.key]();
    else return;
    e.preventDefault(); redraw();
  });
  addEventListener("resize", () => { furnish(); redraw(); }, until);
  furnish(); draw();
  document.documentElement.classList.add("drawn");
  document.body.dataset.after = performance.now();
  document.body.dataset.drawn = "yes";
  return {
    redraw,
    stop() {
      clearInterval(running);
      stopped.abort(); gl.getExtension("WEBGL_lose_context")?.loseContext();
      for (const part of [canvas, marks, said, furniture, tools]) part.remove();
      document.documentElement.classList.remove("drawn"); delete document.body.dataset.drawn;
      return state;
    },
  };
};

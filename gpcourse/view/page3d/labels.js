/* Labels: what is seen comes first, the nearest before the others, each where there is room. */
const CROWD = 60;
const AROUND = [[1, 1], [-1, 1], [1, -1], [-1, -1], [1.15, 0], [-1.15, 0], [0, 1.25], [0, -1.25]];
const between = (low, x, high) => Math.min(Math.max(x, low), high);
const onDark = (hex) => {
  const [r, g, b] = rgb(hex), share = 0.6 * (1 - 0.3 * r - 0.6 * g - 0.1 * b);
  return `rgb(${[r, g, b].map((c) => Math.round(255 * (c + share * (1 - c)))).join(",")})`;
};

const write = (pen, panel, { look, cell, dark, project, under }) => {
  const meshes = panel.layers.filter((l) => l.kind === "mesh"), taken = [], wanted = [];
  const free = ([x, y], w, h) => taken.every((t) => Math.abs(x - t[0]) >= w + t[2] || Math.abs(y - t[1]) >= h + t[3]);
  const middle = [look.cx, look.cy];
  let budget = 6e6;  // triangles to look through, a picture
  const inFront = (x, y, z) => {
    let top = null;
    for (const mesh of meshes) {
      budget -= mesh.owner.length;
      if (budget < 0) return { on: true, behind: z < 0 };
      const hit = under(mesh, look, x, y);
      if (hit && (!top || hit.z > top.z)) top = hit;
    }
    return { on: !!top, behind: !!top && top.z > z + 0.006 * look.reach };
  };
  panel.layers.forEach((l, rank) => {
    if (l.kind === "points" && l.n <= 300)
      for (let i = 0; i < l.n; i++) { const [x, y] = project(l.at, i, look); taken.push([x, y, 0.75 * l.size, 0.75 * l.size]); }
    if (!l.texts || !l.texts.length) return;
    const size = l.a ? arrowLetters(l, look, project) : between(10, 66 / l.texts.length ** 0.45, 14);
    l.texts.forEach((text, i) => {
      const [x, y, z] = project(l.at, i, look), { behind } = inFront(x, y, z), faint = behind && l.hidden !== "show";
      if (text && !(faint && l.hidden === "hide")) wanted.push({ l, i, text, size, rank, x, y, z, faint });
    });
  });
  wanted.sort((p, q) => !!p.l.a - !!q.l.a || p.faint - q.faint || q.rank - p.rank || q.z - p.z);
  pen.save(); pen.beginPath(); pen.rect(cell.x, cell.y, cell.w, cell.h); pen.clip();
  pen.textBaseline = "middle"; pen.textAlign = "center"; pen.lineJoin = "round";
  for (const word of wanted) {
    const { l, text, size } = word, badge = l.place === "badge", bold = badge || (l.a && l.width > 1.5);
    pen.font = `${bold ? "bold " : ""}${size}px system-ui, sans-serif`;
    const w = pen.measureText(text).width / 2 + 1, h = 0.37 * size + 1;
    const places = candidates(word, w, h, middle, look, project), place = places.find((p) => free(p, w, h));
    if (!place && (l.a || l.texts.length > CROWD)) continue;
    const [x, y] = place || places[0];
    if (x - w / 2 < cell.x || x + w / 2 > cell.x + cell.w || y - h / 2 < cell.y || y + h / 2 > cell.y + cell.h) continue;  // could not be read
    stamp(pen, [x, y], word, w, h, dark && !badge && !inFront(x, y, word.z).on);
    taken.push([x, y, badge ? Math.max(w, 0.9 * size) : w, badge ? 0.9 * size : h]);
  }
  pen.restore();
};

const arrowLetters = (l, look, project) => {
  const long = l.texts.map((_, i) => { const p = project(l.a, i, look), q = project(l.b, i, look); return Math.hypot(q[0] - p[0], q[1] - p[1]); }).sort((p, q) => p - q);
  return between(8, 0.2 * long[long.length >> 1], 14) * (l.width > 1.5 ? 1.12 : 1);
};

/* Where a label may stand, the best place first. */
const candidates = ({ l, i, x, y, size }, w, h, middle, look, project) => {
  if (l.a) {
    const p = project(l.a, i, look), q = project(l.b, i, look), long = Math.hypot(q[0] - p[0], q[1] - p[1]) || 1;
    const along = [(q[0] - p[0]) / long, (q[1] - p[1]) / long];
    let side = [along[1], -along[0]];
    if (l.sides) {
      const A = look.axes, s = l.sides.slice(3 * i, 3 * i + 3), flat = [0, 3].map((k) => A[k] * s[0] + A[k + 1] * s[1] + A[k + 2] * s[2]);
      if (side[0] * flat[0] - side[1] * flat[1] < 0) side = [-side[0], -side[1]];
    }
    const reach = Math.abs(side[0]) * w + Math.abs(side[1]) * h + 0.75 * l.width + 1.5;
    return [0, -0.12, 0.12, -0.22].map((t) => [x + side[0] * reach + t * long * along[0], y + side[1] * reach + t * long * along[1]]);
  }
  if (l.place !== "beside") return [[x, y]];
  const out = [x - middle[0], y - middle[1]], score = (a) => (a[0] * out[0] + a[1] * out[1]) / Math.hypot(...a);
  const around = [...AROUND].sort((a, b) => score(b) - score(a));
  return [3, 6, 10].flatMap((gap) => around.map((a) => [x + a[0] * (w + gap), y + a[1] * (h + gap)]));
};

/* On a surface and on white paper: dark letters with a white rim; on dark paper the other way round. */
const stamp = (pen, [x, y], { l, i, text, size, faint }, w, h, light) => {
  const colour = l.colours[i % l.colours.length];
  pen.globalAlpha = faint ? 0.7 : 1;
  if (l.place === "badge") {
    pen.beginPath(); pen.arc(x, y, Math.max(w + 1.5, 0.85 * size), 0, 2 * Math.PI);
    pen.fillStyle = "#fff"; pen.fill(); pen.strokeStyle = colour; pen.lineWidth = 1.6; pen.stroke();
  } else {
    pen.strokeStyle = light ? "#14171a" : "rgba(255,255,255,.85)"; pen.lineWidth = 3; pen.strokeText(text, x, y + 0.5);
  }
  pen.fillStyle = light ? onDark(colour) : colour;
  pen.fillText(text, x, y + 0.5);
  pen.globalAlpha = 1;
};

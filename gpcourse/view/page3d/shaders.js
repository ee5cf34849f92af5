"use strict";
const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
const SHADERS = (() => {
  const seen = `uniform mat3 axes; uniform vec3 focus; uniform vec2 scale; uniform float reach;
    vec3 seen(vec3 x) { vec3 y = (x - focus) * axes; return vec3(y.xy * scale, -y.z / reach); }`;
  // On dark paper dark colours are mixed with white.
  const lifted = `uniform float lift, alpha;
    vec4 lifted(vec3 c) { return vec4(mix(c, vec3(1.0), lift * (1.0 - dot(c, vec3(0.3, 0.6, 0.1)))), alpha); }`;
  return {
    surface: [
      seen + `in vec3 x; in vec3 normal; in vec3 colour; in float value; out vec3 n; out vec3 y; out vec3 c; out float v;
      void main() { gl_Position = vec4(seen(x), 1.0); y = (x - focus) * axes; n = normal * axes; c = colour; v = value; }`,
      `in vec3 n; in vec3 y; in vec3 c; in float v; out vec4 o;
      uniform bool flat_, valued, lines; uniform vec2 range; uniform float spacing; uniform sampler2D lookup; uniform vec3 back;
      void main() {
        vec3 g = normalize(cross(dFdx(y), dFdy(y)));
        vec3 m = flat_ || dot(n, n) < 1e-12 ? g : normalize(n);
        if (m.z < 0.0) m = -m;
        vec3 base = c;
        float t = (v - range.x) / (range.y - range.x);
        bool known = v == v;
        if (valued) base = known ? texture(lookup, vec2(clamp(t, 0.0, 1.0), 0.5)).rgb : vec3(0.73, 0.735, 0.75);
        if (!gl_FrontFacing) base = valued ? mix(base, vec3(0.73), 0.45) : back;
        float ambient = valued ? 0.72 : 0.44;
        float light = ambient + (1.0 - ambient) * max(dot(m, vec3(-0.379, 0.531, 0.758)) + 0.3, 0.0) / 1.058;
        vec3 shown = base * min(light, 1.0);
        float gloss = 0.5 * max(light - 1.0, 0.0);
        shown = shown * (1.0 - gloss) + gloss;
        if (lines && valued && known) {
          // Two lines for every number at the colour bar; those at the numbers are thicker. None where the value is constant.
          float s = v / spacing, w = fwidth(s), d = abs(fract(s - 0.5) - 0.5) / max(w, 1e-5);
          float thick = abs(fract(0.5 * s - 0.5) - 0.5) < 0.25 ? 0.9 : 0.3;
          if (w > 1e-5 && abs(t - 0.5) < 0.497) shown = mix(vec3(0.08), shown, clamp(d - thick, 0.0, 1.0));
        }
        o = vec4(shown, 1.0);
      }`,
    ],
    edge: [
      seen + "in vec3 x; uniform float bias; void main() { gl_Position = vec4(seen(x), 1.0); gl_Position.z -= bias; }",
      "uniform vec4 colour; out vec4 o; void main() { o = colour; }",
    ],
    stroke: [
      seen + `in vec3 a; in vec3 b; in vec3 colour; uniform vec2 pixels; uniform float width, bias, tip; uniform bool head; out vec3 c;
      void main() {
        vec3 p = seen(a), q = seen(b);
        vec2 d = (q.xy - p.xy) * pixels; float l = max(length(d), 1e-6); d /= l;
        vec2 across = vec2(-d.y, d.x);
        float size = min(tip, 0.45 * l);
        vec3 at; vec2 off;
        if (head) {
          at = q; off = gl_VertexID == 0 ? vec2(0.0) : -d * size + across * size * (gl_VertexID == 1 ? 0.4 : -0.4);
        } else {
          // The line ends inside its head, whose tip alone marks the end.
          at = gl_VertexID < 2 ? p : q; off = across * width * 0.5 * (gl_VertexID % 2 == 0 ? 1.0 : -1.0) - (gl_VertexID < 2 ? vec2(0.0) : 0.7 * size * d);
        }
        gl_Position = vec4(at.xy + off / pixels, at.z - bias, 1.0); c = colour;
      }`,
      lifted + "in vec3 c; out vec4 o; void main() { o = lifted(c); }",
    ],
    dot: [
      seen + `in vec3 x; in vec3 colour; uniform float size, bias; out vec3 c;
      void main() { gl_Position = vec4(seen(x), 1.0); gl_Position.z -= bias; gl_PointSize = size + 1.0; c = colour; }`,
      lifted + `in vec3 c; uniform float size; out vec4 o;
      void main() {
        float r = length(gl_PointCoord - 0.5) * (size + 1.0), inside = clamp(0.5 * size + 0.5 - r, 0.0, 1.0);
        if (inside < 0.05) discard;
        o = lifted(c * (1.0 - 0.25 * r * r / (0.25 * size * size)));
        o.a *= inside;  // a soft rim
      }`,
    ],
  };
})();

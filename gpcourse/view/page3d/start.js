/* Dark where the page around is dark: it is asked, since a sandboxed frame cannot look. */
const night = matchMedia("(prefers-color-scheme: dark)");
let told = null;
const isDark = () => told ?? night.matches;
addEventListener("message", (e) => {
  if (e.source !== parent || typeof (e.data || {}).gpcourseDark !== "boolean") return;
  told = e.data.gpcourseDark;
  if (live) live.redraw?.();
});
night.addEventListener("change", () => live?.redraw?.());
if (parent !== window) parent.postMessage("gpcourse: dark?", "*");

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

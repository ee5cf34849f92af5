(() => {
if (window.gpcourseFrames) return;
const frames = window.gpcourseFrames = new Set();
const dark = (e) => {
  for (; e; e = e.parentElement) {
    const [r, g, b, a = 1] = (getComputedStyle(e).backgroundColor.match(/[0-9.]+/g) || [0, 0, 0, 0]).map(Number);
    if (a > 0.5) return 0.3 * r + 0.6 * g + 0.1 * b < 128;
  }
  return getComputedStyle(document.documentElement).colorScheme.includes("dark") && matchMedia("(prefers-color-scheme: dark)").matches;
};
const tell = () => frames.forEach((f) => f.isConnected ? f.contentWindow?.postMessage({ gpcourseDark: dark(f.parentElement) }, "*") : frames.delete(f));
const later = () => [0, 500, 2000].forEach((t) => setTimeout(tell, t));
addEventListener("message", (e) => {
  if (e.data !== "gpcourse: dark?") return;
  for (const f of document.querySelectorAll("iframe")) if (f.contentWindow === e.source) frames.add(f);
  tell();
});
for (const e of [document.documentElement, document.body])
  new MutationObserver(later).observe(e, { attributeFilter: ["class", "data-theme", "data-mode", "data-jp-theme-light", "data-jp-theme-name"] });
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", later);
})();

/** What the colours and marks of the field mean. */
import { html, svg } from "./dom.js";

const LINE = "M1 8H23";

/** Explain what is to be seen of some runs, and nothing else. */
export function legend(runs) {
  const lined = runs.some((run) => run.lined);
  const has = (name) => runs.some((run) => run.decisions[name].some((point) => Number.isFinite(point[0])));
  const modes = new Set(runs.flatMap((run) => run.modes().map(([mode]) => mode)));
  const ruled = runs.some(({ data }) => data.controller !== null);
  const entries = [
    ["left line", "left", LINE, lined],
    ["line to the aim", "middle", LINE, lined],
    ["right line", "right", LINE, lined],
    ["aim", "aim", "M12 0V5M12 11V16M4 8H9M15 8H20", has("aim")],
    [ruled ? "frontier that a way out leads to" : "target", "frontier", "M12 1L19 8L12 15L5 8Z", has("target")],
    [ruled ? "routine" : "path", "routine", LINE, modes.has("routine")],
    ["breakout", "breakout", LINE, modes.has("breakout")],
    ["following", "following", LINE, modes.has("following")],
  ].filter(([, , , shown]) => shown);
  return html(
    "ul",
    { class: "legend" },
    ...entries.map(([text, name, d]) =>
      html("li", {}, svg("svg", { viewBox: "0 0 24 16", "aria-hidden": "true" }, svg("path", { class: name, d })), text)),
  );
}

/** What the colours and marks of the field mean. */
import { html, svg } from "./dom.js";

const ENTRIES = [
  ["left line", "left", "M1 8H23"],
  ["line to the aim", "middle", "M1 8H23"],
  ["right line", "right", "M1 8H23"],
  ["aim", "aim", "M12 0V5M12 11V16M4 8H9M15 8H20"],
  ["frontier that a way out leads to", "frontier", "M12 1L19 8L12 15L5 8Z"],
  ["routine", "routine", "M1 8H23"],
  ["breakout", "breakout", "M1 8H23"],
  ["following", "following", "M1 8H23"],
];

export function legend() {
  return html(
    "ul",
    { class: "legend" },
    ...ENTRIES.map(([text, name, d]) =>
      html("li", {}, svg("svg", { viewBox: "0 0 24 16", "aria-hidden": "true" }, svg("path", { class: name, d })), text)),
  );
}

/** Light and dark: the colours of the style sheet, for what is drawn on a canvas. */

const NAMES = [
  "page", "card", "ink", "muted", "faint", "line", "ground", "grid", "obstacle", "mover", "wall",
  "left", "middle", "right", "goal", "target", "danger", "heat", "robot",
];

const listeners = [];
let known = null;

/** Return the colours that hold now, by name. */
export function colours() {
  if (known === null) {
    const style = getComputedStyle(document.documentElement);
    known = Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
  }
  return known;
}

/** Call a function when the colours have changed. */
export function whenRecoloured(listener) {
  listeners.push(listener);
}

function changed() {
  known = null;
  for (const listener of listeners) listener();
}

export function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

export function toggleDark() {
  document.documentElement.dataset.theme = isDark() ? "light" : "dark";
  changed();
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);

/** Return red, green and blue (0 to 255) of a colour written as #rrggbb. */
export function channels(colour) {
  return [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
}

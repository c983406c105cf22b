/** The keyboard. */
import { html } from "./dom.js";

const TOLD = [
  ["space", "play or pause"],
  ["← →", "one decision back or on"],
  ["shift ← →", "one second back or on"],
  ["Home, End", "start, end"],
  ["p n", "event before, next event"],
  ["− +", "slower, faster"],
  ["z", "close-up of the robot, or the whole field"],
  ["d", "light or dark"],
  ["?", "these keys"],
];

/** Return the dialog that lists the keys. */
export function helpDialog() {
  const rows = TOLD.map(([keys, what]) =>
    html("tr", {}, html("th", { scope: "row" }, ...keys.split(" ").map((key) => html("kbd", {}, key))), html("td", {}, what)));
  return html(
    "dialog",
    { class: "help", "aria-label": "Keys" },
    html("h2", {}, "Keys"),
    html("table", {}, html("tbody", {}, ...rows)),
    html("p", {}, "Press on the path to go there. Handles and sliders move with ← and → when they have the focus."),
    html("form", { method: "dialog" }, html("button", {}, "Close")),
  );
}

/** Listen to the keys; `player` may be null, `acts` has `closeUp`, `dark` and `help`. */
export function listen(player, acts) {
  const keys = { z: acts.closeUp, d: acts.dark, "?": acts.help };
  if (player) {
    Object.assign(keys, {
      " ": () => player.toggle(),
      n: () => player.jump(1),
      p: () => player.jump(-1),
      "+": () => player.faster(1),
      "-": () => player.faster(-1),
      Home: () => player.seek(0),
      End: () => player.seek(player.end),
      ArrowLeft: (event) => (event.shiftKey ? player.seek(player.time - 1) : player.step(-1)),
      ArrowRight: (event) => (event.shiftKey ? player.seek(player.time + 1) : player.step(1)),
    });
  }
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.closest("input, select, dialog")) return;
    if (event.key === " " && event.target.closest("button")) return; // the button is pressed
    const act = keys[event.key];
    if (!act) return;
    event.preventDefault();
    act(event);
  });
}

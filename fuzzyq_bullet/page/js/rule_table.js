/** The rule table: each rule an arrow of its turn and step, lit as strongly as it fires. */
import { arrowPath } from "./arrows.js";
import { fixed, html, say, set, svg } from "./dom.js";

const CELL = 40; // units of an arrow's picture
const COUNTS = 0.05;

export class RuleTable {
  /**
   * Columns run from the greatest difference to the least, so that rules for "left freer" stand on
   * the left.
   *
   * @param controller Whose rules.
   * @param options `labelled`, to write the labels of turn and step in each cell.
   */
  constructor(controller, { labelled = false } = {}) {
    this.controller = controller;
    const { distance, difference } = controller;
    this.columns = difference.sets.map((_, j) => j).reverse();
    this.cells = distance.sets.map(() => []);
    const head = html(
      "tr",
      {},
      html("th", { scope: "col", class: "corner" }, "ahead"),
      ...this.columns.map((j) => header(difference.sets[j], "col")),
    );
    const rows = distance.sets.map((one, i) =>
      html("tr", {}, header(one, "row"), ...this.columns.map((j) => this.cell(i, j, labelled))),
    );
    const table = html("table", { class: labelled ? "rules labelled" : "rules" },
      html("thead", {}, head), html("tbody", {}, ...rows));
    const ends = html("div", { class: "ends" }, html("span", {}, "left freer"), html("span", {}, "right freer"));
    this.element = html("div", { class: "rules-box" }, ends, table);
  }

  cell(i, j, labelled) {
    const { outputs, distance, difference, cells } = this.controller;
    const [turn, step] = outputs.map((output, k) => output.sets[cells[i][j][k]]);
    const arrow = svg("path", { class: "arrow" });
    const labels = labelled ? html("small", {}, `${turn.label} ${step.label}`) : null;
    const strength = html("span", { class: "strength" });
    const lit = html("span", { class: "lit" });
    const element = html(
      "td",
      {
        title: `If ahead is ${distance.sets[i].words} and the sides are ${difference.sets[j].words}: turn ${turn.words}, step ${step.words}`,
      },
      lit,
      svg("svg", { viewBox: `0 0 ${CELL} ${CELL}`, "aria-hidden": "true" }, arrow),
      labels,
      strength,
    );
    this.cells[i][j] = { element, arrow, strength, lit };
    return element;
  }

  /**
   * Point the arrows where the rules turn and let them be as long as these step.
   *
   * `weights(i, j)` returns ω1 and ω2 of a rule; `unit` is A_p (rad).
   */
  point(weights, unit) {
    const { turn, step, cells } = this.controller;
    cells.forEach((row, i) =>
      row.forEach(([t, s], j) => {
        const [w1, w2] = weights(i, j);
        const angle = Math.min(Math.max(turn.sets[t].centre * unit * w2, -3), 3);
        const part = Math.min(Math.max((step.sets[s].centre / step.high) * w1, 0), 1);
        set(this.cells[i][j].arrow, { d: arrowPath(CELL / 2, CELL / 2, angle, 13 + 21 * part) });
      }),
    );
  }

  /** Light the rules; `asked` is whether what they say is done. */
  show(rules, asked = true) {
    const all = rules.flat();
    const strongest = Math.max(...all);
    this.element.classList.toggle("not-asked", !asked);
    rules.forEach((row, i) =>
      row.forEach((strength, j) => {
        const { element, strength: number, lit } = this.cells[i][j];
        // The root lifts weak rules into sight; the order of brightness stays.
        lit.style.opacity = Math.sqrt(strength).toFixed(3);
        element.classList.toggle("bright", strength > 0.25 && asked);
        element.classList.toggle("strongest", strength === strongest && strength > COUNTS && asked);
        say(number, strength >= COUNTS ? fixed(strength) : "");
      }),
    );
  }
}

/** Return the head of a row or column: its words where there is room, its label elsewhere. */
function header(one, scope) {
  return html("th", { scope, title: `${one.label}: ${one.words}` },
    html("span", { class: "in-words" }, one.words), html("abbr", {}, one.label));
}

/** The rule table: each rule an arrow of its turn and step, lit as strongly as it fires. */
import { arrowPath } from "./arrows.js";
import { fixed, html, say, set, svg } from "./dom.js";

const CELL = 40; // units of an arrow's picture
const COUNTS = 0.05;

export class RuleTable {
  /**
   * Rows run from near to far. Columns run from the greatest difference to the least, so that rules
   * for "left freer" stand on the left.
   *
   * @param controller Whose rules.
   * @param options `changed()`, called after a rule was changed: with it each cell says the labels
   *   of its turn and step, and is a button that lets others be chosen.
   */
  constructor(controller, { changed = null } = {}) {
    this.controller = controller;
    this.changed = changed;
    const { distance, difference } = controller;
    const rising = (sets) => [...sets.keys()].sort((a, b) => sets[a].centre - sets[b].centre);
    this.columns = rising(difference.sets).reverse();
    this.cells = distance.sets.map(() => []);
    const head = html(
      "tr",
      {},
      html("th", { scope: "col", class: "corner" }, "ahead"),
      ...this.columns.map((j) => header(difference.sets[j], "col")),
    );
    const rows = rising(distance.sets).map((i) =>
      html("tr", {}, header(distance.sets[i], "row"), ...this.columns.map((j) => this.cell(i, j))),
    );
    const table = html("table", { class: changed ? "rules labelled" : "rules" },
      html("thead", {}, head), html("tbody", {}, ...rows));
    const ends = html("div", { class: "ends" }, html("span", {}, "left freer"), html("span", {}, "right freer"));
    this.dialog = changed && html("dialog", { class: "rule" });
    this.element = html("div", { class: "rules-box" }, ends, table, this.dialog);
  }

  cell(i, j) {
    const arrow = svg("path", { class: "arrow" });
    const labels = html("small");
    const strength = html("span", { class: "strength" });
    const lit = html("span", { class: "lit" });
    const picture = svg("svg", { viewBox: `0 0 ${CELL} ${CELL}`, "aria-hidden": "true" }, arrow);
    const edit = { type: "button", class: "rule", onclick: () => this.edit(i, j) };
    const content = this.changed ? html("button", edit, picture, labels, strength) : picture;
    const element = html("td", {}, lit, content);
    this.cells[i][j] = { element, arrow, labels, strength, lit };
    return element;
  }

  /** Return the turn and the step that a rule names. */
  concludes(i, j) {
    const { outputs, cells } = this.controller;
    return outputs.map((output, k) => output.sets[cells[i][j][k]]);
  }

  condition(i, j) {
    const { distance, difference } = this.controller;
    return `If ahead is ${distance.sets[i].words}, and the sides are ${difference.sets[j].words}:`;
  }

  /** Ask for another turn and step of a rule. */
  edit(i, j) {
    const { outputs, cells } = this.controller;
    const chosen = outputs.map((output, k) =>
      html(
        "select",
        {
          onchange: (event) => {
            cells[i][j][k] = Number(event.target.value);
            this.changed();
          },
        },
        ...output.sets.map((one, number) =>
          html("option", { value: number, selected: number === cells[i][j][k] ? "" : null },
            `${one.label}: ${one.words}`)),
      ),
    );
    this.dialog.replaceChildren(
      html("p", {}, this.condition(i, j)),
      html("label", {}, "turn", chosen[0]),
      html("label", {}, "step", chosen[1]),
      html("form", { method: "dialog" }, html("button", {}, "Close")),
    );
    this.dialog.showModal();
  }

  /**
   * Point the arrows where the rules turn and let them be as long as these step.
   *
   * `weights(i, j)` returns ω1 and ω2 of a rule; `unit` is A_p (rad).
   */
  point(weights, unit) {
    const longest = this.controller.step.high;
    this.cells.forEach((row, i) =>
      row.forEach(({ element, arrow, labels }, j) => {
        const [turn, step] = this.concludes(i, j);
        const [w1, w2] = weights(i, j);
        const angle = Math.min(Math.max(turn.centre * unit * w2, -3), 3);
        const part = Math.min(Math.max((step.centre / longest) * w1, 0), 1);
        set(arrow, { d: arrowPath(CELL / 2, CELL / 2, angle, 13 + 21 * part) });
        say(labels, `${turn.label} ${step.label}`);
        set(element, { title: `${this.condition(i, j)} turn ${turn.words}, step ${step.words}` });
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
        element.classList.toggle("fires", strength >= COUNTS);
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

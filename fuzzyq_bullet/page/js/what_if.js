/** What if: the controller runs here, and its inputs, sets and weights can be changed. */
import { Dial } from "./acts.js";
import { fixed, html, say, turning, weight } from "./dom.js";
import { Controller } from "./inference.js";
import { Plot } from "./plot.js";
import { RuleTable } from "./rule_table.js";
import { SIZE, Surface } from "./surface.js";

const WEIGHTS = [0.05, 20]; // least and greatest that a slider offers; planners allow no greater
const LONGEST = 0.4; // metres: a step that fills the dial's needle

export class WhatIf {
  /**
   * @param data The controller, as the page's data give it.
   * @param standard `turn_unit` (A_p, rad), `step_unit` (S_p, m) and `weights`.
   * @param names Of the runs that can be followed.
   */
  constructor(data, standard, names) {
    this.data = data;
    this.standard = standard;
    this.names = names;
    this.follows = names.length ? 0 : -1;
    this.element = html("section", { class: "what-if", id: "what-if" });
    this.reset();
  }

  /** Begin anew with the sets as they were. */
  reset() {
    this.controller = new Controller(this.data);
    this.original = new Controller(this.data);
    this.changed = false;
    this.d ??= 0.3 * this.controller.distance.high;
    this.df ??= 0.25 * this.controller.difference.low;
    this.weights ??= [...this.standard.weights];
    this.build();
    this.surfaceChanged();
    this.update();
  }

  build() {
    const { distance, difference, turn, step } = this.controller;
    const changed = () => this.setsChanged();
    this.near = new Plot(distance, { title: "d: free distance ahead", changed });
    this.side = new Plot(difference, { title: "Df: left less right", mirrored: true, changed });
    this.turned = new Plot(turn, { title: "turn N_a", mirrored: true, changed });
    this.stepped = new Plot(step, { title: "step N_s", changed });
    this.table = new RuleTable(this.controller, { changed });
    const picked = (d, df) => this.setInputs(d, df);
    this.surfaces = [
      new Surface(this.controller, { title: "turn, for every d and Df", output: "turn", picked }),
      new Surface(this.controller, { title: "step, for every d and Df", output: "step", picked }),
    ];
    this.dSlider = slider("d", distance, () => this.setInputs(Number(this.dSlider.value), this.df));
    this.dfSlider = slider("Df", difference, () => this.setInputs(this.d, Number(this.dfSlider.value)));
    this.dfSlider.dir = "rtl"; // left freer is on the left
    this.dial = new Dial();
    this.answer = html("p", { class: "answer", "aria-live": "polite" });
    this.before = html("p", { class: "before" });
    this.w = WEIGHTS.map((_, k) => this.weightSlider(k));
    const card = (title, ...content) => html("section", { class: "card" }, html("h3", {}, title), ...content);
    this.element.replaceChildren(
      html("header", {}, html("h2", {}, "What if …?"), this.toolbar()),
      html(
        "p",
        { class: "hint" },
        "Move d and Df with the sliders, or press on a surface. Drag the round handles to move a set; ",
        "press on a set to reshape it by its square handles. Press on a rule to change what it says. ",
        "Rules and surfaces follow at once.",
      ),
      html("div", { class: "verdict" }, this.dial.element, html("div", {}, this.answer, this.before)),
      html(
        "div",
        { class: "cards" },
        card("Inputs: what is near, and which side is freer",
          this.near.element, this.dSlider, this.side.element, this.dfSlider),
        card("Rules: how strongly each one fires", this.table.element),
        card("Outputs: what the rules say together",
          this.turned.element, this.stepped.element, ...this.w.map(({ element }) => element)),
        card("Surface of the turn", this.surfaces[0].element),
        card("Surface of the step", this.surfaces[1].element),
      ),
    );
  }

  toolbar() {
    const tools = [html("button", { type: "button", class: "reset", onclick: () => this.reset() }, "Reset the sets")];
    if (this.names.length) {
      const options = ["by hand", ...this.names.map((name) => `follow ${name}`)];
      this.select = html(
        "select",
        { "aria-label": "Where d and Df come from", onchange: () => this.follow(Number(this.select.value)) },
        ...options.map((text, k) =>
          html("option", { value: k - 1, selected: k - 1 === this.follows ? "" : null }, text)),
      );
      tools.unshift(this.select);
    }
    return html("div", { class: "tools" }, ...tools);
  }

  weightSlider(k) {
    const value = html("output");
    const input = html("input", {
      type: "range",
      min: Math.log10(WEIGHTS[0]),
      max: Math.log10(WEIGHTS[1]),
      step: 0.005,
      "aria-label": `ω${k + 1}`,
      oninput: () => {
        this.follow(-1);
        this.weights[k] = 10 ** Number(input.value);
        this.update();
      },
    });
    const name = k ? "ω2, weight of the turn" : "ω1, weight of the step";
    return { input, value, element: html("label", { class: "weight" }, html("span", {}, name), input, value) };
  }

  /** Take d, Df and the weights from a run from now on; −1: from the sliders. */
  follow(number) {
    this.follows = number;
    this.taken = null;
    if (this.select) this.select.value = String(number);
    if (number >= 0 && this.decisions) this.take(this.decisions);
  }

  /** Take what the decisions in force say, one for each run that can be followed. */
  take(decisions) {
    this.decisions = decisions;
    const decision = this.follows < 0 ? null : decisions[this.follows];
    const taken = `${this.follows} ${decision?.index}`;
    if (taken === this.taken) return;
    this.taken = taken;
    if (!decision || decision.distance === null || decision.difference === null) return;
    this.d = decision.distance;
    this.df = decision.difference;
    if (decision.weights.every(Number.isFinite)) this.weights = [...decision.weights];
    this.update();
  }

  setInputs(d, df) {
    this.follow(-1);
    [this.d, this.df] = [d, df];
    this.update();
  }

  setsChanged() {
    this.changed = true;
    this.controller.prepare();
    this.update();
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => {
      this.waiting = null;
      this.surfaceChanged();
    });
  }

  surfaceChanged() {
    const heights = this.controller.surface(SIZE);
    for (const surface of this.surfaces) surface.fill(heights[surface.output]);
  }

  /** Infer, and show all of it. */
  update() {
    const { controller, d, df } = this;
    const found = controller.infer(d, df);
    this.near.show({ value: d, degrees: found.near });
    this.side.show({ value: df, degrees: found.side });
    [this.turned, this.stepped].forEach((plot, k) => {
      const [turn, step] = [found.turn, found.step];
      plot.show({
        value: k ? step : turn,
        degrees: found.strengths[k],
        aggregate: { points: controller.points[k], heights: found.aggregates[k] },
        words: k ? fixed(step) : `${fixed(Math.abs(turn))}${turn > 0 ? " left" : turn < 0 ? " right" : ""}`,
      });
    });
    this.table.point(() => this.weights, this.standard.turn_unit);
    this.table.show(found.rules);
    for (const surface of this.surfaces) surface.mark(d, df);
    this.dSlider.value = String(d);
    this.dfSlider.value = String(df);
    this.w.forEach(({ input, value }, k) => {
      input.value = String(Math.log10(Math.max(this.weights[k], WEIGHTS[0])));
      say(value, weight(this.weights[k]));
    });
    const [turn, step] = this.inUnits(found);
    this.dial.show(turn, step / LONGEST);
    this.explain(found, turn, step);
  }

  /** Return the turn (rad) and the step (m) of an inference, weighed (Eq. 17). */
  inUnits({ turn, step }) {
    const [w1, w2] = this.weights;
    return [w2 * turn * this.standard.turn_unit, w1 * step * this.standard.step_unit];
  }

  /** Say in a sentence what fires and what follows. */
  explain({ near, side, rules }, turn, step) {
    const { distance, difference, cells } = this.controller;
    const strongest = rules.flat().indexOf(Math.max(...rules.flat()));
    const [i, j] = [Math.floor(strongest / side.length), strongest % side.length];
    const strength = rules[i][j];
    const parts = strength > 0
      ? ["Ahead: ", strong(distance.sets[i].words), `. Sides: `, strong(difference.sets[j].words),
         `. This rule fires most (${fixed(strength)}). `]
      : ["No rule fires. "];
    const way = Math.round((Math.abs(turn) * 180) / Math.PI) < 1 ? "go " : "turn ";
    this.answer.replaceChildren(
      ...parts, "So the robot is asked to ", strong(`${way}${turning(turn)}`),
      " and to step ", strong(`${fixed(step)}\u00a0m`), ".");
    if (!this.changed) {
      say(this.before, "");
      return;
    }
    const [oldTurn, oldStep] = this.inUnits(this.original.infer(this.d, this.df));
    say(this.before, `Before your changes: ${turning(oldTurn)}, step asked ${fixed(oldStep)} m.`);
  }
}

function strong(text) {
  return html("b", {}, text);
}

function slider(name, variable, changed) {
  return html("input", {
    type: "range",
    class: "under-plot",
    min: variable.low,
    max: variable.high,
    step: (variable.high - variable.low) / 1000,
    "aria-label": name,
    oninput: changed,
  });
}

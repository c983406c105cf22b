/** Card 3: the rules that fire. */
import { html, say } from "./dom.js";
import { RuleTable } from "./rule_table.js";

export class Rules {
  constructor(run, controller) {
    this.table = new RuleTable(controller);
    this.title = html("h3");
    this.element = html("section", { class: "card" }, this.title, this.table.element);
    const columns = controller.difference.sets.length;
    this.table.point((i, j) => run.data.rule_weights[i * columns + j], run.data.robot.turn_unit ?? 1);
    this.columns = columns;
    this.blank = controller.cells.map((row) => row.map(() => 0));
  }

  show(decision) {
    const asked = !decision || Boolean(decision.asked);
    const unasked = decision?.mode === "routine" ? "3 · Rules not asked" : "3 · Aims at a gap: rules not asked";
    say(this.title, asked ? "3 · Rules that fire" : unasked);
    const fired = this.blank.map((row, i) =>
      row.map((_, j) => decision?.rules[i * this.columns + j] ?? 0),
    );
    this.table.show(fired, asked);
  }
}

/** Card 1 of a planner without detection lines: what is about the robot, and where it heads. */
import { fixed, html } from "./dom.js";
import { Field } from "./field.js";

export class Around {
  constructor(run, seek) {
    this.field = new Field(run, seek);
    this.field.follow(true);
    const told = `No detection lines. It sees up to ${fixed(run.data.robot.range)}\u00a0m: the ring. Arrow: its heading.`;
    this.element = html(
      "section",
      { class: "card around" },
      html("h3", {}, "1 · Senses"),
      this.field.element,
      html("p", { class: "facts" }, told),
    );
  }

  show(moment, decision) {
    this.field.show(moment, decision);
  }
}

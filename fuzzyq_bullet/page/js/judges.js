/** Card 2: what the distances mean to the controller: its sets, and where the values lie. */
import { html } from "./dom.js";
import { Plot } from "./plot.js";

export class Judges {
  constructor(controller) {
    this.near = new Plot(controller.distance, { title: "ahead" });
    this.side = new Plot(controller.difference, { title: "sides", mirrored: true });
    this.element = html(
      "section",
      { class: "card judges" },
      html("h3", {}, "2 · Judges"),
      this.near.element,
      this.side.element,
    );
  }

  show(decision) {
    const value = (number) => (decision ? number : null);
    this.near.show({ value: value(decision?.distance), degrees: decision?.near ?? [] });
    this.side.show({ value: value(decision?.difference), degrees: decision?.side ?? [] });
  }
}

/** One record on the page: who drives, the reason, the field, and the four cards. */
import { Acts } from "./acts.js";
import { Around } from "./around.js";
import { html, say } from "./dom.js";
import { Field } from "./field.js";
import { Controller } from "./inference.js";
import { Judges } from "./judges.js";
import { Rules } from "./rules.js";
import { Senses } from "./senses.js";

export class RunView {
  constructor(run, seek) {
    this.run = run;
    const { controller, planner } = run.data;
    this.field = new Field(run, seek);
    this.mode = html("span", { class: "mode" });
    this.sentence = html("span", { class: "sentence" });
    const rules = controller ? new Controller(controller) : null;
    this.senses = run.lined ? new Senses(run) : null;
    this.around = run.lined ? null : new Around(run, seek);
    this.acts = new Acts(run, rules ? 4 : 2);
    this.judges = rules && new Judges(rules);
    this.rules = rules && new Rules(run, rules);
    const cards = [this.senses, this.around, this.judges, this.rules, this.acts].filter(Boolean);
    this.element = html(
      "article",
      { class: "run" },
      html("h2", {}, html("b", {}, planner), html("span", {}, `${run.data.name}, ${conditions(run.data)}`)),
      html("p", { class: "story", "aria-live": "off" }, this.mode, this.sentence),
      this.field.element,
      html("div", { class: "cards" }, ...cards.map((card) => card.element)),
    );
  }

  /** Show the run at a time (s); while it plays, each decision long enough to be read. */
  show(time, playing) {
    const { run } = this;
    const moment = run.at(time);
    const decision = run.decision(playing ? run.heldAt(time) : run.decisionAt(time));
    if (this.decision === undefined || decision?.index !== this.decision?.index) {
      this.senses?.show(decision);
      this.judges?.show(decision);
      this.rules?.show(decision);
    }
    this.moment = moment;
    this.decision = decision;
    this.field.show(moment, decision);
    this.around?.show(moment, decision);
    this.acts.show(moment, decision);
    const mode = decision?.mode ?? "routine";
    this.mode.className = `mode ${moment.over ? run.data.outcome : mode}`;
    const { title, figures } = run.data.end;
    say(this.mode, moment.over ? "end" : mode === "routine" ? run.data.routine : mode);
    const ended = `${title} (${figures.replace(/ {3}/g, ", ")})`;
    const sentence = moment.over ? ended : decision?.sentence ?? run.data.waiting;
    say(this.sentence, sentence.replaceAll(" m", "\u00a0m"));
  }
}

/** Return the seed of a run, and the drive if it is not that of wheels. */
export function conditions({ seed, drive }) {
  return `seed ${seed}${drive === "kinematic" ? ", kinematic drive" : ""}`;
}

/** The last card: what the robot is asked for, what it does, and the weights in force. */
import { arcPath, arrowPath } from "./arrows.js";
import { fixed, html, say, set, svg, turning, weight } from "./dom.js";

const CENTRE = [90, 84];
const RADIUS = 66;
const MEANINGS = {
  "speed asked": "what the planner asks for; the robot brakes for what is not known to be free",
  "step asked": "how far the robot is to jump",
  "known free": "how far the way ahead was found free when it decided",
  "stops within": "the distance within which the robot could stop",
  w1: "weight in force of the step",
  w2: "weight in force of the turn",
  c_f: "with less than this free towards the goal, the robot breaks out",
};

/** A dial: up is the aim, the needle where the robot heads. */
export class Dial {
  constructor() {
    this.arc = svg("path", { class: "turn" });
    this.needle = svg("path", { class: "needle" });
    const [x, y] = CENTRE;
    const face = `M${x - RADIUS} ${y}A${RADIUS} ${RADIUS} 0 0 1 ${x + RADIUS} ${y}`;
    this.element = svg(
      "svg",
      { viewBox: "0 0 180 108", class: "dial", "aria-hidden": "true" },
      svg("path", { class: "face", d: face }),
      svg("path", { class: "aim", d: `M${x} ${y - RADIUS - 8}V${y - RADIUS + 8}` }),
      this.arc,
      this.needle,
      svg("circle", { class: "robot", cx: x, cy: y, r: 9 }),
    );
  }

  /** Show a turn (rad, left is positive) and a step as a part of the longest. */
  show(turn, part) {
    set(this.arc, { d: arcPath(...CENTRE, RADIUS, turn), class: `turn ${turn > 0 ? "left" : "right"}` });
    const length = 24 + 34 * Math.min(Math.max(part, 0), 1);
    const [x, y] = [CENTRE[0] - (Math.sin(turn) * length) / 2, CENTRE[1] - (Math.cos(turn) * length) / 2];
    set(this.needle, { d: arrowPath(x, y, turn, length, 7) });
  }
}

export class Acts {
  constructor(run, number) {
    this.run = run;
    this.longest = Math.max(...run.decisions.step.filter(Number.isFinite), 1e-6);
    this.dial = new Dial();
    this.turn = html("b");
    this.aim = html("span");
    this.facts = {};
    // What each decision asks for, in the film's words; their names may differ, too.
    const [first, , second] = run.decisions.asks[0];
    this.asks = [first, second].map((text) => {
      const [name, value] = [html("dt", {}, text), html("dd", {}, "–")];
      return { name, value, row: html("div", {}, name, value) };
    });
    const { weights, breakout_at: limits } = run.decisions;
    const weighted = weights.some(([w1]) => w1 !== null);
    const fact = (name, text, told = true) => {
      if (!told) return null;
      this.facts[name] = html("dd");
      return html("div", { title: MEANINGS[name] ?? null }, html("dt", {}, text), this.facts[name]);
    };
    this.element = html(
      "section",
      { class: "card acts" },
      html("h3", {}, `${number} · Acts`),
      html("div", { class: "needle-box" }, this.dial.element, html("p", {}, this.turn, this.aim)),
      html(
        "dl",
        {},
        ...this.asks.map(({ row }) => row),
        fact("speed", run.jumps ? "last step" : "speed"),
        fact("clearance", run.jumps ? "nearest in step" : "nearest"),
        fact("w1", "ω1 · step", weighted),
        fact("w2", "ω2 · turn", weighted),
        fact("c_f", "c_f", limits.some(Number.isFinite)),
      ),
    );
  }

  /** Return how far the robot last jumped, in words. */
  lastStep({ tick }) {
    const { x, y } = this.run.ticks;
    const before = Math.max(tick - 1, 0);
    return `${fixed(Math.hypot(x[tick] - x[before], y[tick] - y[before]))} m`;
  }

  show(moment, decision) {
    say(this.facts.speed, this.run.jumps ? this.lastStep(moment) : `${fixed(Math.abs(moment.speed))} m/s`);
    say(this.facts.clearance, moment.clearance === null ? "far away" : `${fixed(Math.max(moment.clearance, 0))} m`);
    this.dial.element.classList.toggle("blank", !decision);
    if (!decision) return;
    this.dial.show(decision.off_aim, decision.step / this.longest);
    say(this.turn, turning(decision.off_aim));
    say(this.aim, ` ${Math.abs(decision.off_aim) < 0.0087 ? "to" : "of"} ${decision.aims_at}`);
    this.asks.forEach(({ name, value, row }, k) => {
      const [named, told] = decision.asks.slice(2 * k);
      say(name, named);
      say(value, told);
      set(row, { title: MEANINGS[named] ?? "" });
    });
    const { w1, w2, c_f: limit } = this.facts;
    if (w1) say(w1, weight(decision.weights[0]));
    if (w2) say(w2, weight(decision.weights[1]));
    if (limit) say(limit, `${weight(decision.breakout_at)} S_p`);
  }
}

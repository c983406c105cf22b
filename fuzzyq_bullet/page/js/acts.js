/** The last card: what the robot is asked for, what it does, and the weights in force. */
import { arcPath, arrowPath } from "./arrows.js";
import { fixed, html, say, set, svg, turning, weight } from "./dom.js";

const CENTRE = [90, 84];
const RADIUS = 66;
const MEANINGS = {
  step: "what the planner asks for; the robot brakes for what is not known to be free",
  reach: "how far the way is known to be free",
  w1: "weight in force of the step",
  w2: "weight in force of the turn",
  c_f: "with less than this free towards the goal, the robot breaks out",
};

/** Return a turn rate (rad/s, left is positive) in words. */
function turnRate(rate) {
  const degrees = Math.round((Math.abs(rate) * 180) / Math.PI);
  return degrees < 1 ? "straight on" : `${degrees}°/s ${rate > 0 ? "left" : "right"}`;
}

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
        fact("step", "step asked", !run.twists),
        fact("reach", "known free", !run.twists),
        fact("fast", "speed asked", run.twists),
        fact("rate", "turn asked", run.twists),
        fact("speed", "speed"),
        fact("clearance", "nearest"),
        fact("w1", "ω1 · step", weighted),
        fact("w2", "ω2 · turn", weighted),
        fact("c_f", "c_f", limits.some(Number.isFinite)),
      ),
    );
  }

  show(moment, decision) {
    say(this.facts.speed, `${fixed(Math.abs(moment.speed))} m/s`);
    say(this.facts.clearance, moment.clearance === null ? "far away" : `${fixed(Math.max(moment.clearance, 0))} m`);
    this.dial.element.classList.toggle("blank", !decision);
    if (!decision) return;
    this.dial.show(decision.off_aim, decision.step / this.longest);
    say(this.turn, turning(decision.off_aim));
    say(this.aim, ` ${Math.abs(decision.off_aim) < 0.0087 ? "to" : "of"} ${decision.aims_at}`);
    const { step, reach, fast, rate } = this.facts;
    const there = (number, words) => (number === null ? "–" : words(number));
    if (step) say(step, `${fixed(decision.step)} m`);
    if (reach) say(reach, decision.reach === null ? "not checked" : `${fixed(decision.reach)} m`);
    if (fast) say(fast, there(decision.twist_speed, (speed) => `${fixed(speed)} m/s`));
    if (rate) say(rate, there(decision.twist_turn_rate, turnRate));
    const { w1, w2, c_f: limit } = this.facts;
    if (w1) say(w1, weight(decision.weights[0]));
    if (w2) say(w2, weight(decision.weights[1]));
    if (limit) say(limit, `${weight(decision.breakout_at)} S_p`);
  }
}

/** Card 1: what the robot senses: the free distances left, ahead and right, seen towards the aim. */
import { fixed, html, say, set, svg } from "./dom.js";

const WIDTH = 250;
const HEIGHT = 150;
const ROBOT = [WIDTH / 2, HEIGHT - 18];
const RIM = 15; // of the robot's disc
const LONGEST = 104; // of a line's picture
const NAMES = ["left", "middle", "right"];

export class Senses {
  constructor(run) {
    this.run = run;
    this.lines = NAMES.map((name) => svg("line", { class: `sensed ${name}` }));
    this.rest = NAMES.map(() => svg("line", { class: "unsensed" }));
    this.numbers = NAMES.map((name) => svg("text", { class: `length ${name}` }));
    this.nose = svg("path", { class: "nose", d: "M9 0L-5 6L-5 -6Z" });
    this.facts = html("p", { class: "facts" });
    // The lines are those of the disc that it plans with; another body lies within that disc.
    const { footprint, radius } = run.data.robot;
    const disc = svg("circle", { class: footprint ? "disc" : "robot", cx: ROBOT[0], cy: ROBOT[1], r: RIM });
    const corners = (footprint ?? []).map(([x, y]) => `${(x * RIM) / radius},${(-y * RIM) / radius}`);
    this.body = svg("polygon", { class: "robot", points: corners.join(" ") });
    this.picture = svg(
      "svg",
      { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "fan", role: "img", "aria-label": "Free distances" },
      ...this.rest,
      ...this.lines,
      disc,
      this.body,
      this.nose,
      ...this.numbers,
    );
    this.element = html("section", { class: "card senses" }, html("h3", {}, "1 · Senses"), this.picture, this.facts);
  }

  show(decision) {
    this.picture.classList.toggle("blank", !decision?.lined);
    if (!decision?.lined) {
      say(this.facts, "This planner casts no detection lines.");
      return;
    }
    const range = this.run.data.robot.range;
    NAMES.forEach((_, k) => {
      const angle = Math.PI / 2 + decision.lines[k] - decision.lines[1]; // the middle line points up
      const way = [Math.cos(angle), -Math.sin(angle)];
      const part = Math.min(decision.lengths[k] / range, 1);
      const at = (length) => [ROBOT[0] + way[0] * length, ROBOT[1] + way[1] * length];
      const [inner, tip, end] = [at(RIM), at(RIM + part * (LONGEST - RIM)), at(LONGEST)];
      set(this.lines[k], { x1: inner[0], y1: inner[1], x2: tip[0], y2: tip[1] });
      set(this.rest[k], { x1: inner[0], y1: inner[1], x2: end[0], y2: end[1] });
      const beyond = at(LONGEST + 18);
      set(this.numbers[k], { x: beyond[0], y: beyond[1] + 5 });
      say(this.numbers[k], `${fixed(decision.lengths[k])} m`);
    });
    const turned = decision.lines[1] - decision.facing;
    const degrees = (turned * 180) / Math.PI - 90;
    for (const part of [this.body, this.nose]) {
      set(part, { transform: `translate(${ROBOT[0]} ${ROBOT[1]}) rotate(${degrees.toFixed(1)})` });
    }
    const told = decision.distance !== null;
    say(this.facts, !told ? "" : `d = ${fixed(decision.distance)}, Df = ${fixed(decision.difference)} (in robot radii)`);
  }
}

/** The fuzzy controller: the same inference as the Python one, on the same data. */
import { Variable } from "./sets.js";

const NO_AREA = 1e-300; // below this a centroid would be noise

/** Turn and step from the distance ahead (d) and the difference of the sides (Df). */
export class Controller {
  constructor(data) {
    this.distance = new Variable("distance", data.inputs.distance);
    this.difference = new Variable("difference", data.inputs.difference);
    this.turn = new Variable("turn", data.outputs.turn);
    this.step = new Variable("step", data.outputs.step);
    this.outputs = [this.turn, this.step];
    this.inference = data.inference;
    this.and = data.inference.and === "minimum" ? Math.min : (a, b) => a * b;
    /** cells[row][column]: for each output the index of the set that the rule names. */
    this.cells = this.distance.sets.map((row) =>
      data.rules[row.label].map((cell) => {
        const labels = cell.trim().split(/\s+/);
        return this.outputs.map((output, k) => output.index(labels[k]));
      }),
    );
    this.prepare();
  }

  /** Sample the output sets: to be called again when one of them was changed. */
  prepare() {
    const n = this.inference.samples;
    this.points = this.outputs.map(({ low, high }) =>
      Array.from({ length: n }, (_, i) => low + ((high - low) * i) / (n - 1)),
    );
    this.sampled = this.outputs.map((output, k) =>
      output.sets.map((set) => Float64Array.from(this.points[k], (u) => set.membership(u))),
    );
  }

  /**
   * Infer once.
   *
   * Returns near and side (memberships of d and Df), rules (firing strengths, a row for each set
   * of d), turn and step, and aggregates: for each output the maximum of all conclusions over
   * `points`.
   */
  infer(distance, difference) {
    const near = this.distance.memberships(this.distance.clip(distance));
    const side = this.difference.memberships(this.difference.clip(difference));
    const rules = near.map((a) => side.map((b) => this.and(a, b)));
    const average = this.inference.defuzzification === "average";
    const fallback = [0, this.step.low];
    const strengths = this.outputs.map((output, k) => this.concluded(rules, k, output));
    const aggregates = strengths.map((given, k) => this.aggregate(given, k));
    const [turn, step] = this.outputs.map((output, k) =>
      average
        ? this.average(rules, k, output, fallback[k])
        : centroid(this.points[k], aggregates[k], fallback[k]),
    );
    return { near, side, rules, turn, step, strengths, aggregates };
  }

  /** For each set of an output: how strongly the strongest rule that names it fires. */
  concluded(rules, k, output) {
    const strongest = output.sets.map(() => 0);
    rules.forEach((row, i) =>
      row.forEach((strength, j) => {
        const set = this.cells[i][j][k];
        if (strength > strongest[set]) strongest[set] = strength;
      }),
    );
    return strongest;
  }

  aggregate(strengths, k) {
    const sum = new Float64Array(this.points[k].length);
    strengths.forEach((strength, set) => {
      if (strength === 0) return;
      const sampled = this.sampled[k][set];
      for (let i = 0; i < sum.length; i++) {
        const concluded = this.and(strength, sampled[i]);
        if (concluded > sum[i]) sum[i] = concluded;
      }
    });
    return sum;
  }

  average(rules, k, output, fallback) {
    let moment = 0;
    let total = 0;
    rules.forEach((row, i) =>
      row.forEach((strength, j) => {
        moment += strength * output.sets[this.cells[i][j][k]].centre;
        total += strength;
      }),
    );
    return total > NO_AREA ? moment / total : fallback;
  }

  /** Return turn and step on a grid: rows of d, columns of Df, `size` of each. */
  surface(size) {
    const turn = new Float64Array(size * size);
    const step = new Float64Array(size * size);
    const at = (variable, i) => variable.low + ((variable.high - variable.low) * i) / (size - 1);
    for (let i = 0; i < size; i++) {
      for (let j = 0; j < size; j++) {
        const found = this.infer(at(this.distance, i), at(this.difference, j));
        turn[i * size + j] = found.turn;
        step[i * size + j] = found.step;
      }
    }
    return { turn, step };
  }
}

function centroid(points, weights, fallback) {
  let moment = 0;
  let area = 0;
  for (let i = 0; i < points.length; i++) {
    moment += points[i] * weights[i];
    area += weights[i];
  }
  return area > NO_AREA ? moment / area : fallback;
}

/** Membership functions: every shape of a fuzzy set in one place, with the handles that change it. */

const HALF = Math.exp(-0.5); // membership of a Gaussian one width from its centre

/** Rise from 0 at `foot` to 1 at `top`; a vertical side where the two are one. */
function slope(x, foot, top) {
  if (foot === top) return 1;
  return (x - foot) / (top - foot);
}

function ramps(x, left, first, last, right) {
  if (x < left || x > right) return 0;
  return Math.max(0, Math.min(1, slope(x, left, first), slope(x, right, last)));
}

const shifted = (numbers, by) => numbers.map((number) => number + by);

/**
 * For each shape: `membership(numbers, x)`; `centre(numbers)`, which stands for the set in an
 * average; and `handles(numbers)`, each with a name, where it lies (x, y) and `move(x)`, which
 * returns new numbers. The first handle moves the whole set.
 */
export const SHAPES = {
  gaussian: {
    membership: ([centre, width], x) => Math.exp(-((x - centre) ** 2) / (2 * width * width)),
    centre: ([centre]) => centre,
    handles: ([centre, width], least) => [
      { name: "place", x: centre, y: 1, move: (x) => [x, width] },
      ...[1, -1].map((side) => ({
        name: "width",
        x: centre + side * width,
        y: HALF,
        move: (x) => [centre, Math.max(least, side * (x - centre))],
      })),
    ],
  },
  triangular: {
    membership: ([left, peak, right], x) => ramps(x, left, peak, peak, right),
    centre: ([, peak]) => peak,
    handles: ([left, peak, right]) => [
      { name: "place", x: peak, y: 1, move: (x) => shifted([left, peak, right], x - peak) },
      { name: "left foot", x: left, y: 0, move: (x) => [Math.min(x, peak), peak, right] },
      { name: "right foot", x: right, y: 0, move: (x) => [left, peak, Math.max(x, peak)] },
    ],
  },
  trapezoidal: {
    membership: ([left, first, last, right], x) => ramps(x, left, first, last, right),
    centre: ([, first, last]) => (first + last) / 2,
    handles: ([left, first, last, right]) => {
      const centre = (first + last) / 2;
      const all = [left, first, last, right];
      return [
        { name: "place", x: centre, y: 1, move: (x) => shifted(all, x - centre) },
        { name: "left foot", x: left, y: 0, move: (x) => [Math.min(x, first), first, last, right] },
        {
          name: "left shoulder",
          x: first,
          y: 1,
          move: (x) => [left, Math.min(Math.max(x, left), last), last, right],
        },
        {
          name: "right shoulder",
          x: last,
          y: 1,
          move: (x) => [left, first, Math.max(Math.min(x, right), first), right],
        },
        { name: "right foot", x: right, y: 0, move: (x) => [left, first, last, Math.max(x, last)] },
      ];
    },
  },
  bell: {
    membership: ([centre, half, steep], x) => 1 / (1 + Math.abs((x - centre) / half) ** (2 * steep)),
    centre: ([centre]) => centre,
    handles: ([centre, half, steep], least) => [
      { name: "place", x: centre, y: 1, move: (x) => [x, half, steep] },
      ...[1, -1].map((side) => ({
        name: "width",
        x: centre + side * half,
        y: 0.5,
        move: (x) => [centre, Math.max(least, side * (x - centre)), steep],
      })),
    ],
  },
  singleton: {
    membership: ([at], x) => (x === at ? 1 : 0),
    centre: ([at]) => at,
    handles: ([at]) => [{ name: "place", x: at, y: 1, move: (x) => [x] }],
  },
};

/** One set of a variable, as the controller's data give it. */
export class FuzzySet {
  constructor(label, data) {
    this.label = label;
    this.words = data.meaning || data.words || label; // what it means to a robot, if that is told
    this.shape = Object.keys(SHAPES).find((name) => name in data);
    this.numbers = [].concat(data[this.shape]);
  }

  membership(x) {
    return SHAPES[this.shape].membership(this.numbers, x);
  }

  get centre() {
    return SHAPES[this.shape].centre(this.numbers);
  }

  /** Return its handles; no set becomes narrower than `least`. */
  handles(least) {
    return SHAPES[this.shape].handles(this.numbers, least);
  }
}

/** A linguistic variable: a range and the sets that cover it. */
export class Variable {
  constructor(name, data) {
    this.name = name;
    [this.low, this.high] = data.range;
    this.sets = Object.entries(data.sets).map(([label, set]) => new FuzzySet(label, set));
  }

  clip(x) {
    return Math.min(Math.max(x, this.low), this.high);
  }

  memberships(x) {
    return this.sets.map((set) => set.membership(x));
  }

  index(label) {
    return this.sets.findIndex((set) => set.label === label);
  }
}

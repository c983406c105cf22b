/** A plot of one variable: its sets, where a value lies in them, and handles that change them. */
import { html, say, set, svg, fixed, whenSized } from "./dom.js";

export const MARGIN = 12; // pixels to the left and right: half the thumb of a slider below
const TOP = 12;
const BELOW = 20; // for the labels
const POINTS = 240;
const COUNTS = 0.05; // a smaller membership is not worth a word

export class Plot {
  /**
   * @param variable What to draw.
   * @param options `title`; `mirrored`, to have greater values further left; `changed()`, called
   *   after a handle was moved: without it there are no handles.
   */
  constructor(variable, { title, mirrored = false, changed = null }) {
    this.variable = variable;
    this.mirrored = mirrored;
    this.changed = changed;
    this.chosen = null;
    this.name = html("span", { class: "name" }, title);
    this.words = html("b", { class: "words" });
    this.svg = svg("svg", { "aria-hidden": changed ? null : "true" });
    this.box = html("div", { class: changed ? "plot-box large" : "plot-box" }, this.svg);
    this.element = html(
      "figure",
      { class: "plot" },
      html("figcaption", {}, this.name, this.words),
      this.box,
    );
    this.places = []; // from where to where each label reaches
    this.parts = { areas: [], curves: [], labels: [], dots: [] };
    this.build();
    whenSized(this.box, (width, height) => {
      [this.width, this.height] = [width, height];
      set(this.svg, { viewBox: `0 0 ${width} ${height}` });
      this.redraw();
    });
  }

  build() {
    const { parts } = this;
    this.aggregate = svg("path", { class: "aggregate" });
    this.cursor = svg("line", { class: "cursor" });
    this.axis = svg("line", { class: "axis" });
    for (const one of this.variable.sets) {
      parts.areas.push(svg("path", { class: "area" }));
      parts.curves.push(svg("path", { class: "curve" }));
      parts.dots.push(svg("circle", { class: "dot", r: 4.5 }));
      parts.labels.push(svg("text", { class: "label" }, one.label));
    }
    this.handles = svg("g");
    const { areas, curves, labels, dots } = parts;
    const before = [...areas, this.aggregate, this.axis, ...curves, ...labels];
    this.svg.append(...before, this.cursor, ...dots, this.handles);
    if (this.changed) {
      this.svg.addEventListener("pointerdown", (event) => this.choose(event));
    }
  }

  x(value) {
    const { low, high } = this.variable;
    const part = (value - low) / (high - low);
    return MARGIN + (this.mirrored ? 1 - part : part) * (this.width - 2 * MARGIN);
  }

  y(membership) {
    return TOP + (1 - membership) * (this.height - TOP - BELOW);
  }

  value(x) {
    const { low, high } = this.variable;
    const part = (x - MARGIN) / (this.width - 2 * MARGIN);
    return low + (this.mirrored ? 1 - part : part) * (high - low);
  }

  /** Draw the curves anew: after a change of size or of the sets. */
  redraw() {
    if (!this.width) return;
    const { low, high, sets } = this.variable;
    set(this.axis, { x1: MARGIN, x2: this.width - MARGIN, y1: this.y(0), y2: this.y(0) });
    const xs = Array.from({ length: POINTS + 1 }, (_, i) => low + ((high - low) * i) / POINTS);
    sets.forEach((one, k) => {
      const curve =
        one.shape === "singleton"
          ? `M${this.x(one.centre)} ${this.y(0)}V${this.y(1)}`
          : this.path(xs, (x) => one.membership(x));
      set(this.parts.curves[k], { d: curve });
      if (one.shape !== "singleton") {
        set(this.parts.areas[k], { d: `${curve}V${this.y(0)}H${this.x(low)}Z` });
      }
      const half = 0.55 * this.parts.labels[k].getComputedTextLength(); // bold ones are wider
      const least = Math.max(MARGIN + 8, half);
      const at = Math.min(Math.max(this.x(one.centre), least), this.width - least);
      set(this.parts.labels[k], { x: at, y: this.height - 4 });
      this.places[k] = [at - half, at + half];
    });
    if (this.changed) this.drawHandles();
    if (this.shown) this.show(this.shown);
  }

  path(xs, membership) {
    return xs
      .map((x, i) => `${i ? "L" : "M"}${this.x(x).toFixed(1)} ${this.y(membership(x)).toFixed(1)}`)
      .join("");
  }

  /**
   * Mark a value.
   *
   * `value` is where the cursor stands, null for none; `degrees` how strongly each set is lit;
   * `aggregate`, for an output, the conclusions `{points, heights}`; `words` what to write beside
   * the title, by default the sets that the value belongs to.
   */
  show(given) {
    this.shown = given;
    const { value, degrees, aggregate = null, words = null } = given;
    const { sets } = this.variable;
    const strongest = degrees.indexOf(Math.max(...degrees));
    say(this.words, words ?? this.described(degrees));
    if (!this.width) return;
    sets.forEach((one, k) => {
      const degree = value === null ? 0 : degrees[k] ?? 0;
      const stick = one.shape === "singleton"; // no area: it is as high as its rules fire
      if (stick) set(this.parts.areas[k], { d: `M${this.x(one.centre)} ${this.y(0)}V${this.y(degree)}` });
      this.parts.areas[k].classList.toggle("stick", stick);
      this.parts.areas[k].style.opacity = stick ? 1 : aggregate ? 0 : 0.7 * degree;
      this.parts.curves[k].style.opacity = 0.45 + 0.55 * degree;
      this.parts.labels[k].classList.toggle("strongest", k === strongest && degree > COUNTS);
      const dotted = aggregate === null && value !== null && degree > COUNTS;
      this.parts.dots[k].style.display = dotted ? "" : "none";
      if (dotted) set(this.parts.dots[k], { cx: this.x(this.variable.clip(value)), cy: this.y(degree) });
    });
    this.thin(strongest);
    this.cursor.style.display = value === null ? "none" : "";
    if (value !== null) {
      const x = this.x(this.variable.clip(value));
      set(this.cursor, { x1: x, x2: x, y1: TOP - 6, y2: this.y(0) });
    }
    if (aggregate) {
      const { points, heights } = aggregate;
      const top = Array.from(points, (u, i) => `L${this.x(u).toFixed(1)} ${this.y(heights[i]).toFixed(1)}`);
      const [first, last] = [this.x(points[0]), this.x(points[points.length - 1])];
      set(this.aggregate, { d: `M${first} ${this.y(0)}${top.join("")}L${last} ${this.y(0)}Z` });
    }
  }

  /** Hide the labels that others would overlap: the strongest stays, then the first. */
  thin(strongest) {
    const kept = [];
    for (const k of [strongest, ...this.places.keys()]) {
      const [left, right] = this.places[k];
      const free = kept.every(([from, to]) => right < from || to < left);
      if (k !== strongest || !kept.length) {
        this.parts.labels[k].style.visibility = free ? "" : "hidden";
      }
      if (free) kept.push(this.places[k]);
    }
  }

  /** Return the set that a value belongs to most, in words, and the next one by its label. */
  described(degrees) {
    return this.variable.sets
      .map((one, k) => [degrees[k] ?? 0, one])
      .filter(([degree]) => degree >= COUNTS)
      .sort((a, b) => b[0] - a[0])
      .slice(0, this.changed ? 2 : 1)
      .map(([degree, { words, label }], k) => `${k ? label : words} ${fixed(degree)}`)
      .join(", ");
  }

  /** Choose the set that is highest where somebody pressed: its other handles appear. */
  choose(event) {
    if (event.target.closest(".handle")) return;
    const box = this.svg.getBoundingClientRect();
    const degrees = this.variable.memberships(this.value(event.clientX - box.left));
    this.chosen = degrees.indexOf(Math.max(...degrees));
    this.drawHandles();
  }

  /** Draw a handle on every set that moves it, and those that reshape the chosen one. */
  drawHandles() {
    const { low, high, sets } = this.variable;
    const least = (high - low) / 200;
    const found = [];
    sets.forEach((one, k) => {
      one.handles(least).forEach((handle, number) => {
        const inside = handle.x >= low && handle.x <= high;
        if (number === 0 || (k === this.chosen && inside)) found.push([one, k, handle, number]);
      });
    });
    const focused = this.handles.contains(document.activeElement)
      ? document.activeElement.dataset.handle
      : null;
    this.handles.replaceChildren(
      ...found.map(([one, k, handle, number]) => this.handle(one, k, handle, number)),
    );
    if (focused && !this.dragged) {
      this.handles.querySelector(`[data-handle="${focused}"]`)?.focus();
    }
  }

  handle(one, k, handle, number) {
    const { low, high } = this.variable;
    const at = Math.min(Math.max(handle.x, low), high);
    const [x, y] = [this.x(at), this.y(handle.y)];
    const element = svg(
      "g",
      {
        class: `handle${number ? " reshapes" : ""}${k === this.chosen ? " chosen" : ""}`,
        "data-handle": `${one.label} ${number}`,
        tabindex: 0,
        role: "slider",
        "aria-label": `${one.words}: ${handle.name}`,
        "aria-valuemin": low,
        "aria-valuemax": high,
        "aria-valuenow": handle.x.toFixed(3),
        transform: `translate(${x.toFixed(1)} ${y.toFixed(1)})`,
      },
      svg("circle", { class: "hit", r: 18 }),
      number ? svg("rect", { x: -5, y: -5, width: 10, height: 10 }) : svg("circle", { r: 6.5 }),
    );
    element.addEventListener("pointerdown", (event) => this.grab(event, one, k, number));
    element.addEventListener("keydown", (event) => {
      const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!way) return;
      event.preventDefault();
      event.stopPropagation();
      const by = ((high - low) / (event.shiftKey ? 20 : 100)) * way * (this.mirrored ? -1 : 1);
      this.chosen = k;
      this.moved(one, number, handle.x + by);
    });
    return element;
  }

  /** Let a handle follow the pointer until it is let go. */
  grab(event, one, k, number) {
    event.preventDefault();
    this.chosen = k;
    this.dragged = true;
    const least = (this.variable.high - this.variable.low) / 200;
    const left = this.svg.getBoundingClientRect().left;
    // One that lies beyond the edge is drawn on it: it moves by as much as the pointer.
    const offset = one.handles(least)[number].x - this.value(event.clientX - left);
    const move = (later) => {
      this.moved(one, number, this.value(later.clientX - left) + offset);
    };
    const release = () => {
      this.dragged = false;
      window.removeEventListener("pointermove", move);
      window.removeEventListener("pointerup", release);
      window.removeEventListener("pointercancel", release);
    };
    window.addEventListener("pointermove", move);
    window.addEventListener("pointerup", release);
    window.addEventListener("pointercancel", release);
    this.drawHandles();
  }

  moved(one, number, x) {
    const { low, high } = this.variable;
    const reach = high - low;
    const bounded = Math.min(Math.max(x, low - reach / 4), high + reach / 4);
    one.numbers = one.handles(reach / 200)[number].move(bounded);
    this.redraw();
    this.changed();
  }
}

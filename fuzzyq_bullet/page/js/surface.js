/** The control surface: one output over all d and Df, laid out like the rule table. */
import { channels, colours, whenRecoloured } from "./colours.js";
import { html, sharp, whenSized } from "./dom.js";

export const SIZE = 45; // points along each side of the grid
const STEPS = 8; // lines of equal height

/** One output's surface; near is at the top, "left freer" on the left. */
export class Surface {
  /**
   * @param controller Whose surface.
   * @param options `title`; `output` ("turn" or "step"); `picked(d, df)`, called when a place is
   *   pressed.
   */
  constructor(controller, { title, output, picked }) {
    this.controller = controller;
    this.output = output;
    this.canvas = html("canvas", { role: "img", "aria-label": `${title} for every d and Df` });
    this.box = html("div", { class: "surface-box" }, this.canvas);
    this.element = html(
      "figure",
      { class: "surface" },
      html("figcaption", {}, title),
      html("span", { class: "axis-y" }, html("span", {}, "near"), html("span", {}, "far")),
      this.box,
      html("span", { class: "axis-x" }, html("span", {}, "left freer"), html("span", {}, "right freer")),
    );
    const pick = (event) => {
      const box = this.canvas.getBoundingClientRect();
      const { distance, difference } = controller;
      const down = (event.clientY - box.top) / box.height;
      const across = (event.clientX - box.left) / box.width;
      picked(
        distance.clip(distance.low + down * (distance.high - distance.low)),
        difference.clip(difference.high - across * (difference.high - difference.low)),
      );
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      pick(event);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) pick(event);
    });
    whenSized(this.box, (width, height) => {
      [this.width, this.height] = [width, height];
      this.draw();
    });
    whenRecoloured(() => {
      this.heights && this.fill(this.heights);
    });
  }

  /** Take new heights, as `Controller.surface` returns them. */
  fill(heights) {
    this.heights = heights;
    const variable = this.controller[this.output];
    const image = new ImageData(SIZE, SIZE);
    const colour = colours();
    const middle = channels(colour.card);
    const [low, high] =
      this.output === "turn" ? [channels(colour.right), channels(colour.left)] : [middle, channels(colour.heat)];
    const most = Math.max(Math.abs(variable.low), Math.abs(variable.high));
    for (let i = 0; i < SIZE; i++) {
      for (let j = 0; j < SIZE; j++) {
        const value = heights[i * SIZE + j];
        const part =
          this.output === "turn" ? value / most : (value - variable.low) / (variable.high - variable.low);
        const end = part < 0 ? low : high;
        const at = 4 * (i * SIZE + (SIZE - 1 - j));
        for (let c = 0; c < 3; c++) {
          image.data[at + c] = middle[c] + (end[c] - middle[c]) * Math.min(Math.abs(part), 1);
        }
        image.data[at + 3] = 255;
      }
    }
    this.image = html("canvas", { width: SIZE, height: SIZE });
    this.image.getContext("2d").putImageData(image, 0, 0);
    this.draw();
  }

  /** Mark where d and Df lie. */
  mark(d, df) {
    this.marked = [d, df];
    this.draw();
  }

  draw() {
    if (!this.width || !this.image) return;
    const pen = sharp(this.canvas, this.width, this.height);
    const [across, down] = [this.width / (SIZE - 1), this.height / (SIZE - 1)];
    // The middles of the outermost pixels lie on the edges.
    pen.drawImage(this.image, -across / 2, -down / 2, this.width + across, this.height + down);
    this.drawContours(pen, across, down);
    if (!this.marked) return;
    const { distance, difference } = this.controller;
    const y = ((distance.clip(this.marked[0]) - distance.low) / (distance.high - distance.low)) * this.height;
    const x =
      ((difference.high - difference.clip(this.marked[1])) / (difference.high - difference.low)) * this.width;
    pen.lineWidth = 1;
    pen.strokeStyle = colours().ink;
    pen.globalAlpha = 0.5;
    pen.beginPath();
    pen.moveTo(x, 0);
    pen.lineTo(x, this.height);
    pen.moveTo(0, y);
    pen.lineTo(this.width, y);
    pen.stroke();
    pen.globalAlpha = 1;
    const inside = (at, size) => Math.min(Math.max(at, 9), size - 9);
    pen.beginPath();
    pen.arc(inside(x, this.width), inside(y, this.height), 7, 0, 2 * Math.PI);
    pen.fillStyle = colours().robot;
    pen.fill();
    pen.lineWidth = 2.5;
    pen.strokeStyle = colours().page;
    pen.stroke();
  }

  /** Draw lines of equal height (marching squares), which also tell in grey what is steep. */
  drawContours(pen, across, down) {
    const { low, high } = this.controller[this.output];
    pen.strokeStyle = colours().ink;
    pen.globalAlpha = 0.35;
    pen.lineWidth = 1;
    pen.beginPath();
    for (let step = 1; step < STEPS; step++) {
      const level = low + ((high - low) * step) / STEPS + 1e-6;
      for (let i = 0; i < SIZE - 1; i++) {
        for (let j = 0; j < SIZE - 1; j++) this.drawSquare(pen, i, j, level, across, down);
      }
    }
    pen.stroke();
    pen.globalAlpha = 1;
  }

  drawSquare(pen, i, j, level, across, down) {
    const height = (a, b) => this.heights[a * SIZE + b];
    const edges = [[i, j, i, j + 1], [i, j + 1, i + 1, j + 1], [i + 1, j + 1, i + 1, j], [i + 1, j, i, j]];
    const points = [];
    for (const [a, b, c, d] of edges) {
      const [from, to] = [height(a, b), height(c, d)];
      if (from < level === to < level) continue;
      const part = (level - from) / (to - from);
      points.push([(SIZE - 1 - (b + (d - b) * part)) * across, (a + (c - a) * part) * down]);
    }
    for (let k = 0; k + 1 < points.length; k += 2) {
      pen.moveTo(...points[k]);
      pen.lineTo(...points[k + 1]);
    }
  }
}

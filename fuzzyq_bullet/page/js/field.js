/** The field from above: what stands there, the path, the detection lines, and the robot. */
import { drawMovers, solid } from "./movers.js";
import { colours, whenRecoloured } from "./colours.js";
import { html, sharp, whenSized } from "./dom.js";

const PADDING = 14; // pixels about the field
const CLICK = 40; // pixels: a click no farther from the path goes there
const CLOSE_UP = 4; // metres to be seen across, when the view follows the robot
const WIDTHS = { routine: 2.5, following: 4.5, breakout: 6 }; // of the path, by mode

export class Field {
  /** Draw a run; `seek(time)` is called when a place on its path is clicked. */
  constructor(run, seek) {
    this.run = run;
    this.modes = run.modesOfTicks();
    this.follows = false;
    this.canvas = html("canvas", {
      role: "img",
      "aria-label": `The field of ${run.data.name} from above, with the robot's path`,
    });
    const [x0, y0, x1, y1] = run.data.field.extent;
    this.element = html("div", { class: "field" }, this.canvas);
    this.element.style.setProperty("--ratio", ((x1 - x0) / (y1 - y0)).toFixed(3));
    this.canvas.addEventListener("click", (event) => this.clicked(event, seek));
    this.canvas.addEventListener("pointermove", (event) => {
      this.canvas.style.cursor = this.tickNear(event) === null ? "" : "pointer";
    });
    whenSized(this.element, (width, height) => {
      this.size = [width, height];
      this.still = null;
      this.again();
    });
    whenRecoloured(() => {
      this.still = null;
      this.again();
    });
  }

  /** Let the view follow the robot closely, or show the whole field. */
  follow(on) {
    this.follows = on;
    this.still = null;
    this.again();
  }

  again() {
    if (this.shown) this.show(...this.shown);
  }

  /** Draw an instant and the decision that explains it (or null). */
  show(moment, decision) {
    this.shown = [moment, decision];
    if (!this.size) return;
    const [width, height] = this.size;
    this.place(moment);
    if (this.still === null || this.follows) this.still = this.drawStill(width, height);
    const pen = sharp(this.canvas, width, height);
    pen.drawImage(this.still, 0, 0, width, height);
    drawMovers(pen, this, moment);
    this.drawPassed(pen, moment);
    this.drawPath(pen, moment);
    if (decision && !(moment.over && this.run.data.outcome === "goal")) this.drawSensed(pen, decision);
    this.drawRobot(pen, moment);
    if (this.run.data.contact && moment.over) this.drawCross(pen, this.at(...this.run.data.contact));
  }

  /** Choose the scale and what lies in the middle. */
  place(moment) {
    const [width, height] = this.size;
    const [x0, y0, x1, y1] = this.run.data.field.extent;
    const whole = Math.min((width - 2 * PADDING) / (x1 - x0), (height - 2 * PADDING) / (y1 - y0));
    const close = Math.max(whole, Math.min(width, height) / CLOSE_UP);
    this.scale = this.follows ? close : whole;
    this.marks = Math.min(Math.max(Math.min(width, height) / 450, 0.55), 1.4); // their size
    this.middle = this.follows ? [moment.x, moment.y] : [(x0 + x1) / 2, (y0 + y1) / 2];
  }

  at(x, y) {
    const [width, height] = this.size;
    return [
      width / 2 + (x - this.middle[0]) * this.scale,
      height / 2 - (y - this.middle[1]) * this.scale,
    ];
  }

  /** Draw what never moves, once for a size and theme. */
  drawStill(width, height) {
    const canvas = html("canvas");
    const pen = sharp(canvas, width, height);
    const colour = colours();
    const { bounds, walls, obstacles, start, goal } = this.run.data.field;
    const [left, bottom] = this.at(bounds[0], bounds[1]);
    const [right, top] = this.at(bounds[2], bounds[3]);
    pen.fillStyle = colour.ground;
    if (walls) pen.fillRect(left, top, right - left, bottom - top);
    else pen.fillRect(0, 0, width, height);
    this.drawGrid(pen, [left, top, right, bottom], walls);
    pen.fillStyle = pen.strokeStyle = colour.obstacle;
    pen.lineJoin = pen.lineCap = "round";
    for (const { corners, radius } of obstacles) {
      solid(pen, corners.map(([x, y]) => this.at(x, y)), radius * this.scale);
    }
    if (walls) {
      pen.strokeStyle = colour.wall;
      pen.lineWidth = 4;
      pen.lineJoin = "miter";
      pen.strokeRect(left, top, right - left, bottom - top);
    }
    pen.strokeStyle = colour.goal;
    pen.lineWidth = 3;
    this.run.data.field.via.forEach(({ position, radius }, i) => {
      this.drawVia(pen, this.at(...position), Math.max(radius * this.scale, 8 * this.marks), i + 1);
    });
    const there = this.at(...goal.position);
    const goalRadius = Math.max(goal.radius * this.scale, 8 * this.marks);
    disc(pen, there, goalRadius);
    pen.stroke();
    pen.globalAlpha = 0.35;
    pen.fillStyle = colour.goal;
    pen.fill();
    pen.globalAlpha = 1;
    if (goal.heading !== null) this.drawPointer(pen, there, -goal.heading, 2.5 * goalRadius);
    // Each label on the side away from the other, and from the arrow.
    const upwards = goal.heading === null ? goal.position[1] >= start[1] : Math.sin(goal.heading) < 0;
    this.label(pen, "goal", there, Math.max(goalRadius, 14 * this.marks), upwards);
    pen.strokeStyle = colour.muted;
    pen.lineWidth = 2;
    const here = this.at(...start);
    const reach = Math.max(this.run.data.robot.radius * this.scale, 6 * this.marks);
    this.outlineRobot(pen, here, this.run.ticks.heading[0], reach);
    pen.stroke();
    this.label(pen, "start", here, reach, !upwards);
    return canvas;
  }

  /** Draw a via point: a ring, with its number beside it, as the reticle may stand in it. */
  drawVia(pen, [x, y], radius, number) {
    disc(pen, [x, y], radius);
    pen.stroke();
    const [width, height] = this.size;
    const beside = 0.71 * (radius + 9 * this.marks);
    pen.fillStyle = colours().goal;
    pen.font = `700 ${Math.round(13 * this.marks + 2)}px system-ui, sans-serif`;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillText(number, x + (x > width / 2 ? -beside : beside), y + (y > height / 2 ? -beside : beside));
    pen.textBaseline = "alphabetic";
  }

  /** Draw an arrow that shows where the robot shall face; the angle is clockwise. */
  drawPointer(pen, at, angle, length) {
    pen.save();
    pen.translate(...at);
    pen.rotate(angle);
    pen.fillStyle = colours().goal;
    pen.fillRect(0, -0.05 * length, 0.65 * length, 0.1 * length);
    triangle(pen, [0.8 * length, 0], 0, 0.2 * length);
    pen.restore();
  }

  /** Write what a place is, above or below it. */
  label(pen, text, [x, y], radius, above) {
    if (this.marks < 0.6) return; // too small for words
    pen.fillStyle = colours().muted;
    pen.font = `600 ${Math.round(12.5 * this.marks + 2)}px system-ui, sans-serif`;
    pen.textAlign = "center";
    pen.fillText(text, x, above ? y - radius - 6 : y + radius + 8 + 11 * this.marks);
  }

  drawGrid(pen, [left, top, right, bottom], walls) {
    const [width, height] = this.size;
    const span = Math.max(width, height) / this.scale;
    const metres = [0.5, 1, 2, 5, 10, 20, 50, 100].find((step) => span / step <= 16) || 200;
    pen.save();
    pen.beginPath();
    if (walls) pen.rect(left, top, right - left, bottom - top);
    else pen.rect(0, 0, width, height);
    pen.clip();
    pen.strokeStyle = colours().grid;
    pen.lineWidth = 1;
    pen.beginPath();
    const [x, y] = this.at(0, 0);
    const step = metres * this.scale;
    for (let across = x % step; across < width; across += step) {
      pen.moveTo(Math.round(across) + 0.5, 0);
      pen.lineTo(Math.round(across) + 0.5, height);
    }
    for (let down = y % step; down < height; down += step) {
      pen.moveTo(0, Math.round(down) + 0.5);
      pen.lineTo(width, Math.round(down) + 0.5);
    }
    pen.stroke();
    pen.restore();
  }

  /** Draw the path: what is to come faint, what was driven in the colour and width of its mode. */
  drawPath(pen, moment) {
    const { x, y } = this.run.ticks;
    const colour = colours();
    pen.lineJoin = pen.lineCap = "round";
    pen.strokeStyle = colour.faint;
    pen.lineWidth = 1.5;
    pen.setLineDash([2, 5]);
    pen.beginPath();
    for (let i = moment.tick; i < x.length; i++) pen.lineTo(...this.at(x[i], y[i]));
    pen.stroke();
    pen.setLineDash([]);
    let i = 0;
    while (i < moment.tick) {
      const mode = this.modes[i];
      pen.beginPath();
      pen.moveTo(...this.at(x[i], y[i]));
      do {
        i++;
        pen.lineTo(...this.at(x[i], y[i]));
      } while (i < moment.tick && this.modes[i] === mode);
      if (i === moment.tick) pen.lineTo(...this.at(moment.x, moment.y));
      pen.strokeStyle = mode === "routine" ? colour.ink : colour.target;
      pen.globalAlpha = mode === "following" ? 0.65 : 1;
      pen.lineWidth = WIDTHS[mode] * this.marks;
      pen.stroke();
      pen.globalAlpha = 1;
    }
  }

  /** Draw the corridors of the detection lines, the aim, the frontier and the heading decided. */
  drawSensed(pen, decision) {
    const colour = colours();
    const origin = this.at(decision.x, decision.y);
    const radius = this.run.data.robot.radius * this.scale;
    if (decision.lined) {
      if (this.run.data.robot.footprint) this.drawDisc(pen, origin, radius);
      ["left", "middle", "right"].forEach((name, k) => {
        const angle = -decision.lines[k];
        const length = decision.lengths[k] * this.scale;
        pen.save();
        pen.translate(...origin);
        pen.rotate(angle);
        pen.beginPath();
        pen.moveTo(0, -radius);
        pen.lineTo(length, -radius);
        pen.arc(length, 0, radius, -Math.PI / 2, Math.PI / 2);
        pen.lineTo(0, radius);
        pen.fillStyle = pen.strokeStyle = colour[name];
        pen.globalAlpha = 0.22;
        pen.fill();
        pen.globalAlpha = 1;
        pen.lineWidth = 2;
        pen.stroke();
        pen.restore();
      });
    } else if (this.follows) {
      this.drawDisc(pen, origin, radius + this.run.data.robot.range * this.scale); // what it sees
    }
    const reach = Math.max(radius * 2.6, 26 * this.marks);
    const tip = [
      origin[0] + reach * Math.cos(decision.heading),
      origin[1] - reach * Math.sin(decision.heading),
    ];
    pen.strokeStyle = pen.fillStyle = colour.ink;
    pen.lineWidth = 3.5 * this.marks;
    pen.beginPath();
    pen.moveTo(...origin);
    pen.lineTo(...tip);
    pen.stroke();
    triangle(pen, tip, -decision.heading, 8 * this.marks);
    if (decision.target.every(Number.isFinite)) this.drawDiamond(pen, this.at(...decision.target));
    if (decision.aim.every(Number.isFinite)) this.drawReticle(pen, this.at(...decision.aim));
  }

  /** Draw the disc that a robot with another body plans with: its lines are as wide. */
  drawDisc(pen, at, radius) {
    pen.strokeStyle = colours().muted;
    pen.lineWidth = 1.5;
    pen.setLineDash([4, 4]);
    disc(pen, at, radius);
    pen.stroke();
    pen.setLineDash([]);
  }

  /** Fill the rings of the via points that were passed by now. */
  drawPassed(pen, moment) {
    pen.fillStyle = colours().goal;
    pen.globalAlpha = 0.35;
    for (const { position, radius, passed } of this.run.data.field.via) {
      if (passed === null || moment.time < passed) continue;
      disc(pen, this.at(...position), Math.max(radius * this.scale, 8 * this.marks));
      pen.fill();
    }
    pen.globalAlpha = 1;
  }

  drawReticle(pen, [x, y]) {
    const strokes = [[1, 0], [-1, 0], [0, 1], [0, -1]];
    const [inner, outer] = [5 * this.marks, 13 * this.marks];
    for (const [colour, width] of [[colours().page, 6], [colours().middle, 3]]) {
      pen.strokeStyle = colour;
      pen.lineWidth = width * this.marks;
      pen.beginPath();
      for (const [dx, dy] of strokes) {
        pen.moveTo(x + dx * inner, y + dy * inner);
        pen.lineTo(x + dx * outer, y + dy * outer);
      }
      pen.stroke();
    }
  }

  drawDiamond(pen, [x, y]) {
    const size = 10 * this.marks;
    pen.beginPath();
    pen.moveTo(x, y - size);
    pen.lineTo(x + size, y);
    pen.lineTo(x, y + size);
    pen.lineTo(x - size, y);
    pen.closePath();
    pen.fillStyle = pen.strokeStyle = colours().target;
    pen.globalAlpha = 0.3;
    pen.fill();
    pen.globalAlpha = 1;
    pen.lineWidth = 2.5;
    pen.stroke();
  }

  drawCross(pen, [x, y]) {
    for (const [colour, width] of [[colours().page, 9], [colours().danger, 5]]) {
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      pen.beginPath();
      pen.moveTo(x - 10, y - 10);
      pen.lineTo(x + 10, y + 10);
      pen.moveTo(x - 10, y + 10);
      pen.lineTo(x + 10, y - 10);
      pen.stroke();
    }
  }

  /** Begin a path along the robot's rim, turned to its heading. */
  outlineRobot(pen, [left, top], heading, radius) {
    const { footprint, radius: own } = this.run.data.robot;
    if (!footprint) {
      disc(pen, [left, top], radius);
      return;
    }
    const scale = radius / own;
    const [cos, sin] = [Math.cos(heading), Math.sin(heading)];
    pen.beginPath();
    for (const [x, y] of footprint) {
      pen.lineTo(left + scale * (x * cos - y * sin), top - scale * (x * sin + y * cos));
    }
    pen.closePath();
  }

  drawRobot(pen, moment) {
    const colour = colours();
    const radius = Math.max(this.run.data.robot.radius * this.scale, 8 * this.marks);
    const there = this.at(moment.x, moment.y);
    this.outlineRobot(pen, there, moment.heading, radius);
    pen.fillStyle = colour.robot;
    pen.fill();
    pen.strokeStyle = colour.page;
    pen.lineWidth = 1.5;
    pen.stroke();
    pen.fillStyle = colour.page;
    const ahead = [
      there[0] + 0.28 * radius * Math.cos(moment.heading),
      there[1] - 0.28 * radius * Math.sin(moment.heading),
    ];
    triangle(pen, ahead, -moment.heading, radius * 0.55);
  }

  /** Return the tick whose place is nearest to a click; null if the path is not near. */
  tickNear(event) {
    const box = this.canvas.getBoundingClientRect();
    const [px, py] = [event.clientX - box.left, event.clientY - box.top];
    let nearest = null;
    let least = CLICK;
    this.run.ticks.x.forEach((x, i) => {
      const [qx, qy] = this.at(x, this.run.ticks.y[i]);
      const away = Math.hypot(px - qx, py - qy);
      if (away < least) [least, nearest] = [away, i];
    });
    return nearest;
  }

  clicked(event, seek) {
    const tick = this.tickNear(event);
    if (tick !== null) seek(this.run.ticks.time[tick]);
  }
}

function disc(pen, [x, y], radius) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
}

function triangle(pen, [x, y], angle, size) {
  pen.save();
  pen.translate(x, y);
  pen.rotate(angle);
  pen.beginPath();
  pen.moveTo(size, 0);
  pen.lineTo(-size * 0.7, size * 0.75);
  pen.lineTo(-size * 0.7, -size * 0.75);
  pen.closePath();
  pen.fill();
  pen.restore();
}

/** Obstacles: a polygon grown by a radius, standing or on its way. */

import { colours } from "./colours.js";

/** Fill the polygon of some pixels, grown by a radius (pixels); one point is a disc. */
export function solid(pen, corners, radius) {
  pen.beginPath();
  corners.forEach(([x, y], i) => pen[i ? "lineTo" : "moveTo"](x, y));
  if (corners.length === 1) {
    pen.arc(...corners[0], radius, 0, 2 * Math.PI);
  } else if (radius > 0) {
    pen.closePath();
    pen.lineWidth = 2 * radius;
    pen.stroke();
  }
  pen.fill();
}

/** Draw what moves where it is at an instant, with an arrow where it goes. */
export function drawMovers(pen, field, moment) {
  const colour = colours();
  pen.lineJoin = pen.lineCap = "round";
  for (const mover of field.run.data.movers ?? []) {
    const there = poseOf(mover, moment);
    const [cos, sin] = [Math.cos(there.turn), Math.sin(there.turn)];
    const corners = mover.corners.map(([x, y]) =>
      field.at(there.x + x * cos - y * sin, there.y + x * sin + y * cos));
    pen.fillStyle = pen.strokeStyle = colour.mover;
    solid(pen, corners, mover.radius * field.scale);
    const heading = mover.heading[moment.tick];
    if (heading === null) continue;
    pen.fillStyle = colour.page;
    pen.beginPath();
    const size = mover.size * field.scale;
    const [x, y] = field.at(there.x, there.y);
    for (const [ahead, aside] of [[0.62, 0], [-0.48, 0.5], [-0.24, 0], [-0.48, -0.5]]) {
      const [c, s] = [Math.cos(heading) * size, Math.sin(heading) * size];
      pen.lineTo(x + ahead * c - aside * s, y - (ahead * s + aside * c));
    }
    pen.closePath();
    pen.fill();
  }
}

/** Return where a moving obstacle is at an instant, between two ticks. */
export function poseOf(mover, { tick: i, part }) {
  const j = Math.min(i + 1, mover.x.length - 1);
  const between = (values) => values[i] + (values[j] - values[i]) * part;
  return { x: between(mover.x), y: between(mover.y), turn: between(mover.turn) };
}

/** Arrows: up is straight on, left is left. */

/** Return the path of an arrow about (x, y) that points `angle` (rad) to the left of up. */
export function arrowPath(x, y, angle, length, head = 5) {
  const [ux, uy] = [-Math.sin(angle), -Math.cos(angle)];
  const [tx, ty] = [x + (ux * length) / 2, y + (uy * length) / 2];
  const [sx, sy] = [x - (ux * length) / 2, y - (uy * length) / 2];
  const [bx, by] = [tx - ux * head * 1.4, ty - uy * head * 1.4];
  const point = (px, py) => `${px.toFixed(1)} ${py.toFixed(1)}`;
  return (
    `M${point(sx, sy)}L${point(bx, by)}` +
    `M${point(tx, ty)}L${point(bx - uy * head, by + ux * head)}` +
    `L${point(bx + uy * head, by - ux * head)}Z`
  );
}

/** Return the path of a part of a circle from straight up to `angle` (rad, left is positive). */
export function arcPath(x, y, radius, angle) {
  const bounded = Math.min(Math.max(angle, -3.1), 3.1);
  const end = [x - radius * Math.sin(bounded), y - radius * Math.cos(bounded)];
  const sweep = bounded > 0 ? 0 : 1;
  return `M${x} ${y - radius}A${radius} ${radius} 0 0 ${sweep} ${end[0].toFixed(1)} ${end[1].toFixed(1)}`;
}

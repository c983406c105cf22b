/** Elements of the page, and numbers as text. */

const SVG = "http://www.w3.org/2000/svg";

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value !== null && value !== false) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

/** Return an HTML element; attributes that begin with "on" are listeners. */
export function html(name, attributes = {}, ...children) {
  return fill(document.createElement(name), attributes, children);
}

/** Return an SVG element. */
export function svg(name, attributes = {}, ...children) {
  return fill(document.createElementNS(SVG, name), attributes, children);
}

/** Change attributes, but only those that differ: a page that plays does this all the time. */
export function set(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    const text = String(value);
    if (element.getAttribute(name) !== text) element.setAttribute(name, text);
  }
}

/** Change the text of an element, if it is another. */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Return a number with so many decimals and a real minus sign; a dash for what is not known. */
export function fixed(number, digits = 2) {
  if (number === null || number === undefined || !Number.isFinite(number)) return "–";
  const text = number.toFixed(digits);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−");
}

/** Return a weight in few signs. */
export function weight(number) {
  if (number === null || !Number.isFinite(number)) return "–";
  return String(Number(number.toFixed(number >= 10 ? 1 : 2)));
}

/** Return a turn (rad, left is positive) in words: "22° to the left". */
export function turning(angle) {
  const degrees = Math.round((Math.abs(angle) * 180) / Math.PI);
  return degrees < 1 ? "straight on" : `${degrees}° to the ${angle > 0 ? "left" : "right"}`;
}

/** Call `draw(width, height)` now and whenever the size of an element (CSS pixels) changes. */
export function whenSized(element, draw) {
  new ResizeObserver(([entry]) => {
    const { width, height } = entry.contentRect;
    if (width > 0 && height > 0) draw(width, height);
  }).observe(element);
}

/** Empty a canvas, its pixels as fine as the screen's; return its context, in CSS pixels. */
export function sharp(canvas, width, height) {
  const ratio = window.devicePixelRatio || 1;
  const [across, down] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== across) canvas.width = across;
  if (canvas.height !== down) canvas.height = down;
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}

/** The clock of the page: play, pause, speed, and the band on which a time is chosen. */
import { html, say, set, svg, fixed } from "./dom.js";

export const SPEEDS = [0.25, 0.5, 1, 2, 4, 8];
const LANE = 22; // height of a run's band (units)
const HEIGHTS = { routine: 6, following: 12, breakout: 20 };
const LONGEST_FRAME = 0.1; // seconds: after a longer pause of the browser the run does not jump

const ICONS = {
  play: "M7 4L20 12L7 20Z",
  pause: "M6 4H10V20H6ZM14 4H18V20H14Z",
  back: "M18 5L9 12L18 19ZM5 5H8V19H5Z",
  forward: "M6 5L15 12L6 19ZM16 5H19V19H16Z",
};

export function icon(name) {
  return svg("svg", { viewBox: "0 0 24 24", class: "icon", "aria-hidden": "true" }, svg("path", { d: ICONS[name] }));
}

export class Player {
  /**
   * @param runs What plays, in step, each from its own start.
   * @param show Called with the time since the start (s), and whether it plays.
   */
  constructor(runs, show) {
    this.runs = runs;
    this.show = show;
    this.end = Math.max(...runs.map((run) => run.end - run.start));
    this.events = runs
      .flatMap((run) => run.data.events.map((event) => ({ ...event, time: event.time - run.start })))
      .sort((a, b) => a.time - b.time);
    this.time = 0;
    this.speed = 1;
    this.playing = false;
    this.build();
  }

  build() {
    this.button = html("button", { class: "play", type: "button", onclick: () => this.toggle() });
    this.clock = html("output", { class: "clock" });
    this.select = html(
      "select",
      { "aria-label": "Speed", onchange: () => this.setSpeed(Number(this.select.value)) },
      ...SPEEDS.map((speed) => html("option", { value: speed, selected: speed === 1 ? "" : null }, `${speed}×`)),
    );
    const button = (name, label, act) =>
      html("button", { type: "button", "aria-label": label, title: label, onclick: act }, icon(name));
    this.band = this.buildBand();
    this.element = html(
      "div",
      { class: "player" },
      html(
        "div",
        { class: "controls" },
        button("back", "Event before (p)", () => this.jump(-1)),
        this.button,
        button("forward", "Next event (n)", () => this.jump(1)),
        this.clock,
        this.select,
      ),
      this.band,
    );
  }

  /** Return the band: a lane for each run, high where it breaks out, with marks at events. */
  buildBand() {
    const lanes = this.runs.map((run, number) => {
      const bottom = (number + 1) * LANE;
      const part = (time) => (100 * (time - run.start)) / this.end;
      const stretches = run.modes().map(([mode, begin, end]) =>
        svg("rect", {
          class: `stretch ${mode}`,
          x: part(begin),
          width: Math.max(part(end) - part(begin), 0.15),
          y: bottom - 1 - HEIGHTS[mode],
          height: HEIGHTS[mode],
        }),
      );
      return svg("g", {}, ...stretches);
    });
    const height = this.runs.length * LANE;
    const picture = svg("svg", { viewBox: `0 0 100 ${height}`, preserveAspectRatio: "none" }, ...lanes);
    const marks = this.runs.flatMap((run, number) =>
      run.data.events.map((event) => this.mark(event, (event.time - run.start) / this.end, number)),
    );
    this.needle = html("span", { class: "needle" });
    const band = html(
      "div",
      {
        class: "band",
        tabindex: 0,
        role: "slider",
        "aria-label": "Time",
        "aria-valuemin": 0,
        "aria-valuemax": fixed(this.end, 2),
      },
      picture,
      ...marks,
      this.needle,
    );
    band.style.setProperty("--lanes", this.runs.length);
    const seek = (event) => {
      const box = band.getBoundingClientRect();
      this.seek(((event.clientX - box.left) / box.width) * this.end);
    };
    band.addEventListener("pointerdown", (event) => {
      band.setPointerCapture(event.pointerId);
      seek(event);
    });
    band.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) seek(event);
    });
    return band;
  }

  mark(event, part, lane) {
    const mark = html("span", { class: `mark ${event.kind}`, title: `${fixed(event.time, 1)} s: ${event.words}` });
    mark.style.left = `${100 * part}%`;
    mark.style.top = `${((lane + 0.5) / this.runs.length) * 100}%`;
    return mark;
  }

  toggle() {
    if (!this.playing && this.time >= this.end) this.time = 0;
    this.playing = !this.playing;
    this.refresh();
    if (this.playing) {
      this.before = null;
      requestAnimationFrame((now) => this.frame(now));
    }
  }

  pause() {
    this.playing = false;
  }

  frame(now) {
    if (!this.playing) return;
    const passed = this.before === null ? 0 : (now - this.before) / 1000;
    this.before = now;
    this.time = Math.min(this.time + Math.min(passed, LONGEST_FRAME) * this.speed, this.end);
    if (this.time >= this.end) this.playing = false;
    this.refresh();
    requestAnimationFrame((later) => this.frame(later));
  }

  /** Go to a time (s since the start). */
  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.end);
    this.refresh();
  }

  /** Go to the next decision, or the one before. */
  step(way) {
    this.pause();
    const times = this.runs.flatMap((run) => [
      ...run.decisions.time.map((time) => time - run.start),
      run.end - run.start,
    ]);
    const further = times.filter((time) => way * (time - this.time) > 1e-6);
    if (further.length) this.seek(further.reduce((a, b) => (way * (a - b) < 0 ? a : b)));
    else this.refresh();
  }

  /** Go to the next event, or the one before; to the start where there is none. */
  jump(way) {
    const times = [0, ...this.events.map((event) => event.time)];
    const further = times.filter((time) => way * (time - this.time) > 1e-3);
    if (further.length) this.seek(way > 0 ? Math.min(...further) : Math.max(...further));
  }

  setSpeed(speed) {
    this.speed = speed;
    this.select.value = String(speed);
  }

  /** Choose the next speed, or the one before. */
  faster(way) {
    const next = SPEEDS[SPEEDS.indexOf(this.speed) + way];
    if (next) this.setSpeed(next);
  }

  refresh() {
    const label = this.playing ? "Pause (space)" : "Play (space)";
    if (this.button.title !== label) {
      set(this.button, { title: label, "aria-label": label });
      this.button.replaceChildren(icon(this.playing ? "pause" : "play"));
    }
    say(this.clock, `${fixed(this.time, 1)} / ${fixed(this.end, 1)} s`);
    this.needle.style.left = `${(100 * this.time) / this.end}%`;
    set(this.band, { "aria-valuenow": fixed(this.time, 2), "aria-valuetext": `${fixed(this.time, 1)} seconds` });
    this.show(this.time, this.playing);
  }
}

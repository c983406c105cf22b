/** A run, asked by time: where the robot is, and which decision holds. */

/** Return the index of the last entry that is not greater than `value`; −1 if all are. */
export function lastNotAfter(sorted, value) {
  let low = 0;
  let high = sorted.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

const MODES = ["routine", "breakout", "following"];

/** One record. */
export class Run {
  constructor(data) {
    this.data = data;
    this.ticks = data.ticks;
    this.decisions = data.decisions;
    this.start = this.ticks.time[0];
    this.end = this.ticks.time[this.ticks.time.length - 1];
    this.heldTimes = data.held.map(([time]) => time);
    this.unit = data.robot.radius; // S_p (m)
    const { lines } = data.decisions;
    this.lined = lines.some(known); // whether its planner casts detection lines
    this.jumps = data.drive === "kinematic"; // whether it is nowhere between two ticks
  }

  /** Return the robot at a time (s): pose, speed, room, tick, and whether the run is over. */
  at(time) {
    const { time: times, x, y, heading, speed, clearance } = this.ticks;
    const now = Math.min(Math.max(time, this.start), this.end);
    const i = Math.max(lastNotAfter(times, now), 0);
    const j = Math.min(i + 1, times.length - 1);
    const part = j > i && !this.jumps ? (now - times[i]) / (times[j] - times[i]) : 0;
    const between = (values) => values[i] + (values[j] - values[i]) * part;
    return {
      time: now,
      tick: i,
      part, // of the way to the next tick
      x: between(x),
      y: between(y),
      heading: between(heading),
      speed: between(speed),
      clearance: clearance[i] === null || clearance[j] === null ? null : between(clearance),
      over: now >= this.end,
    };
  }

  /** Return the index of the decision in force at a time, −1 before the first. */
  decisionAt(time) {
    return lastNotAfter(this.decisions.time, time + 1e-9);
  }

  /** Return the decision to explain while the run plays: each holds long enough to be read. */
  heldAt(time) {
    if (time >= this.end) return this.decisions.time.length - 1;
    const number = lastNotAfter(this.heldTimes, time + 1e-9);
    return number < 0 ? this.decisionAt(time) : this.data.held[number][1];
  }

  /** Return everything about one decision, null before the first. */
  decision(index) {
    if (index < 0) return null;
    const found = { index };
    for (const [name, values] of Object.entries(this.decisions)) found[name] = values[index];
    found.mode = MODES[found.mode];
    found.sentence = this.data.sentences[found.sentence];
    const tick = Math.max(lastNotAfter(this.ticks.time, found.time + 1e-9), 0);
    found.x = this.ticks.x[tick];
    found.y = this.ticks.y[tick];
    found.facing = this.ticks.heading[tick];
    found.lined = known(found.lines) && known(found.lengths);
    return found;
  }

  /** Return stretches of one mode: [mode, begin, end] in seconds. */
  modes() {
    const { time, mode } = this.decisions;
    const found = [];
    for (let k = 0; k < time.length; k++) {
      const last = found[found.length - 1];
      if (last && last[0] === MODES[mode[k]]) continue;
      if (last) last[2] = time[k];
      found.push([MODES[mode[k]], k ? time[k] : this.start, this.end]);
    }
    return found;
  }

  /** Return the mode in force at every tick. */
  modesOfTicks() {
    const of = this.decisions.mode;
    return this.ticks.time.map((time) => {
      const index = this.decisionAt(time);
      return index < 0 ? "routine" : MODES[of[index]];
    });
  }
}

/** Whether all numbers of a list are there. */
export function known(numbers) {
  return numbers.every((number) => number !== null);
}

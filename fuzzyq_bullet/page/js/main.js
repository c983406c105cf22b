/** The page begins here: its data, what they are shown with, and the buttons above. */
import { toggleDark } from "./colours.js";
import { html } from "./dom.js";
import { Controller } from "./inference.js";
import { helpDialog, listen } from "./keys.js";
import { legend } from "./legend.js";
import { Player } from "./player.js";
import { conditions, RunView } from "./run_view.js";
import { Run } from "./timeline.js";
import { WhatIf } from "./what_if.js";

function start() {
  const data = JSON.parse(document.getElementById("data").textContent);
  const runs = data.runs.map((run) => new Run(run));
  const followed = runs.findIndex((run) => run.data.controller !== null);
  const controller = followed < 0 ? data.controller : runs[followed].data.controller;
  // A second run can be followed too, if it was driven with the same controller.
  const same = (run) => JSON.stringify(run.data.controller) === JSON.stringify(controller);
  const pupils = controller ? runs.filter(same) : [];
  const main = document.querySelector("main");

  let player = null;
  const views = runs.map((run) => new RunView(run, (time) => player.seek(time - run.start)));
  const whatIf = controller ? new WhatIf(controller, standard(data, runs[followed]), pupils.map(nameOf)) : null;
  if (runs.length === 1) {
    const [{ data: run }] = runs;
    document.querySelector("h1").append(html("span", {}, `planner ${run.planner}, ${conditions(run)}`));
  }
  if (runs.length) {
    player = new Player(runs, (time, playing) => {
      for (const view of views) view.show(view.run.start + time, playing);
      whatIf?.take(views.filter(({ run }) => pupils.includes(run)).map(({ decision }) => decision));
    });
    const side = html("div", { class: "runs" }, ...views.map(({ element }) => element));
    main.append(side, legend(runs));
    document.body.append(html("footer", {}, player.element));
  }
  if (whatIf) main.append(whatIf.element);
  document.body.classList.add(runs.length ? `records-${runs.length}` : "lesson");

  const help = helpDialog();
  document.body.append(help);
  let close = false;
  const acts = {
    dark: toggleDark,
    help: () => (help.open ? help.close() : help.showModal()),
    closeUp: () => {
      close = !close;
      for (const { field } of views) field.follow(close);
    },
  };
  const button = (text, label, act) => html("button", { type: "button", title: label, "aria-label": label, onclick: act }, text);
  document.querySelector("body > header nav").append(
    ...(runs.length ? [button("Close-up", "Close-up of the robot, or the whole field (z)", acts.closeUp)] : []),
    button("Light / dark", "Light or dark (d)", acts.dark),
    button("Keys", "Keys (?)", acts.help),
  );
  listen(player, acts);
  player?.refresh();
  // For tests and for the browser's console.
  window.fuzzyq = { player, views, whatIf, Controller };
}

function nameOf(run, number, all) {
  return all.length > 1 ? `${number + 1}: ${run.data.planner}` : "the run";
}

/** Return A_p, S_p and the weights to begin with: those of the run, where there is one. */
function standard(data, run) {
  const { turn_unit: turn, step_unit: step, weights } = data.standard;
  if (!run) return data.standard;
  return { turn_unit: run.data.robot.turn_unit ?? turn, step_unit: run.unit ?? step, weights };
}

start();

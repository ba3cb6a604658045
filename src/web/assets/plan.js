// A plan: the experiments, what they can name, and how that compares with sweeps.

import { announce, h, row, table } from "./dom.js";
import { ask, posted } from "./api.js";
import { effect, number, parameter, seconds, sentence as whole } from "./format.js";
import { frame, load } from "./figure.js";
import { keep } from "./plot-tools.js";

const HERTZ = 1 / (2 * Math.PI);
const n = (text) => ({ text, class: "n" });
const cell = (content) => ({ content, class: "n" });

/// What is shown of a plan that answers a question.
export function planned(plan, asked, units, signal) {
  return [
    h("section", { "aria-labelledby": "plan" },
      h("h2", { id: "plan" }, "The plan"),
      h("p", { class: "lead" }, sentence(plan)),
      downloads(plan, asked, signal)),
    h("section", { "aria-labelledby": "experiments" },
      h("h2", { id: "experiments" }, "Experiments in their order"),
      experiments(plan, units.input)),
    h("section", { "aria-labelledby": "names" },
      h("h2", { id: "names" }, "Effects it can identify, with probability"),
      h("p", {}, "The percentages are approximate: use them to compare plans, not as a promise."),
      effects(plan, units),
      figure(asked, units, signal)),
    h("section", { "aria-labelledby": "sweeps" },
      h("h2", { id: "sweeps" }, "Compared with sweeps of the same duration"),
      sweeps(plan)),
    h("section", { "aria-labelledby": "assumed" },
      h("h2", { id: "assumed" }, "What was assumed"),
      h("ul", {}, plan.notes.map((note) => h("li", {}, whole(note))))),
  ];
}

function sentence({ experiments, duration_s, request, nameable, effects, sweeps }) {
  const best = Math.max(0, ...sweeps.map((sweep) => sweep.nameable));
  const same = best === nameable ? `${best} as well, so at these sizes the plan has no advantage` : `${best}`;
  const swept = sweeps.length > 0 ? `${sweeps.length > 1 ? "The better of two logarithmic sweeps" : "A logarithmic sweep"} of the same duration should identify ${same}` : "No logarithmic sweep fits into that time";
  return `${experiments.length} experiments in ${seconds(duration_s)} of ${seconds(request.budget_s)} should identify ${nameable} of ${effects.length} effects `
    + `of typical size, with a probability of 90 % or more. ${swept}.`;
}

function experiments({ experiments }, unit) {
  const rows = experiments.map((one) => row([
    cell(one.run),
    cell(number(one.magnitude, 3)),
    cell(number(one.omega_rad_s * HERTZ, 4)),
    cell(one.settle_periods),
    cell(one.measured_periods),
    cell(one.repeats),
    cell(number(one.duration_s, 3)),
    one.serves ? effect(one.serves) : "",
  ]));
  const part = scrolled("Experiments", "The order is random, so that warming does not look like an effect of magnitude or frequency.",
    [n("Run"), n(unit ? `Magnitude (${unit})` : "Magnitude"), n("Frequency (Hz)"), n("Settling periods"), n("Periods measured"), n("Repeats"), n("Duration (s)"), "Mainly for"],
    rows);
  part.classList.add("long");
  return part;
}

/// A table that the keyboard can scroll where it is larger than its place.
function scrolled(label, ...parts) {
  const part = table(...parts);
  for (const [key, value] of Object.entries({ tabindex: 0, role: "group", "aria-label": label })) part.setAttribute(key, value);
  return part;
}

function effects({ effects, sweeps }, units) {
  const sweep = sweeps.at(-1);
  const share = (value) => (value == null ? "" : value > 0.99 ? "> 99 %" : `${Math.floor(100 * value)} %`);
  const rows = [...effects].sort((a, b) => b.probability - a.probability).map((one) => row([
    one.title,
    cell(h("strong", {}, share(one.probability))),
    cell(share(sweep?.probabilities[one.effect])),
    one.noticed_from ? size(one, one.noticed_from, units) : "never",
    one.named_from ? size(one, one.named_from, units) : "never",
    one.closest_imitator ? effect(one.closest_imitator) : "",
  ]));
  return scrolled("Effects", "Probability that an effect of typical size is detected (√Δχ² above √30) and told apart from every other one.",
    ["Effect", n("as planned"), n(sweep ? "by a sweep" : ""), "Smallest size noticed", "Smallest size told apart", "Most similar effect"], rows);
}

/// The parameter that sets the size of an effect, in the units of the result that the axis is from.
function size({ effect: id }, { parameters, set_by: [first] }, units) {
  const key = first ?? Object.keys(parameters)[0];
  const { value, unit } = parameters[key];
  const known = unit.replace(/input|response/g, (placeholder) => units[placeholder] || placeholder);
  return `${parameter(`${id}.${key}`)} ${number(value, 3)} ${known}`.trim();
}

function sweeps({ experiments, duration_s, nameable, score, sweeps }) {
  const line = (title, points, duration, named, mean) => row([title, cell(points), cell(seconds(duration)), cell(named), cell(number(100 * mean, 3) + " %")]);
  if (sweeps.length === 0) return h("p", {}, "No logarithmic sweep fits into that time.");
  return scrolled("Sweeps", "The mean is over all effects, at sizes up to the typical one.",
    ["", n("Points"), n("Duration"), n("Identified with 90 % or more"), n("Mean probability")],
    [
      line(h("strong", {}, "This plan"), experiments.length, duration_s, nameable, score),
      ...sweeps.map((sweep) => line(
        sweep.magnitudes.length === 1 ? "Logarithmic sweep at one magnitude" : `Logarithmic sweep at ${sweep.magnitudes.length} magnitudes`,
        sweep.experiments.length, sweep.duration_s, sweep.nameable, sweep.score)),
    ]);
}

function figure(asked, { input = "" }, signal) {
  const { node, figure } = frame("", "The planned experiments, and what they identify beside a sweep");
  const named = input ? `?${new URLSearchParams({ input_unit: input })}` : "";
  load(figure, `/v1/plans/plan.svg${named}`, signal, posted(asked))
    .catch((error) => signal.aborted || node.replaceChildren(h("p", { class: "small" }, error.message)));
  return node;
}

/// What can be taken away. The server is asked when it is wanted.
function downloads(plan, asked, signal) {
  const said = h("span", { class: "small", role: "status" });
  const download = (title, name, path) => {
    const button = h("button", { onclick: async () => {
      button.disabled = true;
      said.textContent = "";
      try {
        keep(await (await ask(path, { ...posted(asked), signal })).blob(), name);
        announce(`${name} is downloaded.`);
      } catch (error) {
        if (!signal.aborted) said.textContent = error.message;
      } finally {
        button.disabled = false;
      }
    } }, title);
    return button;
  };
  const object = new Blob([JSON.stringify(plan, null, 1)], { type: "application/json" });
  return h("p", { class: "actions" },
    download("Stepped sine, CSV", "stepped-sine.csv", "/v1/plans/excitation.csv"),
    download("Multisine, CSV", "multisine.csv", "/v1/plans/excitation.csv?kind=multisine"),
    h("button", { onclick: () => keep(object, "plan.json") }, "Plan, JSON"),
    h("span", { class: "small" }, "The input as samples, for a generator or a drive. With the velocity added as a column ", h("code", {}, "output"), " it is a file to upload."),
    said);
}

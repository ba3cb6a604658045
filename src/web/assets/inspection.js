// What a measurement says before anything is computed of it: its curves, what looks wrong, and
// which effects it can show.

import { h, row, table } from "./dom.js";
import { json } from "./api.js";
import { frame, load } from "./figure.js";
import { number, parameter, percent } from "./format.js";

/// The curves of a measurement.
export function curves(path, signal) {
  const { node, figure } = frame(null, "What was measured, over frequency");
  load(figure, `${path}/measured.svg`, signal).catch(() => node.remove());
  return node;
}

/// What looks wrong with a measurement and what it can show, once it is computed.
export function inspection(path, signal) {
  const found = h("div", { role: "status" },
    h("p", {}, "Checking for faults and for detectable effects …"), h("progress", {}));
  json(`${path}/inspection`, { signal })
    .then((answer) => found.replaceChildren(...sections(answer)))
    .catch((error) => signal.aborted || found.replaceChildren(h("p", {}, error.message)));
  return h("section", { "aria-labelledby": "look" }, h("h2", { id: "look" }, "Before you compute"), found);
}

function sections({ doubts, detectability, obstacle }) {
  return [
    ...doubts.map(({ sentence, remedy }) =>
      h("p", {}, h("strong", {}, "Looks wrong: "), coded(`${sentence}. To do: ${remedy}.`))),
    obstacle && h("p", {}, `No model can be fitted: ${obstacle}.`),
    ...(detectability ? shown(detectability) : []),
  ].filter(Boolean);
}

function shown({ effects }) {
  const seen = effects.filter((effect) => effect.detected_from)
    .sort((a, b) => a.detected_from.change - b.detected_from.change);
  const unseen = effects.filter((effect) => !effect.detected_from);
  const body = seen.map((effect) => row([
    effect.title,
    size(effect, effect.detected_from),
    percent(effect.detected_from.change, 2),
    effect.named_from ? size(effect, effect.named_from) : "never",
    name(effects, effect.closest_imitator),
  ]));
  return [
    h("details", {},
      h("summary", {}, `This measurement can reveal ${seen.length} of ${effects.length} effects`),
      table("", ["Effect", "Smallest size noticed", "changes the response by", "Smallest size told apart", "Most similar effect"], body),
      unseen.length > 0 && [
        h("p", {}, "It cannot reveal:"),
        h("ul", {}, unseen.map((effect) => h("li", {}, `${effect.title}: ${effect.reason}`))),
      ]),
  ];
}

/// A text in which what stands between backquotes is code.
function coded(text) {
  return text.split("`").map((part, place) => place % 2 ? h("code", {}, part) : part);
}

/// The parameter that sets the size of an effect.
function size({ effect: id }, { parameters, set_by: [first] }) {
  const key = first ?? Object.keys(parameters)[0];
  const { value, unit } = parameters[key];
  return `${parameter(`${id}.${key}`)} ${number(value, 3)} ${unit}`.trim();
}

function name(effects, id) {
  return effects.find((effect) => effect.effect === id)?.title ?? "";
}

// Where a job stands, in a word, a colour and a bar.

import { h } from "./dom.js";
import { capital, named, number, percent } from "./format.js";

/// What each verdict means.
export const MEANING = {
  adequate: "no error found in the simulation",
  explained: "causes named, only noise remains",
  improved: "causes named, something remains",
  unexplained: "wrong, no cause found",
};
/// Ratio above which another digit says nothing.
const LARGEST = 1000;

const VERDICTS = { adequate: "good", explained: "good", improved: "part", unexplained: "bad" };

/// A word in its colour.
export function chip(word, kind = { failed: "bad" }[word] ?? "open") {
  return h("span", { class: `chip ${kind}` }, word);
}

/// A verdict in its colour; what it means is its title.
export function ofVerdict(verdict) {
  const node = chip(verdict, VERDICTS[verdict]);
  node.title = MEANING[verdict] ?? "";
  return node;
}

/// The verdict of a result; of one that could not be tested, that.
export function judged({ verdict, tested }) {
  if (verdict !== "adequate" || tested !== false) return ofVerdict(verdict);
  const node = chip("not tested");
  node.title = "too few data to test the simulation";
  return node;
}

/// The same by the name under which batches count it.
export function counted(name) {
  return name === "not_tested" ? judged({ verdict: "adequate", tested: false }) : ofVerdict(name);
}

/// Whether a model fits, in words.
export function adequacy(adequate) {
  return adequate == null ? "adequacy unknown" : adequate ? "adequate" : "not adequate";
}

/// How far a job has come.
export function bar(job) {
  const { progress, status, priority, cancel_requested: stopping } = job;
  const share = status === "queued" ? 0 : progress?.fraction ?? 0;
  const waiting = ["low", "high"].includes(priority) ? `queued, ${priority} priority` : "queued";
  const word = stopping ? "being cancelled" : status === "queued" ? waiting : capital(stage(progress));
  return h("span", { class: "progress" },
    h("progress", { max: 1, value: share, "aria-label": word }),
    h("span", { class: "small" }, status === "queued" ? word : `${word}, ${Math.floor(100 * share)} %`));
}

/// The stage in words.
export function stage(progress) {
  return progress?.stage ?? "starting";
}

/// What came of a job: its verdict and the causes named, or why there is none.
export function outcome({ status, failure, result }) {
  if (status === "failed") return failure?.reason ?? "";
  if (!result) return "";
  const { verdict, causes, ratio, nrmse, adequate } = result;
  if (!verdict) return [adequate == null ? "" : `${adequacy(adequate)}, `, `residual ${percent(nrmse)} of the response`];
  return [judged(result), " ", h("strong", {}, named(causes)), ratio ? h("span", { class: "small" }, ` ${change(ratio)}`) : ""];
}

/// What the causes make of the residual on held-out data, which they divide by a ratio.
export function change(ratio, interval) {
  const [sign, of] = ratio >= 1 ? ["÷", (value) => value] : ["×", (value) => 1 / value];
  const [low, high] = (interval ?? []).map(of).sort((a, b) => a - b);
  const size = of(ratio) > LARGEST ? `more than ${LARGEST}` : number(of(ratio), 3);
  return `residual ${sign} ${size}${interval ? ` (95 % interval ${number(low, 3)} to ${number(high, 3)})` : ""}`;
}

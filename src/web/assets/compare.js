// Two jobs side by side.

import { h, row, table } from "./dom.js";
import { json } from "./api.js";
import { confidence, decimals, effect, filesOf, fixed, kind, named, number, parameter, percent, subject, time } from "./format.js";
import { frame, load } from "./figure.js";
import { adequacy, change, judged } from "./status.js";

const FIGURES = ["bode-errors", "residuals", "spectrum", "friction", "convergence"];
/// Figures of one model that are shown of the model of the table: that with the causes.
const OF_MODEL = ["residuals", "spectrum", "friction"];

export async function show({ query, signal, go }) {
  const [a, b] = await Promise.all(["a", "b"].map((side) => loaded(query.get(side), signal)));
  const { items } = await json("/v1/results.json", { signal }).then(({ rows }) => ({ items: rows }));
  const choose = (side, chosen) => h("label", {}, h("span", {}, side === "a" ? "On the left" : "On the right"),
    h("select", { onchange: ({ target }) => {
      query.set(side, target.value);
      go(`/compare?${query}`);
    } },
    !chosen && h("option", { value: "" }, "choose a job"),
    items.map((item) => h("option", { value: item.job_id, selected: item.job_id === chosen?.job.id },
      `${kind(item)}: ${subject(item)}, ${item.causes ? `${named(item.causes)}, ` : ""}${time(item.at)}`))));
  const both = a && b;
  const node = h("div", { class: "wide" },
    h("p", { class: "trail" }, h("a", { href: "/" }, "Overview")),
    h("h1", {}, "Two jobs side by side"),
    h("div", { class: "halves fields" }, choose("a", a), choose("b", b)),
    !both && h("p", { class: "state" }, items.length < 2 ? "There are not two results yet. Start a job on a measurement first." : "Choose two jobs that have a result."),
    both && [
      a.job.measurement_id !== b.job.measurement_id
        && h("p", {}, "Two different measurements: compare their parameters, not their residuals."),
      h("div", { class: "halves" }, [a, b].map(summary)),
      together(a, b, signal),
      parameters(a, b),
      FIGURES.map((name) => h("section", { "aria-label": name },
        h("div", { class: "halves" }, [a, b].map((side) => plot(side, name, signal))))),
    ]);
  return { title: "Two jobs side by side", node };
}

async function loaded(id, signal) {
  if (!id) return null;
  const job = await json(`/v1/jobs/${encodeURIComponent(id)}`, { signal });
  const [result, measurement] = await Promise.all([
    json(`/v1/jobs/${job.id}/result`, { signal }),
    json(`/v1/measurements/${job.measurement_id}`, { signal }),
  ]);
  const base = result.base ?? result;
  return { job, result, measurement, base, model: result.extended ?? base };
}

function summary({ job, result, measurement, model }) {
  const { verdict, causes = [], gain } = result;
  const said = [
    ["Files", filesOf(measurement)],
    measurement.measured_at ? ["Measured", time(measurement.measured_at)] : ["Uploaded", time(measurement.created_at)],
    ["Verdict", verdict ? judged({ verdict, tested: isTested(result) }) : adequacy(model.fit.adequate)],
    ["Cause", causes.map((cause) => `${effect(cause.effect)} (${confidence(cause.confidence)})`).join(", ")],
    ["Improvement", gain && `${change(gain.ratio, gain.interval95)}, on held-out data`],
    ["Residual", `${percent(model.fit.nrmse)} of the response`],
    ["χ² per degree of freedom", number(model.fit.chi2_per_dof, 3)],
  ];
  return h("section", {},
    h("h2", {}, h("a", { href: `/jobs/${job.id}` }, `${kind(job)} of ${subject(measurement)}`)),
    h("dl", { class: "pairs" }, said.filter(([, value]) => value).map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, value)))));
}

/// Whether any test of the base model could be made.
function isTested({ discrepancy: { tests } }) {
  return tests.length === 0 || tests.some((test) => test.p_value != null);
}

/// The frequency responses of both over each other, if their gains are of one unit.
function together(a, b, signal) {
  const [left, right] = [a, b].map(({ measurement: { input, response, response_kind: kind } }) =>
    `${kind ?? "response"} (${response?.unit || "no unit"}) over input (${input?.unit || "no unit"})`);
  return h("section", { "aria-labelledby": "together" },
    h("h2", { id: "together" }, "Both in one diagram"),
    left === right
      ? plot(a, `bode-against-${b.job.id}`, signal, "Frequency response of both")
      : h("p", {}, `Their gains have different units: ${left} on the left, ${right} on the right.`));
}

/// Parameters of both models in one table; those that differ by more than their
/// joint interval are marked, and those of different units are not compared.
function parameters(a, b) {
  const names = [...new Set([...Object.keys(a.model.parameters), ...Object.keys(b.model.parameters)])];
  const rows = names.map((name) => {
    const [left, right] = [a, b].map((side) => side.model.parameters[name]);
    const isComparable = !left || !right || left.unit === right.unit;
    const least = Math.min(...[left, right].map((estimate) => estimate?.std).filter((std) => std > 0));
    const places = (estimate) => decimals(isComparable ? least : estimate?.std);
    const difference = isComparable && left?.value != null && right?.value != null ? right.value - left.value : null;
    const joint = left?.interval95 && right?.interval95
      && Math.hypot(...[left, right].map(({ interval95: [from, to] }) => (to - from) / 2));
    const beyond = difference != null && joint && Math.abs(difference) > joint;
    return row([
      parameter(name),
      ...[left, right].flatMap((estimate) => [
        { content: fixed(estimate?.value, places(estimate)), class: "n" },
        { content: estimate?.std ? `± ${fixed(1.96 * estimate.std, places(estimate))}` : "", class: "n small" },
      ]),
      { content: fixed(difference, places(left)), class: "n" },
      isComparable ? (left ?? right).unit : `${left.unit || "no unit"}, ${right.unit || "no unit"}`,
      beyond ? h("strong", { class: "beyond" }, "more than the uncertainty of both") : isComparable ? "" : "different units: not compared",
    ], { class: beyond ? "changed" : "" });
  });
  const n = (text) => ({ text, class: "n" });
  return h("section", {}, h("h2", {}, "Parameters"),
    table("", ["Parameter", n("left"), n("95 %"), n("right"), n("95 %"), n("change"), "unit", ""], rows));
}

function plot({ job, result }, name, signal, label = `${name} of ${job.id}`) {
  const { node, figure } = frame("", label);
  const of = result.extended && OF_MODEL.includes(name) ? `${name}-after` : name;
  load(figure, `/v1/jobs/${job.id}/plots/${of}.svg`, signal)
    .catch((error) => signal.aborted || node.replaceChildren(h("p", { class: "small" }, error.message)));
  return node;
}

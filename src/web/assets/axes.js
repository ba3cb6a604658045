// Axes and how their parameters change from one measurement to the next.

import { h, row, table } from "./dom.js";
import { json } from "./api.js";
import { capital, decimals, fixed, named, time } from "./format.js";
import { frame, load } from "./figure.js";
import { chip } from "./status.js";

export async function show({ query, signal }) {
  const machine = query.get("machine");
  const axis = query.get("axis");
  return machine !== null && axis !== null ? history(machine, axis, signal) : list(signal);
}

async function list(signal) {
  const { items } = await json("/v1/axes", { signal });
  const rows = items.map((item) => row([
    h("a", { href: `/axes?${new URLSearchParams({ machine: item.machine, axis: item.axis })}` }, `${item.machine}, ${item.axis}`),
    { content: item.measurements, class: "n" },
    { content: item.results, class: "n" },
    { content: time(item.first_at), class: "time" },
    { content: time(item.last_at), class: "time" },
  ]));
  const n = (text) => ({ text, class: "n" });
  const node = h("div", { class: "wide" },
    h("h1", {}, "Axes"),
    items.length > 0
      ? table("", ["Machine, axis", n("Measurements"), n("With a result"), "First measured", "Last measured"], rows)
      : h("section", { class: "state" },
        h("h2", {}, "No axis is known yet"),
        h("p", {}, "A measurement belongs to an axis where its file says so, in lines ahead of the header:"),
        h("pre", {}, "# machine: press 4\n# axis: Y\n# measured_at: 2026-03-04T10:20:00Z"),
        h("p", { class: "actions" }, h("a", { class: "button", href: "/" }, "Upload one"))));
  return { title: "Axes", node };
}

async function history(machine, axis, signal) {
  const query = new URLSearchParams({ machine, axis });
  const { rows } = await json(`/v1/history.json?${query}`, { signal });
  const title = `${machine}, ${axis}`;
  const link = (format) => h("a", { class: "button", href: `/v1/history.${format}?${query}`, download: `history.${format}` }, format.toUpperCase());
  const { node: figure, figure: host } = frame("", `History of ${title}`);
  if (rows.length > 0) await load(host, `/v1/history.svg?${query}`, signal);
  const node = h("div", { class: "wide" },
    h("p", { class: "trail" }, h("a", { href: "/axes" }, "Axes")),
    h("h1", {}, title),
    rows.length === 0
      ? h("section", { class: "state" },
        h("p", {}, "Nothing has been identified on this axis yet. Start a job on one of its measurements."),
        h("p", { class: "actions" }, h("a", { class: "button", href: "/" }, "Go to the overview")))
      : [
        h("p", { class: "actions" }, ["csv", "json", "svg"].map(link)),
        h("p", {}, "The newest result of each measurement, of the model that explains it best. A change is marked where it goes beyond the joint 95 % interval of both values."),
        figure,
        h("section", {}, h("h2", {}, "Values"), values(rows)),
      ]);
  return { title, node };
}

function values(rows) {
  const names = [...new Set(rows.map((item) => item.parameter))];
  const body = names.flatMap((name) => rows.filter((item) => item.parameter === name).map((item, i) => {
    const places = decimals(item.std);
    return row([
      i === 0 ? capital(item.name) : h("span", { class: "unseen" }, item.name),
      { content: h("a", { href: `/jobs/${item.job_id}` }, time(item.at)), class: "time" },
      { content: fixed(item.value, places), class: "n" },
      { content: item.low95 == null ? "" : `${fixed(item.low95, places)} to ${fixed(item.high95, places)}`, class: "n" },
      item.unit,
      named(item.causes),
      item.changed ? chip("changed", "bad") : "",
    ], { class: i === 0 ? "first" : "" });
  }));
  const n = (text) => ({ text, class: "n" });
  return table("", ["Parameter", "Measured", n("value"), n("95 %"), "unit", "named cause", ""], body);
}

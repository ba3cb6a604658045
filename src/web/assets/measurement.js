// One measurement: what it says of itself, jobs on it, and the start of another.

import { confirmed, h, keyed, row, table } from "./dom.js";
import { json, remove, repeatedly } from "./api.js";
import { filesOf, kind, range, sentence, subject, time } from "./format.js";
import { bar, chip, outcome } from "./status.js";
import { curves, inspection } from "./inspection.js";
import { startForm } from "./start.js";
import { editor } from "./describe.js";
import { rereader } from "./reread.js";

const ACTIVE_MS = 700;
const QUIET_MS = 5000;
const HERTZ = 1 / (2 * Math.PI);

export async function show({ argument: id, query, signal, go }) {
  const measurement = await json(`/v1/measurements/${encodeURIComponent(id)}`, { signal });
  const earlier = query.get("again") && await json(`/v1/jobs/${query.get("again")}`, { signal }).catch(() => null);
  const title = subject(measurement);
  const path = `/v1/measurements/${measurement.id}`;
  const { machine, axis } = measurement;
  const erase = h("button", { class: "danger", onclick: async () => {
    if (!await confirmed(`Delete “${title}” (${filesOf(measurement)}) and every job on it? This cannot be undone.`, "Delete")) return;
    await remove(path);
    go("/");
  } }, "Delete");
  const again = rereader(measurement, () => go(location.pathname));
  const jobs = jobsOf(measurement, signal);
  const node = h("div", { class: "wide" },
    h("p", { class: "trail" }, h("a", { href: "/" }, "Overview")),
    h("h1", {}, title),
    h("p", { class: "actions" },
      h("a", { class: "button", href: `${path}/data.csv`, download: `${measurement.name ?? "measurement"}.csv` }, "Harmonics, CSV"),
      h("a", { class: "button", href: `${path}/data.json`, download: `${measurement.name ?? "measurement"}.json` }, "JSON"),
      machine && axis && h("a", { class: "button", href: `/axes?${new URLSearchParams({ machine, axis })}` }, "History of the axis"),
      h("button", { onclick: () => editor(measurement, () => go(location.pathname)) }, "Edit …"),
      again.button, erase),
    again.node,
    duplicates(measurement, signal),
    inspection(path, signal),
    h("div", { class: "halves" },
      h("section", { "aria-labelledby": "what" }, h("h2", { id: "what" }, "What was measured"), facts(measurement), curves(path, signal)),
      h("section", { "aria-labelledby": "start" },
        h("h2", { id: "start" }, earlier ? "Start it again" : "Start a job"),
        await startForm(measurement, (job) => go(`/jobs/${job.id}`), { earlier, signal }))),
    jobs);
  return { title, node };
}

/// Other uploads of the same data, with a link to each.
function duplicates({ id, sha256 }, signal) {
  const node = h("p", { hidden: true, role: "status" });
  json(`/v1/measurements?sha256=${sha256}&limit=5`, { signal }).then(({ items }) => {
    const others = items.filter((item) => item.id !== id);
    if (others.length === 0) return;
    const links = others.map((other) => h("a", { href: `/measurements/${other.id}` }, `on ${time(other.created_at)}`));
    node.append(h("strong", {}, "The same data were uploaded "), ...links.flatMap((link, i) => (i > 0 ? [", ", link] : [link])), ".");
    node.hidden = false;
  }).catch(() => {});
  return node;
}

function facts(item) {
  const said = [
    ["Name", item.name],
    ["Machine", item.machine],
    ["Axis", item.axis],
    ["Measured", time(item.measured_at)],
    ["By", item.operator],
    ["Files", item.files.join(", ")],
    ["Uploaded", time(item.created_at)],
    ["Input", item.input && [item.input.name, item.input.unit].filter(Boolean).join(", ")],
    ["Response", item.response && [item.response_kind, item.response.unit].filter(Boolean).join(", ")],
    ["Loop", item.loop],
    ["Experiments", item.experiments],
    ["Magnitudes", range(item.magnitude_range, item.input?.unit ?? "")],
    ["Fundamentals", range(item.omega_range_rad_s, "Hz", HERTZ)],
    ["Harmonics", `up to ${item.highest_harmonic}`],
    ...Object.entries(item.labels),
    ["SHA-256", h("code", { class: "digest" }, item.sha256)],
  ];
  return [
    h("dl", { class: "pairs" }, said.filter(([, value]) => value).map(([name, value]) =>
      h("div", {}, h("dt", {}, name), h("dd", {}, value)))),
    item.notes.length > 0 && [
      h("p", {}, "How the files were read:"),
      h("ul", {}, item.notes.map((note) => h("li", {}, sentence(note)))),
    ],
  ];
}

function jobsOf(measurement, signal) {
  const part = table("", ["Job", "Status", "Outcome", "Started"], [], "list");
  const node = h("section", { hidden: true, "aria-labelledby": "jobs" }, h("h2", { id: "jobs" }, "Jobs for this measurement"), part);
  let results = new Map();
  let settled = "";
  repeatedly(signal, async () => {
    const { items } = await json(`/v1/jobs?measurement_id=${measurement.id}&limit=50`, { signal });
    const ended = items.filter((job) => job.status === "succeeded").map((job) => job.id).join();
    if (ended !== settled) {
      const { rows } = await json(`/v1/results.json?measurement_id=${measurement.id}`, { signal });
      results = new Map(rows.map((result) => [result.job_id, result]));
      settled = ended;
    }
    const shown = items.map((job) => ({ ...job, result: results.get(job.id) }));
    keyed(part.querySelector("tbody"), shown, (job) => job.id, jobRow);
    node.hidden = items.length === 0;
    return items.some((job) => ["queued", "running"].includes(job.status)) ? ACTIVE_MS : QUIET_MS;
  });
  return node;
}

function jobRow(job) {
  const active = ["queued", "running"].includes(job.status);
  return row([
    h("a", { href: `/jobs/${job.id}` }, kind(job)),
    active ? bar(job) : chip(job.status),
    active ? "" : outcome(job),
    { content: time(job.started_at ?? job.created_at), class: "time" },
  ]);
}

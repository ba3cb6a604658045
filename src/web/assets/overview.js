// Everything there is: measurements, and jobs as they come along.

import { h, keyed, row, table } from "./dom.js";
import { json, repeatedly, send } from "./api.js";
import { filesOf, kind, number, range, subject, time } from "./format.js";
import { bar, chip, outcome } from "./status.js";
import { upload } from "./files.js";
import { dropZone } from "./upload.js";
import { mappings } from "./mappings.js";
import { finder } from "./find.js";

const ACTIVE_MS = 700;
const QUIET_MS = 4000;
const PAGE = 20;
const HERTZ = 1 / (2 * Math.PI);

export async function show({ query, signal, go }) {
  const find = finder(query, () => refresh().catch(() => {}));
  const compare = comparison(go);
  const jobs = list("jobs", "Jobs", ["Job", "Measurement", "Status", "Outcome", "Started", { text: "", class: "end" }], compare.node);
  const measurements = list("measurements", "Measurements",
    ["Name", "Machine, axis", "Measured", { text: "Experiments", class: "n" }, "Magnitudes", "Frequencies", ""]);
  /// What is known of the measurements of jobs that are on older pages than shown.
  const known = new Map();
  let results = new Map();
  let settled = "";

  async function refresh() {
    const [ofJobs, ofMeasurements] = await Promise.all([
      json(`/v1/jobs?${find.jobs(jobs.limit)}`, { signal }),
      json(`/v1/measurements?${find.measurements(measurements.limit)}`, { signal }),
    ]);
    ofMeasurements.items.forEach((item) => known.set(item.id, item));
    const unknown = ofJobs.items.map((job) => job.measurement_id).filter((id) => !known.has(id));
    for (const id of new Set(unknown)) {
      known.set(id, await json(`/v1/measurements/${id}`, { signal }).catch(() => ({ id })));
    }
    const ended = ofJobs.items.filter((job) => job.status === "succeeded").map((job) => job.id).join();
    if (ended !== settled && ended) {
      const { rows } = await json("/v1/results.json", { signal });
      results = new Map(rows.map((result) => [result.job_id, result]));
    }
    settled = ended;
    jobs.fill(ofJobs, (job) => job, (job) => jobRow(job, compare));
    measurements.fill(ofMeasurements, (item) => item, measurementRow);
    const any = ofMeasurements.items.length + ofJobs.items.length > 0;
    empty.hidden = any || find.active();
    find.say(any);
    jobs.node.hidden = ofJobs.items.length === 0;
    measurements.node.hidden = ofMeasurements.items.length === 0 || find.ofJobsAlone();
    find.node.hidden = !any && !find.active();
    return ofJobs.items.some((job) => ["queued", "running"].includes(job.status)) ? ACTIVE_MS : QUIET_MS;
  }

  function list(path, title, titles, tools) {
    const part = table("", titles, [], "list");
    const body = part.querySelector("tbody");
    const more = h("button", { hidden: true, onclick: () => {
      shown.limit = Math.min(200, shown.limit + 2 * PAGE);
      refresh();
    } }, "Show older ones");
    const node = h("section", { hidden: true, "aria-labelledby": `${path}-title`, id: path },
      h("div", { class: "tools" }, h("h2", { id: `${path}-title` }, title), tools), part, more);
    const shown = {
      node,
      limit: PAGE,
      fill({ items, next }, state, render) {
        const joined = items.map((item) => ({ ...item, measurement: known.get(item.measurement_id), result: results.get(item.id) }));
        keyed(body, joined, (item) => item.id, render);
        more.hidden = !next || shown.limit >= 200;
      },
    };
    return shown;
  }

  const empty = welcome(go);
  const kept = mappings(signal);
  const node = h("div", { class: "wide" },
    h("h1", {}, "Overview"),
    dropZone((measurement) => go(`/measurements/${measurement.id}`), go),
    empty, find.node, jobs.node, measurements.node, kept.node);
  const [pause] = await Promise.all([refresh(), kept.refresh()]);
  let first = true;
  repeatedly(signal, async () => {
    // What was just asked for need not be asked for again.
    if (!first) return refresh();
    first = false;
    return pause;
  });
  return { title: "Overview", node };
}

/// What somebody sees who has not measured yet.
function welcome(go) {
  const button = h("button", { class: "primary", onclick: async () => {
    button.disabled = true;
    const file = await fetch("/assets/example.csv").then((answer) => answer.blob());
    const measurement = await upload([new File([file], "sticky_axis.csv")]);
    const job = await send("/v1/jobs", { measurement_id: measurement.id, kind: "diagnose" });
    go(`/jobs/${job.id}`);
  } }, "Diagnose the example");
  return h("section", { class: "welcome", hidden: true },
    h("h2", {}, "Nothing has been measured yet"),
    h("p", {}, "Drop a file above with either time, input and response, or frequency, gain and phase: CSV, Excel, MATLAB, TDMS ",
      "or universal files. servoscope fits a model with friction to it, and says where the model is wrong and which effect is missing."),
    h("p", { class: "actions" }, button, h("span", { class: "small" }, "A simulated axis with static friction; takes a few seconds.")));
}

/// Ticks of two jobs that are to stand side by side.
function comparison(go) {
  const ticked = new Set();
  const button = h("button", { disabled: true, onclick: () => {
    const [a, b] = ticked;
    go(`/compare?a=${a}&b=${b}`);
  } }, "Compare");
  const hint = h("span", { class: "small" }, "Tick two jobs to see them side by side.");
  return {
    node: h("p", { class: "actions" }, button, hint),
    tick(id, label) {
      return h("input", { type: "checkbox", "aria-label": `Compare ${label}`, checked: ticked.has(id), onchange: ({ target }) => {
        target.checked ? ticked.add(id) : ticked.delete(id);
        button.disabled = ticked.size !== 2;
      } });
    },
  };
}

function jobRow(job, compare) {
  const { measurement = {} } = job;
  const name = subject(measurement);
  const active = ["queued", "running"].includes(job.status);
  const tick = job.status === "succeeded" && compare.tick(job.id, `${kind(job)} of ${name}, ${time(job.created_at)}`);
  return row([
    h("a", { href: `/jobs/${job.id}` }, kind(job)),
    [h("a", { href: `/measurements/${job.measurement_id}` }, name),
      h("span", { class: "small" }, ` ${filesOf(measurement)}`)],
    active ? bar(job) : chip(job.status),
    active ? "" : outcome(job),
    { content: time(job.started_at ?? job.created_at), class: "time" },
    { content: tick || "", class: "end" },
  ]);
}

function measurementRow(item) {
  return row([
    [h("a", { href: `/measurements/${item.id}` }, item.name || "unnamed"), h("span", { class: "small" }, ` ${filesOf(item)}`)],
    [item.machine, item.axis].filter(Boolean).join(", "),
    { content: item.measured_at ? time(item.measured_at) : h("span", { class: "small" }, `uploaded ${time(item.created_at)}`), class: "time" },
    { content: number(item.experiments, 6), class: "n" },
    range(item.magnitude_range, item.input?.unit ?? ""),
    range(item.omega_range_rad_s, "Hz", HERTZ),
    { content: h("a", { class: "button", href: `/measurements/${item.id}#start` }, "Start …"), class: "end" },
  ]);
}

// Several files diagnosed in one go, each by itself: what came of each.

import { h, keyed, row, table } from "./dom.js";
import { Problem, json, repeatedly, send } from "./api.js";
import { confidence, filesOf, named, number, percent, subject, time } from "./format.js";
import { bar, chip, judged } from "./status.js";
import { upload } from "./files.js";

const ACTIVE_MS = 700;
const QUIET_MS = 5000;
/// Most characters of a reason that the address has.
const REASON = 200;

/// Stores each file and starts a diagnosis of it; gives the address that shows them. `reading` is told
/// the name of each. A file that is refused keeps no other from being diagnosed.
export async function diagnoseEach(files, reading) {
  const query = new URLSearchParams();
  const jobs = [];
  for (const file of files) {
    reading(file.name);
    try {
      const { id } = await upload([file]);
      jobs.push((await send("/v1/jobs", { measurement_id: id, kind: "diagnose" })).id);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      const reason = error.message.length > REASON ? `${error.message.slice(0, REASON)} …` : error.message;
      query.append("refused", reason.startsWith(file.name) ? reason : `${file.name}: ${reason}`);
    }
  }
  query.set("jobs", jobs.join());
  return `/together?${query}`;
}

export async function show({ query, signal }) {
  const ids = (query.get("jobs") ?? "").split(",").filter(Boolean);
  const refused = query.getAll("refused");
  const n = (text) => ({ text, class: "n" });
  const part = table("", ["Measurement", "Status", "Verdict", "Cause", n("Confidence"), n("Residual ÷"), n("Residual, % of the response"), "Started"], [], "list");
  const summary = h("p", { class: "lead", role: "status" });
  const measurements = new Map();
  const ended = new Map();

  /// A job with its measurement and its result; one that was deleted is left out.
  async function look(id) {
    if (ended.has(id)) return ended.get(id);
    const job = await json(`/v1/jobs/${encodeURIComponent(id)}`, { signal }).catch((error) => {
      if (error instanceof Problem && error.status === 404) return null;
      throw error;
    });
    if (!job) return null;
    const of = job.measurement_id;
    if (!measurements.has(of)) measurements.set(of, await json(`/v1/measurements/${of}`, { signal }));
    const active = ["queued", "running"].includes(job.status);
    const results = job.status === "succeeded" && (await json(`/v1/results.json?measurement_id=${of}`, { signal })).rows;
    const seen = { ...job, measurement: measurements.get(of), result: results && results.find((result) => result.job_id === id) };
    if (!active) ended.set(id, seen);
    return seen;
  }

  async function refresh() {
    const jobs = (await Promise.all(ids.map(look))).filter(Boolean);
    keyed(part.querySelector("tbody"), jobs, (job) => job.id, jobRow);
    summary.textContent = jobs.length === 0 ? "None of the files could be read." : `${ended.size} of ${jobs.length} finished.`;
    return ended.size < jobs.length ? ACTIVE_MS : QUIET_MS;
  }

  const node = h("div", { class: "wide" },
    h("p", { class: "trail" }, h("a", { href: "/" }, "Overview")),
    h("h1", {}, "Several files diagnosed"),
    summary,
    h("section", { "aria-label": "What came of each" }, ids.length > 0 && part),
    refused.length > 0 && h("section", { "aria-labelledby": "refused" },
      h("h2", { id: "refused" }, "Not read"),
      h("p", {}, "Drop one of these files on the overview on its own: the form there asks for what is missing. If the files have the same layout, you need to do this only once: save the settings under a name there, then drop all the other files again. The mapping is used automatically."),
      h("ul", {}, refused.map((text) => h("li", {}, text)))));
  await refresh();
  if (ids.length > 0) repeatedly(signal, refresh);
  return { title: "Several files diagnosed", node };
}

function jobRow(job) {
  const { measurement, result, status, failure } = job;
  const active = ["queued", "running"].includes(status);
  return row([
    [h("a", { href: `/jobs/${job.id}` }, filesOf(measurement)), h("span", { class: "small" }, ` ${subject(measurement)}`)],
    active ? bar(job) : chip(status),
    result?.verdict ? judged(result) : failure?.reason ?? "",
    named(result?.causes),
    { content: result?.confidence == null ? "" : confidence(result.confidence), class: "n" },
    { content: number(result?.ratio, 3), class: "n" },
    { content: percent(result?.nrmse), class: "n" },
    { content: time(job.started_at ?? job.created_at), class: "time" },
  ]);
}

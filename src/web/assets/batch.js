// One batch: how far it has come, and what came of each measurement.

import { announce, confirmed, h, keyed, row, table } from "./dom.js";
import { json, remove, repeatedly, send } from "./api.js";
import { confidence, effect, seconds, time } from "./format.js";
import { causes, progress, title, verdicts } from "./batches.js";
import { chip, judged } from "./status.js";

const ACTIVE_MS = 1500;
const QUIET_MS = 6000;
const PAGE = 100;
const STATES = ["succeeded", "failed", "cancelled", "deleted", "running", "queued"];

export async function show({ argument: id, query, signal, go }) {
  const path = `/v1/batches/${encodeURIComponent(id)}`;
  const part = table("", ["File", "Status", "Verdict", "First cause", { text: "Confidence", class: "n" }, "Problem"], [], "list");
  const state = h("select", { name: "state", onchange: () => {
    history.replaceState(null, "", state.value ? `?state=${state.value}` : location.pathname);
    pages = 1;
    refresh().catch(() => {});
  } }, h("option", { value: "" }, "any"),
    STATES.map((value) => h("option", { value, selected: value === query.get("state") }, value)));
  const more = h("button", { hidden: true, onclick: () => {
    pages += 1;
    refresh().catch(() => {});
  } }, "Show more");
  const heading = h("h1");
  const origin = h("p", { class: "origin" });
  const actions = h("p", { class: "actions" });
  const summary = h("div", { role: "status" });
  let pages = 1;
  let before;

  /// The rows of as many pages as are shown.
  async function rows() {
    const all = [];
    let cursor = "";
    for (let page = 0; page < pages; page += 1) {
      const only = state.value ? `&state=${state.value}` : "";
      const { items, next } = await json(`${path}/results?limit=${PAGE}${only}${cursor}`, { signal });
      all.push(...items);
      more.hidden = !next;
      if (!next) break;
      cursor = `&cursor=${next}`;
    }
    return all;
  }

  async function refresh() {
    const batch = await json(path, { signal });
    keyed(part.querySelector("tbody"), await rows(), (item) => item.job_id, resultRow);
    if (before === JSON.stringify(batch)) return pause(batch);
    const ends = before && batch.state === "ended" && JSON.parse(before).state !== "ended";
    before = JSON.stringify(batch);
    heading.textContent = title(batch);
    origin.textContent = said(batch);
    summary.replaceChildren(...told(batch));
    actions.replaceChildren(...tools(batch));
    if (ends) announce("The batch has ended.");
    return pause(batch);
  }

  function tools(batch) {
    const csv = h("a", { class: "button", href: `${path}/results.csv`, download: `batch-${id.slice(-6)}.csv` }, "CSV");
    if (batch.state !== "ended") {
      const cancel = h("button", { onclick: async () => {
        if (!await confirmed("Cancel every job of this batch that has not ended?", "Cancel them")) return;
        cancel.disabled = true;
        await send(`${path}/cancel`).catch(() => (cancel.disabled = false));
        await refresh();
      } }, "Cancel");
      return [csv, cancel];
    }
    return [csv, h("button", { class: "danger", onclick: async () => {
      if (!await confirmed("Delete this batch, its jobs and their results for good? The measurements stay.", "Delete")) return;
      await remove(path);
      go("/batches");
    } }, "Delete")];
  }

  const node = h("div", { class: "wide" },
    h("p", { class: "trail" }, h("a", { href: "/batches" }, "Batches")),
    h("div", { class: "head" }, heading, actions),
    origin, summary,
    h("section", { class: "find", "aria-label": "What came of each" },
      h("div", { class: "fields" }, h("label", {}, h("span", {}, "Status"), state))),
    part, more);
  await refresh();
  repeatedly(signal, refresh);
  return { title: heading.textContent, node };
}

function pause(batch) {
  return batch.state === "ended" ? QUIET_MS : ACTIVE_MS;
}

function said({ kind, method, jobs, created_at, started_at, ended_at }) {
  const took = started_at && ended_at && `took ${seconds((new Date(ended_at) - new Date(started_at)) / 1000)}`;
  return [`${jobs} measurements`, `${kind === "diagnose" ? "diagnosed" : "identified"} with ${method}`, `created ${time(created_at)}`, took].filter(Boolean).join(" · ");
}

/// Progress and, as far as there are any, verdicts, causes and reasons.
function told(batch) {
  const found = verdicts(batch);
  const named = causes(batch);
  return [
    h("p", { class: "lead" }, progress(batch)),
    found.length > 0 && h("p", {}, "Verdicts: ", found),
    named && h("p", {}, `First causes: ${named}`),
    batch.failures.length > 0 && h("ul", {}, batch.failures.map(({ reason, jobs }) => h("li", {}, `${jobs} failed: ${reason}`))),
  ].filter(Boolean);
}

function resultRow(item) {
  const gone = item.state === "deleted";
  const name = item.file ?? item.measurement_id;
  return row([
    gone ? name : h("a", { href: `/jobs/${item.job_id}` }, name),
    chip(item.state),
    item.verdict ? judged(item) : "",
    item.cause ? effect(item.cause) : "",
    { content: item.confidence == null ? "" : confidence(item.confidence), class: "n" },
    item.problem ?? "",
  ]);
}

// Batches: many measurements that are computed in the same way.

import { h, keyed, row, table } from "./dom.js";
import { json, repeatedly } from "./api.js";
import { effect, kind, time } from "./format.js";
import { chip, counted } from "./status.js";

const ACTIVE_MS = 2000;
const QUIET_MS = 6000;
const PAGE = 20;

export async function show({ signal }) {
  let limit = PAGE;
  const part = table("", ["Batch", "Progress", "Verdicts", "First causes", "Made"], [], "list");
  const more = h("button", { hidden: true, onclick: () => {
    limit = Math.min(200, limit + 2 * PAGE);
    refresh().catch(() => {});
  } }, "Show older ones");
  const empty = h("section", { class: "state", hidden: true },
    h("h2", {}, "There is no batch yet"),
    h("p", {}, "A folder of measurements becomes one with the command line:"),
    h("pre", {}, `servoscope batch FOLDER --server ${location.origin}`));

  async function refresh() {
    const { items, next } = await json(`/v1/batches?limit=${limit}`, { signal });
    keyed(part.querySelector("tbody"), items, (batch) => batch.id, batchRow);
    part.hidden = items.length === 0;
    empty.hidden = items.length > 0;
    more.hidden = !next || limit >= 200;
    return items.some((batch) => batch.state !== "ended") ? ACTIVE_MS : QUIET_MS;
  }

  const node = h("div", { class: "wide" }, h("h1", {}, "Batches"), part, more, empty);
  await refresh();
  repeatedly(signal, refresh);
  return { title: "Batches", node };
}

/// What a batch is called.
export function title(batch) {
  return batch.name || `${kind(batch)} of ${batch.jobs} measurements`;
}

/// How many of its jobs have ended, or are gone.
function ended({ jobs, counts }) {
  return jobs - counts.queued - counts.running;
}

/// How far a batch has come: a bar while it goes on, and where its jobs stand.
export function progress(batch) {
  const { counts, jobs, state } = batch;
  const some = ["succeeded", "failed", "cancelled", "deleted", "running", "queued"].filter((name) => counts[name] > 0);
  const words = some.map((name) => `${counts[name]} ${name}`).join(", ");
  if (state === "ended") return [chip("ended"), h("span", { class: "small" }, ` ${words}`)];
  return h("span", { class: "progress" },
    h("progress", { max: jobs, value: ended(batch), "aria-label": `${ended(batch)} of ${jobs} have ended` }),
    h("span", { class: "small" }, words));
}

/// How often each verdict was found, and how often each cause was named first; the most frequent ones
/// ahead.
export function verdicts(batch) {
  return often(batch.verdicts).map(([name, count]) => [counted(name), ` ${count} `]);
}

export function causes(batch) {
  return often(batch.causes).map(([name, count]) => `${effect(name)} ${count}`).join(", ");
}

function often(counts) {
  return Object.entries(counts).sort(([, one], [, other]) => other - one);
}

function batchRow(batch) {
  return row([
    [h("a", { href: `/batches/${batch.id}` }, title(batch)), h("span", { class: "small" }, ` ${batch.jobs} measurements, ${batch.kind}`)],
    progress(batch),
    verdicts(batch),
    causes(batch),
    { content: time(batch.created_at), class: "time" },
  ]);
}

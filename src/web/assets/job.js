// One job: live while it runs, its answer once it has one.

import { announce, confirmed, h } from "./dom.js";
import { json, remove, send, text } from "./api.js";
import { kind, percent, subject, time } from "./format.js";
import { answer } from "./answer.js";
import { follow } from "./live.js";
import { tried } from "./tried.js";

const ENDED = ["succeeded", "failed", "cancelled"];

export async function show({ argument: id, signal, go }) {
  const job = await json(`/v1/jobs/${encodeURIComponent(id)}`, { signal });
  const measurement = await json(`/v1/measurements/${job.measurement_id}`, { signal });
  const title = `${kind(job)} of ${subject(measurement)}`;
  const actions = h("p", { class: "actions" });
  const body = h("div", { class: "body" });
  const node = h("div", { class: "job" },
    h("div", { class: "of" },
      h("p", { class: "trail" }, h("a", { href: "/" }, "Overview"), " / ",
        h("a", { href: `/measurements/${measurement.id}` }, subject(measurement))),
      h("p", { class: "origin" }, origin(job, measurement))),
    h("div", { class: "head" }, h("h1", {}, title), actions),
    body);

  async function ended(job) {
    const path = `/v1/jobs/${job.id}`;
    const again = `/measurements/${measurement.id}?again=${job.id}#start`;
    const shown = job.status === "succeeded"
      && answer(...await Promise.all([text(`${path}/report.html`, { signal }), tried(job, signal)]));
    const left = shown && job.kind === "identify" && await leaves(job, signal);
    if (signal.aborted) return;
    actions.replaceChildren(...[
      ...(left ? [h("button", { class: "primary", title: left, onclick: () => diagnose(job) }, "Diagnose this")] : []),
      ...(shown ? downloads(path, job, shown.figures) : []),
      h("a", { class: "button", href: again }, "Start again …"),
      h("button", { class: "danger", onclick: async () => {
        if (!await confirmed("Delete this job and its result for good?", "Delete")) return;
        await remove(path);
        go(`/measurements/${measurement.id}`);
      } }, "Delete")]);
    if (shown) {
      body.replaceChildren(...shown.nodes);
      body.querySelector(".card.next").append(h("p", {}, h("a", { href: `/plans?job=${job.id}` }, "Plan a later measurement"), " of this axis."));
      announce(`Ended: ${shown.verdict}`);
    } else {
      body.replaceChildren(without(job));
      announce(`The job ${job.status === "failed" ? "failed" : "was cancelled"}.`);
    }
  }

  /// Starts a diagnosis with what was asked for here.
  async function diagnose({ measurement_id, plant, method, options }) {
    const { id } = await send("/v1/jobs", { measurement_id, kind: "diagnose", plant: plant ?? undefined, method, options });
    go(`/jobs/${id}`);
  }

  if (ENDED.includes(job.status)) {
    await ended(job);
  } else {
    const cancel = h("button", { onclick: async () => {
      cancel.disabled = true;
      await send(`/v1/jobs/${job.id}/cancel`).catch(() => (cancel.disabled = false));
    } }, "Cancel");
    actions.replaceChildren(cancel);
    body.replaceChildren(follow(job, signal, ended));
  }
  return { title, node };
}

/// What an identification leaves unexplained, if it is too much.
async function leaves({ id, measurement_id }, signal) {
  const { rows } = await json(`/v1/results.json?measurement_id=${measurement_id}`, { signal });
  const result = rows.find((row) => row.job_id === id);
  return result?.adequate === false && `The residual of the model is ${percent(result.nrmse)} of the response, more than its noise.`;
}

function origin(job, measurement) {
  const measured = measurement.measured_at && `measured ${time(measurement.measured_at)}`;
  return [measured, measurement.operator && `by ${measurement.operator}`, `${job.kind === "diagnose" ? "diagnosed" : "identified"} ${time(job.created_at)}`]
    .filter(Boolean).join(" · ");
}

/// Everything that can be taken away, in one place.
function downloads(path, job, figures) {
  const name = `${job.kind}-${job.id.slice(-6)}`;
  const link = (file, title) => h("li", {}, h("a", { href: `${path}/${file}`, download: `${name}-${file.split("/").pop()}` }, title));
  const close = () => (menu.open = false);
  const menu = h("details", {
    class: "menu",
    onkeydown: ({ key }) => key === "Escape" && (close(), menu.firstElementChild.focus()),
    onfocusout: ({ relatedTarget }) => relatedTarget && !menu.contains(relatedTarget) && close(),
  },
    h("summary", { class: "button" }, "Data and figures"),
    h("ul", {},
      link("result", "Result, JSON"), link("parameters.csv", "Parameters, CSV"),
      link("comparison.csv", "Measured and simulated, CSV"), link("convergence.csv", "Convergence, CSV"),
      figures.map((figure) => link(`plots/${figure}.svg`, `Figure: ${figure}, SVG`))));
  return [h("a", { class: "button primary", href: `${path}/report.html`, download: `${name}.html` }, "Report"), menu];
}

/// Why there is no answer, and what to do.
function without(job) {
  const { failure } = job;
  return h("section", { class: "state" },
    h("h2", {}, job.status === "failed" ? "This job failed" : "Cancelled"),
    failure && h("p", {}, failure.reason),
    failure?.reference && h("p", { class: "small" }, "The log of the server says more under ", h("code", {}, failure.reference), "."),
    h("p", {}, job.status === "failed" ? "“Start again …” keeps the settings." : "There is no result. “Start again …” keeps the settings."));
}

// A job while it runs: stage, share and convergence as they arrive.

import { h } from "./dom.js";
import { Problem, connection, json, lost } from "./api.js";
import { about, seconds } from "./format.js";
import { frame, load } from "./figure.js";
import { stage } from "./status.js";

/// Least time between two drawings of the convergence.
const REDRAW_MS = 700;

/// Follows a job to its end, which `ended` is told.
export function follow(job, signal, ended) {
  const progress = h("progress", { max: 1, value: 0, "aria-label": "Progress" });
  const word = h("p", { class: "lead" });
  const detail = h("p", { class: "small" });
  const { node: convergence, figure } = frame("", "Convergence by stage");
  convergence.hidden = true;
  const node = h("section", { class: "live", "aria-label": "Progress" }, word, progress, detail, convergence);
  let latest = job;
  let row;

  function tell() {
    const { status, progress: at, started_at, attempt, cancel_requested: stopping } = latest;
    const share = at?.fraction ?? 0;
    word.textContent = stopping ? "Being cancelled …" : status === "queued" ? "Waiting for a worker"
      : `${stage(at).replace(/^./, (c) => c.toUpperCase())} · ${Math.floor(100 * share)} %`;
    progress.value = share;
    const parts = [
      at && at.total > 1 && `step ${at.done} of at most ${at.total}`,
      row && `${row.evaluations} simulations in this stage`,
      at?.remaining_s != null && !stopping && `${about(at.remaining_s)} left`,
      started_at && `running for ${seconds(Math.max(0, Date.now() - new Date(started_at)) / 1000)}`,
      attempt > 1 && `attempt ${attempt}: the server was interrupted`,
    ];
    detail.textContent = parts.filter(Boolean).join(" · ");
  }

  const draw = throttled(REDRAW_MS, async () => {
    if (signal.aborted) return;
    await load(figure, `/v1/jobs/${job.id}/plots/convergence.svg`, signal).then(
      () => (convergence.hidden = false),
      // Not drawn this time: the next row asks again.
      () => {});
  });

  const clock = setInterval(tell, 1000);
  signal.addEventListener("abort", () => clearInterval(clock), { once: true });
  listen(`/v1/jobs/${job.id}/events`, signal, {
    status: (data) => {
      latest = data;
      tell();
    },
    convergence: (data) => {
      row = data;
      draw();
    },
    end: (data) => {
      clearInterval(clock);
      ended(data);
    },
  });
  tell();
  return node;
}

/// Listens to a stream of events to its end. A browser comes back by itself where
/// the connection broke, and names the last event it saw; where it was refused, it
/// gives up, and this tries again.
function listen(path, signal, handlers) {
  const source = new EventSource(path);
  const close = () => source.close();
  signal.addEventListener("abort", close, { once: true });
  for (const [name, handle] of Object.entries(handlers)) {
    source.addEventListener(name, (event) => {
      if (name === "end") close();
      handle(JSON.parse(event.data));
    });
  }
  source.addEventListener("error", () => {
    if (signal.aborted) return;
    const gaveUp = source.readyState === EventSource.CLOSED;
    // One look says whether the stream was cut or the whole server is away.
    json(path.replace(/\/events$/, "")).then(
      (job) => {
        if (!gaveUp || signal.aborted) return;
        if (["succeeded", "failed", "cancelled"].includes(job.status)) handlers.end(job);
        else setTimeout(() => signal.aborted || listen(path, signal, handlers), 1000);
      },
      (error) => {
        if (error instanceof Problem) return close();
        lost();
        if (gaveUp) connection.addEventListener("back", () => listen(path, signal, handlers), { once: true, signal });
      });
  });
}

/// Runs an action at most once in a while, and once more after the last call.
function throttled(pause, action) {
  let busy = false;
  let wanted = false;
  return async function run() {
    wanted = true;
    if (busy) return;
    busy = true;
    while (wanted) {
      wanted = false;
      await action();
      await new Promise((resolve) => setTimeout(resolve, pause));
    }
    busy = false;
  };
}

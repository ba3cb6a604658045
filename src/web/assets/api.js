// Requests to the server this page came from.

const AGAIN_MS = 1500;
const TROUBLE_MS = 3000;

/// What the server says is wrong: a problem document (RFC 9457).
export class Problem extends Error {
  constructor(status, document) {
    super(document.detail ?? document.title ?? `the server answered ${status}`);
    this.status = status;
    this.document = document;
  }
}

/// The server does not answer.
export class Away extends Error {
  constructor() {
    super("the server does not answer");
  }
}

/// Whether the server answers: `away` and `back` are told once each.
export const connection = Object.assign(new EventTarget(), { away: false });

/// Whether the server knows who asks: `unknown` is told whenever it does not.
export const identity = new EventTarget();

/// The server was found not to answer: asks until it does.
export function lost() {
  if (connection.away) return;
  connection.away = true;
  connection.dispatchEvent(new Event("away"));
  setTimeout(look, AGAIN_MS);
}

async function look() {
  const answer = await fetch("/readyz", { cache: "no-store" }).catch(() => null);
  if (!answer?.ok) return setTimeout(look, AGAIN_MS);
  connection.away = false;
  connection.dispatchEvent(new Event("back"));
}

/// Asks; anything but success is an error that says what is wrong.
export async function ask(path, options = {}) {
  let answer;
  try {
    answer = await fetch(path, options);
  } catch (error) {
    if (options.signal?.aborted) throw error;
    lost();
    throw new Away();
  }
  if (answer.ok) return answer;
  const document = await answer.json().catch(() => ({}));
  // Whoever signs in sees the answer beside the form.
  if (answer.status === 401 && path !== "/v1/session") identity.dispatchEvent(new Event("unknown"));
  throw new Problem(answer.status, document);
}

export async function json(path, options) {
  return (await ask(path, options)).json();
}

export async function text(path, options) {
  return (await ask(path, options)).text();
}

export function send(path, body, options = {}) {
  return json(path, { ...posted(body), ...options });
}

/// A request that brings JSON.
export function posted(body) {
  return { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) };
}

export function remove(path) {
  return ask(path, { method: "DELETE" });
}

/// Does something now and again after a pause that it returns, until `signal` ends
/// it. A page that nobody sees asks nothing; one whose server is away asks when it is
/// back, and one whose server is in trouble a little later.
export async function repeatedly(signal, action) {
  while (!signal.aborted) {
    let pause;
    try {
      pause = await action();
    } catch (error) {
      if (signal.aborted) return;
      if (error instanceof Away) await happens(connection, "back", signal);
      pause = TROUBLE_MS;
    }
    await new Promise((resolve) => setTimeout(resolve, pause));
    if (document.hidden) await happens(document, "visibilitychange", signal);
  }
}

function happens(target, name, signal) {
  if (signal.aborted || (target === connection && !connection.away)) return Promise.resolve();
  return new Promise((resolve) => {
    target.addEventListener(name, resolve, { once: true, signal });
    signal.addEventListener("abort", resolve, { once: true });
  });
}

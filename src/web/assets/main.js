// Which view an address names, and what surrounds every view.

import { announce, h } from "./dom.js";
import { Away, Problem, connection, identity } from "./api.js";
import * as session from "./session.js";
import * as overview from "./overview.js";
import * as measurement from "./measurement.js";
import * as job from "./job.js";
import * as compare from "./compare.js";
import * as axes from "./axes.js";
import * as plans from "./plans.js";
import * as together from "./together.js";
import * as batches from "./batches.js";
import * as batch from "./batch.js";

const VIEWS = [
  [/^\/$/, overview],
  [/^\/measurements\/([^/]+)$/, measurement],
  [/^\/jobs\/([^/]+)$/, job],
  [/^\/compare$/, compare],
  [/^\/axes$/, axes],
  [/^\/plans$/, plans],
  [/^\/together$/, together],
  [/^\/batches$/, batches],
  [/^\/batches\/([^/]+)$/, batch],
];

const main = document.getElementById("main");
const banner = document.getElementById("connection");
let leaving = new AbortController();
/// Path and query of what is shown: a change of the fragment alone shows nothing new.
let shown;

/// Goes to an address of this page; to the one that is shown, to show it anew.
export function go(path) {
  if (path === location.pathname + location.search) shown = undefined;
  else history.pushState(null, "", path);
  show();
}

async function show() {
  const address = location.pathname + location.search;
  if (address === shown) return scrollToFragment();
  shown = address;
  leaving.abort();
  leaving = new AbortController();
  const { signal } = leaving;
  const [pattern, view] = VIEWS.find(([pattern]) => pattern.test(location.pathname)) ?? [];
  for (const link of document.querySelectorAll(".bar nav a")) {
    const here = link.pathname === location.pathname;
    here ? link.setAttribute("aria-current", "page") : link.removeAttribute("aria-current");
  }
  if (!view) return fail(signal, Object.assign(new Error(`${location.pathname} is not a page of this server`), { unknown: true }));
  const waiting = setTimeout(() => main.replaceChildren(h("p", { class: "state" }, "Loading …")), 300);
  try {
    const argument = decodeURIComponent(location.pathname.match(pattern)[1] ?? "");
    const { title, node } = await view.show({ argument, query: new URLSearchParams(location.search), signal, go });
    if (signal.aborted) return;
    document.title = `${title} · servoscope`;
    main.replaceChildren(node);
    announce(title);
    location.hash ? scrollToFragment() : scrollTo(0, 0);
  } catch (error) {
    fail(signal, error);
  } finally {
    clearTimeout(waiting);
  }
}

/// Says why there is nothing to see, and what to do.
function fail(signal, error) {
  if (signal.aborted) return;
  document.title = "servoscope";
  const away = error instanceof Away;
  const again = () => {
    shown = undefined;
    show();
  };
  if (away) connection.addEventListener("back", again, { once: true, signal });
  const gone = error.unknown || (error instanceof Problem && error.status === 404);
  main.replaceChildren(h("section", { class: "state" },
    h("h1", {}, away ? "Waiting for the server" : gone ? "Not found" : "That did not work"),
    h("p", {}, away ? "It does not answer. This page continues automatically as soon as it does." : `${capital(error.message)}.`),
    h("p", { class: "actions" },
      h("a", { class: "button", href: "/" }, "Go to the overview"),
      !gone && h("button", { onclick: again }, "Try again"))));
}

/// Asks for a key, and then shows what was asked for.
function locked() {
  leaving.abort();
  leaving = new AbortController();
  document.title = "Sign in · servoscope";
  const form = session.form(() => {
    shown = undefined;
    show();
  });
  main.replaceChildren(form);
  form.elements.key.focus();
}

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1).replace(/\.$/, "");

function scrollToFragment() {
  const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
  target?.scrollIntoView();
}

/// Links within the page do not load it again.
document.addEventListener("click", (event) => {
  const link = event.target.closest("a[href]");
  const plain = event.button === 0 && !event.metaKey && !event.ctrlKey && !event.shiftKey && !event.altKey;
  if (!link || !plain || event.defaultPrevented || link.origin !== location.origin) return;
  const within = link.hash && link.pathname + link.search === location.pathname + location.search;
  if (link.download || link.target || within || !VIEWS.some(([pattern]) => pattern.test(link.pathname))) return;
  event.preventDefault();
  if (link.href !== location.href) go(link.pathname + link.search + link.hash);
  main.focus({ preventScroll: true });
});
addEventListener("popstate", show);

identity.addEventListener("unknown", () => {
  // Several requests may fail at once.
  if (!main.querySelector(".sign-in")) locked();
});
connection.addEventListener("away", () => {
  banner.hidden = false;
  banner.className = "connection away";
  banner.textContent = "The server does not answer. What you see may be old; trying again …";
});
connection.addEventListener("back", () => {
  banner.className = "connection back";
  banner.textContent = "The server is back.";
  setTimeout(() => (banner.hidden = !connection.away), 4000);
});

session.show(locked);
show();

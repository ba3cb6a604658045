// Who is signed in: the form that asks for a key, and the name of the key in the bar.

import { h } from "./dom.js";
import { ask, json, send } from "./api.js";

const PATH = "/v1/session";

/// The form that signs in; `entered` is called once the server knows the key.
export function form(entered) {
  const field = h("input", { name: "key", type: "password", required: true, autocomplete: "current-password", autofocus: true,
    spellcheck: "false", placeholder: "sk_servoscope_…" });
  const wrong = h("p", { class: "wrong", role: "alert" });
  const button = h("button", { class: "primary" }, "Sign in");
  const node = h("form", { class: "state sign-in" },
    h("h1", {}, "This server asks for a key"),
    h("p", {}, "Ask whoever operates it for one. This browser then stays signed in for 12 hours; it does not keep the key itself."),
    h("div", { class: "fields" }, h("label", {}, h("span", {}, "Key"), field)),
    h("p", { class: "actions" }, button),
    wrong);
  node.addEventListener("submit", async (event) => {
    event.preventDefault();
    button.disabled = true;
    wrong.textContent = "";
    try {
      const { key } = await send(PATH, { key: field.value.trim() });
      name(key);
      entered();
    } catch (error) {
      wrong.textContent = error.status === 401 ? "The server does not know this key, or it has expired or was revoked." : error.message;
      field.setAttribute("aria-invalid", "true");
      field.focus();
    } finally {
      button.disabled = false;
    }
  });
  return node;
}

/// Shows in the bar whose key it is, with a way out that `left` is told of; nothing where
/// the server asks for none.
export async function show(left) {
  out.onclick = async () => {
    await ask(PATH, { method: "DELETE" }).catch(() => {});
    name(null);
    left();
  };
  // Without a key the form is shown, and says what is wrong.
  const { key } = await json(PATH).catch(() => ({ key: null }));
  name(key);
}

const holder = document.getElementById("holder");
const out = h("button", {}, "Sign out");

function name(key) {
  holder.hidden = !key;
  holder.replaceChildren(...(key ? [h("span", { title: `may ${key.scopes.join(", ")}` }, key.name), out] : []));
}

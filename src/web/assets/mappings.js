// Mappings: how files of one layout are read, kept under a name.

import { announce, confirmed, h, row, table } from "./dom.js";
import { json, remove, send } from "./api.js";
import { time } from "./format.js";

const path = (name) => `/v1/mappings/${encodeURIComponent(name)}`;

/// A field for the name under which a mapping is kept; `made` says what it is.
export function keep(made) {
  const field = h("input", { name: "mapping_name", autocomplete: "off", maxlength: 64 });
  const outcome = h("span", { class: "small", role: "status" });
  const button = h("button", { type: "button", onclick: () => store().catch(refuse) }, "Save");
  // The name says nothing of how the file is read.
  field.addEventListener("change", (event) => event.stopPropagation());
  const node = h("fieldset", { class: "keep" },
    h("legend", {}, "Remember these settings for files of this layout"),
    h("p", { class: "actions" }, h("label", {}, "Name ", field), button, outcome));

  function refuse(error) {
    field.setAttribute("aria-invalid", "true");
    outcome.className = "small wrong";
    outcome.textContent = error.message;
  }

  /// Stores the mapping if it has a name.
  async function store() {
    const name = field.value.trim();
    field.removeAttribute("aria-invalid");
    if (!name) return;
    const { layout, settings } = made();
    await send(path(name), { layout, settings }, { method: "PUT" });
    outcome.className = "small";
    outcome.replaceChildren("Saved as ", toml(name), layout ? "; used automatically for the next file of this layout." : "; files of this kind cannot be recognised, so name the mapping when you upload one.");
    announce(`The mapping ${name} is saved.`);
  }
  return { node, store };
}

function toml(name) {
  return h("a", { href: `${path(name)}/mapping.toml`, download: `${name}.toml` }, `${name}.toml`);
}

/// The mappings that are kept; hidden where there are none.
export function mappings(signal) {
  const part = table("", ["Name", "Settings", "Saved", { text: "", class: "end" }], [], "list");
  const node = h("section", { hidden: true, id: "mappings", "aria-labelledby": "mappings-title" },
    h("div", { class: "tools" }, h("h2", { id: "mappings-title" }, "Mappings")), part);

  async function refresh() {
    const { items } = await json("/v1/mappings", { signal });
    part.querySelector("tbody").replaceChildren(...items.map((mapping) => row([
      mapping.name,
      h("span", { class: "small" }, Object.entries(mapping.settings).map(([key, value]) => `${key} = ${value}`).join("; ")),
      { content: time(mapping.updated_at), class: "time" },
      { content: [toml(mapping.name), " ", h("button", { class: "danger", "aria-label": `Delete the mapping ${mapping.name}`, onclick: () => erase(mapping.name) }, "Delete")], class: "end" },
    ])));
    node.hidden = items.length === 0;
  }

  async function erase(name) {
    if (!await confirmed(`Delete the mapping ${name}? Measurements that were read with it stay.`, "Delete")) return;
    await remove(path(name));
    announce(`The mapping ${name} is deleted.`);
    await refresh();
  }
  return { node, refresh };
}

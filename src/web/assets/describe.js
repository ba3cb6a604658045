// What a measurement says of itself, changed after it was stored.

import { announce, h } from "./dom.js";
import { send } from "./api.js";
import { clear, input, refuse } from "./form.js";

const FIELDS = [
  ["name", "Name"], ["machine", "Machine"], ["axis", "Axis"], ["operator", "Measured by"],
  ["measured_at", "Measured at", "With its zone: 2026-03-04T10:20:00+01:00"],
];

/// Asks in a dialog for what a measurement is to say of itself; `done` is called once it says so.
export function editor(measurement, done) {
  const labels = Object.entries(measurement.labels).map(([name, value]) => `${name}: ${value}`);
  const lines = h("textarea", { name: "labels", rows: Math.max(2, labels.length + 1) });
  lines.value = labels.join("\n");
  const form = h("form", { novalidate: true, "aria-label": "Measurement details" },
    h("h2", {}, "Edit measurement"),
    h("div", { class: "fields" },
      FIELDS.map(([name, title, hint]) => input(name, title, { value: measurement[name] ?? "" }, hint)),
      h("label", {}, h("span", {}, "Labels"), lines, h("span", { class: "small" }, "One per line, for example site: north"))),
    h("p", { class: "small" }, "Units, kind of the response and columns: “Read it again …” on the page of the measurement."),
    h("p", { class: "actions" }, h("button", { class: "primary" }, "Save"), h("button", { type: "button", onclick: () => dialog.close() }, "Cancel")),
    h("p", { class: "wrong", role: "alert" }));
  const dialog = h("dialog", { class: "editor", "aria-label": "Edit the measurement", onclose: () => dialog.remove() }, form);

  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    clear(form);
    try {
      const said = FIELDS.map(([name]) => [name, form.elements[name].value.trim()]);
      await send(`/v1/measurements/${measurement.id}`, { ...Object.fromEntries(said), labels: labelled(lines.value) }, { method: "PATCH" });
      dialog.close();
      announce("The measurement is changed.");
      done();
    } catch (error) {
      refuse(form, error);
    }
  });
  document.body.append(dialog);
  dialog.showModal();
}

/// Labels from lines with a name and a value each.
function labelled(text) {
  const lines = text.split("\n").filter((line) => line.trim());
  return Object.fromEntries(lines.map((line) => {
    const at = line.indexOf(":");
    if (at < 1) throw Object.assign(new Error(`“${line.trim()}” is not a name and a value, as in site: north`), { field: "labels" });
    return [line.slice(0, at).trim(), line.slice(at + 1).trim()];
  }));
}

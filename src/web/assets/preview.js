// How files are read, before they are stored or until there is a job on them: the first rows, what
// each column is, and what else they lack.

import { announce, h } from "./dom.js";
import { json, send } from "./api.js";
import { number, range } from "./format.js";
import { body, upload } from "./files.js";
import { columnsForm } from "./columns.js";
import { keep } from "./mappings.js";

const HERTZ = 1 / (2 * Math.PI);

/// What can be given beside a file: title, hint, and the values if there are few.
const SETTINGS = {
  response: ["Response", "Kind and unit: velocity rad/s, position mm, acceleration m/s²"],
  input: ["Input", "Name and unit: current A"],
  magnitude: ["Magnitude of the input", "Where it is the same at every frequency; in the unit of the input"],
  sample_s: ["Time between samples, s", "Where there is no column of times"],
  sheet: ["Sheet", "Of a workbook with several tables"],
  decimal: ["Decimal mark", "", ["comma", "point"]],
  inverted: ["Response is inverted", "yes if it is turned by 180°, as a Bode 100 loop gain is", ["yes", "no"]],
  amplitude: ["Amplitudes are", "", ["peak", "rms", "peak-to-peak"]],
  period_s: ["Period, s", "Of a time record; none for a motion that does not repeat"],
  loop: ["Loop", "", ["open", "closed"]],
};

/// In place of how to give something on the command line.
const HERE = {
  column_names: "say below what each column is",
  response: "say below whether the response is a velocity, a position or an acceleration, and its unit",
};

/// What the server makes of files, with what is given beside them.
export function preview(files, given = {}, signal) {
  return json("/v1/preview", { method: "POST", body: body(files, given), signal });
}

/// Files that are not stored yet, as a form shows them.
export function dropped(files) {
  return {
    preview: (given, signal) => preview(files, given, signal),
    store: (given) => upload(files, given),
    action: "Store it",
    stored: "The measurement was uploaded.",
  };
}

/// Files of a measurement, as a form shows them.
export function stored({ id }) {
  const path = `/v1/measurements/${id}`;
  return {
    preview: (given, signal) => send(`${path}/preview`, { given }, { signal }),
    store: (given) => send(`${path}/reading`, { given }, { method: "PUT" }),
    // Whoever reads it again wants another unit, mostly.
    asks: true,
    action: "Apply these settings",
    stored: "The measurement was read again.",
  };
}

/// A form that shows how files are read and asks for what they lack. `done` gets the measurement
/// once it is stored, `stopped` is called where it is not to be.
export function previewForm(source, first, done, stopped) {
  let seen = first;
  let asking = new AbortController();
  const said = h("div", { role: "status", class: "understood" });
  const table = first.files.find((file) => file.table)?.table;
  const columns = table && columnsForm(table, first, first.files[0].name);
  const missing = new Set((first.refusal?.missing ?? []).map(({ key }) => key));
  const wanted = Object.keys(SETTINGS).filter((key) => missing.has(key));
  const others = Object.keys(SETTINGS).filter((key) => !missing.has(key));
  const store = h("button", { class: "primary" }, source.action);
  const kept = keep(() => ({ layout: seen.layout, settings: settings() }));
  const form = h("form", { class: "preview", novalidate: true, "aria-label": "How the file is read", onchange: changed },
    said,
    columns?.node,
    wanted.length > 0 && h("div", { class: "fields" }, wanted.map(field)),
    h("details", { open: source.asks }, h("summary", {}, "More settings"), h("div", { class: "fields" }, others.map(field))),
    kept.node,
    h("p", { class: "actions" }, store, h("button", { type: "button", onclick: stopped }, "Cancel")));

  /// What is given beside the file: by the stored mapping that was used, and by the form.
  function settings() {
    const all = { ...seen.given };
    for (const key of Object.keys(SETTINGS)) {
      const value = form.elements[key].value.trim();
      value ? (all[key] = value) : delete all[key];
    }
    const names = columns?.names();
    return names ? { ...all, column_names: names } : all;
  }

  function field(key) {
    const [title, hint, values] = SETTINGS[key];
    const value = first.given[key] ?? "";
    const options = (values) => ["", ...values].map((one) => h("option", { value: one, selected: one === value }, one || "not said"));
    const list = key === "sheet" && table?.sheets.length > 0 ? table.sheets : values;
    const control = list
      ? h("select", { name: key }, options(list))
      : h("input", { name: key, value, autocomplete: "off" });
    return h("label", {}, h("span", {}, title), control, hint && h("span", { class: "small" }, hint));
  }

  function say() {
    const { measurement, refusal, mapping } = seen;
    store.disabled = !measurement;
    for (const key of Object.keys(SETTINGS)) {
      const wrong = refusal?.column === key || refusal?.missing.some((lack) => lack.key === key);
      wrong ? form.elements[key].setAttribute("aria-invalid", "true") : form.elements[key].removeAttribute("aria-invalid");
    }
    said.className = measurement ? "understood" : "understood wrong";
    said.replaceChildren(
      h("p", {}, h("strong", {}, measurement ? "This is understood: " : "Not yet understood: "), measurement ? summary(measurement) : plain(refusal)),
      ...(mapping ? [h("p", { class: "small" }, `The stored mapping “${mapping}” is used.`)] : []));
  }

  /// Asks again with what the form says; only the latest answer counts.
  async function changed() {
    asking.abort();
    asking = new AbortController();
    const { signal } = asking;
    try {
      const answer = await source.preview(settings(), signal);
      if (signal.aborted) return;
      seen = answer;
      say();
    } catch (error) {
      if (!signal.aborted) wrong(error);
    }
  }

  function wrong(error) {
    said.className = "understood wrong";
    said.replaceChildren(h("p", {}, error.message));
  }

  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    store.disabled = true;
    try {
      await kept.store();
      const measurement = await source.store(settings());
      announce(source.stored);
      done(measurement);
    } catch (error) {
      wrong(error);
      store.disabled = false;
    }
  });
  say();
  return form;
}

/// What a measurement is, in one sentence.
function summary({ experiments, input, response, response_kind: kind, magnitude_range, omega_range_rad_s }) {
  const of = experiments === 1 ? "one experiment" : `${number(experiments, 6)} experiments`;
  const from = [input?.name, input?.unit && `(${input.unit})`].filter(Boolean).join(" ") || "the input";
  const to = [kind, response?.unit && `(${response.unit})`].filter(Boolean).join(" ");
  const magnitudes = `${range(magnitude_range, input?.unit ?? "")}${input?.unit ? "" : " (no unit given)"}`;
  return `${of}, from ${from} to ${to}, magnitude ${magnitudes}, ${range(omega_range_rad_s, "Hz", HERTZ)}.`;
}

/// Why a file is not understood, without the ways to give something that this form does not need.
function plain({ detail, missing }) {
  return `${missing.reduce((text, { key, how }) => text.replace(how, HERE[key] ?? `fill in “${SETTINGS[key]?.[0] ?? key}” below`), detail)}.`;
}

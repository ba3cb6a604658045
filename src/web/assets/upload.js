// Uploading a measurement by drag and drop, or from a dialog.

import { announce, h } from "./dom.js";
import { Problem } from "./api.js";
import { upload } from "./files.js";
import { dropped, preview, previewForm } from "./preview.js";
import { diagnoseEach } from "./together.js";

/// Lines shown before and after one that is wrong.
const AROUND = 2;

/// A place to drop files on. `done` gets the measurement; `go` shows what became of several.
export function dropZone(done, go) {
  const input = h("input", { type: "file", multiple: true, accept: ".csv,.json,.txt,.tsv,.dat,.xlsx,.uff,.unv,.58,.mat,.tdms", id: "files", class: "unseen" });
  const outcome = h("div", { role: "alert" });
  const look = h("input", { type: "checkbox", id: "look-first" });
  const shown = h("div");
  const zone = h("section", { class: "drop", "aria-label": "Upload a measurement" },
    h("p", {},
      h("strong", {}, "Drop a measurement here"), " or ",
      h("label", { class: "button", for: "files" }, "choose files")),
    h("p", { class: "small" }, "CSV, JSON, Excel, MATLAB, TDMS or universal files with time, input and response, or frequency, gain and phase. With several files you are asked whether they belong together. ",
      h("a", { href: "/assets/example.csv", download: "sticky_axis.csv" }, "An example to look at"), "."),
    h("p", { class: "small" }, h("label", {}, look, " Show how it is read before it is stored")),
    input, outcome, shown);

  /// Asks what several files are.
  async function choose(files) {
    if (files.length < 2) return take(files);
    const each = h("button", { class: "primary", onclick: () => apart(files) }, "Diagnose each by itself");
    outcome.replaceChildren(h("div", { class: "actions middle" },
      h("span", {}, `${files.length} files:`), each,
      h("button", { onclick: () => take(files) }, "They are one measurement"),
      h("button", { onclick: () => outcome.replaceChildren() }, "Cancel")));
    each.focus();
  }

  async function apart(files) {
    zone.classList.add("busy");
    try {
      const path = await diagnoseEach(files, (name) => outcome.replaceChildren(h("p", {}, `Reading ${name} …`)));
      outcome.replaceChildren();
      go(path);
    } catch (error) {
      outcome.replaceChildren(h("p", { class: "wrong" }, error.message));
    } finally {
      zone.classList.remove("busy");
    }
  }

  async function take(files) {
    if (files.length === 0) return;
    outcome.replaceChildren(h("p", {}, `Reading ${files.map((file) => file.name).join(", ")} …`));
    shown.replaceChildren();
    zone.classList.add("busy");
    try {
      if (look.checked) return await show(files);
      const measurement = await upload(files);
      outcome.replaceChildren();
      announce("The measurement was uploaded.");
      done(measurement);
    } catch (error) {
      if (error instanceof Problem && error.status === 422) await show(files, error).catch(() => {});
      if (!shown.firstChild) outcome.replaceChildren(await explained(error, files));
    } finally {
      zone.classList.remove("busy");
      input.value = "";
    }
  }

  /// Shows how files are read; after a refusal only where something can be given to mend it.
  async function show(files, refused) {
    const seen = await preview(files);
    const lacking = seen.refusal?.missing.length > 0;
    if (refused && !lacking) return;
    const reason = seen.refusal && h("div", { class: "refused" },
      h("h2", {}, "Nothing is stored yet"), h("p", {}, "The file lacks something. Fill it in below, and store it then."));
    outcome.replaceChildren(...(reason ? [reason] : []));
    shown.replaceChildren(previewForm(dropped(files), seen, done, () => {
      shown.replaceChildren();
      outcome.replaceChildren();
    }));
    shown.querySelector(".understood").scrollIntoView({ block: "nearest" });
  }

  input.addEventListener("change", () => choose([...input.files]));
  const over = (event) => {
    event.preventDefault();
    zone.classList.add("over");
  };
  zone.addEventListener("dragenter", over);
  zone.addEventListener("dragover", over);
  zone.addEventListener("dragleave", (event) => zone.contains(event.relatedTarget) || zone.classList.remove("over"));
  zone.addEventListener("drop", (event) => {
    event.preventDefault();
    zone.classList.remove("over");
    choose([...event.dataTransfer.files]);
  });
  return zone;
}

/// What is wrong with a file, at the lines where it is.
async function explained(error, files) {
  const { file: name, line, column } = error instanceof Problem ? error.document : {};
  const file = files.find((file) => file.name === name) ?? (files.length === 1 ? files[0] : undefined);
  const where = [name, line && `line ${line}`, column && `column ${column}`].filter(Boolean).join(", ");
  return h("div", { class: "refused" },
    h("h2", {}, "Nothing was stored"),
    h("p", {}, error.message),
    file && line && await excerpt(file, line, where),
    h("p", { class: "small" }, "Correct the file and drop it again. ",
      h("a", { href: "/assets/example.csv", download: "sticky_axis.csv" }, "The example"), " shows the form of a harmonic table."));
}

async function excerpt(file, line, where) {
  const lines = (await file.text()).split(/\r\n|\n|\r/);
  const first = Math.max(0, line - 1 - AROUND);
  const rows = lines.slice(first, line + AROUND).map((text, i) => {
    const number = first + i + 1;
    const wrong = number === line;
    return h("span", { class: wrong ? "line wrong" : "line", "aria-current": wrong && "true" },
      h("b", {}, String(number).padStart(String(line + AROUND).length)), text.slice(0, 300) || " ");
  });
  return h("div", { class: "excerpt" },
    h("pre", { tabindex: "0", "aria-label": `The file around ${where}` }, rows));
}

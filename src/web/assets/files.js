// Files as one measurement, with what is given beside them.

import { json } from "./api.js";

/// Files, and what is given beside them, as a form.
export function body(files, given = {}) {
  const form = new FormData();
  for (const file of files) {
    const type = file.name.endsWith(".json") ? "application/json" : "text/csv";
    form.append("file", new File([file], file.name, { type }));
  }
  for (const [key, value] of Object.entries(given)) form.append(key, value);
  return form;
}

/// Sends files as one measurement.
export function upload(files, given) {
  const name = files.length === 1 ? files[0].name.replace(/\.(csv|json|txt|tsv|dat|xlsx|uff|unv|58|mat|tdms)$/, "") : "";
  return json(`/v1/measurements${name && `?name=${encodeURIComponent(name)}`}`, { method: "POST", body: body(files, given) });
}

// Files of a measurement read again: in other units, as another kind of response.

import { h } from "./dom.js";
import { json, send } from "./api.js";
import { previewForm, stored } from "./preview.js";

/// A button, and the form that it opens; `done` is called once the files are read anew.
export function rereader(measurement, done) {
  const node = h("section", { hidden: true, class: "again", "aria-label": "Read it again" });
  const close = () => {
    node.hidden = true;
    button.focus();
  };
  const button = h("button", { onclick: async () => {
    node.hidden = false;
    node.replaceChildren(h("p", { role: "status" }, "Reading …"));
    try {
      const [seen, { items: jobs }] = await Promise.all([
        send(`/v1/measurements/${measurement.id}/preview`, {}),
        json(`/v1/jobs?measurement_id=${measurement.id}&limit=1`),
      ]);
      node.replaceChildren(...(jobs.length > 0 ? refused(close) : [previewForm(stored(measurement), seen, done, close)]));
      node.querySelector("button, input, select").focus();
    } catch (error) {
      node.replaceChildren(h("p", { class: "wrong", role: "alert" }, error.message));
    }
  } }, "Read it again …");
  return { node, button };
}

/// Why it cannot be, and what can be done.
function refused(close) {
  return [
    h("p", {}, "This measurement has results that depend on how the file was read. ",
      "Delete its jobs first, or upload the file again with “Show how it is read before it is stored” ticked."),
    h("p", { class: "actions" }, h("button", { onclick: close }, "Close")),
  ];
}

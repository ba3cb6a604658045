// A result tried on another measurement: both models simulated on it, nothing fitted.

import { announce, h, row, table } from "./dom.js";
import { json, send } from "./api.js";
import { inList, named, number, percent, sentence } from "./format.js";
import { ofVerdict } from "./status.js";

/// A section that tries the result of a job on a measurement of the reader's choice.
export async function tried(job, signal) {
  const { items } = await json("/v1/measurements?limit=200", { signal });
  const others = nearestFirst(items, job.measurement_id);
  const body = h("div", { role: "status" });
  const form = h("form", { class: "fields" },
    h("label", {}, h("span", {}, "Measurement"),
      h("select", { name: "measurement_id" }, others.map((item) => h("option", { value: item.id }, inList(item))))),
    h("p", { class: "actions" }, h("button", {}, "Test")));
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const button = form.querySelector("button");
    button.disabled = true;
    body.replaceChildren(h("p", { class: "small" }, "Simulating …"));
    try {
      const request = { job_id: job.id, measurement_id: form.elements.measurement_id.value };
      const validation = await send("/v1/validations", request, { signal });
      body.replaceChildren(...told(validation));
    } catch (error) {
      if (!signal.aborted) body.replaceChildren(h("p", { class: "wrong" }, error.message));
    } finally {
      button.disabled = false;
    }
  });
  return {
    id: "tried",
    title: "Test on another measurement",
    short: "does it predict data that no fit has seen?",
    body: [
      h("p", {}, "Simulates this result on another measurement of the same axis, without fitting again."),
      others.length > 0 ? [form, body]
        : h("p", {}, "There is no other measurement yet. ", h("a", { href: "/" }, "Upload one"), ", then come back."),
    ],
  };
}

// Of the same axis first, then of the same machine, each as listed.
function nearestFirst(items, id) {
  const fitted = items.find((item) => item.id === id);
  const shares = (item, key) => Boolean(fitted?.[key]) && item[key] === fitted[key];
  const distance = (item) => (shares(item, "machine") ? 0 : 2) + (shares(item, "axis") ? 0 : 1);
  return items.filter((item) => item.id !== id).sort((a, b) => distance(a) - distance(b));
}

function told({ models, causes, verdict, remarks, response_unit: unit }) {
  const model = (name, { nrmse, rms, chi2_per_dof: chi2, components }) => row([
    name,
    ...[percent(nrmse), number(rms, 3), number(chi2, 3), components].map((content) => ({ content, class: "n" })),
  ]);
  const titles = ["Residual, % of the response", `rms${unit ? `, ${unit}` : ""}`, "χ² per value", "Values"];
  const ids = causes.map(({ effect }) => effect);
  const extended = models.extended && model(`With ${named(ids.join(" "))}`, models.extended);
  const plain = (text) => sentence(ids.reduce((said, id) => said.replaceAll(id, named(id)), text));
  const [first, ...rest] = remarks;
  if (first) announce(plain(first));
  return [
    first && h("p", {}, plain(first)),
    table("", ["Model", ...titles.map((text) => ({ text, class: "n" }))], [model("Base model", models.base), extended].filter(Boolean)),
    verdict && h("p", {}, "Verdict: ", ofVerdict(verdict)),
    rest.length > 0 && h("ul", {}, rest.map((remark) => h("li", {}, plain(remark)))),
  ].filter(Boolean);
}

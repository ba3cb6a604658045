// Experiments planned before anything is measured: the question, and what answers it.

import { announce, h } from "./dom.js";
import { json, send } from "./api.js";
import { kind, named, parameter, subject, time } from "./format.js";
import { clear, input, refuse, select, typed } from "./form.js";
import { planned } from "./plan.js";

const RAD_S = 2 * Math.PI;
/// Members of an actuator by its order.
const ACTUATOR = [[], ["actuator_pole"], ["natural_frequency", "damping_ratio"]];
const AXIS = ["pole", "constant", "fc_plus", "fc_minus"];
/// Members of the options, and by how much a value of the form is multiplied.
const OPTIONS = {
  largest_magnitude: 1, lowest_rad_s: RAD_S, highest_rad_s: RAD_S, largest_velocity: 1, largest_travel: 1,
  noise_std: 1, noise_share: 0.01, uncertainty: 0.01, seed: 1,
};

export async function show({ query, signal }) {
  const { rows: results } = await json("/v1/results.json", { signal });
  /// Units of input and velocity, where a result says them.
  let units = {};
  let asking = new AbortController();
  const field = (name, title, attributes = {}, hint = "") => input(name, title, { inputmode: "decimal", value: query.get(name), ...attributes }, hint);
  const button = h("button", { class: "primary" }, "Plan it");
  const answer = h("div", { role: "status" });
  const given = h("p", { class: "small", role: "status" });
  const form = h("form", { class: "plan", novalidate: true, "aria-label": "Axis and limits" },
    h("div", { class: "fields" },
      results.length > 0 && select("job", "Start from a result", [["", "no result: enter values"], ...results.map((result) => [result.job_id, name(result)])],
        query.get("job") ?? "", "Fills in the values below. Change any that you know better."),
      field("pole", "Pole of the mechanics, rad/s", { placeholder: "−10" }, "Negative: −1 ÷ time constant."),
      field("constant", "Constant", { placeholder: "10" }, "Acceleration per unit of the input."),
      field("fc_plus", "Friction forwards", { placeholder: "0.5" }, "In units of the input."),
      field("fc_minus", "Friction backwards", { placeholder: "same as forwards" }, "In units of the input."),
      select("order", "Actuator", [[0, "none"], [1, "first order"], [2, "second order"]], query.get("order") ?? 0),
      field("actuator_pole", "Pole of the actuator, rad/s", { placeholder: "−300" }),
      field("natural_frequency", "Natural frequency, rad/s", { placeholder: "300" }),
      field("damping_ratio", "Damping ratio", { placeholder: "0.7" }),
      field("budget_s", "Time for all experiments, s", { placeholder: "120" }, "Including the time to settle.")),
    given,
    h("details", { open: Object.keys(OPTIONS).some((member) => query.has(member)) }, h("summary", {}, "More: limits and noise"),
      h("div", { class: "fields" },
        field("largest_magnitude", "Largest magnitude", { placeholder: "8 times the friction" }, "In units of the input."),
        field("lowest_rad_s", "Lowest frequency, Hz", { placeholder: "0.15 of the pole's" }),
        field("highest_rad_s", "Highest frequency, Hz", { placeholder: "10 times the pole's" }),
        field("largest_velocity", "Largest velocity", { placeholder: "any" }),
        field("largest_travel", "Largest travel to either side", { placeholder: "any" }, "Units of the velocity times second."),
        field("noise_std", "Noise of a harmonic", { placeholder: "a thousandth of the response" },
          "Standard deviation after one second of measuring, units of the velocity."),
        field("noise_share", "Noise in proportion, %", { placeholder: "0" }, "Of the size of a harmonic, in each repeat."),
        field("uncertainty", "The axis is known to ±, %", { placeholder: "25" }),
        field("seed", "Seed", { inputmode: "numeric", placeholder: "1" }, "The same seed gives the same plan."))),
    h("p", { class: "actions" }, button),
    h("p", { class: "wrong", role: "alert" }));
  const value = (name) => form.elements[name].value.trim().replace("−", "-");

  function adapt() {
    for (const member of ACTUATOR.flat()) {
      form.elements[member].closest("label").hidden = !ACTUATOR[value("order")].includes(member);
    }
  }

  /// Fills in the axis that a job found.
  async function fill(job) {
    given.textContent = "";
    units = {};
    if (!job) return;
    const result = await json(`/v1/jobs/${encodeURIComponent(job)}/result`, { signal });
    const { parameters } = result.base ?? result;
    const known = (member) => parameters[member]?.value;
    units = unitsOf(parameters);
    const order = known("natural_frequency") != null ? 2 : known("actuator_pole") != null ? 1 : 0;
    form.elements.order.value = order;
    for (const member of [...AXIS, ...ACTUATOR[order]]) {
      const found = known(member);
      form.elements[member].value = found == null ? "" : Number(found.toPrecision(5));
    }
    const unknown = AXIS.filter((member) => known(member) == null);
    if (unknown.length > 0) given.textContent = `Its measurement does not determine ${unknown.map(parameter).join(" and ")}: enter a value.`;
  }

  /// What the form asks for; a field that is needed and empty is refused.
  function question() {
    const need = [...AXIS.slice(0, 3), ...ACTUATOR[value("order")], "budget_s"];
    const empty = need.find((member) => value(member) === "");
    if (empty) throw Object.assign(new Error(`${title(form.elements[empty])}: enter a value${form.elements[empty].placeholder ? `, for example ${form.elements[empty].placeholder}` : ""}.`), { field: empty });
    const axis = Object.fromEntries([...AXIS, ...ACTUATOR[value("order")]].map((member) => [member, typed(value(member))]));
    axis.fc_minus ??= axis.fc_plus;
    const options = Object.fromEntries(Object.entries(OPTIONS).map(([member, factor]) => {
      const number = typed(value(member));
      return [member, typeof number === "number" ? number * factor : number];
    }));
    return { axis, budget_s: typed(value("budget_s")), options };
  }

  /// The address says what was asked, so that it is asked again after the page is loaded again.
  function remember() {
    const said = [...form.elements].filter((one) => one.name && one.value.trim() && !(one.name === "order" && one.value === "0"));
    history.replaceState(null, "", `/plans?${new URLSearchParams(said.map((one) => [one.name, one.value.trim()]))}`);
  }

  form.addEventListener("change", async ({ target }) => {
    if (target.name === "job") await fill(target.value).catch((error) => refuse(form, error));
    adapt();
  });
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    clear(form);
    asking.abort();
    asking = new AbortController();
    const { signal: latest } = asking;
    signal.addEventListener("abort", () => asking.abort(), { once: true });
    try {
      const asked = question();
      remember();
      button.disabled = true;
      answer.replaceChildren(waiting());
      const plan = await send("/v1/plans", asked, { signal: latest });
      answer.replaceChildren(...planned(plan, asked, units, latest));
      announce("The experiments are planned.");
      answer.scrollIntoView({ block: "start" });
    } catch (error) {
      if (signal.aborted) return;
      answer.replaceChildren();
      refuse(form, error);
    } finally {
      button.disabled = false;
    }
  });

  if (query.get("job") && !query.has("pole")) await fill(query.get("job"));
  adapt();
  const node = h("div", { class: "wide" },
    h("p", { class: "trail" }, h("a", { href: "/" }, "Overview")),
    h("h1", {}, "Plan experiments"),
    h("p", {}, "From a rough idea of the axis: where to measure within a given time, so that as many effects as possible can be identified."),
    form, answer);
  return { title: "Plan experiments", node };
}

/// Units of input and velocity, as the parameters of a result have them: a DC gain is in `(rad/s)/A`.
function unitsOf({ fc_plus, dc_gain }) {
  const input = fc_plus?.unit ?? "";
  const per = `/${input}`;
  return { input, response: input && dc_gain?.unit.endsWith(per) ? dc_gain.unit.slice(0, -per.length) : "" };
}

/// How long it is computed, while it is.
function waiting() {
  return h("section", { class: "live", "aria-label": "Progress" },
    h("p", { class: "lead" }, "Planning …"), h("progress", { "aria-label": "Progress" }),
    h("p", { class: "small" }, "This simulates the axis and several similar ones at many points. It takes from a few seconds to a minute."));
}

function title(field) {
  return field.closest("label").firstElementChild.textContent;
}

/// A result where one is chosen among others.
function name(result) {
  return [`${kind(result)}: ${subject(result)}`, named(result.causes), time(result.at)].filter(Boolean).join(", ");
}

// The form that starts an identification or a diagnosis.

import { h } from "./dom.js";
import { json, send } from "./api.js";
import { clear, input, refuse, select, typed } from "./form.js";
import { inList } from "./format.js";

/// A form for jobs on a measurement; `earlier` is a job that is to be started again,
/// `started` gets the new one.
export async function startForm(measurement, started, { earlier, signal } = {}) {
  const [document, { items }] = await Promise.all([
    json("/openapi.json", { signal }),
    json("/v1/measurements?limit=200", { signal }),
  ]);
  const schemas = document.components.schemas;
  const others = items.filter((item) => item.id !== measurement.id);
  const options = earlier?.options ?? {};
  const kind = earlier?.kind ?? "diagnose";

  const radio = (value, title, text) => h("label", { class: "choice" },
    h("input", { type: "radio", name: "kind", value, checked: value === kind }),
    h("span", {}, h("strong", {}, title), h("span", { class: "small" }, text)));
  const order = earlier?.plant?.actuator_order;
  const form = h("form", { class: "start", novalidate: true },
    h("fieldset", {},
      h("legend", {}, "What to find"),
      radio("diagnose", "Diagnosis", "Where the simulation is wrong, which physical effect is missing, and how much adding it helps."),
      radio("identify", "Identification", "Transfer function and dry friction, without looking for a cause.")),
    // Before what hardly anybody changes: it is seen without scrolling.
    h("p", { class: "actions" }, h("button", { class: "primary" }, "Start")),
    h("p", { class: "wrong", role: "alert" }),
    h("div", { class: "fields" },
      select("plant.actuator_order", "Actuator", [["", "order chosen from the data"], [0, "none (no lag)"], [1, "first order"], [2, "second order"]], order ?? ""),
      select("method", "Method", schemas.Method.enum.map((name) => [name, name]), earlier?.method),
      input("noise_std", "Noise, standard deviation", { inputmode: "decimal", placeholder: "from the data", value: options.noise_std },
        "In units of the response; only if the file does not state it."),
      input("seed", "Seed", { inputmode: "numeric", value: options.seed ?? 1 }, "A whole number; the same seed gives the same result."),
      select("weights", "Weight of each harmonic", [["noise", "by its noise"], ["response", "the same for all"]], options.weights),
      select("priority", "Priority", [["normal", "normal"], ["high", "high: before your other jobs"], ["low", "low: after your other jobs"]], earlier?.priority ?? "normal"),
      select("validation_measurement_id", "Test on", [["", "parts of this measurement"],
        ...others.map((item) => [item.id, inList(item)])],
        earlier?.validation_measurement_id ?? "", "A second measurement of the same axis; for a diagnosis.")));

  const chosen = () => form.elements.kind.value;
  const adapt = () => {
    const field = form.elements.validation_measurement_id;
    field.disabled = chosen() !== "diagnose";
    field.closest("label").classList.toggle("off", field.disabled);
  };
  form.addEventListener("change", adapt);
  adapt();
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const button = form.querySelector(".primary");
    button.disabled = true;
    clear(form);
    try {
      started(await send("/v1/jobs", request(form, measurement.id, options)));
    } catch (error) {
      refuse(form, error);
    } finally {
      button.disabled = false;
    }
  });
  return form;
}

/// What the form asks for.
function request(form, measurement_id, options) {
  const value = (name) => form.elements[name].value.trim();
  const diagnose = value("kind") === "diagnose";
  const order = value("plant.actuator_order");
  return {
    measurement_id,
    kind: value("kind"),
    plant: order === "" ? undefined : { actuator_order: Number(order) },
    method: value("method"),
    priority: value("priority"),
    validation_measurement_id: (diagnose && value("validation_measurement_id")) || undefined,
    options: { ...options, seed: typed(value("seed")), noise_std: typed(value("noise_std")), weights: value("weights") },
  };
}

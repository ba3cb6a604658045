// Fields of a form, and what the server refuses of them.

import { h } from "./dom.js";
import { Problem } from "./api.js";

/// A number as it was typed, with a decimal point or a decimal comma. What is none, or has a comma that may stand between
/// thousands, is sent as it is: the server says what it should be.
export function typed(text) {
  if (text === "") return undefined;
  const thousands = /^[+-]?[1-9]\d{0,2},\d{3}$/.test(text);
  const number = Number(thousands ? text : text.replace(",", "."));
  return Number.isNaN(number) ? text : number;
}

/// Takes away what was said of the last attempt.
export function clear(form) {
  form.querySelector(".wrong").textContent = "";
  for (const field of form.querySelectorAll("[aria-invalid]")) field.removeAttribute("aria-invalid");
}

/// Says what is wrong where it is wrong: at the member that the server names, or at the `field` that
/// an error of the page has.
export function refuse(form, error) {
  form.querySelector(".wrong").textContent = error.message;
  const member = error instanceof Problem ? error.document.member ?? "" : error.field ?? "";
  const field = [...form.elements].find((field) => field.name && (field.name === member || member.endsWith(`.${field.name}`)));
  field?.setAttribute("aria-invalid", "true");
  field?.focus();
}

function label(title, field, hint) {
  return h("label", {}, h("span", {}, title), field, hint && h("span", { class: "small" }, hint));
}

/// A choice with its title, a hint and its values.
export function select(name, title, values, chosen, hint) {
  return label(title, h("select", { name }, values.map(([value, text]) =>
    h("option", { value, selected: String(value) === String(chosen) }, text))), hint);
}

/// A field for a text with its title and a hint.
export function input(name, title, attributes, hint) {
  return label(title, h("input", { name, autocomplete: "off", ...attributes }), hint);
}

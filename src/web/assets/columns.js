// The columns of a table with its first rows: what each is, and in which unit.

import { h } from "./dom.js";

/// A table of the first rows with a choice of quantity and unit above each column. `names` says it
/// as `column_names`, once somebody has changed it.
export function columnsForm(table, { quantities, refusal }, file) {
  const known = new Map(quantities.map((quantity) => [quantity.key, quantity]));
  let touched = false;
  const columns = table.columns.map(({ name, quantity, unit, used_as }, place) => {
    const title = name || `column ${place + 1}`;
    // Where the file is understood, a column that is not used stays so.
    const chosen = (refusal || used_as) && quantity ? quantity : "";
    const select = h("select", { "aria-label": `What ${title} is` },
      h("option", { value: "" }, "not used"),
      quantities.map(({ key, title }) => h("option", { value: key, selected: key === chosen }, title)));
    const units = h("datalist", { id: `units-${place}` });
    const measure = h("input", { "aria-label": `Unit of ${title}`, list: units.id, value: unit, placeholder: "unit", autocomplete: "off", class: "unit" });
    const adapt = () => {
      const usual = known.get(select.value)?.units ?? [];
      units.replaceChildren(...usual.map((value) => h("option", { value })));
      measure.hidden = select.value === "" || (usual.length === 0 && !OPEN.includes(select.value));
    };
    adapt();
    for (const field of [select, measure]) field.addEventListener("change", () => {
      touched = true;
      adapt();
    });
    return { title, used_as, select, measure, units };
  });
  const choices = columns.map(({ used_as, select, measure, units }) =>
    h("td", { class: refusal && !used_as && !select.value && "unknown" }, select, measure, units));
  const node = h("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": `The first rows of ${file}` },
    h("table", { class: "rows" },
      h("caption", {}, about(table, file)),
      h("thead", {},
        h("tr", {}, columns.map(({ title }) => h("th", { scope: "col" }, title))),
        h("tr", { class: "asked" }, choices)),
      h("tbody", {}, table.rows.map((cells) => h("tr", {}, columns.map((_, place) => h("td", {}, cells[place] ?? "")))))));
  return {
    node,
    names: () => touched && columns.map(({ select, measure }) => written(known.get(select.value), measure)).join("; "),
  };
}

/// Quantities whose unit may be any.
const OPEN = ["input", "response"];

/// A column as `column_names` has it.
function written(quantity, measure) {
  const unit = measure.hidden ? "" : measure.value.trim();
  if (!quantity) return "";
  return unit ? `${quantity.name} (${unit})` : quantity.name;
}

/// How a text is read, in words.
function about({ delimiter, decimal, line, preamble, rows }, file) {
  const parts = [
    `The first ${rows.length} rows of ${file}`,
    delimiter && `columns between ${delimiter}`,
    decimal && `a decimal ${decimal}`,
    line > 1 && preamble.length > 0 && `the table begins at line ${line}`,
  ];
  return `${parts.filter(Boolean).join("; ")}.`;
}

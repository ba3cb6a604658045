// Finding measurements and jobs among many.

import { h } from "./dom.js";
import { MEANING } from "./status.js";

/// How long somebody may pause while typing.
const PAUSE_MS = 250;

/// A form that narrows both lists; `changed` is called when it says something else. What it says is in
/// the address, so that a list can be handed on.
export function finder(query, changed) {
  const text = h("input", { name: "text", type: "search", value: query.get("text") ?? "", autocomplete: "off", placeholder: "name, machine, axis, label, file" });
  const verdict = h("select", { name: "verdict" }, h("option", { value: "" }, "any"),
    Object.entries(MEANING).map(([value, meaning]) => h("option", { value, selected: value === query.get("verdict") }, `${value}: ${meaning}`)));
  const day = (name) => h("input", { name, type: "date", value: query.get(name) ?? "" });
  const [since, until] = [day("since"), day("until")];
  const said = h("p", { class: "small", role: "status" });
  const label = (title, field) => h("label", {}, h("span", {}, title), field);
  const form = h("form", { role: "search", "aria-label": "Measurements and jobs", onsubmit: (event) => event.preventDefault() },
    h("div", { class: "fields" }, label("Find", text), label("Verdict", verdict), label("From", since), label("To", until)));
  const node = h("section", { class: "find" }, form, said);
  let waiting;

  form.addEventListener("input", () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      const all = given();
      history.replaceState(null, "", all.size > 0 ? `/?${all}` : "/");
      changed();
    }, PAUSE_MS);
  });

  function given() {
    const fields = [text, verdict, since, until].filter((field) => field.value.trim());
    return new URLSearchParams(fields.map((field) => [field.name, field.value.trim()]));
  }

  /// The query of a list; days are those of the reader's clock, the last one to its end.
  function of(limit, names) {
    const said = given();
    const list = new URLSearchParams({ limit });
    for (const name of names) {
      if (said.has(name)) list.set(name, said.get(name));
    }
    for (const [name, days] of [["since", 0], ["until", 1]]) {
      const begins = said.has(name) && new Date(`${said.get(name)}T00:00:00`);
      if (!begins || Number.isNaN(begins.getTime())) continue;
      begins.setDate(begins.getDate() + days);
      list.set(name, begins.toISOString());
    }
    return list;
  }

  return {
    node,
    jobs: (limit) => of(limit, ["text", "verdict"]),
    measurements: (limit) => of(limit, ["text"]),
    active: () => given().size > 0,
    /// Whether what is asked for is said of jobs alone.
    ofJobsAlone: () => verdict.value !== "",
    say: (any) => (said.textContent = any || given().size === 0 ? "" : "Nothing matches."),
  };
}

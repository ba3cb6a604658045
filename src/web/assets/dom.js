// Elements without a framework. Text is always set as text: what an upload says of
// itself never becomes markup.

/// An element with attributes (`onclick` and the like are listeners; false and null
/// leave an attribute out) and children (texts, elements, arrays of them).
export function h(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (value === true) element.setAttribute(key, "");
    else if (value !== false && value != null) element.setAttribute(key, value);
  }
  element.append(...children.flat(Infinity).filter((child) => child != null && child !== false));
  return element;
}

/// Says something to those who do not see it happen.
export function announce(text) {
  document.getElementById("announcements").textContent = text;
}

/// A table; `rows` are arrays of cells, the first of which says what the row is of.
/// Of kind `list`, its rows stand below each other where there is no room.
export function table(caption, titles, rows, kind) {
  return h("div", { class: "scroll" },
    h("table", { class: kind },
      caption && h("caption", {}, caption),
      h("thead", {}, h("tr", {}, titles.map((title) => h("th", { scope: "col", class: title.class }, title.text ?? title)))),
      h("tbody", {}, rows)));
}

/// A row of a table.
export function row(cells, attributes = {}) {
  return h("tr", attributes, cells.map((cell, place) => {
    const { class: kind, content } = cell?.content !== undefined ? cell : { content: cell };
    return place === 0 ? h("th", { scope: "row", class: kind }, content) : h("td", { class: kind }, content);
  }));
}

/// Shows the rows of a list under their keys. A row stays in place while its item
/// stays the same, so that whoever stands on it with the keyboard is not thrown off.
export function keyed(body, items, key, render) {
  const before = new Map([...body.children].map((element) => [element.dataset.key, element]));
  const focused = body.contains(document.activeElement) ? document.activeElement : null;
  const place = focused && { key: focused.closest("[data-key]")?.dataset.key, index: stops(focused).indexOf(focused) };
  const rows = items.map((item) => {
    const [id, state] = [key(item), JSON.stringify(item)];
    const known = before.get(id);
    if (known?.state === state) return known;
    const made = render(item);
    made.dataset.key = id;
    made.state = state;
    return made;
  });
  const same = rows.length === body.children.length && rows.every((element, i) => element === body.children[i]);
  if (same) return;
  body.replaceChildren(...rows);
  if (place && !body.contains(document.activeElement)) {
    const again = rows.find((element) => element.dataset.key === place.key);
    again?.querySelectorAll(STOPS)[place.index]?.focus();
  }
}

const STOPS = "a[href], button, input, select";

function stops(element) {
  return [...(element.closest("[data-key]")?.querySelectorAll(STOPS) ?? [])];
}

/// Asks before something is done for good.
export function confirmed(question, action) {
  return new Promise((resolve) => {
    const dialog = h("dialog", { "aria-label": question, onclose: () => {
      resolve(dialog.returnValue === "yes");
      dialog.remove();
    } },
      h("form", { method: "dialog" },
        h("p", {}, question),
        h("p", { class: "actions" },
          h("button", { value: "yes", class: "danger" }, action),
          h("button", { value: "no", autofocus: true }, "Go back"))));
    document.body.append(dialog);
    dialog.showModal();
  });
}

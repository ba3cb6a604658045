// A small layer of interaction over the figures as the server draws them: a cursor with values,
// zoom, pan, traces on and off. It reads what the figures say of themselves (`data-panel` and the
// like); without it they are the same pictures.

import { Panel, make, round } from "./plot-panel.js";
import { tools } from "./plot-tools.js";

/// Every figure of the page: those with the same horizontal axis move together.
const figures = new Set();

/// Makes a figure one to be read off. `say` tells those who do not see it what the cursor is on;
/// `style` gives the style sheet of the figure where it is not in it. Whether there is anything to read off.
export function interactive(svg, figure, say, style = () => "") {
  const panels = [...svg.querySelectorAll("[data-panel]")].map((grid, index) => new Panel(svg, grid, index));
  if (panels.length === 0) return false;
  const overlay = make("g", { "pointer-events": "none" });
  svg.append(overlay);
  svg.setAttribute("role", "group");
  svg.setAttribute("tabindex", "0");
  svg.style.touchAction = "pan-x pan-y";
  const self = { svg, panels, draw, clear };
  const hidden = new Set();
  let cursor = null;

  function draw() {
    for (const panel of panels) panel.draw();
    const isHome = panels.every((panel) => panel.x.isHome && panel.y.isHome);
    svg.style.touchAction = isHome ? "pan-x pan-y" : "none";
    if (cursor) mark();
  }

  function clear() {
    cursor = null;
    overlay.replaceChildren();
  }

  /// Draws after a change of a panel's axes, and moves every figure that shares the horizontal one.
  function changed({ x }) {
    for (const other of figures) {
      if (!other.svg.isConnected) figures.delete(other);
      const same = other.panels.filter((panel) => panel.x.name === x.name && panel.x.isLog === x.isLog);
      for (const panel of same) [panel.x.low, panel.x.high] = [x.low, x.high];
      if (same.length > 0) other.draw();
    }
  }

  function reset() {
    for (const other of figures) {
      for (const { x, y } of other.panels) [[x.low, x.high], [y.low, y.high]] = [x.home, y.home];
      other.clear();
      other.draw();
    }
  }

  function at(event) {
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    return [point.x, point.y];
  }

  function nearest(panel, [px, py]) {
    let best = null;
    for (const trace of panel.visible()) {
      for (const point of trace.points) {
        const [atX, atY, , reachX = 0, reachY = 0] = point;
        const [x, y] = [panel.x.moved(atX), panel.y.moved(atY)];
        const beside = (at, cursor, side) => Math.max(0, Math.abs(at - cursor) - Math.abs(side - at));
        const distance = beside(x, px, panel.x.moved(atX + reachX)) ** 2 + beside(y, py, panel.y.moved(atY + reachY)) ** 2;
        if ((reachX > 0 || panel.holds([x, y])) && distance < (best?.distance ?? Infinity)) best = { panel, trace, point, distance };
      }
    }
    return best;
  }

  /// Puts the cursor on a point: a line in every panel with the same axis, a ring, and the values
  /// of its series in the panels above and below each other.
  function mark() {
    const { panel, trace, point } = cursor;
    const linked = panels.filter((other) => other.x.name === panel.x.name);
    const place = panel.x.coordinate(panel.x.moved(point[0]));
    const parts = linked.map(({ x, top, bottom }) => {
      const px = round(x.from + ((place - x.low) / (x.high - x.low)) * (x.to - x.from));
      return make("path", { class: "frame", d: `M${px} ${top}L${px} ${bottom}` });
    });
    // What reaches to the sides may have its middle beyond them.
    const [x, y] = [Math.max(panel.left, Math.min(panel.right, panel.x.moved(point[0]))), panel.y.moved(point[1])];
    parts.push(make("circle", { class: "ink", cx: round(x), cy: round(y), r: 5.5 }));
    const unit = panel.x.name.match(/\(([^–)]*)\)/)?.[1] ?? "";
    const rows = [];
    if (point[2]) {
      const [of, values] = point[2].split(": ");
      rows.push([of, ""], ...values.split(", ").map((value) => [`  ${value}`, ""]));
    } else {
      rows.push([[trace.series, `${panel.x.written(point[0])} ${unit}`].filter(Boolean).join(", "), ""]);
    }
    for (const other of point[2] ? [] : linked.filter(({ left }) => left === panel.left)) {
      const same = other.visible().filter(({ series }) => series === trace.series);
      const found = same.map(({ name, points }) => {
        const hit = points.filter(([px]) => Math.abs(px - point[0]) < 0.7);
        return hit.length > 0 && [`  ${name}`, other.y.written(hit[0][1])];
      }).filter(Boolean);
      if (found.length > 0) rows.push([other.y.name.replace(/ re 1 .*\)/, ")"), ""], ...found);
    }
    const width = 12 + 6.2 * Math.max(...rows.map(([name, value]) => name.length + value.length + 2));
    const left = x + 14 + width < 796 ? x + 14 : Math.max(4, x - 14 - width);
    const top = Math.max(4, Math.min(y - 20, svg.viewBox.baseVal.height - 15 * rows.length - 14));
    parts.push(make("rect", { class: "bg", x: left, y: top, width, height: 15 * rows.length + 10 }));
    parts.push(make("rect", { class: "frame", x: left, y: top, width, height: 15 * rows.length + 10 }));
    rows.forEach(([name, value], i) => {
      const line = { y: top + 17 + 15 * i, "font-size": 11, class: i === 0 ? "b" : name.startsWith(" ") ? "" : "m" };
      parts.push(make("text", { ...line, x: left + (name.startsWith(" ") ? 14 : 7) }, name.trim()));
      parts.push(make("text", { ...line, x: left + width - 7, "text-anchor": "end" }, value));
    });
    overlay.replaceChildren(...parts);
    return rows.map(([name, value]) => [name.trim(), value].filter(Boolean).join(" ")).join("; ");
  }

  function point(place) {
    const panel = panels.find((candidate) => candidate.holds(place));
    cursor = panel ? nearest(panel, place) : null;
    cursor ? mark() : overlay.replaceChildren();
  }

  /// To the next point of the series, or to another series at this place: after the last one of a
  /// panel follows the first one of the next panel.
  function step(along, across) {
    const all = panels.flatMap((panel) => panel.visible().map((trace) => ({ panel, trace }))).filter(({ trace }) => trace.points.length > 0);
    if (all.length === 0) return;
    const now = Math.max(0, all.findIndex(({ trace }) => trace === cursor?.trace));
    const { panel, trace } = all[(now + across + all.length) % all.length];
    const sorted = [...trace.points].sort((a, b) => a[0] - b[0]);
    const here = cursor ? sorted.reduce((best, [x], i) => (Math.abs(x - cursor.point[0]) < Math.abs(sorted[best][0] - cursor.point[0]) ? i : best), 0) : -along;
    const next = sorted[Math.max(0, Math.min(sorted.length - 1, here + along))];
    cursor = { panel, trace, point: next };
    say(mark());
  }

  const fingers = new Map();
  svg.addEventListener("pointerdown", (event) => {
    if (event.target.closest("[data-toggle]")) return;
    const place = at(event);
    svg.focus({ preventScroll: true, focusVisible: false });
    fingers.set(event.pointerId, place);
    if (event.pointerType === "mouse") svg.setPointerCapture(event.pointerId);
    else point(place);
  });
  svg.addEventListener("pointermove", (event) => {
    const [place, before] = [at(event), fingers.get(event.pointerId)];
    if (!before) return event.pointerType === "mouse" && point(place);
    const panel = panels.find((candidate) => candidate.holds(before)) ?? panels[0];
    if (fingers.size === 2) {
      const [, other] = [...fingers].find(([id]) => id !== event.pointerId);
      const apart = ([x, y]) => Math.hypot(x - other[0], y - other[1]) || 1;
      const factor = apart(place) / apart(before);
      panel.x.zoom(factor, other[0]);
      panel.y.zoom(factor, other[1]);
    } else {
      if (panel.x.isHome && panel.y.isHome) return;
      panel.x.pan(place[0] - before[0]);
      panel.y.pan(place[1] - before[1]);
    }
    fingers.set(event.pointerId, place);
    changed(panel);
  });
  for (const name of ["pointerup", "pointercancel"]) svg.addEventListener(name, ({ pointerId }) => fingers.delete(pointerId));
  svg.addEventListener("pointerleave", ({ pointerType }) => pointerType === "mouse" && clear());
  svg.addEventListener("dblclick", reset);
  svg.addEventListener("wheel", (event) => {
    const place = at(event);
    const panel = panels.find((candidate) => candidate.holds(place));
    // The page scrolls where nobody has turned to the figure.
    const isMeant = event.ctrlKey || event.metaKey || svg.getRootNode().activeElement === svg;
    if (!panel || !isMeant) return;
    event.preventDefault();
    const factor = Math.exp(-0.0018 * event.deltaY * (event.deltaMode === 1 ? 16 : 1));
    if (!event.shiftKey) panel.x.zoom(factor, place[0]);
    panel.y.zoom(factor, place[1]);
    changed(panel);
  }, { passive: false });
  svg.addEventListener("keydown", (event) => {
    if (event.target !== svg || event.ctrlKey || event.metaKey || event.altKey) return;
    const panel = cursor?.panel ?? panels[0];
    const middle = cursor
      ? [panel.x.moved(cursor.point[0]), panel.y.moved(cursor.point[1])]
      : [(panel.left + panel.right) / 2, (panel.top + panel.bottom) / 2];
    const zoom = (factor) => () => (panel.x.zoom(factor, middle[0]), panel.y.zoom(factor, middle[1]), changed(panel));
    const pan = (x, y) => () => (panel.x.pan(x), panel.y.pan(y), changed(panel));
    const [plain, shifted] = [
      { ArrowRight: () => step(1, 0), ArrowLeft: () => step(-1, 0), ArrowUp: () => step(0, -1), ArrowDown: () => step(0, 1) },
      { ArrowRight: pan(-40, 0), ArrowLeft: pan(40, 0), ArrowUp: pan(0, 40), ArrowDown: pan(0, -40) },
    ];
    const always = { "+": zoom(1.4), "=": zoom(1.4), "-": zoom(1 / 1.4), 0: reset, Escape: clear };
    const action = (event.shiftKey ? shifted : plain)[event.key] ?? always[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });

  for (const entry of svg.querySelectorAll("[data-toggle]")) {
    for (const [name, value] of [["role", "button"], ["tabindex", "0"], ["aria-pressed", "true"], ["pointer-events", "bounding-box"]]) entry.setAttribute(name, value);
    entry.setAttribute("aria-label", entry.textContent);
    entry.style.cursor = "pointer";
    const toggle = () => {
      const { toggle: key } = entry.dataset;
      hidden.delete(key) || hidden.add(key);
      entry.setAttribute("aria-pressed", String(!hidden.has(key)));
      entry.style.opacity = hidden.has(key) ? 0.4 : 1;
      for (const group of svg.querySelectorAll("[data-keys]")) {
        group.style.display = group.dataset.keys.split(" ").some((name) => hidden.has(name)) ? "none" : "";
      }
      clear();
    };
    entry.addEventListener("click", toggle);
    entry.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      toggle();
    });
  }
  figures.add(self);
  tools(svg, overlay, figure, reset, style);
  return true;
}

// A panel of a figure: its axes, its grid, and the shapes that move with them.

import { Axis } from "./plot-axis.js";

const SVG = "http://www.w3.org/2000/svg";

/// An element of a figure.
export function make(name, attributes = {}, text = "") {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.textContent = text;
  return element;
}

/// A pair of axes, its grid, and what moves with it.
export class Panel {
  constructor(svg, grid, index) {
    [this.left, this.top, this.right, this.bottom] = grid.dataset.panel.split(" ").map(Number);
    this.x = new Axis(grid.dataset.x, grid.dataset.xName, "x");
    this.y = new Axis(grid.dataset.y, grid.dataset.yName, "y");
    this.numbered = grid.dataset.numbered;
    this.grid = grid;
    this.drawn = [...grid.childNodes];
    this.groups = [...svg.querySelectorAll(`[data-in="${grid.dataset.panel}"]`)];
    this.shapes = this.groups.flatMap((group) => [...group.querySelectorAll("path, circle, rect, text")].map(shape));
    this.traces = this.groups.filter((group) => group.dataset.name).map((group) => ({ group, points: points(group), ...group.dataset }));
    const { left, top, right, bottom } = this;
    const clip = make("clipPath", { id: `${svg.id}-panel-${index}` });
    clip.append(make("rect", { x: left, y: top, width: right - left, height: bottom - top }));
    svg.append(clip);
    this.clip = `url(#${clip.id})`;
  }

  holds([x, y]) {
    return x >= this.left && x <= this.right && y >= this.top && y <= this.bottom;
  }

  visible() {
    return this.traces.filter(({ group }) => group.style.display !== "none");
  }

  draw() {
    const [x, y] = [(px) => round(this.x.moved(px)), (px) => round(this.y.moved(px))];
    for (const move of this.shapes) move(x, y);
    for (const group of this.groups) group.setAttribute("clip-path", this.clip);
    if (this.x.isHome && this.y.isHome) return this.grid.replaceChildren(...this.drawn);
    const { left, top, right, bottom } = this;
    const line = (d) => make("path", { class: "grid", d });
    const label = (x, y, anchor, text) => make("text", { class: "m", x, y, "font-size": 11, "text-anchor": anchor }, text);
    const [across, up] = [this.x.ticks(), this.y.ticks()];
    this.grid.replaceChildren(
      ...across.map(({ px }) => line(`M${px} ${top}L${px} ${bottom}`)),
      ...up.map(({ px }) => line(`M${left} ${px}L${right} ${px}`)),
      ...(this.numbered.includes("x") ? across.map(({ px, label: text }) => label(px, bottom + 16, "middle", text)) : []),
      ...(this.numbered.includes("y") ? up.map(({ px, label: text }) => label(left - 7, px + 4, "end", text)) : []));
  }
}

/// A coordinate with a tenth of a pixel.
export function round(px) {
  return Math.round(10 * Math.max(-1e5, Math.min(1e5, px))) / 10;
}

/// How a shape moves with the axes: markers keep their size.
function shape(element) {
  const number = (name) => Number(element.getAttribute(name));
  if (element.tagName === "circle" || element.tagName === "text") {
    const [nx, ny] = element.tagName === "circle" ? ["cx", "cy"] : ["x", "y"];
    const [px, py] = [number(nx), number(ny)];
    return (x, y) => (element.setAttribute(nx, x(px)), element.setAttribute(ny, y(py)));
  }
  if (element.tagName === "rect") {
    const [px, py, width, height] = ["x", "y", "width", "height"].map(number);
    if (element.classList.contains("badge")) {
      return (x, y) => (element.setAttribute("x", x(px + width / 2) - width / 2), element.setAttribute("y", y(py + height / 2) - height / 2));
    }
    return (x, y) => {
      const [x1, x2, y1, y2] = [x(px), x(px + width), y(py), y(py + height)];
      for (const [name, value] of [["x", x1], ["y", y1], ["width", x2 - x1], ["height", y2 - y1]]) element.setAttribute(name, value);
    };
  }
  const place = element.getAttribute("transform")?.match(/-?[\d.]+/g).map(Number);
  if (place) return (x, y) => element.setAttribute("transform", `translate(${x(place[0])} ${y(place[1])})`);
  const steps = [...element.getAttribute("d").matchAll(/([ML])(\S+) ([^ML]+)/g)].map(([, pen, px, py]) => [pen, Number(px), Number(py)]);
  return (x, y) => element.setAttribute("d", steps.map(([pen, px, py]) => `${pen}${x(px)} ${y(py)}`).join(""));
}

/// Points of a trace, as it was drawn: where each is, what it says in the place of its coordinates,
/// and how far it reaches to the sides.
function points(group) {
  return [...group.querySelectorAll("path, circle, rect")].flatMap((element) => {
    const numbers = (...names) => names.map((name) => Number(element.getAttribute(name)));
    const hint = group.dataset.hints === undefined ? undefined : element.querySelector("title")?.textContent;
    if (element.tagName === "circle") return [[...numbers("cx", "cy"), hint]];
    if (element.tagName === "rect") {
      const [x, y, width, height] = numbers("x", "y", "width", "height");
      return [[x + width / 2, y + height / 2, hint, width / 2, height / 2]];
    }
    const text = element.getAttribute("transform") ?? element.getAttribute("d");
    const coordinates = text.match(/-?[\d.]+/g).map(Number);
    return coordinates.flatMap((x, i) => (i % 2 ? [] : [[x, coordinates[i + 1], hint]]));
  });
}

// The answer to a job: the first screen of its report, and its sections, folded until
// somebody asks.

import { h } from "./dom.js";
import { frame, unstyled } from "./figure.js";

/// Takes a report apart and lays it out here. Its markup is the server's own, and this page
/// allows neither script nor style in line. `trial` is a section beside those of the report.
export function answer(html, trial) {
  // The first style sheet is that of the page, the others are those of its figures.
  const { markup, styles } = unstyled(html);
  // Taken over first: an element that visits another document loses its styles.
  const report = document.adoptNode(new DOMParser().parseFromString(markup, "text/html").body);
  const figures = [];
  for (const [i, figure] of report.querySelectorAll("figure").entries()) {
    const svg = figure.querySelector("svg");
    const title = svg.querySelector("title")?.textContent;
    const { node, figure: host } = frame(figure.querySelector("figcaption")?.textContent, title);
    node.className = figure.className;
    host.show(svg, styles[i + 1]);
    if (!figure.classList.contains("phone")) figures.push(svg.id.replace("servoscope-", ""));
    figure.replaceWith(node);
  }
  for (const wide of report.querySelectorAll(".scroll:not(figure .scroll)")) {
    wide.setAttribute("tabindex", "0");
    wide.setAttribute("role", "group");
    wide.setAttribute("aria-label", wide.querySelector("caption")?.textContent || "Table");
  }
  const verdict = report.querySelector(".verdict");
  const sections = [...report.querySelectorAll("main > details")];
  const nodes = [h("div", { class: "answer" }, verdict, report.querySelector(".screen"), sections, folded(trial))];
  return {
    nodes,
    figures,
    verdict: [...verdict.querySelectorAll(".word, .lead")].map((part) => part.textContent).join(": "),
  };
}

/// A section as one that is folded, too.
function folded({ id, title, short, body }) {
  return h("details", { id },
    h("summary", {}, h("h2", {}, title), h("span", { class: "short" }, short)),
    h("div", { class: "whole" }, body));
}

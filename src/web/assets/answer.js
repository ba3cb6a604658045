// The answer to a job: the sections of its report, which say it in words, tables and
// figures, with a list of contents that follows the reader.

import { h } from "./dom.js";
import { frame, unstyled } from "./figure.js";

/// Takes a report apart and lays it out here. Its markup is the server's own, and
/// its policy allows neither script nor style in line. `trial` is a section beside them.
export function answer(html, trial) {
  // The first style sheet is that of the page, the others are those of its figures.
  const { markup, styles } = unstyled(html);
  // Taken over first: an element that visits another document loses its styles.
  const report = document.adoptNode(new DOMParser().parseFromString(markup, "text/html").body);
  const sections = inOrder([...report.querySelectorAll("main > section"), trial]);
  const figures = [];
  for (const [i, figure] of report.querySelectorAll("figure").entries()) {
    const svg = figure.querySelector("svg");
    const title = svg.querySelector("title")?.textContent;
    const { node, figure: host } = frame(figure.querySelector("figcaption")?.textContent, title);
    host.show(svg, styles[i + 1]);
    figures.push(svg.id.replace("servoscope-", ""));
    figure.replaceWith(node);
  }
  for (const wide of report.querySelectorAll(".scroll:not([tabindex])")) {
    wide.setAttribute("tabindex", "0");
    wide.setAttribute("role", "group");
    wide.setAttribute("aria-label", wide.querySelector("caption")?.textContent || "Table");
  }
  const verdict = report.querySelector(".verdict");
  const contents = h("nav", { class: "contents", "aria-label": "Contents" },
    h("ol", {}, sections.map((section) =>
      h("li", {}, h("a", { href: `#${section.id}` }, section.querySelector("h2").textContent)))));
  const column = h("div", { class: "answer" }, verdict, report.querySelector(".facts"), sections);
  mark(contents, sections);
  return {
    nodes: [contents, column],
    figures,
    verdict: [...verdict.querySelectorAll(".word, .lead")].map((part) => part.textContent).join(": "),
  };
}

/// Whoever asked knows what was measured: it stands with the provenance, not first.
function inOrder(sections) {
  const background = sections.filter(({ id }) => ["measured", "provenance"].includes(id));
  return [...sections.filter((section) => !background.includes(section)), ...background];
}

/// Marks in the contents where the reader is.
function mark(contents, sections) {
  const links = new Map([...contents.querySelectorAll("a")].map((link) => [link.hash.slice(1), link]));
  const seen = new Set();
  const observer = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) isIntersecting ? seen.add(target) : seen.delete(target);
    const here = sections.find((section) => seen.has(section));
    for (const [id, link] of links) {
      id === here?.id ? link.setAttribute("aria-current", "true") : link.removeAttribute("aria-current");
    }
  }, { rootMargin: "-80px 0px -55% 0px" });
  sections.forEach((section) => observer.observe(section));
}

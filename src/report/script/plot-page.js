// The figures of a page that stands alone.

import { interactive } from "./plot.js";

const said = Object.assign(document.createElement("p"), { className: "unseen" });
said.setAttribute("aria-live", "polite");
document.body.append(said);
for (const svg of document.querySelectorAll("figure svg")) {
  interactive(svg, svg.closest("figure"), (text) => (said.textContent = text));
}
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((section) => (section.open = true)));

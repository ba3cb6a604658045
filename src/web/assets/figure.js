// Figures that the server draws, in the page: sharp at any size, with hints at the
// pointer and a description for those who do not see them.

import { announce, h } from "./dom.js";
import { text } from "./api.js";
import { interactive } from "./plot.js";

/// Condition under which a figure is dark, as the server writes it.
const DARK = "screen and (prefers-color-scheme:dark)";

/// Holds one figure in a tree of its own: its ids and its style sheet would meet
/// those of another figure, and the page allows no style sheet in line.
class ServerFigure extends HTMLElement {
  #style = "";
  #sheet = new CSSStyleSheet();
  #painted = () => this.#style.replaceAll(DARK, globalThis.colours.dark());
  #paint = () => this.#sheet.replaceSync(this.#painted());

  constructor() {
    super();
    this.attachShadow({ mode: "open" }).adoptedStyleSheets = [LAYOUT, this.#sheet];
  }

  connectedCallback() {
    document.addEventListener("colours", this.#paint);
  }

  disconnectedCallback() {
    document.removeEventListener("colours", this.#paint);
  }

  /// Shows an SVG element of another document, which has this style sheet.
  show(svg, style) {
    this.#style = style;
    this.#paint();
    this.shadowRoot.replaceChildren(document.adoptNode(svg));
    if (!interactive(svg, this.closest("figure"), announce, this.#painted)) return;
    // The figure itself is what the keyboard stands on.
    for (const name of ["tabindex", "role", "aria-label"]) this.parentElement.removeAttribute(name);
  }
}

const LAYOUT = new CSSStyleSheet();
LAYOUT.replaceSync(`:host{display:block}svg{display:block;width:100%;height:auto}
  svg:focus-visible,[data-toggle]:focus-visible{outline:2px solid var(--good);outline-offset:-2px}`);
customElements.define("server-figure", ServerFigure);

/// A place for a figure, wider than a phone: it is moved with the finger or, once
/// focused, with the arrow keys.
export function frame(caption, label) {
  const figure = h("server-figure");
  const scroll = h("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": label });
  scroll.append(figure);
  const node = h("figure", {}, scroll, caption && h("figcaption", {}, caption));
  return { node, figure };
}

/// Markup without its style sheets, and these in order: a browser counts them as in
/// line, and refuses them, even in a document that is only read.
export function unstyled(markup) {
  const styles = [];
  const rest = markup.replace(/<style>([\s\S]*?)<\/style>/g, (_, style) => (styles.push(style), ""));
  return { markup: rest, styles };
}

/// Fetches a figure; what is there already stays until then.
export async function load(figure, path, signal, options = {}) {
  const { markup, styles } = unstyled(await text(path, { signal, ...options }));
  const document = new DOMParser().parseFromString(markup, "image/svg+xml");
  figure.show(document.documentElement, styles[0]);
}

// What stands below a figure: how it is moved, and what is seen of it to keep.

const DARK = /screen and \(prefers-color-scheme: ?dark\)/g;

/// Adds the line of tools to a figure.
export function tools(svg, overlay, figure, reset, style) {
  const name = svg.id.replace("servoscope-", "");
  const button = (text, action) => {
    const element = document.createElement("button");
    Object.assign(element, { type: "button", textContent: text });
    element.addEventListener("click", action);
    return element;
  };
  const help = document.createElement("span");
  help.textContent = matchMedia("(pointer: coarse)").matches
    ? "Tap to read values, pinch to zoom, drag to move."
    : "Click, then wheel or + − to zoom, drag or Shift+arrows to move, arrows to read.";
  const line = document.createElement("div");
  line.className = "tools-of-figure";
  line.append(help,
    button("Reset zoom", reset),
    button("Save SVG", () => keep(new Blob([seen(svg, overlay, style)], { type: "image/svg+xml" }), `${name}.svg`)),
    button("Save PNG", async () => keep(await pixels(svg, seen(svg, overlay, style)), `${name}.png`)));
  figure.querySelector(".tools-of-figure")?.remove();
  const caption = figure.querySelector("figcaption");
  caption ? caption.before(line) : figure.append(line);
}

/// The figure as it is seen, in the colours that it has now, as a document of its own.
function seen(svg, overlay, style) {
  const copy = svg.cloneNode(true);
  copy.children[[...svg.children].indexOf(overlay)].remove();
  copy.removeAttribute("style");
  copy.removeAttribute("tabindex");
  const sheet = copy.querySelector("style") ?? document.createElementNS("http://www.w3.org/2000/svg", "style");
  const isDark = matchMedia("(prefers-color-scheme: dark)").matches;
  sheet.textContent = (style() || sheet.textContent).replaceAll(DARK, isDark ? "all" : "not all");
  copy.prepend(sheet);
  return new XMLSerializer().serializeToString(copy);
}

/// The same as pixels, twice as many as the figure is drawn with.
async function pixels(svg, text) {
  const image = new Image();
  const { width, height } = svg.viewBox.baseVal;
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), { width: 2 * width, height: 2 * height });
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((done) => canvas.toBlob(done, "image/png"));
}

/// Gives a file to whoever looks, under a name.
export function keep(blob, name) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

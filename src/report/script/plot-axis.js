// Axes of a figure: from values to pixels and back, and the numbers that stand at them.

const SPACING = { x: 62, y: 26 };
const DEGREES = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 45, 90, 180, 360];

/// One direction of a panel, as the server writes it: kind, range (logarithms where it is
/// logarithmic) and edges.
export class Axis {
  constructor(text, name, direction) {
    const [kind, ...numbers] = text.split(" ");
    [this.low, this.high, this.from, this.to] = numbers.map(Number);
    // Rows of a table do not move.
    Object.assign(this, { name, direction, isLog: kind === "log", isFixed: kind === "rows" });
    this.home = [this.low, this.high];
  }

  get isHome() {
    return this.low === this.home[0] && this.high === this.home[1];
  }

  /// Where a pixel of the figure as it was drawn is now.
  moved(px) {
    const [low, high] = this.home;
    const coordinate = low + ((px - this.from) / (this.to - this.from)) * (high - low);
    return this.from + ((coordinate - this.low) / (this.high - this.low)) * (this.to - this.from);
  }

  /// The coordinate at a pixel: the value, or its logarithm.
  coordinate(px) {
    return this.low + ((px - this.from) / (this.to - this.from)) * (this.high - this.low);
  }

  set([low, high]) {
    if (this.isFixed) return;
    const [first, last] = this.home;
    const share = (high - low) / (last - first);
    if (share > 1e-5 && share < 8) [this.low, this.high] = [low, high];
  }

  zoom(factor, px) {
    const fixed = this.coordinate(px);
    this.set([this.low, this.high].map((end) => fixed + (end - fixed) / factor));
  }

  pan(pixels) {
    const by = (pixels / (this.to - this.from)) * (this.high - this.low);
    this.set([this.low - by, this.high - by]);
  }

  /// A pixel of the figure as it was drawn in words: to the digits that a pixel can tell.
  written(px) {
    const [low, high] = this.home;
    const coordinate = low + ((px - this.from) / (this.to - this.from)) * (high - low);
    if (this.name === "UTC") return date(coordinate);
    if (this.isLog) return short(10 ** coordinate, 3);
    const pixel = Math.abs((high - low) / (this.to - this.from)) / 5;
    return signed(coordinate.toFixed(Math.max(0, Math.min(9, Math.ceil(-Math.log10(pixel))))));
  }

  ticks() {
    const room = Math.abs(this.to - this.from) / SPACING[this.direction];
    const at = (coordinate) => this.from + ((coordinate - this.low) / (this.high - this.low)) * (this.to - this.from);
    const decades = this.high - this.low;
    if (this.isLog && decades > 0.8) {
      const factors = decades * 3 < room ? [1, 2, 5] : [1];
      const stride = Math.ceil(decades / room);
      const found = [];
      for (let power = Math.floor(this.low); power <= this.high; power += 1) {
        for (const factor of factors) {
          const place = power + Math.log10(factor);
          if (place < this.low || place > this.high) continue;
          found.push({ px: at(place), label: power % stride ? "" : short(factor * 10 ** power, 2) });
        }
      }
      return found;
    }
    if (this.isFixed) return [];
    const [low, high] = this.isLog ? [10 ** this.low, 10 ** this.high] : [this.low, this.high];
    const step = this.#step((high - low) / room);
    const decimals = Math.max(0, Math.min(12, -Math.floor(Math.log10(step) + 1e-9)));
    const found = [];
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step && found.length < 50; i += 1) {
      const value = i * step;
      const label = this.name === "UTC" ? date(value) : signed(value.toFixed(decimals));
      found.push({ px: at(this.isLog ? Math.log10(value) : value), label });
    }
    return found;
  }

  #step(least) {
    if (/degrees/.test(this.name) && least > 0.1) return DEGREES.find((step) => step >= least) ?? 360 * Math.ceil(least / 360);
    const power = 10 ** Math.floor(Math.log10(least));
    return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= least * (1 - 1e-9));
  }
}

function date(seconds) {
  return new Date(1000 * seconds).toISOString().slice(0, 10);
}

function signed(text) {
  return text.replace("-", "−").replace(/^−(0\.?0*)$/, "$1");
}

function short(value, digits) {
  return signed(Number(value.toPrecision(digits)).toString());
}

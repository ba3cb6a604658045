// Numbers, times and names as they are read.

import { PARAMETERS } from "./parameters.js";

const POWERS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/// At most so many significant digits, a true minus sign, and a power of ten where
/// the number is very large or small.
export function number(value, digits = 4) {
  if (value == null || !Number.isFinite(value)) return "";
  const text = Number(value.toPrecision(digits)).toString();
  const [mantissa, power] = text.split("e");
  const raised = power && [...power.replace("+", "")].map((c) => POWERS[c] ?? "⁻").join("");
  return (power ? `${mantissa}·10${raised}` : mantissa).replace("-", "−");
}

/// With so many digits behind the point: numbers that stand below each other.
export function fixed(value, decimals) {
  return value == null ? "" : value.toFixed(decimals).replace("-", "−");
}

/// Digits behind the point at which the last one shown is a tenth of the deviation.
export function decimals(deviation) {
  if (!(deviation > 0)) return 4;
  return Math.min(8, Math.max(0, 1 - Math.floor(Math.log10(deviation))));
}

export function percent(share, digits = 3) {
  return share == null ? "" : `${number(100 * share, digits)} %`;
}

/// A probability: nothing is certain.
export function confidence(share) {
  if (share > 0.999) return "above 99.9 %";
  // Cut, not rounded, to as many digits as a report has.
  const [shift, digits] = share > 0.99 ? [10, 1] : [1, 0];
  return `${(Math.floor(100 * shift * share + 1e-9) / shift).toFixed(digits)} %`;
}

export function range([low, high], unit, factor = 1) {
  const [from, to] = [number(low * factor, 3), number(high * factor, 3)];
  const space = unit ? " " : "";
  return from === to ? `${from}${space}${unit}` : `${from} to ${to}${space}${unit}`;
}

export function seconds(value) {
  if (value < 59.5) return `${value < 10 ? value.toFixed(1) : Math.round(value)} s`;
  const whole = Math.round(value);
  const minutes = Math.floor(whole / 60);
  const rest = whole % 60;
  return minutes < 60 ? `${minutes} min${rest ? ` ${rest} s` : ""}` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/// An estimate of a duration, which deserves no more digits.
export function about(value) {
  if (value < 10) return "a few seconds";
  return value < 90 ? `about ${10 * Math.round(value / 10)} s` : `about ${Math.round(value / 60)} min`;
}

/// A time on the reader's clock, with its zone.
export function time(rfc3339) {
  if (!rfc3339) return "";
  const date = new Date(rfc3339);
  if (Number.isNaN(date.getTime())) return rfc3339;
  const two = (part) => String(part).padStart(2, "0");
  const day = `${date.getFullYear()}-${two(date.getMonth() + 1)}-${two(date.getDate())}`;
  return `${day} ${two(date.getHours())}:${two(date.getMinutes())} ${zone(date)}`;
}

/// The zone of the reader's clock at a time: `UTC`, `UTC+1`, `UTC+5:30`.
function zone(date) {
  const minutes = -date.getTimezoneOffset();
  if (minutes === 0) return "UTC";
  const rest = Math.abs(minutes) % 60;
  const hours = Math.floor(Math.abs(minutes) / 60);
  return `UTC${minutes < 0 ? "−" : "+"}${hours}${rest ? `:${String(rest).padStart(2, "0")}` : ""}`;
}

/// An id as words.
export function effect(id) {
  return id === "stribeck" ? "Stribeck friction" : id.replaceAll("_", " ");
}

/// Ids of causes with spaces between them, as words.
export function named(causes) {
  return causes ? causes.split(" ").map(effect).join(", ") : "";
}

/// The kind of a job as what it makes.
export function kind(job) {
  return job.kind === "diagnose" ? "Diagnosis" : "Identification";
}

/// What a parameter is called, by its id: `stribeck.fs_over_fc` is of an effect.
export function parameter(id) {
  return PARAMETERS[id] ?? capital(id.split(".").map(effect).join(": "));
}

export function capital(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/// A text as a sentence.
export function sentence(text) {
  return `${capital(text)}${/[.!?]$/.test(text) ? "" : "."}`;
}

/// What a measurement is of, as far as it says.
export function subject({ machine, axis, name }) {
  const parts = [machine, axis && `axis ${axis}`].filter(Boolean);
  return parts.join(", ") || name || "unnamed measurement";
}

/// The names of its files, the first of several.
export function filesOf({ files: [first, ...more] = [] }) {
  return more.length > 0 ? `${first} and ${more.length} more` : first ?? "";
}

/// A measurement where one is chosen among others.
export function inList(item) {
  const { name, measured_at, created_at } = item;
  return [subject(item), name !== subject(item) && name, filesOf(item), time(measured_at ?? created_at)].filter(Boolean).join(", ");
}

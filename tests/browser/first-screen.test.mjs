// What a person sees of a real machine without scrolling: verdict, response with its errors, cause,
// improvement and what to do next.

import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

import { overflows, picture } from "./page.mjs";
import { stage } from "./stage.mjs";

/// The public record of a ball-screw stage, which the repository does not carry.
const EMPS = fileURLToPath(new URL("../../../shared/data/emps/emps.csv", import.meta.url));
const skip = !existsSync(EMPS) && `${EMPS} is absent`;

const { server, visit } = stage();

/// How far below the screen a part ends, pixels; above 0 one has to scroll.
async function beyond(page, locator) {
  const box = await locator.boundingBox();
  return box ? box.y + box.height - page.viewportSize().height : Infinity;
}

test("the answer to a real machine is on the first screen", { skip }, async () => {
  const measurement = await server.post("/v1/measurements?loop=closed", readFileSync(EMPS, "utf8"), "text/csv");
  const { id } = await server.post("/v1/jobs", { measurement_id: measurement.id, kind: "diagnose" });
  let job;
  do {
    job = await (await fetch(`${server.address}/v1/jobs/${id}?wait=30`)).json();
  } while (["queued", "running"].includes(job.status));
  assert.equal(job.status, "succeeded", job.failure?.reason);

  const page = await visit(`/jobs/${id}`);
  await page.locator(".verdict").waitFor();
  await page.locator(".first server-figure").waitFor();
  const parts = {
    "the verdict": ".verdict",
    "the response with its errors": ".first server-figure",
    "the cause": ".card.cause",
    "the improvement": ".card.gain",
    "the next step": ".card.next",
  };
  const below = {};
  for (const [name, path] of Object.entries(parts)) {
    const pixels = await beyond(page, page.locator(path));
    if (pixels > 0) below[name] = pixels;
  }
  await picture(page, "36-first-screen");
  assert.deepEqual(below, {}, "pixels below the first screen");
  // The errors stand beneath the response in the same figure.
  const titles = await page.locator(".first server-figure").evaluate((figure) => figure.shadowRoot.querySelector("svg").textContent);
  for (const part of ["Error of the gain (dB)", "Error of the phase (degrees)"]) assert.ok(titles.includes(part), part);
  assert.match(await page.locator(".card.cause").textContent(), /viscous asymmetry/i);

  await page.setViewportSize({ width: 390, height: 844 });
  assert.ok(!await overflows(page), "too wide on a phone");
  const figure = page.locator(".phone server-figure");
  const { width } = await figure.boundingBox();
  assert.ok(width <= 390, `the figure is ${width} pixels wide on a phone`);
  assert.ok(!await page.locator(".first server-figure").isVisible(), "two figures of the same");
  for (const part of ["Gain (dB", "Phase (degrees)"]) await figure.getByText(part).first().waitFor();
  await picture(page, "37-first-screen-phone", { fullPage: true });
});

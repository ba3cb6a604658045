// Batches: how far they have come, what came of each measurement, and ending them.

import assert from "node:assert/strict";
import { test } from "node:test";

import { faults } from "./axe.mjs";
import { overflows, picture } from "./page.mjs";
import { STICKY, simulated } from "./server.mjs";
import { stage } from "./stage.mjs";

const PATIENCE = 600_000;
const { server, visit } = stage();

/// Uploads measurements and makes a batch of them; gives its address.
async function batch(names, request) {
  const measurement_ids = [];
  for (const name of names) {
    const flags = name.startsWith("sticky") ? STICKY : [];
    measurement_ids.push((await server.post(`/v1/measurements?name=${name}`, simulated(flags), "text/csv")).id);
  }
  const { id } = await server.post("/v1/batches", { measurement_ids, ...request });
  return `/batches/${id}`;
}

test("a server without a batch says how one is made", async () => {
  const page = await visit("/batches");
  await page.getByText("There is no batch yet").waitFor();
  assert.match(await page.locator("pre").textContent(), /servoscope batch FOLDER --server http/);
  assert.deepEqual(await faults(page), []);
});

test("a batch is followed to its end, its table narrowed, and the batch deleted", async () => {
  const address = await batch(["sticky.csv", "sliding.csv"], { name: "press hall", kind: "diagnose", plant: { actuator_order: 0 } });
  const page = await visit("/batches");
  await page.getByRole("link", { name: "press hall" }).click();
  await page.getByRole("heading", { name: "press hall" }).waitFor();
  await page.getByText("2 succeeded").waitFor({ timeout: PATIENCE });
  await page.getByRole("button", { name: "Delete" }).waitFor();
  assert.match(await page.getByRole("row", { name: /^sticky/ }).textContent(), /explained.*static friction.*%/);
  assert.match(await page.getByRole("row", { name: /^sliding/ }).textContent(), /adequate/);
  assert.match(await page.locator("main").textContent(), /First causes: static friction 1/);
  assert.deepEqual(await faults(page), []);
  await picture(page, "70-batch", { fullPage: true });

  await page.getByLabel("Status").selectOption("failed");
  await page.waitForFunction(() => document.querySelectorAll("main tbody tr").length === 0);
  await page.reload();
  await page.getByRole("heading", { name: "press hall" }).waitFor();
  assert.equal(await page.getByLabel("Status").inputValue(), "failed");
  await page.getByLabel("Status").selectOption("");
  await page.getByRole("link", { name: "sticky.csv" }).waitFor();

  const list = await visit("/batches", { viewport: { width: 360, height: 740 } });
  await list.getByRole("link", { name: "press hall" }).waitFor();
  assert.equal(await overflows(list), false);
  await picture(list, "71-phone-batches");

  await page.getByRole("button", { name: "Delete" }).click();
  await page.getByRole("dialog").getByRole("button", { name: "Delete" }).click();
  await page.getByText("There is no batch yet").waitFor();
  assert.equal((await fetch(`${server.address}/v1${address}`)).status, 404);
});

test("a batch that runs is cancelled", async () => {
  const options = { colony: { food_sources: 1000, cycles: 1000, abandonment_limit: 1_000_000 } };
  const page = await visit(await batch(["a.csv", "b.csv"], { kind: "identify", options }));
  await page.getByRole("heading", { name: "Identification of 2 measurements" }).waitFor();
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByRole("dialog").getByRole("button", { name: "Cancel them" }).click();
  await page.getByText("2 cancelled").waitFor({ timeout: PATIENCE });
  assert.deepEqual(await faults(page), []);
});

// Many measurements and jobs: diagnosed in one go, found, renamed, recognised.

import assert from "node:assert/strict";
import { test } from "node:test";

import { faults } from "./axe.mjs";
import { drop, dropAll, overflows, picture } from "./page.mjs";
import { STICKY, simulated } from "./server.mjs";
import { stage } from "./stage.mjs";

const PATIENCE = 600_000;
const { visit } = stage();

test("several files are diagnosed in one go, and a bad one keeps no other from it", async () => {
  const page = await visit("/");
  await dropAll(page, [
    ["north.csv", simulated(STICKY, { machine: "press 4", axis: "Y" })],
    ["bad.csv", "magnitude,omega_rad_s,harmonic,re,im\ntwo,1,1,1,1\n"],
    ["south.csv", simulated([], { machine: "press 5", axis: "X", "label.site": "outside" })],
  ]);
  await page.getByText("3 files:").waitFor();
  await picture(page, "60-several-files");
  await page.getByRole("button", { name: "Diagnose each by itself" }).click();
  await page.getByRole("heading", { name: "Several files diagnosed" }).waitFor({ timeout: PATIENCE });
  assert.match(await page.locator("section", { has: page.locator("#refused") }).textContent(), /you need to do this only once.*bad\.csv.*two/);
  await page.getByText("2 of 2 finished.").waitFor({ timeout: PATIENCE });
  assert.match(await page.getByRole("row", { name: /^north/ }).textContent(), /explained.*static friction/);
  assert.match(await page.getByRole("row", { name: /^south/ }).textContent(), /adequate/);
  assert.deepEqual(await faults(page), []);
  await picture(page, "61-together", { fullPage: true });
  page.wrong = page.wrong.filter((text) => !text.includes("422"));
});

test("measurements and jobs are found by text and by verdict, and the address keeps it", async () => {
  const page = await visit("/");
  const rows = (list) => page.locator(`#${list} tbody tr`);
  await page.waitForFunction(() => document.querySelectorAll("#jobs tbody tr").length === 2);
  await page.getByLabel("Find").fill("SOUTH");
  await page.waitForFunction(() => document.querySelectorAll("#measurements tbody tr").length === 1);
  assert.match(await rows("jobs").textContent(), /press 5/);
  await page.getByLabel("Find").fill("");
  await page.getByLabel("Verdict").selectOption("explained");
  await page.waitForFunction(() => /^[^]*press 4[^]*explained/.test(document.querySelector("#jobs tbody").textContent) && document.querySelectorAll("#jobs tbody tr").length === 1);
  assert.equal(await page.locator("#measurements").isVisible(), false);
  await picture(page, "62-found");
  await page.reload();
  await rows("jobs").first().waitFor();
  assert.equal(await page.getByLabel("Verdict").inputValue(), "explained");
  await page.getByLabel("From").fill("2120-01-01");
  await page.getByText("Nothing matches.").waitFor();
  assert.deepEqual(await faults(page), []);
});

test("a measurement is renamed, and times have zones", async () => {
  const page = await visit("/");
  await page.locator("#measurements").getByRole("row", { name: /south/ }).getByRole("link").first().click();
  await page.getByRole("button", { name: "Edit …" }).click();
  const dialog = page.getByRole("dialog");
  await dialog.getByLabel("Measured at").fill("yesterday");
  await dialog.getByRole("button", { name: "Save" }).click();
  await dialog.locator("[name=measured_at][aria-invalid]").waitFor();
  await dialog.getByLabel("Measured at").fill("2026-03-04T10:20:00+01:00");
  await dialog.getByLabel("Machine").fill("lathe 2");
  await dialog.getByLabel("Labels").fill("site: north\nshift: night");
  assert.deepEqual(await faults(page), []);
  await picture(page, "63-edit");
  await dialog.getByRole("button", { name: "Save" }).click();
  await page.getByRole("heading", { name: "lathe 2, axis X" }).waitFor();
  assert.match(await page.locator(".pairs").textContent(), /Measured2026-03-04 \d\d:\d\d UTC.*shift.*night/);
  page.wrong = page.wrong.filter((text) => !text.includes("422"));
});

test("the same file is recognised, and an identification that leaves too much is diagnosed", async () => {
  const page = await visit("/");
  await drop(page, "again.csv", simulated(STICKY, { machine: "press 4", axis: "Y" }));
  await page.getByRole("heading", { name: "Start a job" }).waitFor();
  await page.getByText("The same data were uploaded").waitFor();
  await page.getByRole("radio", { name: /Identification/ }).check();
  await page.getByRole("button", { name: "Start", exact: true }).click();
  await page.getByRole("button", { name: "Diagnose this" }).click({ timeout: PATIENCE });
  await page.getByRole("heading", { name: /^Diagnosis of press 4/ }).waitFor();
  await page.locator(".verdict").waitFor({ timeout: PATIENCE });
  assert.match(await page.locator(".verdict").textContent(), /Explained/);
});

test("an unknown address shows a page that says so", async () => {
  const page = await visit("/no/such/page", { viewport: { width: 390, height: 844 } });
  await page.getByRole("heading", { name: "Not found" }).waitFor();
  await page.getByText("/no/such/page is not a page of this server").waitFor();
  assert.ok(!await overflows(page));
  page.wrong = page.wrong.filter((text) => !text.includes("404"));
  await page.getByRole("link", { name: "Go to the overview" }).click();
  await page.locator("#jobs tbody tr").first().waitFor();
  await picture(page, "64-phone-overview", { fullPage: true });
  assert.ok(!await overflows(page));
});

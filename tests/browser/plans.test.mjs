// Experiments planned from a rough axis or from a result, looked at and taken away.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";

import { faults } from "./axe.mjs";
import { overflows, picture } from "./page.mjs";
import { simulated } from "./server.mjs";
import { stage } from "./stage.mjs";

const PATIENCE = 600_000;
const { server, visit } = stage();
/// The address of a plan that was made: it says what was asked.
let asked;

const planned = (page) => page.locator("#names").waitFor({ timeout: PATIENCE });

test("a field that is needed is asked for, and what the server refuses is said at its field", async () => {
  const page = await visit("/plans");
  await page.getByLabel("Pole of the mechanics").fill("10");
  await page.getByRole("textbox", { name: /^Constant/ }).fill("10");
  await page.getByRole("button", { name: "Plan it" }).click();
  assert.match(await page.locator(".wrong").textContent(), /Friction forwards: enter a value, for example 0.5/);
  await page.getByLabel("Friction forwards").fill("0.5");
  await page.getByLabel("Time for all experiments").fill("20");
  await page.getByRole("button", { name: "Plan it" }).click();
  await page.locator("[name=pole][aria-invalid]").waitFor();
  assert.match(await page.locator(".wrong").textContent(), /pole of a stable axis/);
  page.wrong = page.wrong.filter((text) => !text.includes("422"));
});

test("a result fills in the axis, and the plan is shown, compared and downloaded", async () => {
  const metadata = { machine: "press 4", axis: "Y", input: "current A", response: "velocity rad/s" };
  const job = await server.answered(simulated(["--fc-minus", "0.4"], metadata));
  const page = await visit("/plans");
  await page.getByLabel("Start from a result").waitFor();
  await picture(page, "50-plan-form");
  await page.getByLabel("Start from a result").selectOption(job.id);
  await page.waitForFunction(() => document.querySelector("[name=pole]").value !== "");
  assert.match(await page.getByLabel("Pole of the mechanics").inputValue(), /^-(9\.9|10)/);
  assert.match(await page.getByLabel("Friction backwards").inputValue(), /^0\.(39|40)/);
  await page.getByLabel("Time for all experiments").fill("25");
  await page.getByRole("button", { name: "Plan it" }).click();
  await page.getByText("Planning …").waitFor();
  assert.equal(await page.getByRole("button", { name: "Plan it" }).isEnabled(), false);
  await picture(page, "51-planning");
  await planned(page);
  assert.match(await page.locator(".lead").first().textContent(), /\d+ experiments in \d+ s of 25 s should identify \d+ of 17 effects of typical size/);
  const head = await page.locator("section", { has: page.locator("#experiments") }).locator("thead").textContent();
  assert.match(head, /Magnitude \(A\)Frequency \(Hz\)Settling periodsPeriods measuredRepeatsDuration \(s\)/);
  assert.match(await page.locator("section", { has: page.locator("#names") }).textContent(), /use them to compare plans/);
  await page.locator("server-figure svg").waitFor({ timeout: PATIENCE });
  await picture(page, "52-plan", { fullPage: true });
  for (const [name, begins] of [["Stepped sine, CSV", /time_s,input,segment\n/], ["Multisine, CSV", /time_s,input,segment\n/], ["Plan, JSON", /"experiments"/]]) {
    const waiting = page.waitForEvent("download", { timeout: PATIENCE });
    await page.getByRole("button", { name }).click();
    assert.match(await readFile(await (await waiting).path(), "utf8"), begins);
  }
  assert.deepEqual(await faults(page), []);
  asked = page.url().replace(server.address, "");
});

test("the page of a job leads to a plan for its axis", async () => {
  const metadata = { input: "force N", response: "velocity m/s" };
  const job = await server.answered(simulated([], metadata));
  const page = await visit(`/jobs/${job.id}`);
  await page.getByRole("link", { name: "Plan a later measurement" }).click();
  await page.waitForFunction(() => document.querySelector("[name=pole]")?.value);
  assert.equal(await page.getByLabel("Start from a result").inputValue(), job.id);
  assert.match(await page.getByLabel("Pole of the mechanics").inputValue(), /^-(9\.9|10)/);
  await page.getByLabel("Time for all experiments").fill("10");
  await page.getByRole("button", { name: "Plan it" }).click();
  await planned(page);
  const head = await page.locator("section", { has: page.locator("#experiments") }).locator("thead").textContent();
  assert.match(head, /Magnitude \(N\)/);
  const sizes = await page.locator("section", { has: page.locator("#names") }).textContent();
  assert.match(sizes, /Limit of the input [\d.]+ N/);
  assert.ok(!/\d\s(1\/\()?(input|response)\b/.test(sizes), "every unit is known");
  await page.locator("server-figure svg").waitFor({ timeout: PATIENCE });
  const figure = await page.locator("server-figure").evaluate((all) => all.shadowRoot.textContent);
  assert.match(figure, /Magnitude of the input \(N\)/);
});

test("the address asks for the same plan again, also on a phone and in the dark", async () => {
  for (const options of [{ viewport: { width: 390, height: 844 } }, { colorScheme: "dark" }]) {
    const page = await visit(asked, options);
    assert.ok(!await overflows(page), "the form is too wide");
    assert.equal(await page.getByLabel("Time for all experiments").inputValue(), "25");
    await page.getByRole("button", { name: "Plan it" }).click();
    await planned(page);
    await page.locator("server-figure svg").waitFor({ timeout: PATIENCE });
    await page.evaluate(() => document.querySelectorAll("details").forEach((section) => (section.open = true)));
    assert.deepEqual(await faults(page), []);
    assert.ok(!await overflows(page), "the plan is too wide");
    await picture(page, `53-plan-${options.colorScheme ?? "phone"}`, { fullPage: true });
  }
});

// A file that does not say everything: seen, named, kept, and read by itself the next time.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";

import { faults } from "./axe.mjs";
import { drop, overflows, picture } from "./page.mjs";
import { STICKY, simulated } from "./server.mjs";
import { stage } from "./stage.mjs";

const { server, visit } = stage();

/// A record under names that nobody knows, with a column of words.
function foreign(amplitude = 1) {
  const rows = Array.from({ length: 400 }, (_, n) => {
    const angle = (2 * Math.PI * n) / 50;
    return [n, (amplitude * Math.cos(angle)).toFixed(5), "on", Math.cos(angle - 0.5).toFixed(5)].join(";").replaceAll(".", ",");
  });
  return ["Rig 7", "", "tick;chan a;state;chan b", ...rows, ""].join("\n");
}

/// A gain in dB, of which it is not said what response and magnitude are.
const BODE = ["Frequency (Hz),Magnitude (dB),Phase (deg)", ...Array.from({ length: 12 }, (_, n) => `${n + 1},${-n},${-10 * n}`), ""].join("\n");

/// The browser itself notes that the server refused.
const forgive = (page) => (page.wrong = page.wrong.filter((text) => !text.includes("422")));
const measured = async () => (await (await fetch(`${server.address}/v1/measurements`)).json()).items;

/// Says what the columns of the foreign record are, and waits for the answer to the last of it: with
/// a position in no unit the record is understood, too.
async function named(page) {
  for (const [column, quantity, unit] of [["tick", "time", "ms"], ["chan a", "input: current", "A"], ["chan b", "response: position", "mm"]]) {
    await page.getByLabel(`What ${column} is`).selectOption({ label: quantity });
    await page.getByLabel(`Unit of ${column}`).fill(unit);
    await page.getByLabel(`Unit of ${column}`).press("Tab");
  }
  await page.locator(".understood", { hasText: /This is understood: .* to position \(mm\)/ }).waitFor();
}

test("a file of unknown columns is shown, named and kept, and the next one needs nothing", async () => {
  const page = await visit("/");
  await drop(page, "rig.txt", foreign());
  await page.getByText("Not yet understood").waitFor();
  await picture(page, "40-preview-asked");
  const store = page.getByRole("button", { name: "Store it" });
  assert.equal(await store.isEnabled(), false);
  assert.equal((await measured()).length, 0);
  assert.equal(await page.locator(".rows tbody tr").count(), 20);
  assert.match(await page.locator(".rows caption").textContent(), /between semicolons; a decimal comma; the table begins at line 3/);
  assert.match(await page.locator(".understood").textContent(), /say below what each column is\.$/);
  await named(page);
  assert.match(await page.locator(".understood").textContent(), /from current \(A\) to position \(mm\), magnitude 1 A, 20 Hz/);
  await page.getByRole("textbox", { name: "Name" }).fill("rig 7");
  await page.getByRole("button", { name: "Save" }).click();
  const waiting = page.waitForEvent("download");
  await page.getByRole("link", { name: "rig 7.toml" }).click();
  assert.equal(await readFile(await (await waiting).path(), "utf8"), 'column_names = "Time (ms); Current (A); ; Position (mm)"\n');
  await picture(page, "41-preview-named");
  await store.click();
  await page.getByRole("heading", { name: "Start a job" }).waitFor();
  forgive(page);

  await page.getByRole("link", { name: "Overview" }).first().click();
  await drop(page, "next.txt", foreign(2));
  await page.getByRole("heading", { name: "Start a job" }).waitFor();
  await page.getByText("the stored mapping `rig 7` is used").waitFor();
  assert.equal((await measured()).length, 2);
});

test("what a response and a magnitude are is asked for by name", async () => {
  const page = await visit("/");
  await drop(page, "bode.csv", BODE);
  await page.getByText("Not yet understood").waitFor();
  for (const [field, value] of [[/^Response ?Kind/, "velocity rad/s"], [/^Magnitude of the input/, "0.5"]]) {
    const one = page.getByLabel(field);
    assert.equal(await one.getAttribute("aria-invalid"), "true");
    await one.fill(value);
    await one.press("Tab");
  }
  await page.getByText("This is understood").waitFor();
  await picture(page, "42-preview-bode");
  await page.getByRole("button", { name: "Store it" }).click();
  await page.getByRole("heading", { name: "Start a job" }).waitFor();
  forgive(page);
});

test("a file that is understood is shown before it is stored where that is asked for", async () => {
  const before = (await measured()).length;
  const page = await visit("/");
  await page.getByLabel("Show how it is read before it is stored").check();
  await drop(page, "sticky.csv", simulated(STICKY));
  await page.getByText("This is understood").waitFor();
  await picture(page, "43-preview-understood");
  assert.equal((await measured()).length, before);
  assert.equal(await page.getByLabel("What omega_rad_s is").inputValue(), "frequency");
  await page.getByRole("button", { name: "Cancel" }).click();
  assert.equal(await page.locator(".preview").count(), 0);
  await drop(page, "sticky.csv", simulated(STICKY));
  await page.getByRole("button", { name: "Store it" }).click();
  await page.getByRole("heading", { name: "Start a job" }).waitFor();
  assert.equal((await measured()).length, before + 1);
});

test("nothing keeps anybody from a preview, in either colour scheme or on a phone", async () => {
  for (const options of [{ colorScheme: "light" }, { colorScheme: "dark" }, { viewport: { width: 390, height: 844 } }]) {
    const page = await visit("/", options);
    await drop(page, "other.txt", foreign().replace("chan b", "chan c"));
    await page.getByText("Not yet understood").waitFor();
    await page.evaluate(() => document.querySelectorAll("details").forEach((section) => (section.open = true)));
    assert.deepEqual(await faults(page), []);
    assert.ok(!await overflows(page), "the preview is too wide");
    await picture(page, `44-preview-${options.colorScheme ?? "phone"}`, { fullPage: true });
    const unnamed = await page.locator(".preview button, .preview input, .preview select").evaluateAll((all) =>
      all.filter((one) => !(one.textContent.trim() && one.tagName === "BUTTON" || one.ariaLabel || one.labels?.length)).map((one) => one.outerHTML));
    assert.deepEqual(unnamed, []);
    forgive(page);
  }
});

test("a mapping is deleted where mappings are listed", async () => {
  const page = await visit("/");
  await page.getByRole("button", { name: "Delete the mapping rig 7" }).click();
  await page.getByRole("dialog").getByRole("button", { name: "Delete" }).click();
  await page.locator("#mappings").waitFor({ state: "hidden" });
  assert.deepEqual((await (await fetch(`${server.address}/v1/mappings`)).json()).items, []);
});

test("a stored file is read again in other units, until there is a job on it", async () => {
  const { id } = await server.post("/v1/measurements?input=current%20A&response=velocity%20rad/s", simulated([]), "text/csv");
  const page = await visit(`/measurements/${id}`);
  const facts = page.locator("#what + dl");
  assert.match(await facts.textContent(), /Inputcurrent, A.*Responsevelocity, rad\/s/);
  await page.getByRole("button", { name: "Read it again …" }).click();
  const response = page.getByRole("textbox", { name: /^Response/ });
  assert.equal(await response.inputValue(), "velocity rad/s");
  await response.fill("position mm");
  await page.getByRole("textbox", { name: /^Input/ }).fill("force N");
  await response.press("Tab");
  await page.locator(".understood", { hasText: /from force \(N\) to position \(mm\)/ }).waitFor();
  await picture(page, "44-read-again");
  assert.deepEqual(await faults(page), []);
  await page.getByRole("button", { name: "Apply these settings" }).click();
  await page.locator("#what + dl", { hasText: /Responseposition, mm/ }).waitFor();

  await server.post("/v1/jobs", { measurement_id: id, kind: "identify", plant: { actuator_order: 0 } });
  await page.getByRole("button", { name: "Read it again …" }).click();
  await page.getByText(/This measurement has results that depend/).waitFor();
  await page.getByRole("button", { name: "Close" }).click();
  assert.equal(await page.getByText(/This measurement has results that depend/).isVisible(), false);
});

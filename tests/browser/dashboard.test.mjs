// The dashboard as a person meets it: a real browser, the real program.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";

import { drop, overflows, picture } from "./page.mjs";
import { STICKY, simulated } from "./server.mjs";
import { stage } from "./stage.mjs";

const PHONE = { viewport: { width: 390, height: 844 } };
/// Far more than a diagnosis takes.
const PATIENCE = 600_000;
const PRESS = { machine: "press 4", axis: "Y" };

const { server, visit } = stage();
/// A diagnosis that has ended, which several tests look at.
let diagnosed;

/// Notes, in a page until it is loaded again, what it shows of a job that runs. It looks
/// from within: a fast machine answers between two looks from outside.
function watched() {
  globalThis.seen = { shares: new Set(), drawings: new Set() };
  setInterval(() => {
    const bar = document.querySelector(".live progress");
    const figure = document.querySelector(".live server-figure");
    if (bar) seen.shares.add(bar.value);
    if (figure?.shadowRoot.firstChild) seen.drawings.add(figure.shadowRoot.innerHTML.length);
  }, 20);
}

test("an empty server says what to do", async () => {
  const page = await visit("/");
  await page.getByRole("heading", { name: "Nothing has been measured yet" }).waitFor();
  assert.ok(await page.getByRole("button", { name: "Diagnose the example" }).isEnabled());
  await picture(page, "01-empty");
  await page.getByRole("link", { name: "Axes" }).click();
  await page.getByRole("heading", { name: "No axis is known yet" }).waitFor();
  await picture(page, "02-no-axis");
});

test("a bad file is refused at its line, and nothing is stored", async () => {
  const page = await visit("/");
  const lines = simulated(STICKY).split("\n");
  const at = lines.findIndex((line) => /^\d/.test(line)) + 4;
  lines[at] = lines[at].replace(/^[^,]*/, "two");
  await drop(page, "bad.csv", lines.join("\n"));
  const wrong = page.locator(".line.wrong");
  await wrong.waitFor();
  assert.match(await wrong.textContent(), new RegExp(`^\\s*${at + 1}two,`));
  assert.match(await page.getByRole("alert").textContent(), /Nothing was stored/);
  assert.match(await page.getByRole("alert").textContent(), /two/);
  await picture(page, "03-bad-file");
  // The browser itself notes that the server refused.
  page.wrong = page.wrong.filter((text) => !text.includes("422"));
  const { items } = await (await fetch(`${server.address}/v1/measurements`)).json();
  assert.equal(items.length, 0);
});

test("a file is dropped, diagnosed, watched to its end, and the cause is read", async () => {
  const page = await visit("/");
  // So many frequencies that the diagnosis takes a few seconds.
  const about = { ...PRESS, measured_at: "2026-03-04T10:20:00Z", operator: "Ada" };
  await drop(page, "sticky.csv", simulated(STICKY, about, 32));
  await page.getByRole("heading", { name: "Start a job" }).waitFor();
  await picture(page, "04-measurement", { fullPage: true });
  await page.evaluate(watched);
  await page.getByRole("button", { name: "Start", exact: true }).click();

  // Progress arrives while somebody looks: the share grows, the figure is drawn again.
  await page.waitForFunction(() => seen.drawings.size > 1 || document.querySelector(".verdict"));
  await picture(page, "05-running");
  const verdict = page.locator(".verdict");
  await verdict.waitFor({ timeout: PATIENCE });
  const [shares, drawings] = await page.evaluate(() => [seen.shares.size, seen.drawings.size]);
  assert.ok(shares > 3 && drawings > 1, `${shares} shares and ${drawings} drawings were seen`);

  assert.match(await verdict.textContent(), /Explained.*static friction/);
  const sections = await page.locator(".answer > details > summary > h2").allTextContents();
  assert.deepEqual(sections, ["How sure?", "What else could it be?", "Where is it wrong?", "Friction", "Harmonics",
    "Convergence", "Parameters", "Provenance", "Test on another measurement"]);
  const figures = await page.locator("server-figure").evaluateAll((all) => all.map((one) => one.shadowRoot.querySelector("svg").id));
  for (const name of ["bode-errors", "spectrum", "residuals", "residuals-after", "convergence", "friction-after"]) {
    assert.ok(figures.includes(`servoscope-${name}`), `${name} is not among ${figures}`);
  }
  diagnosed = new URL(page.url()).pathname;
  await picture(page, "06-answer");
  await picture(page, "07-answer-whole", { fullPage: true });
});

test("the report and the data are downloaded", async () => {
  const page = await visit(diagnosed);
  const fetched = async (link) => {
    const waiting = page.waitForEvent("download");
    await link.click();
    return readFile(await (await waiting).path(), "utf8");
  };
  const report = await fetched(page.getByRole("link", { name: "Report", exact: true }));
  assert.match(report, /^<!DOCTYPE html>[^]*static friction/);
  await page.getByText("Data and figures").click();
  await picture(page, "08-downloads");
  assert.match(await fetched(page.getByRole("link", { name: "Result, JSON" })), /"verdict":"explained"/);
  assert.match(await fetched(page.getByRole("link", { name: "Parameters, CSV" })), /static_friction\.fs_plus/);
  for (const figure of ["bode-errors", "residuals-after"]) {
    assert.match(await fetched(page.getByRole("link", { name: `Figure: ${figure}, SVG` })), /^<svg/);
    await page.locator(".menu").evaluate((menu) => (menu.open = true));
  }
});

test("a result is tried on another measurement", async () => {
  const other = await server.post("/v1/measurements", simulated([...STICKY, "--seed", "5"], { ...PRESS, measured_at: "2026-03-11T10:20:00Z" }), "text/csv");
  const stranger = await server.post("/v1/measurements", simulated([...STICKY, "--seed", "6"], {}), "text/csv");
  const page = await visit(diagnosed);
  await page.locator("#tried > summary").click();
  const choice = page.getByRole("combobox", { name: "Measurement" });
  assert.equal(await choice.inputValue(), other.id, "the same axis comes before what is newer");
  await choice.selectOption(other.id);
  await page.getByRole("button", { name: "Test", exact: true }).click();
  const tried = page.locator("#tried");
  await tried.getByText(/^Verdict/).waitFor();
  assert.match(await tried.textContent(), /Static friction helps here, too[^]*With static friction[^]*Verdict: explained/);
  await tried.scrollIntoViewIfNeeded();
  await picture(page, "09-tried");
  for (const { id } of [other, stranger]) await fetch(`${server.address}/v1/measurements/${id}`, { method: "DELETE" });
});

test("a job is cancelled, started again and deleted", async () => {
  const page = await visit("/");
  await page.locator("#measurements").getByRole("link", { name: "Start …" }).first().click();
  await page.getByLabel("Seed").fill("7");
  await page.getByLabel("Priority").selectOption("high");
  await page.getByRole("button", { name: "Start", exact: true }).click();
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByRole("heading", { name: "Cancelled" }).waitFor();
  await picture(page, "10-cancelled");
  await page.getByRole("link", { name: "Start again …" }).click();
  await page.getByRole("heading", { name: "Start it again" }).waitFor();
  assert.equal(await page.getByLabel("Seed").inputValue(), "7");
  assert.equal(await page.getByLabel("Priority").inputValue(), "high");
  await page.goBack();
  await page.getByRole("button", { name: "Delete" }).click();
  await picture(page, "11-delete");
  await page.getByRole("dialog").getByRole("button", { name: "Delete" }).click();
  await page.getByRole("heading", { name: "Start a job" }).waitFor();
});

test("what the server refuses of a form is said at its field", async () => {
  const page = await visit("/");
  await page.locator("#measurements").getByRole("link", { name: "Start …" }).first().click();
  await page.getByLabel("Noise, standard deviation").fill("-1");
  await page.getByRole("button", { name: "Start", exact: true }).click();
  await page.locator("[name=noise_std][aria-invalid]").waitFor();
  assert.match(await page.locator(".wrong").textContent(), /noise_std/);
  await picture(page, "12-refused-form", { fullPage: true });
  page.wrong = page.wrong.filter((text) => !text.includes("422"));
});

test("everything is reached with the keyboard", async () => {
  const page = await visit("/");
  await page.locator("#measurements").waitFor();
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.textContent), "Skip to the content");
  await picture(page, "13-keyboard");
  await page.keyboard.press("Enter");
  const stops = [];
  for (let i = 0; i < 24; i += 1) {
    await page.keyboard.press("Tab");
    stops.push(await page.evaluate(() => {
      const { textContent, id, ariaLabel, labels } = document.activeElement;
      return textContent || id || ariaLabel || labels?.[0]?.textContent || "";
    }));
  }
  for (const stop of ["files", "Diagnosis", "press 4, Y"]) {
    assert.ok(stops.some((text) => text.includes(stop)), `${stop} is not among ${stops}`);
  }
  const unnamed = await page.locator("button, a[href], input, select").evaluateAll((all) =>
    all.filter((one) => !(one.textContent.trim() || one.ariaLabel || one.labels?.length)).map((one) => one.outerHTML));
  assert.deepEqual(unnamed, []);
});

test("the history of an axis marks what changed, and two jobs stand side by side", async () => {
  const poles = { "2026-03-11T10:20:00Z": "-10", "2026-03-18T10:20:00Z": "-10", "2026-04-01T10:20:00Z": "-10.6" };
  let seed = 2;
  const ids = [];
  for (const [measured_at, pole] of Object.entries(poles)) {
    const file = simulated(["--pole", pole, "--seed", String((seed += 1))], { machine: "mill", axis: "B", measured_at });
    const job = await server.answered(file);
    assert.equal(job.status, "succeeded");
    ids.push(job.id);
  }
  const page = await visit("/axes");
  await page.getByRole("link", { name: "mill, B" }).click();
  await page.locator("server-figure").waitFor();
  const changed = page.locator("tr", { has: page.getByText("changed", { exact: true }) });
  assert.ok(await changed.count() >= 1);
  assert.match((await changed.allTextContents()).join(), /2026-04-01.*−10\.(59|60)/);
  await picture(page, "14-history", { fullPage: true });

  await page.goto(`${server.address}/`);
  const rows = page.locator("#jobs tbody tr", { hasText: "mill" });
  await rows.nth(0).getByRole("checkbox").check();
  await rows.nth(1).getByRole("checkbox").check();
  await picture(page, "15-overview", { fullPage: true });
  await page.getByRole("button", { name: "Compare" }).click();
  await page.getByRole("heading", { name: "Two jobs side by side" }).waitFor();
  assert.match(await page.locator("tr.changed").first().textContent(), /Pole.*more than the uncertainty of both/);
  const both = page.locator("section", { has: page.getByRole("heading", { name: "Both in one diagram" }) });
  for (const side of ["left", "right"]) await both.locator(`[data-series^="${side} "]`).first().waitFor({ state: "attached" });
  await page.locator("server-figure").nth(5).waitFor();
  await page.waitForLoadState("networkidle");
  await picture(page, "16-compare", { fullPage: true });
});

test("numbers of different units are not compared", async () => {
  const ids = [];
  for (const input of ["current A", "voltage V"]) {
    ids.push((await server.answered(simulated([], { input, response: "velocity rad/s" }))).id);
  }
  const page = await visit(`/compare?a=${ids[0]}&b=${ids[1]}`);
  await page.getByText("Their gains have different units: velocity (rad/s) over input (A) on the left").waitFor();
  assert.match(await page.locator("tr", { hasText: "Dry friction forwards" }).textContent(), /A, V.*different units: not compared/);
  assert.doesNotMatch(await page.locator("tr", { hasText: "Pole" }).first().textContent(), /not compared/);
  await page.waitForLoadState("networkidle");
});

test("both colour schemes are the system's or the reader's choice", async () => {
  const background = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const inFigure = (page) => page.locator("server-figure").first().evaluate((figure) => getComputedStyle(figure.shadowRoot.querySelector(".bg")).fill);
  const page = await visit(diagnosed, { colorScheme: "dark" });
  await page.locator(".verdict").waitFor();
  const [dark, darkFigure] = [await background(page), await inFigure(page)];
  assert.equal(dark, darkFigure);
  await picture(page, "17-answer-dark");
  await picture(page, "18-answer-dark-whole", { fullPage: true });
  await page.getByLabel("Colours").selectOption("light");
  const light = await background(page);
  assert.notEqual(light, dark);
  assert.equal(await inFigure(page), light);
  await page.reload();
  await page.locator(".verdict").waitFor();
  assert.equal(await background(page), light, "the choice is kept");
  await page.goto(`${server.address}/`);
  await page.getByLabel("Colours").selectOption("dark");
  await page.locator("#jobs tbody tr").first().waitFor();
  await picture(page, "19-overview-dark");
});

test("a phone shows everything without moving the page sideways", async () => {
  const page = await visit("/", PHONE);
  await page.locator("#jobs tbody tr").first().waitFor();
  await picture(page, "20-phone-overview", { fullPage: true });
  assert.ok(!await overflows(page), "the overview is too wide");
  const places = { "21-phone-answer": diagnosed, "22-phone-axis": "/axes?machine=mill&axis=B", "23-phone-axes": "/axes" };
  for (const [name, path] of Object.entries(places)) {
    await page.goto(server.address + path);
    await page.locator("h1").waitFor();
    await page.waitForLoadState("networkidle");
    await picture(page, name, { fullPage: true });
    assert.ok(!await overflows(page), `${path} is too wide`);
  }
  await page.goto(server.address + diagnosed);
  await page.locator(".trail a").last().click();
  await page.getByRole("heading", { name: "Start a job" }).waitFor();
  await picture(page, "24-phone-measurement", { fullPage: true });
  assert.ok(!await overflows(page), "the measurement is too wide");
});

test("what is not there is said", async () => {
  const page = await visit("/jobs/nobody");
  await page.getByRole("heading", { name: "Not found" }).waitFor();
  await picture(page, "25-not-found");
  page.wrong = page.wrong.filter((text) => !text.includes("404"));
});

test("a server that goes away is noticed, and its job goes on when it is back", async () => {
  const page = await visit("/");
  await drop(page, "again.csv", simulated(STICKY, {}, 33));
  await page.getByRole("button", { name: "Start", exact: true }).click();
  await page.locator("progress").waitFor();
  await page.waitForFunction(() => document.querySelector("progress").value > 0);
  await server.kill();
  await page.getByText("The server does not answer").waitFor();
  await picture(page, "26-away");
  await server.start();
  await page.getByText("The server is back").waitFor();
  await picture(page, "27-back");
  await page.getByText("attempt 2").waitFor();
  await page.locator(".verdict").waitFor({ timeout: PATIENCE });
  assert.match(await page.locator(".verdict").textContent(), /static friction/);
  // While the server is away the browser itself notes each request that fails.
  page.wrong = page.wrong.filter((text) => !/ERR_CONNECTION|ERR_INCOMPLETE|ERR_EMPTY|Failed to load resource/.test(text));
});

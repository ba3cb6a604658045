// The answer as it is looked at: on one screen, and figures that are read off.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";

import { faults } from "./axe.mjs";
import { drop, overflows, picture } from "./page.mjs";
import { STICKY, simulated } from "./server.mjs";
import { stage } from "./stage.mjs";

const PATIENCE = 600_000;

const { server, visit } = stage();
/// The address of a diagnosis that has ended, and that of its report.
let diagnosed;
let report;

/// Asserts that something is seen whole without scrolling.
async function seen(page, locator, name) {
  const box = await locator.boundingBox();
  const { height } = page.viewportSize();
  assert.ok(box && box.y >= 0 && box.y + box.height <= height, `${name} is not on the first screen: ${JSON.stringify(box)}`);
  assert.equal(await page.evaluate(() => scrollY), 0);
}

test("a measurement says what it can show before anything is computed", async () => {
  const page = await visit("/");
  await drop(page, "axis.csv", simulated([]));
  const shown = page.getByText(/This measurement can reveal 1\d of 17 effects/);
  await shown.waitFor({ timeout: PATIENCE });
  await shown.click();
  await page.getByRole("row", { name: /^static friction Static friction forwards 0\.5/ }).waitFor();
  await page.locator("server-figure").first().waitFor();
  assert.equal(await page.getByText("Looks wrong").count(), 0);
});

test("from the drop of a file to its answer nobody scrolls", async () => {
  const page = await visit("/");
  await seen(page, page.locator(".drop"), "the place to drop a file");
  await drop(page, "sticky.csv", simulated(STICKY, { machine: "press 4", axis: "Y", input: "current A", response: "velocity rad/s" }));
  const start = page.getByRole("button", { name: "Start", exact: true });
  await start.waitFor();
  await seen(page, start, "the button that starts a job");
  await start.click();
  await page.locator(".verdict").waitFor({ timeout: PATIENCE });
  diagnosed = new URL(page.url()).pathname;
  report = `/v1${diagnosed}/report.html`;
  await seen(page, page.locator(".verdict"), "the verdict");
  await seen(page, page.locator(".first server-figure"), "the response");
  for (const name of ["cause", "gain", "next"]) await seen(page, page.locator(`.card.${name}`), name);
  assert.match(await page.locator(".card.cause").textContent(), /Static friction.*0\.80.*± .*A.*above dry friction/i);
  await picture(page, "30-answer-screen");
});

test("the report stands on one screen, too, and weighs little", async () => {
  const page = await visit(report);
  await seen(page, page.locator(".first svg"), "the response");
  for (const name of ["cause", "gain", "next"]) await seen(page, page.locator(`.card.${name}`), name);
  await picture(page, "31-report-screen");
  const text = await (await fetch(server.address + report)).text();
  assert.ok(text.length < 1_500_000, `${text.length} bytes`);
  await page.locator("#departure > summary").click();
  await page.locator("#servoscope-residuals").waitFor();
  for (const [name, width] of [["32-report-tablet", 768], ["33-report-phone", 390]]) {
    await page.setViewportSize({ width, height: 844 });
    assert.ok(!await overflows(page), `too wide at ${width}`);
    await picture(page, name, { fullPage: true });
  }
});

for (const place of ["report", "dashboard"]) {
  test(`a figure is read off with the pointer: ${place}`, async () => {
    const page = await visit(place === "report" ? report : diagnosed);
    const svg = page.locator(".first svg");
    await svg.waitFor();
    const texts = () => svg.evaluate((all) => [...all.querySelectorAll("text")].map((text) => text.textContent));
    const ticks = () => svg.evaluate((all) => [...all.querySelectorAll("[data-panel]")].map((grid) => [...grid.querySelectorAll("text")].map((text) => text.textContent).join()));
    const box = await svg.boundingBox();
    const at = [box.x + 0.3 * box.width, box.y + 0.38 * box.height];
    await page.mouse.move(...at);
    for (const part of ["with causes", "base model", "error after"]) assert.ok((await texts()).includes(part), part);

    // A wheel over a figure that nobody has turned to scrolls the page.
    const before = await ticks();
    await page.mouse.wheel(0, 10);
    assert.deepEqual(await ticks(), before);
    await page.evaluate(() => scrollTo(0, 0));
    await page.mouse.click(...at);
    await page.mouse.wheel(0, -400);
    await page.waitForFunction(([path, was]) => {
      const first = document.querySelector(path);
      const grids = (first.shadowRoot ?? first).querySelectorAll("[data-panel]");
      return grids[1] && grids[1].textContent !== was;
    }, [place === "report" ? ".first svg" : ".first server-figure", before[1].replaceAll(",", "")]);
    const zoomed = await ticks();
    assert.ok(zoomed.every((text, i) => text !== before[i] || i % 2 === 0), "panels of one frequency axis move together");
    await page.mouse.dblclick(...at);
    assert.deepEqual(await ticks(), before);

    const hidden = () => svg.evaluate((all) => [...all.querySelectorAll("[data-keys~=before]")].every((group) => group.style.display === "none"));
    assert.equal(await hidden(), false);
    await svg.locator("[data-toggle=before]").click();
    assert.equal(await hidden(), true);
    for (const [name, begin] of [["Save SVG", "<svg"], ["Save PNG", "\x89PNG"]]) {
      const waiting = page.waitForEvent("download");
      await page.locator(".first").getByRole("button", { name }).click();
      const kept = await readFile(await (await waiting).path(), "latin1");
      assert.ok(kept.startsWith(begin), kept.slice(0, 40));
    }
    await picture(page, `34-read-off-${place}`);
  });
}

test("a figure is read off with the keyboard", async () => {
  const page = await visit(report);
  const svg = page.locator(".first svg");
  await svg.focus();
  const said = page.locator("p.unseen");
  await page.keyboard.press("ArrowRight");
  const first = await said.textContent();
  assert.match(first, /A, [\d.]+ Hz; Gain \(dB\); .*−?\d/);
  await page.keyboard.press("ArrowRight");
  const next = await said.textContent();
  assert.notEqual(next, first);
  const path = () => svg.evaluate((all) => all.querySelector(".simulated path").getAttribute("d"));
  const drawn = await path();
  await page.keyboard.press("+");
  const zoomed = await path();
  assert.notEqual(zoomed, drawn);
  await page.keyboard.press("Shift+ArrowRight");
  assert.notEqual(await path(), zoomed);
  await page.keyboard.press("0");
  assert.equal(await path(), drawn);
  const ring = await svg.evaluate((all) => getComputedStyle(all).outlineStyle);
  assert.notEqual(ring, "none");
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  assert.equal(await svg.locator("[data-toggle=measured]").getAttribute("aria-pressed"), "false");
});

test("the map of residuals is read off cell by cell", async () => {
  const page = await visit(report);
  await page.locator("#departure > summary").click();
  const svg = page.locator("#servoscope-residuals");
  const texts = () => svg.locator("text").allTextContents();
  const cell = svg.locator(".cells rect").nth(2);
  const hint = await cell.locator("title").textContent();
  const [where, size] = hint.split(": ");
  assert.match(hint, /^[\d.]+\u00a0?\s?A, [\d.]+ Hz, k = \d+: [\d.]+ σ$/);
  await cell.hover();
  assert.ok((await texts()).includes(where) && (await texts()).includes(size), hint);
  await page.mouse.move(0, 0);

  await svg.focus();
  const said = page.locator("p.unseen");
  const read = async (key) => (await page.keyboard.press(key), said.textContent());
  const first = await read("ArrowRight");
  assert.match(first, /A, [\d.]+ Hz, k = \d+; [\d.]+ σ/);
  assert.notEqual(await read("ArrowRight"), first);
  // Down through the harmonics of a magnitude to those of the next.
  const magnitudes = new Set();
  for (let i = 0; i < 8; i += 1) magnitudes.add((await read("ArrowDown")).split(",")[0]);
  assert.ok(magnitudes.size > 1, [...magnitudes].join());

  const width = async () => Number(await cell.getAttribute("width"));
  const [drawn, height] = [await width(), await cell.getAttribute("height")];
  await page.keyboard.press("+");
  assert.ok(await width() > 1.3 * drawn, "frequencies are zoomed");
  assert.ok(Math.abs(await cell.getAttribute("height") - height) < 0.1, "rows stay");
  await page.keyboard.press("0");
  assert.equal(await width(), drawn);
});

test("every figure of a job says what the cursor is on", async () => {
  const page = await visit(report);
  await page.evaluate(() => document.querySelectorAll("details").forEach((section) => (section.open = true)));
  const figures = await page.locator("figure svg[id]").all();
  assert.ok(figures.length > 5, `${figures.length} figures`);
  const said = page.locator("p.unseen");
  for (const svg of figures) {
    await said.evaluate((all) => (all.textContent = ""));
    await svg.focus();
    await page.keyboard.press("ArrowRight");
    assert.match(await said.textContent(), /\d/, await svg.getAttribute("id"));
  }
});

test("the page of a job is small as it is sent", async () => {
  const page = await visit(diagnosed);
  await page.locator(".verdict").waitFor();
  await page.waitForLoadState("networkidle");
  const sent = await page.evaluate(() => performance.getEntries()
    .filter(({ entryType }) => ["navigation", "resource"].includes(entryType))
    .map(({ name, transferSize }) => [name, transferSize]));
  const bytes = sent.reduce((sum, [, size]) => sum + size, 0);
  assert.ok(bytes > 20_000, "it is counted");
  assert.ok(bytes < 1_500_000, JSON.stringify(sent));
  // Three are asked for by address, the others are files of the page.
  assert.ok(sent.filter(([name]) => !name.includes("/assets/")).length < 12, JSON.stringify(sent));
});

test("two fingers zoom a figure, and one tap shows values", async () => {
  const page = await visit(report, { viewport: { width: 390, height: 844 }, hasTouch: true });
  const svg = page.locator(".phone svg");
  await svg.scrollIntoViewIfNeeded();
  const box = await svg.boundingBox();
  const at = { x: box.x + 0.25 * box.width, y: box.y + 0.35 * box.height };
  await page.touchscreen.tap(at.x, at.y);
  assert.ok((await svg.locator("text").allTextContents()).includes("with causes"));
  const path = () => svg.evaluate((all) => all.querySelector(".simulated path").getAttribute("d"));
  const drawn = await path();
  const touch = await page.context().newCDPSession(page);
  const fingers = (apart) => [-1, 1].map((side, id) => ({ x: at.x + side * apart, y: at.y, id }));
  await touch.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: fingers(20) });
  for (const apart of [30, 40, 50]) await touch.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: fingers(apart) });
  await touch.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  assert.notEqual(await path(), drawn);
});

test("nothing keeps anybody from using a page", async () => {
  const { items } = await (await fetch(`${server.address}/v1/jobs`)).json();
  const places = ["/", `/measurements/${items[0].measurement_id}`, diagnosed, "/axes", report];
  for (const colorScheme of ["light", "dark"]) {
    for (const path of places) {
      const page = await visit(path, { colorScheme });
      await page.waitForLoadState("networkidle");
      await page.locator("h1").first().waitFor();
      await page.evaluate(() => document.querySelectorAll("details").forEach((section) => (section.open = true)));
      assert.deepEqual(await faults(page), [], `${path}, ${colorScheme}`);
    }
  }
});

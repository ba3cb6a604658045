// How soon the page of a job is drawn and how much of it is sent, in a real browser.
//
//   npm run timing --prefix tests/browser -- [FILE…]
//
// Of each file a diagnosis is made (of an axis that sticks, where none is named), and its page is
// opened: ten times by a browser that has nothing of it yet. It prints medians, with the smallest and the
// largest. Times depend on the machine; nothing is asserted.

import { readFileSync } from "node:fs";
import { basename } from "node:path";

import { browser as launched } from "./page.mjs";
import { STICKY, Server, simulated } from "./server.mjs";

const TIMES = 10;
const PLACES = [["page", (id) => `/jobs/${id}`, ".verdict"], ["report", (id) => `/v1/jobs/${id}/report.html`, ".first svg"]];

const named = process.argv.slice(2);
const files = named.length > 0 ? named.map((path) => [basename(path), readFileSync(path)]) : [["sticking axis", simulated(STICKY)]];
const server = new Server();
await server.start();
const browser = await launched();
console.log(["file", "place", "first drawing, ms", "answer, ms", "sent, kB", "requests"].join("\t"));
for (const [name, file] of files) {
  const { id, status } = await server.answered(file, { kind: "diagnose" });
  if (status !== "succeeded") throw new Error(`${name}: ${status}`);
  for (const [place, path, answer] of PLACES) {
    const seen = [];
    for (let i = 0; i < TIMES; i += 1) seen.push(await opened(server.address + path(id), answer));
    const column = (member) => seen.map((one) => one[member]).sort((a, b) => a - b);
    const spread = (member) => ((all) => `${Math.round(all[TIMES / 2])} (${Math.round(all[0])}–${Math.round(all.at(-1))})`)(column(member));
    console.log([name, place, spread("drawn"), spread("answered"), spread("sent"), column("requests")[TIMES / 2]].join("\t"));
  }
}
await browser.close();
await server.end();

/// What a new browser notes of a page: when something was drawn, when the answer stood there, and what was sent.
async function opened(address, answer) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  const page = await context.newPage();
  await page.goto(address);
  await page.locator(answer).waitFor();
  const answered = await page.evaluate(() => performance.now());
  await page.waitForLoadState("networkidle");
  const noted = await page.evaluate(() => {
    const sent = performance.getEntries().filter(({ entryType }) => ["navigation", "resource"].includes(entryType));
    return {
      drawn: performance.getEntriesByName("first-contentful-paint")[0].startTime,
      sent: sent.reduce((sum, { transferSize }) => sum + transferSize, 0) / 1000,
      requests: sent.length,
    };
  });
  await context.close();
  return { answered, ...noted };
}

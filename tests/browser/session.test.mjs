// A server with keys, as a person meets it.

import assert from "node:assert/strict";
import { test } from "node:test";

import { picture } from "./page.mjs";
import { stage } from "./stage.mjs";

const { server, visit } = stage();
let key;

test("a server with a key asks for it, and a wrong one is refused beside the form", async () => {
  ({ key } = await server.post("/v1/keys", { name: "Ada", scopes: ["admin"] }));
  const page = await visit("/axes");
  await page.getByRole("heading", { name: "This server asks for a key" }).waitFor();
  await picture(page, "20-sign-in");
  await page.getByLabel("Key").fill("sk_servoscope_wrong");
  await page.getByRole("button", { name: "Sign in" }).click();
  await page.getByText("The server does not know this key").waitFor();
  // The browser itself notes that the server refused.
  page.wrong = page.wrong.filter((text) => !text.includes("401"));
});

test("whoever signs in sees what was asked for, uses it, and signs out", async () => {
  const page = await visit("/axes");
  await page.getByLabel("Key").fill(key);
  await page.getByRole("button", { name: "Sign in" }).click();
  await page.getByRole("heading", { name: "No axis is known yet" }).waitFor();
  await page.getByText("Ada").waitFor();
  await picture(page, "21-signed-in");
  assert.equal(await page.evaluate(() => document.cookie), "", "no script sees the session");
  await page.getByRole("link", { name: "Overview" }).click();
  await page.getByRole("button", { name: "Diagnose the example" }).click();
  // Its events arrive: the answer is shown without a reload.
  await page.locator(".verdict").waitFor({ timeout: 600_000 });
  await page.getByRole("button", { name: "Sign out" }).click();
  await page.getByRole("heading", { name: "This server asks for a key" }).waitFor();
  page.wrong = page.wrong.filter((text) => !text.includes("401"));
});

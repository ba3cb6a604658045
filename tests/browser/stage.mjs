// What every file of tests stands on: a server and a browser of its own, and pages whose errors
// count.

import assert from "node:assert/strict";
import { after, afterEach, before } from "node:test";

import { browser as launched, open } from "./page.mjs";
import { Server } from "./server.mjs";

/// A server, and `visit`, which opens a page of it; both end with the tests of the file.
export function stage() {
  const server = new Server();
  const pages = [];
  let browser;

  before(async () => {
    await server.start();
    browser = await launched();
  });

  after(async () => {
    await browser?.close();
    await server.end();
  });

  afterEach(async () => {
    for (const page of pages.splice(0)) {
      await page.context().close();
      assert.deepEqual(page.wrong, []);
    }
  });

  /// A page whose errors are counted when its test ends.
  async function visit(path, options) {
    const page = await open(browser, server, path, options);
    pages.push(page);
    return page;
  }
  return { server, visit };
}

// The program as a process, and measurements that it simulates.

import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";

const repository = fileURLToPath(new URL("../..", import.meta.url));

/// The program that is tried: of `SERVOSCOPE`, or as `cargo build` leaves it.
const program = resolve(repository, process.env.SERVOSCOPE ?? "target/debug/servoscope");

/// Where pictures of every state are left.
export const pictures = resolve(repository, "target/screenshots");

/// A server with a folder of its own, which goes when the server is ended.
export class Server {
  #folder = mkdtempSync(join(tmpdir(), "servoscope-"));
  #child;
  address;

  /// Starts it, the second time where it was before.
  async start() {
    const listen = this.address?.replace("http://", "") ?? "127.0.0.1:0";
    const args = ["serve", "--listen", listen, "--data-dir", this.#folder, "--lease-seconds", "2"];
    this.#child = spawn(program, args, { stdio: ["ignore", "pipe", "ignore"] });
    const lines = createInterface({ input: this.#child.stdout });
    for await (const line of lines) {
      this.address = line.replace("listening on ", "").trim();
      return;
    }
    throw new Error(`${program} did not start`);
  }

  /// As a power cut ends it.
  async kill() {
    const gone = new Promise((done) => this.#child.once("exit", done));
    this.#child.kill("SIGKILL");
    await gone;
  }

  async end() {
    await this.kill();
    rmSync(this.#folder, { recursive: true, force: true });
  }

  async post(path, body, type = "application/json") {
    const text = type === "application/json" ? JSON.stringify(body) : body;
    const answer = await fetch(this.address + path, { method: "POST", headers: { "content-type": type }, body: text });
    if (!answer.ok) throw new Error(await answer.text());
    return answer.json();
  }

  /// Uploads a file, has it identified or diagnosed, and gives the job at its end.
  async answered(file, request = { kind: "identify", plant: { actuator_order: 0 } }) {
    const measurement = await this.post("/v1/measurements", file, "text/csv");
    const { id } = await this.post("/v1/jobs", { measurement_id: measurement.id, ...request });
    for (;;) {
      const job = await (await fetch(`${this.address}/v1/jobs/${id}?wait=30`)).json();
      if (!["queued", "running"].includes(job.status)) return job;
    }
  }
}

/// A measurement with these lines in front.
export function simulated(flags, metadata = {}, frequencies = 9) {
  const design = ["--noise-db", "60", "--harmonics", "5", "--frequency-range", `1:100:${frequencies}`];
  const table = execFileSync(program, ["simulate", ...design, ...flags], { encoding: "utf8" });
  const lines = Object.entries(metadata).map(([key, value]) => `# ${key}: ${value}\n`);
  return lines.join("") + table;
}

/// An axis that sticks harder than it slides.
export const STICKY = ["--fs-plus", "0.8", "--fs-minus", "0.6"];

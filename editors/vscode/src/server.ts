// The server of `strahl preview`: its process, and the requests that the panel needs.

import { type ChildProcess, spawn } from "node:child_process";

/** A place in the text: lines and columns from 1, columns in UTF-16. */
export interface Place {
  line: number;
  column: number;
}

export interface Span {
  from: Place;
  to: Place;
}

export interface Edit extends Span {
  text: string;
}

/** The part of the server's state that the panel shows. */
export interface State {
  version: number;
  is_broken: boolean;
  diagnostics: { severity: "error" | "warning" }[];
  scene: { revision: number; width: number; height: number; cameras: string[] } | null;
}

export type Query = Record<string, string | number>;

/** An answer that is not a success. */
export class Refused extends Error {
  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
  }
}

export class PreviewServer {
  private constructor(
    private readonly child: ChildProcess,
    /** The address of the page, with the token. */
    readonly address: string,
  ) {}

  /** Starts the program, and waits for the address that it prints. */
  static start(program: string, file: string, folder: string): Promise<PreviewServer> {
    const child = spawn(program, ["preview", "--no-open", file], {
      cwd: folder,
      env: { ...process.env, NO_COLOR: "1" },
      stdio: ["ignore", "pipe", "pipe"],
      windowsHide: true,
    });
    return new Promise((done, fail) => {
      let printed = "";
      let complaint = "";
      child.stdout.setEncoding("utf8").on("data", (text: string) => {
        printed += text;
        const end = printed.indexOf("\n");
        if (end >= 0) done(new PreviewServer(child, printed.slice(0, end).trim()));
      });
      child.stderr.setEncoding("utf8").on("data", (text: string) => {
        complaint += text;
      });
      child.on("error", fail);
      child.on("exit", () => fail(new Error(complaint.trim() || "strahl preview has ended")));
    });
  }

  /** Calls back once the program has ended. */
  onEnd(callback: () => void): void {
    this.child.once("exit", callback);
    if (this.child.exitCode !== null || this.child.signalCode !== null) callback();
  }

  stop(): void {
    this.child.kill();
  }

  async get(path: string, query: Query, signal?: AbortSignal): Promise<Response> {
    const parts = new URLSearchParams();
    for (const [name, value] of Object.entries(query)) parts.set(name, String(value));
    return await this.answer(`${path}?${parts}`, signal ? { signal } : {});
  }

  async getJson<T>(path: string, query: Query = {}): Promise<T> {
    return (await (await this.get(path, query)).json()) as T;
  }

  /** Edits the draft of a version; returns the new version. */
  async edit(version: number, edits: Edit[]): Promise<number> {
    const response = await this.answer("/edits", {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify({ version, edits }),
    });
    return ((await response.json()) as { version: number }).version;
  }

  /** Passes on each state until the signal aborts or the program ends. */
  async follow(onState: (state: State) => void, signal: AbortSignal): Promise<void> {
    const response = await this.answer("/events", { signal });
    const reader = response.body!.pipeThrough(new TextDecoderStream()).getReader();
    let pending = "";
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      const events = (pending + value).split("\n\n");
      pending = events.pop() ?? "";
      for (const event of events) {
        if (event.startsWith("data:")) onState(JSON.parse(event.slice(5)) as State);
      }
    }
  }

  private async answer(path: string, init: RequestInit): Promise<Response> {
    const url = new URL(this.address);
    const token = url.searchParams.get("token") ?? "";
    const headers = { ...init.headers, Authorization: `Bearer ${token}` };
    const response = await fetch(new URL(path, url.origin), { ...init, headers });
    if (!response.ok) {
      const body = (await response.json().catch(() => null)) as { error?: string } | null;
      throw new Refused(response.status, body?.error ?? response.statusText);
    }
    return response;
  }
}

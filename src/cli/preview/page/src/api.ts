// What the server offers; see src/cli/preview/routes.rs.

const token = new URLSearchParams(location.search).get("token") ?? "";

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

export interface Finding extends Span {
  code: string;
  severity: "error" | "warning";
  message: string;
  help: string | null;
  path: string;
  labels: (Span & { message: string })[];
  fix: { is_safe: boolean; edits: Edit[] } | null;
  /** The place in the table or the mesh that is at fault; the span is that of its name in the scene. */
  in_file: (Place & { file: string; message: string }) | null;
}

export interface SceneState {
  revision: number;
  width: number;
  height: number;
  samples: number;
  follows_paths: boolean;
  cameras: string[];
  has_camera: boolean;
  frames: number;
  fps: number;
  is_lit: boolean;
  exposure: number;
  geometries: number;
  layers: string[];
}

export interface State {
  file: string;
  syntax: "ron" | "json";
  version: number;
  revision: number;
  checked: number;
  is_saved: boolean;
  conflict: boolean;
  is_broken: boolean;
  diagnostics: Finding[];
  suppressed: number;
  scene: SceneState | null;
}

export interface Pixel {
  x: number;
  y: number;
  byte: [number, number, number];
  geometry:
    | (Partial<Span> & {
        path: string;
        row: number | null;
        name: string | null;
        kind: string;
        depth: number;
        position: [number, number, number];
        normal: [number, number, number];
        /** The first columns of the row of a table. */
        columns: [string, string][];
        more_columns: number;
        /** True for the text of the file, false for the numbers of the scene. */
        is_from_file: boolean;
      })
    | null;
}

/** An answer that is not a success. */
export class Refused extends Error {
  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
  }
}

export type Query = Record<string, string | number | undefined>;

function headers(): Record<string, string> {
  return { Authorization: `Bearer ${token}` };
}

async function answer(path: string, init: RequestInit): Promise<Response> {
  const response = await fetch(path, { ...init, headers: { ...headers(), ...init.headers } });
  // A refusal that can be expected is a success for the browser, which notes others in its console.
  const refused = response.headers.get("x-strahl-refused");
  if (!response.ok || refused !== null) {
    const body = (await response.json().catch(() => null)) as { error?: string } | null;
    throw new Refused(Number(refused ?? response.status), body?.error ?? response.statusText);
  }
  return response;
}

export function get(path: string, query: Query = {}, signal?: AbortSignal): Promise<Response> {
  const parts = new URLSearchParams();
  for (const [name, value] of Object.entries(query)) {
    if (value !== undefined) parts.set(name, String(value));
  }
  return answer(`${path}?${parts}`, signal ? { signal } : {});
}

export async function getJson<T>(path: string, query: Query = {}, signal?: AbortSignal): Promise<T> {
  return (await (await get(path, query, signal)).json()) as T;
}

export async function post<T>(path: string, body: unknown): Promise<T> {
  const response = await answer(path, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(body),
  });
  return (await response.json()) as T;
}

export async function upload<T>(path: string, file: Blob): Promise<T> {
  return (await (await answer(path, { method: "POST", body: file })).json()) as T;
}

/** What the worker of events.ts tells its pages. */
export type Message = { state: State } | { problem: string | null };

/** Passes on each state, and what is wrong with the connection, from the worker of all pages. */
export function listen(onState: (state: State) => void, onConnection: (problem: string | null) => void): void {
  const { port } = new SharedWorker(`/events.js${location.search}`);
  port.onmessage = ({ data }: MessageEvent<Message>) => {
    if ("state" in data) onState(data.state);
    else onConnection(data.problem);
  };
  addEventListener("pagehide", () => port.postMessage("leave"));
  addEventListener("pageshow", (event) => {
    if (event.persisted) location.reload();
  });
}

/** Passes on each state, and whether the connection stands. Tries again for ever. */
export async function follow(
  onState: (state: State) => void,
  onConnection: (problem: string | null) => void,
): Promise<never> {
  for (;;) {
    try {
      const response = await answer("/events", {});
      onConnection(null);
      for await (const data of events(response)) onState(JSON.parse(data) as State);
      onConnection("The connection to strahl is lost.");
    } catch (error) {
      const isForbidden = error instanceof Refused && error.status === 403;
      onConnection(
        isForbidden
          ? "The address has no valid token. Copy it again from the terminal."
          : "The connection to strahl is lost.",
      );
    }
    await new Promise((done) => setTimeout(done, 1000));
  }
}

/** The data of server-sent events. EventSource cannot send the token in a header. */
async function* events(response: Response): AsyncGenerator<string> {
  const reader = response.body!.pipeThrough(new TextDecoderStream()).getReader();
  let pending = "";
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    pending += value;
    const parts = pending.split("\n\n");
    pending = parts.pop() ?? "";
    for (const part of parts) {
      const lines = part.split("\n").filter((line) => line.startsWith("data:"));
      if (lines.length > 0) yield lines.map((line) => line.slice(5).trim()).join("\n");
    }
  }
}

// The picture beside the text. The panel gets everything from the extension, which asks the server:
// the server refuses to be framed, and its token stays out of the panel.

import { basename, dirname } from "node:path";
import * as vscode from "vscode";
import type { FromPanel, ToPanel } from "./panel/messages.ts";
import { PreviewServer, Refused, type Span, type State } from "./server.ts";
import { Sync } from "./sync.ts";

/** The time in milliseconds above which a coarse picture comes first. */
const SLOW = 80;

export class Preview implements vscode.Disposable {
  private readonly panel: vscode.WebviewPanel;
  private readonly sync: Sync;
  private readonly stopped = new AbortController();
  private readonly listeners: vscode.Disposable[] = [];
  private state: State | null = null;
  private camera = "";
  /** The messages that make the present panel. */
  private readonly shown = new Map<ToPanel["type"], ToPanel>();
  private drawing = new AbortController();
  private drawn = "";
  private duration = Infinity;

  /** Starts the server of a document and opens the panel. */
  static async open(
    document: vscode.TextDocument,
    program: string,
    extension: vscode.Uri,
    onClose: () => void,
  ): Promise<Preview> {
    const file = document.uri.fsPath;
    const folder = vscode.workspace.getWorkspaceFolder(document.uri)?.uri.fsPath ?? dirname(file);
    const server = await PreviewServer.start(program, file, folder);
    return new Preview(document, server, extension, onClose);
  }

  private constructor(
    private readonly document: vscode.TextDocument,
    private readonly server: PreviewServer,
    extension: vscode.Uri,
    private readonly onClose: () => void,
  ) {
    const name = basename(document.uri.fsPath);
    const parts = vscode.Uri.joinPath(extension, "dist", "panel");
    this.panel = vscode.window.createWebviewPanel(
      "strahl.preview",
      `Preview ${name}`,
      { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true },
      { enableScripts: true, localResourceRoots: [parts] },
    );
    const { webview } = this.panel;
    this.sync = new Sync(server, document, (error) => this.fail(error));
    this.listeners.push(
      this.panel,
      this.panel.onDidDispose(() => this.dispose()),
      webview.onDidReceiveMessage((message: FromPanel) => this.onMessage(message)),
      vscode.workspace.onDidChangeTextDocument((event) => {
        if (event.document === document) this.sync.onEdit(event.contentChanges);
      }),
      vscode.workspace.onDidCloseTextDocument((closed) => {
        if (closed === document) this.dispose();
      }),
    );
    webview.html = page(webview, parts);
    this.show({ type: "address", address: server.address.replace(/\/\?.*/, "") });
    server.onEnd(() => this.fail(new Error("strahl preview has ended")));
    server.follow((state) => this.onState(state), this.stopped.signal).catch((error) => this.fail(error));
  }

  reveal(): void {
    this.panel.reveal(undefined, true);
  }

  /** Opens the whole page, with all its tools, in the browser. */
  async openPage(): Promise<void> {
    await vscode.env.openExternal(vscode.Uri.parse(this.server.address, true));
  }

  dispose(): void {
    if (this.stopped.signal.aborted) return;
    this.stopped.abort();
    this.drawing.abort();
    this.server.stop();
    for (const listener of this.listeners) listener.dispose();
    this.onClose();
  }

  private onState(state: State): void {
    this.state = state;
    this.sync.onVersion(state.version);
    const { scene, diagnostics, is_broken: isBroken } = state;
    const cameras = scene?.cameras ?? [];
    if (!cameras.includes(this.camera)) this.camera = "";
    const errors = diagnostics.filter(({ severity }) => severity === "error").length;
    this.show({ type: "state", isBroken, errors, cameras, camera: this.camera });
    void this.draw();
  }

  /** Draws the scene unless it is drawn: coarse at first if it may take long. */
  private async draw(): Promise<void> {
    const revision = this.state?.scene?.revision;
    const wanted = `${revision} ${this.camera}`;
    if (revision === undefined || wanted === this.drawn) return;
    this.drawn = wanted;
    this.drawing.abort();
    this.drawing = new AbortController();
    const { signal } = this.drawing;
    const start = performance.now();
    try {
      for (const quality of this.duration > SLOW ? ["coarse", "full"] : ["full"]) {
        const query = { revision, camera: this.camera, quality };
        const response = await this.server.get("/picture", query, signal);
        const png = new Uint8Array(await response.arrayBuffer());
        if (signal.aborted) return;
        const { width = 0, height = 0 } = this.state?.scene ?? {};
        this.show({ type: "picture", png, revision, width, height });
      }
      this.duration = performance.now() - start;
    } catch (error) {
      const isOutdated = error instanceof Refused && error.status === 410;
      if (!signal.aborted && !isOutdated) this.fail(error);
    }
  }

  private async onMessage(message: FromPanel): Promise<void> {
    switch (message.type) {
      case "ready":
        for (const part of this.shown.values()) void this.panel.webview.postMessage(part);
        break;
      case "camera":
        this.camera = message.camera;
        if (this.state) this.onState(this.state);
        break;
      case "page":
        await this.openPage();
        break;
      case "pick":
        await this.pick(message.x, message.y).catch((error) => this.fail(error));
        break;
    }
  }

  /** Selects the text of the geometry that a pixel shows. */
  private async pick(x: number, y: number): Promise<void> {
    const revision = this.state?.scene?.revision;
    if (revision === undefined) return;
    const query = { revision, camera: this.camera, x, y };
    const pixel = await this.server.getJson<{ geometry: Partial<Span> | null }>("/pixel", query);
    const { from, to } = pixel.geometry ?? {};
    if (!from || !to) return;
    const selection = new vscode.Range(from.line - 1, from.column - 1, to.line - 1, to.column - 1);
    const seen = vscode.window.visibleTextEditors.find((editor) => editor.document === this.document);
    const viewColumn = seen?.viewColumn ?? vscode.ViewColumn.One;
    await vscode.window.showTextDocument(this.document, { selection, viewColumn });
  }

  private show(message: ToPanel): void {
    this.shown.set(message.type, message);
    void this.panel.webview.postMessage(message);
  }

  private fail(error: unknown): void {
    if (this.stopped.signal.aborted) return;
    const message = error instanceof Error ? error.message : String(error);
    this.show({ type: "failure", message });
  }
}

function page(webview: vscode.Webview, parts: vscode.Uri): string {
  const part = (name: string) => webview.asWebviewUri(vscode.Uri.joinPath(parts, name)).toString();
  const source = webview.cspSource;
  const policy = `default-src 'none'; img-src blob:; style-src ${source}; script-src ${source}`;
  return `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="${policy}">
<title>Preview</title>
<link rel="stylesheet" href="${part("page.css")}">
</head>
<body>
<header>
<label id="views" hidden>Camera <select id="camera"></select></label>
<span id="state" role="status">Drawing</span>
<button id="page">Open in the browser</button>
</header>
<main><img id="picture" alt="The picture of the scene" hidden></main>
<footer id="address"></footer>
<script type="module" src="${part("page.js")}"></script>
</body>
</html>`;
}

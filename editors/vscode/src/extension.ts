// The language server and the preview of Strahl in VS Code.

import * as vscode from "vscode";
import { LanguageClient } from "vscode-languageclient/node";
import { Preview } from "./preview.ts";
import { findProgram, hasServer } from "./program.ts";

let client: LanguageClient | undefined;
const previews = new Map<string, Promise<Preview>>();

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const open = (document: vscode.TextDocument | undefined) => openPreview(document, context.extensionUri);
  const active = () => vscode.window.activeTextEditor?.document;
  context.subscriptions.push(
    vscode.commands.registerCommand("strahl.openPreview", async () => (await open(active()))?.reveal()),
    vscode.commands.registerCommand("strahl.openPage", async () => (await open(active()))?.openPage()),
    vscode.commands.registerCommand("strahl.restart", start),
    vscode.workspace.onDidChangeConfiguration(async (event) => {
      if (event.affectsConfiguration("strahl.path")) await start();
    }),
  );
  await start();
}

export async function deactivate(): Promise<void> {
  for (const preview of previews.values()) void preview.then((open) => open.dispose());
  await stop();
}

/** Starts the language server, again if it runs. */
async function start(): Promise<void> {
  await stop();
  const command = await findProgram();
  if (command === undefined || !(await hasServer(command))) return;
  const scenes = ["ron", "json"].flatMap((language) => [
    { language, scheme: "file" },
    { language, scheme: "untitled" },
  ]);
  // The unsaved text of a table counts.
  const tables = { scheme: "file", pattern: "**/*.csv" };
  const started = new LanguageClient(
    "strahl",
    "Strahl",
    { command, args: ["lsp"] },
    { documentSelector: [...scenes, tables] },
  );
  client = started;
  await started.start().catch(() => undefined);
}

async function stop(): Promise<void> {
  const running = client;
  client = undefined;
  // A server that has crashed cannot be stopped.
  await running?.dispose().catch(() => undefined);
}

async function openPreview(
  document: vscode.TextDocument | undefined,
  extension: vscode.Uri,
): Promise<Preview | undefined> {
  if (!document) return undefined;
  if (document.uri.scheme !== "file") {
    void vscode.window.showErrorMessage("The preview needs a file. Save the scene first.");
    return undefined;
  }
  const key = document.uri.toString();
  const known = previews.get(key);
  if (known) return known;
  const program = await findProgram();
  if (program === undefined) return undefined;
  const opened = Preview.open(document, program, extension, () => previews.delete(key));
  previews.set(key, opened);
  try {
    return await opened;
  } catch (error) {
    previews.delete(key);
    const message = error instanceof Error ? error.message : String(error);
    void vscode.window.showErrorMessage(`The preview does not start: ${message}`);
    return undefined;
  }
}

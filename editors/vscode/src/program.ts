// Finds the program and reports what is wrong with it.

import { execFile } from "node:child_process";
import { constants } from "node:fs";
import { access, stat } from "node:fs/promises";
import { homedir } from "node:os";
import { delimiter, isAbsolute, join } from "node:path";
import { promisify } from "node:util";
import * as vscode from "vscode";

const INSTALLATION = "https://github.com/strahl-render/strahl/blob/main/docs/install.md";

/** Returns the path of the program, or undefined after a message if there is none. */
export async function findProgram(): Promise<string | undefined> {
  const wanted = vscode.workspace.getConfiguration("strahl").get("path", "").trim() || "strahl";
  for (const path of places(wanted)) {
    if (await isProgram(path)) return path;
  }
  void complain(`The program \`${wanted}\` is missing. Install Strahl, or set \`strahl.path\`.`);
  return undefined;
}

/** Returns true if the program has a language server; shows a message if it has none. */
export async function hasServer(program: string): Promise<boolean> {
  try {
    await promisify(execFile)(program, ["lsp", "--help"]);
    return true;
  } catch {
    void complain(`\`${program}\` has no language server. Install a newer Strahl.`);
    return false;
  }
}

/** Shows a message with a way to the manual and the setting. */
async function complain(message: string): Promise<void> {
  const [install, settings] = ["Installation", "Open Settings"];
  const chosen = await vscode.window.showErrorMessage(message, install, settings);
  if (chosen === install) await vscode.env.openExternal(vscode.Uri.parse(INSTALLATION));
  if (chosen === settings) {
    await vscode.commands.executeCommand("workbench.action.openSettings", "strahl.path");
  }
}

/** Returns where a program can be: a path, or a name in the folders of PATH. */
function places(wanted: string): string[] {
  const home = wanted.replace(/^~(?=[/\\])/, homedir());
  const extensions = process.platform === "win32" ? ["", ".exe"] : [""];
  const withExtensions = (path: string): string[] => extensions.map((extension) => path + extension);
  if (isAbsolute(home)) return withExtensions(home);
  if (/[/\\]/.test(home)) {
    const folders = vscode.workspace.workspaceFolders ?? [];
    return folders.flatMap((folder) => withExtensions(join(folder.uri.fsPath, home)));
  }
  // An editor that is started from a desktop often lacks the folders that a shell adds.
  const usual = [".cargo/bin", ".local/bin"].map((folder) => join(homedir(), folder));
  const folders = (process.env["PATH"] ?? "").split(delimiter).filter((folder) => folder !== "");
  return [...folders, ...usual].flatMap((folder) => withExtensions(join(folder, home)));
}

async function isProgram(path: string): Promise<boolean> {
  try {
    await access(path, constants.X_OK);
    return (await stat(path)).isFile();
  } catch {
    return false;
  }
}

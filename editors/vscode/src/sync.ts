// Keeps the text of the editor and the draft of the preview equal. The draft changes on its own when
// the page in the browser edits it, for example when its camera is moved.

import * as vscode from "vscode";
import { type Edit, type PreviewServer, Refused } from "./server.ts";

export class Sync {
  /** The version of the draft that the editor knows. */
  private version = 0;
  private readonly pending: Edit[][] = [];
  private busy = false;
  /** The newest version that the server has reported. */
  private reported = 0;

  constructor(
    private readonly server: PreviewServer,
    private readonly document: vscode.TextDocument,
    private readonly onFailure: (error: unknown) => void,
  ) {}

  onEdit(changes: readonly vscode.TextDocumentContentChangeEvent[]): void {
    if (changes.length === 0) return;
    this.pending.push(changes.map(({ range, text }) => ({ ...placesOf(range), text: unix(text) })));
    void this.run();
  }

  onVersion(version: number): void {
    this.reported = version;
    void this.run();
  }

  private async run(): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    try {
      while (this.pending.length > 0 || this.reported > this.version) {
        const edits = this.pending.shift();
        if (this.version === 0) await this.push();
        else if (edits) await this.send(edits);
        else await this.pull();
      }
    } catch (error) {
      this.onFailure(error);
    } finally {
      this.busy = false;
    }
  }

  private async send(edits: Edit[]): Promise<void> {
    try {
      this.version = await this.server.edit(this.version, edits);
    } catch (error) {
      if (!(error instanceof Refused && error.status === 409)) throw error;
      // The draft has changed meanwhile. What is typed here counts.
      await this.push();
    }
  }

  /** Makes the draft equal to the text of the editor. */
  private async push(): Promise<void> {
    for (;;) {
      const { version, text } = await this.draft();
      this.pending.length = 0;
      const wanted = unix(this.document.getText());
      this.version = version;
      if (text === wanted) return;
      try {
        const to = { line: text.split("\n").length + 1, column: 1 };
        const edit = { from: { line: 1, column: 1 }, to, text: wanted };
        this.version = await this.server.edit(version, [edit]);
        return;
      } catch (error) {
        if (!(error instanceof Refused && error.status === 409)) throw error;
      }
    }
  }

  /** Takes over the draft, unless the text of the editor changes meanwhile. */
  private async pull(): Promise<void> {
    const { version, text } = await this.draft();
    if (this.pending.length > 0) return;
    this.version = version;
    const old = unix(this.document.getText());
    if (text === old) return;
    const [start, oldEnd, end] = difference(old, text);
    const lines = old.slice(0, oldEnd).split("\n");
    const first = old.slice(0, start).split("\n");
    const range = new vscode.Range(
      new vscode.Position(first.length - 1, first.at(-1)!.length),
      new vscode.Position(lines.length - 1, lines.at(-1)!.length),
    );
    const change = new vscode.WorkspaceEdit();
    change.replace(this.document.uri, range, text.slice(start, end));
    await vscode.workspace.applyEdit(change);
    // The editor has reported this change like any other, but the draft has it already.
    this.pending.length = 0;
    if (unix(this.document.getText()) !== text) await this.push();
  }

  private async draft(): Promise<{ version: number; text: string }> {
    return await this.server.getJson<{ version: number; text: string }>("/text");
  }
}

function placesOf({ start, end }: vscode.Range): Pick<Edit, "from" | "to"> {
  const place = ({ line, character }: vscode.Position) => ({ line: line + 1, column: character + 1 });
  return { from: place(start), to: place(end) };
}

function unix(text: string): string {
  return text.replaceAll("\r\n", "\n");
}

/** Returns the start of the difference of two texts, and its end in each. Splits no character. */
function difference(old: string, text: string): [number, number, number] {
  const isLow = (unit: number) => unit >= 0xdc00 && unit < 0xe000;
  const shorter = Math.min(old.length, text.length);
  let start = 0;
  while (start < shorter && old[start] === text[start]) start += 1;
  if (start > 0 && (isLow(old.charCodeAt(start)) || isLow(text.charCodeAt(start)))) start -= 1;
  let same = 0;
  while (same < shorter - start && old.at(-1 - same) === text.at(-1 - same)) same += 1;
  if (same > 0 && isLow(old.charCodeAt(old.length - same))) same -= 1;
  return [start, old.length - same, text.length - same];
}

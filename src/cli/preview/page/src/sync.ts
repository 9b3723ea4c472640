// Keeps the text of the editor and that of the server equal.

import { isolateHistory } from "@codemirror/commands";
import { Annotation, type ChangeSet, type Text, Transaction } from "@codemirror/state";
import { EditorView, type ViewUpdate } from "@codemirror/view";
import { type Edit, type Place, Refused, getJson, post } from "./api.ts";

/** Marks changes that come from the server. */
const fromServer = Annotation.define<boolean>();

/**
 * The event of a movement. All steps of one are undone at once; the history joins no other events
 * than those of typing and deleting.
 */
export const MOVE = "delete.move";

export function placeOf(text: Text, offset: number): Place {
  const line = text.lineAt(offset);
  return { line: line.number, column: offset - line.from + 1 };
}

/** The offset of a place; a place outside of the text becomes the nearest one in it. */
export function offsetOf(text: Text, place: Place): number {
  const line = text.line(Math.min(Math.max(place.line, 1), text.lines));
  return Math.min(line.from + Math.max(place.column, 1) - 1, line.to);
}

export class Sync {
  /** The version of the text that the server has. */
  private version = 0;
  /** The text that the server has. */
  private known: Text;
  /** The changes that it does not have yet. */
  private pending: ChangeSet | null = null;
  private busy: Promise<void> | null = null;
  /** The newest version that the server has reported. */
  private reported = 0;

  constructor(
    private readonly view: EditorView,
    private readonly onSettled: () => void,
  ) {
    this.known = view.state.doc;
  }

  /** Takes notice of a change in the editor. */
  onUpdate(update: ViewUpdate): void {
    for (const transaction of update.transactions) {
      if (!transaction.docChanged || transaction.annotation(fromServer)) continue;
      this.pending = this.pending ? this.pending.compose(transaction.changes) : transaction.changes;
    }
    if (this.pending && this.version > 0) this.start();
  }

  /** Takes notice of the version that the server has. */
  onVersion(version: number): void {
    this.reported = version;
    if (!this.busy && version !== this.version) this.start();
  }

  /** The version of the text in the editor; null while changes are on their way. */
  get current(): number | null {
    return this.busy || this.pending || this.version === 0 ? null : this.version;
  }

  /** Waits until the server has the text, and returns its version. */
  async settled(): Promise<number> {
    while (this.busy) await this.busy;
    return this.version;
  }

  private start(): void {
    this.busy ??= this.run().finally(() => {
      this.busy = null;
      if (this.pending) this.start();
      else this.onSettled();
    });
  }

  private async run(): Promise<void> {
    try {
      while (this.pending) await this.send(this.pending);
      if (this.reported > this.version || this.version === 0) await this.fetch();
    } catch {
      // The connection is lost; the next state starts again.
      await new Promise((done) => setTimeout(done, 300));
    }
  }

  private async send(changes: ChangeSet): Promise<void> {
    const edits: Edit[] = [];
    changes.iterChanges((from, to, _from, _to, inserted) => {
      edits.push({
        from: placeOf(this.known, from),
        to: placeOf(this.known, to),
        text: inserted.sliceString(0),
      });
    });
    const sent = changes.apply(this.known);
    this.pending = null;
    try {
      const { version } = await post<{ version: number }>("/edits", { version: this.version, edits });
      this.version = version;
      this.known = sent;
    } catch (error) {
      if (!(error instanceof Refused && error.status === 409)) {
        // Nothing is lost: the changes are sent again.
        const later: ChangeSet | null = this.pending;
        this.pending = later ? changes.compose(later) : changes;
        throw error;
      }
      this.pending = null;
      await this.fetch();
    }
  }

  /** Takes over the text of the server, with the smallest change. */
  private async fetch(): Promise<void> {
    const { version, text } = await getJson<{ version: number; text: string }>("/text");
    const old = this.view.state.doc.toString();
    this.pending = null;
    const shorter = Math.min(old.length, text.length);
    let start = 0;
    while (start < shorter && old[start] === text[start]) start += 1;
    let end = 0;
    while (end < shorter - start && old[old.length - 1 - end] === text[text.length - 1 - end]) end += 1;
    if (start + end < old.length || start + end < text.length) {
      this.view.dispatch({
        changes: { from: start, to: old.length - end, insert: text.slice(start, text.length - end) },
        // The first text cannot be undone; a later one can, so that nothing is lost.
        annotations: [
          fromServer.of(true),
          Transaction.addToHistory.of(this.version > 0),
          isolateHistory.of("full"),
        ],
      });
    }
    this.known = this.view.state.doc;
    this.version = version;
    this.reported = Math.max(this.reported, version);
  }
}

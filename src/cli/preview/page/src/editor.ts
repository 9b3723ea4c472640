// The editor: the text of the scene, its diagnostics, and help with writing it.

import { acceptCompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, isolateHistory, redo, undo } from "@codemirror/commands";
import { bracketMatching, foldGutter, foldKeymap, indentOnInput, indentUnit } from "@codemirror/language";
import { type Diagnostic, lintGutter, lintKeymap, nextDiagnostic, previousDiagnostic, setDiagnostics } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { EditorState, StateEffect, StateField } from "@codemirror/state";
import { Decoration, type DecorationSet, drawSelection, EditorView, highlightActiveLine, highlightActiveLineGutter, highlightSpecialChars, keymap, lineNumbers } from "@codemirror/view";
import type { Edit, Finding, Span, State } from "./api.ts";
import { assist } from "./assist.ts";
import { language } from "./language.ts";
import { Latest } from "./page.ts";
import { showSwatches, swatches } from "./swatches.ts";
import { MOVE, offsetOf, placeOf, Sync } from "./sync.ts";

/** The mark of the geometry that was found in the picture. */
const setMark = StateEffect.define<{ from: number; to: number } | null>();
const mark = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(value, transaction) {
    let next = value.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(setMark)) continue;
      next = effect.value
        ? Decoration.set(Decoration.mark({ class: "found" }).range(effect.value.from, effect.value.to))
        : Decoration.none;
    }
    return next;
  },
  provide: (field) => EditorView.decorations.from(field),
});

export class Editor {
  readonly view: EditorView;
  readonly sync: Sync;
  private findings: Finding[] = [];
  /** The revision whose diagnostics are shown. */
  private shown = 0;
  private readonly colors = new Latest<null>(() => showSwatches(this.view, this.sync));

  constructor(parent: HTMLElement, syntax: "ron" | "json", onCursor: () => void, onSettled: () => void, save: () => void) {
    const nonce = document.querySelector<HTMLMetaElement>('meta[name="csp-nonce"]')?.content ?? "";
    const fix = (): boolean => this.fixAtCursor();
    this.view = new EditorView({
      parent,
      state: EditorState.create({
        extensions: [
          EditorView.cspNonce.of(nonce),
          EditorState.lineSeparator.of("\n"),
          EditorView.contentAttributes.of({ "aria-label": "Text of the scene", spellcheck: "false" }),
          indentUnit.of("    "),
          lineNumbers(),
          foldGutter(),
          highlightSpecialChars(),
          highlightActiveLine(),
          highlightActiveLineGutter(),
          highlightSelectionMatches(),
          history({ joinToEvent: (transaction, isAdjacent) => isAdjacent || transaction.isUserEvent(MOVE) }),
          drawSelection(),
          indentOnInput(),
          bracketMatching(),
          closeBrackets(),
          lintGutter(),
          language(syntax),
          assist(() => this.sync ?? null),
          swatches,
          mark,
          keymap.of([
            { key: "Mod-s", preventDefault: true, run: () => (save(), true) },
            { key: "F8", run: nextDiagnostic },
            { key: "Shift-F8", run: previousDiagnostic },
            { key: "Mod-.", run: fix },
            { key: "Alt-Enter", run: fix },
            { key: "Tab", run: acceptCompletion },
            ...closeBracketsKeymap,
            ...completionKeymap,
            ...defaultKeymap,
            ...historyKeymap,
            ...searchKeymap,
            ...foldKeymap,
            ...lintKeymap,
          ]),
          EditorView.updateListener.of((update) => {
            this.sync?.onUpdate(update);
            if (update.selectionSet || update.docChanged) onCursor();
            if (update.viewportChanged) this.colors.push(null);
          }),
        ],
      }),
    });
    this.sync = new Sync(this.view, onSettled);
  }

  /** Shows the diagnostics of a state, unless the text has changed meanwhile. */
  show({ diagnostics: findings, checked, revision }: State): void {
    if (this.sync.current !== checked || this.shown === revision) return;
    this.shown = revision;
    this.findings = findings;
    const text = this.view.state.doc;
    const shown = findings.map((finding): Diagnostic => {
      const from = offsetOf(text, finding.from);
      const fix = finding.fix;
      return {
        from,
        to: Math.max(offsetOf(text, finding.to), from),
        severity: finding.severity,
        source: finding.code,
        message: finding.help ? `${finding.message}\n${finding.help}` : finding.message,
        actions: fix ? [{ name: "Fix", apply: () => this.apply(fix.edits, "input.fix") }] : [],
      };
    });
    this.view.dispatch(setDiagnostics(this.view.state, shown));
    this.colors.push(null);
  }

  /** Applies edits as one step that can be undone, or as a part of a movement. */
  apply(edits: Edit[], userEvent: string): void {
    const text = this.view.state.doc;
    const changes = edits.map((edit) => ({
      from: offsetOf(text, edit.from),
      to: offsetOf(text, edit.to),
      insert: edit.text,
    }));
    const annotations = userEvent.startsWith(MOVE) ? [] : [isolateHistory.of("full")];
    if (changes.length > 0) this.view.dispatch({ changes, userEvent, annotations });
  }

  private fixAtCursor(): boolean {
    const { line } = placeOf(this.view.state.doc, this.view.state.selection.main.head);
    const here = this.findings.filter((finding) => finding.from.line <= line && line <= finding.to.line);
    const fix = here.find((finding) => finding.fix)?.fix;
    if (fix) this.apply(fix.edits, "input.fix");
    return fix !== undefined;
  }

  /** Moves the cursor to a place and shows it. */
  jump(span: Span, isMarked: boolean): void {
    const text = this.view.state.doc;
    const from = offsetOf(text, span.from);
    const to = Math.max(offsetOf(text, span.to), from);
    this.view.dispatch({
      selection: { anchor: from },
      effects: [
        EditorView.scrollIntoView(from, { y: "center" }),
        setMark.of(isMarked && to > from ? { from, to } : null),
      ],
    });
  }

  get cursor(): { line: number; column: number } {
    return placeOf(this.view.state.doc, this.view.state.selection.main.head);
  }

  get text(): string {
    return this.view.state.doc.toString();
  }

  undo(): void {
    undo(this.view);
  }

  redo(): void {
    redo(this.view);
  }
}

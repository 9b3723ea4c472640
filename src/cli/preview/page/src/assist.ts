// Help with writing, by the program: completion and docs.

import {
  autocompletion,
  type Completion,
  type CompletionContext,
  type CompletionResult,
  insertCompletionText,
  pickedCompletion,
} from "@codemirror/autocomplete";
import { linter } from "@codemirror/lint";
import type { Extension } from "@codemirror/state";
import { type EditorView, hoverTooltip, type Tooltip } from "@codemirror/view";
import { get, getJson, type Query, Refused, type Span } from "./api.ts";
import { offsetOf, placeOf, type Sync } from "./sync.ts";

/** Number of characters above which nothing is asked while typing. */
const LARGE = 20_000_000;

interface Item {
  label: string;
  insert: string;
  kind: string;
  detail: string;
  docs: string;
}

const icons: Record<string, string> = {
  field: "property",
  variant: "class",
  name: "variable",
  value: "constant",
  file: "text",
};

/** The text under docs: `code` in backticks is set as code. */
export function docs(text: string): HTMLElement {
  const paragraph = document.createElement("p");
  text.split("`").forEach((part, index) => {
    const piece = index % 2 === 1 ? document.createElement("code") : document.createElement("span");
    piece.textContent = part;
    paragraph.append(piece);
  });
  return paragraph;
}

export function assist(sync: () => Sync | null): Extension {
  async function at(view: EditorView, offset: number): Promise<Query | null> {
    const version = await sync()?.settled();
    if (!version || view.state.doc.length > LARGE) return null;
    return { version, ...placeOf(view.state.doc, Math.min(offset, view.state.doc.length)) };
  }

  async function complete(context: CompletionContext): Promise<CompletionResult | null> {
    const { view } = context;
    const before = context.matchBefore(/[\w"#.]+|[([{:,]\s*/);
    if (!view || (!context.explicit && !before)) return null;
    const query = await at(view, context.pos);
    if (!query || context.aborted) return null;
    const found = await retry(() => getJson<Span & { items: Item[] }>("/completions", query), () => context.aborted);
    if (!found || context.aborted || found.items.length === 0) return null;
    const text = view.state.doc;
    // Only what is before the cursor is looked for; what follows of the word is replaced.
    const rest = offsetOf(text, found.to) - context.pos;
    const options = found.items.map((item, index): Completion => ({
      label: item.label,
      apply: (view, completion, from, to) =>
        view.dispatch({
          ...insertCompletionText(view.state, item.insert, from, to + rest),
          annotations: pickedCompletion.of(completion),
        }),
      type: icons[item.kind] ?? "text",
      detail: item.detail,
      boost: -index / 100,
      ...(item.docs ? { info: () => docs(item.docs) } : {}),
    }));
    return { from: offsetOf(text, found.from), options, validFor: /^[\w"]*$/ };
  }

  async function hover(view: EditorView, offset: number): Promise<Tooltip | null> {
    const query = await at(view, offset);
    const isOld = (): boolean => sync()?.current !== query?.["version"];
    const response = query && (await retry(() => get("/hover", query), isOld));
    if (!response || response.status === 204) return null;
    const found = (await response.json()) as Span & { title: string; docs: string };
    return {
      pos: offsetOf(view.state.doc, found.from),
      end: offsetOf(view.state.doc, found.to),
      create() {
        const dom = document.createElement("div");
        dom.className = "hover-docs";
        const title = document.createElement("strong");
        title.textContent = found.title;
        dom.append(title, docs(found.docs));
        return { dom };
      },
    };
  }

  // So few that the list need not scroll, which keys alone could not reach.
  const maxRenderedOptions = 12;
  return [
    autocompletion({ override: [complete], icons: false, maxRenderedOptions }),
    hoverTooltip(hover, { hideOnChange: true }),
    // Those of diagnostics too.
    linter(null, { hideOn: (transaction) => transaction.docChanged || null }),
  ];
}

/** Asks again while the text is being checked; gives up when there is a newer one. */
async function retry<T>(ask: () => Promise<T>, isOld: () => boolean): Promise<T | null> {
  while (!isOld()) {
    try {
      return await ask();
    } catch (error) {
      if (!(error instanceof Refused && error.status === 409)) return null;
      await new Promise((done) => setTimeout(done, 40));
    }
  }
  return null;
}

// A swatch beside each color of the text, which opens the browser's picker.

import { RangeSet, StateEffect, StateField, type Extension } from "@codemirror/state";
import { Decoration, type DecorationSet, EditorView, WidgetType } from "@codemirror/view";
import { getJson, type Span } from "./api.ts";
import { MOVE, offsetOf, type Sync } from "./sync.ts";

type Color = Span & { color: string; is_string: boolean };

class Swatch extends WidgetType {
  constructor(readonly color: string) {
    super();
  }

  override eq(other: Swatch): boolean {
    return other.color === this.color;
  }

  override toDOM(view: EditorView): HTMLElement {
    const input = document.createElement("input");
    input.type = "color";
    input.className = "swatch";
    this.updateDOM(input);
    // While the picker is open, and when it closes.
    const pick = (): void => {
      const from = view.posAtDOM(input);
      let found: { from: number; to: number } | null = null;
      view.state.field(ranges).between(from, from, (start, end, value) => {
        if (value.spec.isColor) found = { from: start, to: end };
      });
      const range = found as { from: number; to: number } | null;
      const insert = JSON.stringify(input.value);
      if (!range || view.state.sliceDoc(range.from, range.to) === insert) return;
      view.dispatch({ changes: { ...range, insert }, userEvent: `${MOVE}.color` });
    };
    input.addEventListener("input", pick);
    input.addEventListener("change", pick);
    return input;
  }

  /** Keeps the element: with another one, an open picker would close. */
  override updateDOM(dom: HTMLElement): boolean {
    const input = dom as HTMLInputElement;
    input.value = this.color;
    input.setAttribute("aria-label", `Color ${this.color}`);
    return true;
  }

  override ignoreEvent(): boolean {
    return true;
  }
}

const setColors = StateEffect.define<DecorationSet>();

const ranges = StateField.define<DecorationSet>({
  create: () => RangeSet.empty,
  update(value, transaction) {
    let next = value.map(transaction.changes);
    for (const effect of transaction.effects) if (effect.is(setColors)) next = effect.value;
    return next;
  },
  provide: (field) => EditorView.decorations.from(field),
});

export const swatches: Extension = ranges;

/** Asks for the colors of the visible text, and shows them unless it has changed meanwhile. */
export async function showSwatches(view: EditorView, sync: Sync): Promise<void> {
  const version = sync.current;
  if (version === null) return;
  const { from, to } = view.viewport;
  const [first, last] = [from, to].map((offset) => view.state.doc.lineAt(offset).number);
  const colors = await getJson<Color[]>("/colors", { version, first, last }).catch(() => null);
  if (!colors || sync.current !== version) return;
  const text = view.state.doc;
  const all = colors.flatMap((color) => {
    const from = offsetOf(text, color.from);
    const to = offsetOf(text, color.to);
    if (from >= to) return [];
    return [
      Decoration.widget({ widget: new Swatch(color.color), side: -1 }).range(from),
      Decoration.mark({ class: "color", isColor: true, inclusive: true }).range(from, to),
    ];
  });
  view.dispatch({ effects: setColors.of(Decoration.set(all, true)) });
}

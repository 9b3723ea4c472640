// A swatch beside each color of the text, which opens the browser's picker.

import { RangeSet, StateEffect, StateField, type Extension } from "@codemirror/state";
import { Decoration, type DecorationSet, EditorView, WidgetType } from "@codemirror/view";
import { getJson, type Span } from "./api.ts";
import { offsetOf, type Sync } from "./sync.ts";

type Color = Span & { color: string; is_string: boolean };

/** The most swatches: more would slow down the editor. */
const MOST = 2000;

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
    input.value = this.color;
    input.setAttribute("aria-label", `Color ${this.color}`);
    input.addEventListener("change", () => {
      const from = view.posAtDOM(input);
      let found: { from: number; to: number } | null = null;
      view.state.field(ranges).between(from, from, (start, end, value) => {
        if (value.spec.isColor) found = { from: start, to: end };
      });
      const range = found as { from: number; to: number } | null;
      if (!range) return;
      view.dispatch({ changes: { ...range, insert: JSON.stringify(input.value) }, userEvent: "input.color" });
    });
    return input;
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

/** Asks for the colors of the text, and shows them unless it has changed meanwhile. */
export async function showSwatches(view: EditorView, sync: Sync): Promise<void> {
  const version = sync.current;
  if (version === null) return;
  const colors = await getJson<Color[]>("/colors", { version }).catch(() => null);
  if (!colors || sync.current !== version) return;
  const text = view.state.doc;
  const all = colors.slice(0, MOST).flatMap((color) => {
    const from = offsetOf(text, color.from);
    const to = offsetOf(text, color.to);
    if (from >= to) return [];
    return [
      Decoration.widget({ widget: new Swatch(color.color), side: -1 }).range(from),
      Decoration.mark({ class: "color", isColor: true }).range(from, to),
    ];
  });
  view.dispatch({ effects: setColors.of(Decoration.set(all, true)) });
}

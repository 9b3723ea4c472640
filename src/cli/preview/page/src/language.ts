// The highlighting of RON. That of JSON comes with the editor.

import { json } from "@codemirror/lang-json";
import { HighlightStyle, StreamLanguage, type StringStream, syntaxHighlighting } from "@codemirror/language";
import type { Extension } from "@codemirror/state";
import { tags } from "@lezer/highlight";

interface RonState {
  /** The number of open block comments, which nest. */
  depth: number;
  /** The end of an open string: a quote, after `#` signs for a raw one. */
  quote: string | null;
}

function inComment(stream: StringStream, state: RonState): string {
  while (!stream.eol() && state.depth > 0) {
    if (stream.match("/*")) state.depth += 1;
    else if (stream.match("*/")) state.depth -= 1;
    else stream.next();
  }
  return "comment";
}

function inString(stream: StringStream, state: RonState): string {
  const isRaw = state.quote !== '"';
  while (!stream.eol() && state.quote !== null) {
    if (!isRaw && stream.match(/^\\./)) continue;
    if (stream.match(state.quote)) state.quote = null;
    else stream.next();
  }
  return "string";
}

const ron = StreamLanguage.define<RonState>({
  name: "ron",
  startState: () => ({ depth: 0, quote: null }),
  copyState: (state) => ({ ...state }),
  token(stream, state) {
    if (state.depth > 0) return inComment(stream, state);
    if (state.quote !== null) return inString(stream, state);
    if (stream.eatSpace()) return null;
    if (stream.match("//")) {
      stream.skipToEnd();
      return "comment";
    }
    if (stream.match("/*")) {
      state.depth = 1;
      return inComment(stream, state);
    }
    const raw = stream.match(/^b?r(#*)"/) as RegExpMatchArray | null;
    if (raw) {
      state.quote = `"${raw[1] ?? ""}`;
      return inString(stream, state);
    }
    if (stream.match(/^b?"/)) {
      state.quote = '"';
      return inString(stream, state);
    }
    if (stream.match(/^[+-]?(0[xob][0-9a-fA-F_]+|[0-9][0-9_]*(\.[0-9_]*)?([eE][+-]?[0-9_]+)?|\.[0-9_]+([eE][+-]?[0-9]+)?|inf|NaN)/)) return "number";
    if (stream.match(/^(true|false|None|Some)\b/)) return "atom";
    if (stream.match(/^[A-Z][A-Za-z0-9_]*/)) return "typeName";
    if (stream.match(/^[a-z_][A-Za-z0-9_]*(?=\s*:)/)) return "propertyName";
    if (stream.match(/^[a-z_][A-Za-z0-9_]*/)) return "variableName";
    stream.next();
    return null;
  },
  languageData: {
    commentTokens: { line: "//", block: { open: "/*", close: "*/" } },
    closeBrackets: { brackets: ["(", "[", "{", '"'] },
    indentOnInput: /^\s*[\])}]$/,
  },
});

/** The colors are variables of page.css, which knows light and dark. */
const style = HighlightStyle.define([
  { tag: tags.comment, color: "var(--comment)", fontStyle: "italic" },
  { tag: tags.string, color: "var(--string)" },
  { tag: [tags.number, tags.atom, tags.bool, tags.null], color: "var(--number)" },
  { tag: tags.typeName, color: "var(--type)", fontWeight: "600" },
  { tag: tags.propertyName, color: "var(--property)" },
]);

export function language(syntax: "ron" | "json"): Extension {
  return [syntax === "json" ? json() : ron, syntaxHighlighting(style)];
}

// The list of diagnostics.

import type { Edit, Finding, Span, State } from "./api.ts";
import { element } from "./page.ts";

function plural(count: number, noun: string): string {
  return `${count} ${noun}${count === 1 ? "" : "s"}`;
}

/** The list that is shown, as text: it is not built again, or a button would lose the focus. */
let shown = "";

export interface Hand {
  jump(span: Span): void;
  fix(edits: Edit[]): void;
  /** Moves the camera at a path until everything is in the picture. */
  frame(path: string): void;
}

export function showProblems(state: State, hand: Hand): void {
  const count = (severity: string): number =>
    state.diagnostics.filter((finding) => finding.severity === severity).length;
  const [errors, warnings] = [count("error"), count("warning")];
  const parts = [
    ...(errors > 0 ? [plural(errors, "error")] : []),
    ...(warnings > 0 ? [plural(warnings, "warning")] : []),
    ...(state.suppressed > 0 ? [`${state.suppressed} more`] : []),
  ];
  element("count").textContent = parts.join(", ") || "No problems";
  const list = JSON.stringify(state.diagnostics);
  if (list === shown) return;
  shown = list;
  element("diagnostics").replaceChildren(...state.diagnostics.map((finding) => entry(finding, hand)));
}

function entry(finding: Finding, hand: Hand): HTMLElement {
  const item = document.createElement("li");
  item.className = finding.severity;
  item.dataset["code"] = finding.code;
  item.dataset["line"] = String(finding.from.line);
  const go = document.createElement("button");
  go.type = "button";
  go.className = "problem";
  const place = document.createElement("span");
  place.className = "place";
  const own = finding.in_file;
  const at = own ? `${own.file}:${own.line}:${own.column}` : `${finding.from.line}:${finding.from.column}`;
  place.textContent = `${at} ${finding.severity}[${finding.code}]`;
  const message = document.createElement("span");
  message.textContent = ` ${own ? `${own.message} (used by ${finding.from.line}:${finding.from.column})` : finding.message}`;
  go.append(place, message);
  go.addEventListener("click", () => hand.jump(finding));
  item.append(go);
  if (finding.help) {
    const help = document.createElement("p");
    help.className = "help";
    help.textContent = finding.help;
    item.append(help);
  }
  const edits = finding.fix?.edits;
  if (edits) item.append(button("Fix", finding, () => hand.fix(edits)));
  else if (finding.code === "nothing-visible") item.append(button("Frame all", finding, () => hand.frame(finding.path)));
  return item;
}

function button(name: string, finding: Finding, onClick: () => void): HTMLElement {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "fix";
  button.textContent = name;
  button.setAttribute("aria-label", `${name}: ${finding.message}`);
  button.addEventListener("click", onClick);
  return button;
}

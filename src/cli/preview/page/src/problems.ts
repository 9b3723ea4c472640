// The list of diagnostics.

import type { Edit, Finding, Span, State } from "./api.ts";
import { element } from "./page.ts";

function plural(count: number, noun: string): string {
  return `${count} ${noun}${count === 1 ? "" : "s"}`;
}

/** The list that is shown, as text: it is not built again, or a button would lose the focus. */
let shown = "";

export function showProblems(state: State, jump: (span: Span) => void, fix: (edits: Edit[]) => void): void {
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
  element("diagnostics").replaceChildren(...state.diagnostics.map((finding) => entry(finding, jump, fix)));
}

function entry(finding: Finding, jump: (span: Span) => void, fix: (edits: Edit[]) => void): HTMLElement {
  const item = document.createElement("li");
  item.className = finding.severity;
  item.dataset["code"] = finding.code;
  item.dataset["line"] = String(finding.from.line);
  const go = document.createElement("button");
  go.type = "button";
  go.className = "problem";
  const place = document.createElement("span");
  place.className = "place";
  place.textContent = `${finding.from.line}:${finding.from.column} ${finding.severity}[${finding.code}]`;
  const message = document.createElement("span");
  message.textContent = ` ${finding.message}`;
  go.append(place, message);
  go.addEventListener("click", () => jump(finding));
  item.append(go);
  if (finding.help) {
    const help = document.createElement("p");
    help.className = "help";
    help.textContent = finding.help;
    item.append(help);
  }
  const edits = finding.fix?.edits;
  if (edits) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "fix";
    button.textContent = "Fix";
    button.setAttribute("aria-label", `Fix: ${finding.message}`);
    button.addEventListener("click", () => fix(edits));
    item.append(button);
  }
  return item;
}

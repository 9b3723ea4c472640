// The events of the server for all pages of one browser, which opens at most six connections to a
// server: a page with a connection of its own would leave none to the seventh.

import { type Message, follow } from "./api.ts";

declare const self: { onconnect: ((event: MessageEvent) => void) | null };

const pages = new Set<MessagePort>();
let problem: Message = { problem: null };
let state: Message | null = null;

function tell(message: Message): Message {
  for (const page of pages) page.postMessage(message);
  return message;
}

self.onconnect = (event) => {
  const page = event.ports[0]!;
  pages.add(page);
  // A page says one thing: that it leaves.
  page.onmessage = () => pages.delete(page);
  page.postMessage(problem);
  if (state) page.postMessage(state);
};

void follow(
  (next) => (state = tell({ state: next })),
  (next) => (problem = tell({ problem: next })),
);

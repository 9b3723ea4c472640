// The panel: shows what the extension sends.

import type { FromPanel, ToPanel } from "./messages.ts";

declare function acquireVsCodeApi(): { postMessage(message: FromPanel): void };

const editor = acquireVsCodeApi();
const picture = element<HTMLImageElement>("picture");
const camera = element<HTMLSelectElement>("camera");
const state = element("state");
let size = { width: 1, height: 1 };

function element<T extends HTMLElement = HTMLElement>(id: string): T {
  return document.getElementById(id) as T;
}

async function onMessage(message: ToPanel): Promise<void> {
  switch (message.type) {
    case "address":
      element("address").textContent = message.address;
      break;
    case "state": {
      const { isBroken, errors, cameras } = message;
      document.body.dataset["state"] = isBroken ? "broken" : "drawn";
      state.textContent = !isBroken ? "" : errors === 1 ? "1 error" : `${errors} errors`;
      element("views").hidden = cameras.length < 2;
      camera.replaceChildren(...cameras.map((name) => new Option(name, name)));
      camera.value = message.camera || (cameras[0] ?? "");
      break;
    }
    case "picture": {
      size = { width: message.width, height: message.height };
      const old = picture.src;
      picture.src = URL.createObjectURL(new Blob([message.png as BlobPart], { type: "image/png" }));
      await picture.decode().catch(() => undefined);
      if (old) URL.revokeObjectURL(old);
      picture.hidden = false;
      document.body.dataset["revision"] = String(message.revision);
      break;
    }
    case "failure":
      document.body.dataset["state"] = "broken";
      state.textContent = message.message;
      break;
  }
}

window.addEventListener("message", (event: MessageEvent<ToPanel>) => void onMessage(event.data));
camera.addEventListener("change", () => editor.postMessage({ type: "camera", camera: camera.value }));
element("page").addEventListener("click", () => editor.postMessage({ type: "page" }));
picture.addEventListener("click", (event) => {
  // A coarse picture has fewer pixels than the scene.
  const x = Math.floor((event.offsetX / picture.clientWidth) * size.width);
  const y = Math.floor((event.offsetY / picture.clientHeight) * size.height);
  editor.postMessage({ type: "pick", x, y });
});
editor.postMessage({ type: "ready" });

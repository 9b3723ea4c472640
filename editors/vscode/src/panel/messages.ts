// The messages between the extension and its panel.

export type ToPanel =
  | { type: "address"; address: string }
  | { type: "state"; isBroken: boolean; errors: number; cameras: string[]; camera: string }
  | { type: "picture"; png: Uint8Array; revision: number; width: number; height: number }
  | { type: "failure"; message: string };

export type FromPanel =
  | { type: "ready" }
  | { type: "camera"; camera: string }
  | { type: "pick"; x: number; y: number }
  | { type: "page" };

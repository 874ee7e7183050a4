// What keys and the pointer do, for who asks with "?".
import type { JSX } from "preact";
import { kModeNames, kModes } from "./modes";
import { Dialog } from "./parts";

const kKeys: readonly (readonly [string, string])[] = [
  [`1 to ${kModeNames.length}`, kModeNames.map((name) => kModes[name].label).join(", ")],
  ["B N P E A H", "Fluid, not fluid, paint, erase, area, hold still"],
  ["Right button, Alt", "The opposite of what the tool does"],
  ["[ ]", "Smaller, larger brush"],
  ["Enter, Escape", "Close an area that is clicked together, drop it"],
  ["Space", "Play or pause; held, the pointer moves the picture"],
  ["← →", "One frame back, on"],
  ["+ − 0, wheel", "Zoom, fit"],
  ["C", "Compare with the picture"],
  ["O", "Outlines before and after"],
  ["T", "Other takes, and what looks wrong"],
  ["Delete", "Remove the chosen line"],
  ["Ctrl+Z, Ctrl+Shift+Z", "Undo, redo"],
  ["Ctrl+E", "Export"],
  ["?", "This list"],
];

export function KeysDialog(props: { open: boolean; onClose: () => void }): JSX.Element {
  return (
    <Dialog title="Keys" open={props.open} onClose={props.onClose}>
      <dl class="keys">
        {kKeys.map(([keys, does]) => (
          <>
            <dt>{keys}</dt>
            <dd>{does}</dd>
          </>
        ))}
      </dl>
    </Dialog>
  );
}

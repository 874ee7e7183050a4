// Pins between two stills: begun on the one, ended on the other, which is shown meanwhile.
import { Arrow } from "konva/lib/shapes/Arrow";
import { Circle } from "konva/lib/shapes/Circle";
import { Line } from "konva/lib/shapes/Line";
import { Rect } from "konva/lib/shapes/Rect";
import { flat } from "../pen";
import { beginPin, endPin, movePin, pairBoxes, pinBegun, pinsShown } from "../stillpins";
import type { Point } from "../types";
import * as view from "../view";
import { accent, kPlainTool, kShade, type Sheet, type Tool } from "./tool";

let begins = false; // by the gesture that is being made

function showPin({ index, pin, here }: ReturnType<typeof pinsShown>[number], sheet: Sheet): void {
  const { scale } = sheet;
  const chosen = view.pin.value === index;
  const [colour, below] = chosen ? [accent(), "#fff"] : ["#fff", kShade];
  if (chosen) for (const [stroke, width] of [[below, 3], [colour, 1.5]] as const)
    sheet.add(new Circle({ x: here[0], y: here[1], radius: pin.reach, stroke, strokeWidth: width / scale, dash: [6 / scale, 4 / scale], listening: false }));
  for (const [stroke, width] of [[below, 4.5], [colour, 2]] as const)
    sheet.add(new Arrow({ points: flat(pin.points), stroke, fill: stroke, strokeWidth: width / scale, pointerLength: 8 / scale, pointerWidth: 7 / scale, listening: false }));
  const handle = new Circle({ x: here[0], y: here[1], radius: 6 / scale, fill: colour, stroke: below, strokeWidth: 2 / scale, draggable: true, hitStrokeWidth: 14 / scale });
  handle.on("pointerdown", (event) => {
    if (!view.panning.value && event.evt.button === 0) event.cancelBubble = true;
  });
  handle.on("pointerclick", () => (view.pin.value = index));
  handle.on("dragend", () => movePin(index, [handle.x(), handle.y()]));
  sheet.add(handle);
}

/** Where a pin was begun, on the other still. */
function showBegun([x, y]: Point, sheet: Sheet): void {
  const arm = 9 / sheet.scale;
  for (const [stroke, width] of [[kShade, 4], [accent(), 2]] as const)
    for (const [dx, dy] of [[arm, 0], [0, arm]] as const)
      sheet.add(new Line({ points: [x - dx, y - dy, x + dx, y + dy], stroke, strokeWidth: width / sheet.scale, listening: false }));
}

export const stillsTool: Tool = {
  ...kPlainTool,
  get pans() {
    return !view.pair.value;
  },
  pen: () => (view.pair.value ? "arrow" : "none"),
  press(point) {
    if (!view.ground.value) return false;
    begins = !pinBegun.value;
    if (begins) beginPin(point);
    return true;
  },
  finish({ points, isClick }) {
    const last = points[points.length - 1];
    if (last && !(begins && isClick)) endPin(last);
  },
  show(sheet) {
    if (!view.ground.value) return;
    const { scale, width, height } = sheet;
    for (const [x, y, across, down] of pairBoxes())
      for (const [stroke, thick] of [[kShade, 2.5], ["#fff", 1.2]] as const)
        sheet.add(new Rect({ x: x * width, y: y * height, width: across * width, height: down * height, stroke, strokeWidth: thick / scale, dash: [6 / scale, 4 / scale], opacity: 0.7, listening: false }));
    // While one is set, others are no handles in its way.
    if (pinBegun.value) showBegun(pinBegun.value.point, sheet);
    else for (const pin of pinsShown()) showPin(pin, sheet);
  },
};

// The lines that a clip's fluid flows along, and where it shall flow.
import { Arrow } from "konva/lib/shapes/Arrow";
import { Line } from "konva/lib/shapes/Line";
import { addLine, inputLines, moveLine, pointsAt, positionOf, shownLines } from "../cliplines";
import { flat, rounded } from "../pen";
import type { ClipLine, Point } from "../types";
import * as view from "../view";
import { accent, kPlainTool, kShade, type Sheet, showHandles, type Tool } from "./tool";

function showLine(line: ClipLine, index: number, sheet: Sheet): void {
  const { scale } = sheet;
  const chosen = view.line.value === index;
  const position = chosen ? positionOf(line) : 0;
  const points = pointsAt(line, position);
  const shape = { points: flat(points), pointerLength: 9 / scale, pointerWidth: 8 / scale, lineCap: "round" as const, lineJoin: "round" as const };
  const colour = chosen ? accent() : "#fff";
  // Where it lies at other times.
  for (let other = 0; other <= line.later.length; ++other)
    if (other !== position) sheet.add(new Arrow({ ...shape, points: flat(pointsAt(line, other)), stroke: colour, fill: colour, strokeWidth: 1.2 / scale, opacity: 0.55, listening: false }));
  sheet.add(new Arrow({ ...shape, stroke: kShade, fill: kShade, strokeWidth: 5 / scale, opacity: 0.5, listening: false }));
  const arrow = new Arrow({ ...shape, stroke: colour, fill: colour, strokeWidth: 2.2 / scale, hitStrokeWidth: 14 / scale, draggable: chosen });
  arrow.on("pointerdown", (event) => {
    if (view.panning.value || event.evt.button !== 0) return;
    event.cancelBubble = true;
    if (view.line.value !== index) view.position.value = 0;
    view.line.value = index;
  });
  arrow.on("dragend", () => {
    const [dx, dy] = [arrow.x(), arrow.y()];
    moveLine(index, points.map(([x, y]): Point => [rounded(x + dx), rounded(y + dy)]));
  });
  sheet.add(arrow);
  if (chosen) showHandles(points, sheet, (moved) => moveLine(index, moved));
}

export const flowlinesTool: Tool = {
  ...kPlainTool,
  pen: () => "arrow",
  press: () => !!view.ground.value,
  finish({ points, isClick }) {
    if (isClick) view.line.value = null;
    else addLine(points);
  },
  show(sheet) {
    if (!view.ground.value) return;
    if (view.lineTool.value === "edited")
      for (const { points } of inputLines()) sheet.add(new Line({ points: flat(points), stroke: "#9fb4bd", strokeWidth: 1.2 / sheet.scale, dash: [5 / sheet.scale, 4 / sheet.scale], listening: false }));
    const lines = shownLines();
    const chosen = view.line.value ?? -1;
    lines.forEach((line, index) => index !== chosen && showLine(line, index, sheet));
    // Above all others: it is the one that is dragged.
    if (lines[chosen]) showLine(lines[chosen], chosen, sheet);
  },
};

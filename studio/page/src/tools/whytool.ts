// Which patch was chosen for each piece of the picture.
import { Circle } from "konva/lib/shapes/Circle";
import { Rect } from "konva/lib/shapes/Rect";
import * as state from "../state";
import type { Point } from "../types";
import * as view from "../view";
import { accent, kPlainTool, kShade, type Tool } from "./tool";

function choosePiece(point: Point): void {
  const found = state.pieces.value;
  if (!found) return;
  let best = -1;
  let nearest = found.side / 2;
  found.pieces.forEach(([x, y], i) => {
    const distance = Math.max(Math.abs(x + found.side / 2 - point[0]), Math.abs(y + found.side / 2 - point[1]));
    if (distance < nearest) [nearest, best] = [distance, i];
  });
  view.piece.value = best >= 0 ? best : null;
}

export const whyTool: Tool = {
  ...kPlainTool,
  press(point) {
    choosePiece(point);
    return false;
  },
  show(sheet) {
    const found = state.pieces.value;
    if (!found) return;
    const { scale } = sheet;
    const map = view.pieceMap.value;
    const margins = map === "sure" ? found.pieces.map((piece) => piece[5] ?? Infinity).sort((a, b) => a - b) : [];
    // How sure it is means little as a number: where it stands among all pieces is shown.
    const place = (margin: number | null): number => margins.findIndex((each) => each >= (margin ?? Infinity)) / Math.max(1, margins.length - 1);
    if (map !== "none")
      for (const [x, y, clip, score, , margin] of found.pieces)
        sheet.add(
          new Rect({
            x: x + found.side / 4,
            y: y + found.side / 4,
            width: found.side / 2,
            height: found.side / 2,
            fill: map === "clip" ? view.clipColour(clip) : `hsl(${map === "score" ? Math.min(150, score * 360) : 150 * place(margin)} 65% 50%)`,
            opacity: 0.55,
            listening: false,
          }),
        );
    for (const [x, y, , , pinned] of found.pieces)
      if (pinned) sheet.add(new Circle({ x: x + found.side / 2, y: y + found.side / 2, radius: 5 / scale, fill: accent(), stroke: "#fff", strokeWidth: 1.5 / scale, listening: false }));
    const chosen = view.piece.value === null ? undefined : found.pieces[view.piece.value];
    if (chosen)
      for (const [colour, width] of [[kShade, 5], [accent(), 2.5]] as const)
        sheet.add(new Rect({ x: chosen[0], y: chosen[1], width: found.side, height: found.side, stroke: colour, strokeWidth: width / scale, cornerRadius: 3 / scale, listening: false }));
  },
};

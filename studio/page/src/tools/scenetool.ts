// Layers that one wind moves: where each is, and its lines.
import { Arrow } from "konva/lib/shapes/Arrow";
import { Image as KonvaImage } from "konva/lib/shapes/Image";
import { Rect } from "konva/lib/shapes/Rect";
import { Circle } from "konva/lib/shapes/Circle";
import { addLayerLine, chosenLayer, foundShape, layerShape, paintLayer, placeFilm } from "../layers";
import { flat, rounded } from "../pen";
import * as state from "../state";
import type { DrawnLayer, Point } from "../types";
import * as view from "../view";
import { kPlainTool, kShade, kTakes, type Sheet, showHandles, showScribbles, type Tool } from "./tool";

function showFilm(layer: DrawnLayer, colour: string, chosen: boolean, sheet: Sheet): void {
  const { width, height } = sheet;
  if (chosen && layer.paint.length > 0 && view.layerTool.value !== "line") sheet.add(new KonvaImage({ width, height, opacity: 0.35, listening: false, image: layerShape(layer.paint, colour, width, height) }));
  const [place] = layer.lines;
  const [[left, top], [right, bottom]] = place ? [place.points[0] as Point, place.points[place.points.length - 1] as Point] : [[0, 0], [sheet.width, sheet.height]];
  sheet.add(new Rect({ x: Math.min(left, right), y: Math.min(top, bottom), width: Math.abs(right - left), height: Math.abs(bottom - top), stroke: colour, strokeWidth: (chosen ? 2.4 : 1.2) / sheet.scale, dash: [6 / sheet.scale, 4 / sheet.scale], listening: false }));
  if (chosen && view.layerTool.value === "line") showPlace([[left, top], [right, bottom]], colour, sheet);
}

/** Handles of a film's place: two corners, and its middle, by which it is moved. */
function showPlace(corners: [Point, Point], colour: string, sheet: Sheet): void {
  const { scale } = sheet;
  const middle = [0, 1].map((axis) => ((corners[0][axis] as number) + (corners[1][axis] as number)) / 2) as Point;
  const handle = new Circle({ x: middle[0], y: middle[1], radius: 7 / scale, fill: colour, stroke: "#fff", strokeWidth: 2 / scale, draggable: true, hitStrokeWidth: 14 / scale });
  handle.on("pointerdown", (event) => (event.cancelBubble = true));
  handle.on("dragend", () => placeFilm(corners.map(([x, y]): Point => [rounded(x + handle.x() - middle[0]), rounded(y + handle.y() - middle[1])])));
  sheet.add(handle);
  showHandles(corners, sheet, placeFilm); // above it: a small film is made large by its corners
}

function showLayer(layer: DrawnLayer, index: number, sheet: Sheet): void {
  const { scale, width, height } = sheet;
  const chosen = view.layer.value === index;
  const colour = view.clipColour(index);
  if (layer.motion === "footage") return showFilm(layer, colour, chosen, sheet);
  const look = { width, height, opacity: chosen ? 0.5 : 0.22, listening: false };
  const found = layer.matte === "scribbled" ? foundShape(layer.paint, colour) : null;
  if (found) sheet.add(new KonvaImage({ ...look, image: found }));
  if (layer.matte === "scribbled" && chosen) showScribbles(layer.paint, sheet);
  else if (!found && layer.matte !== "rest") sheet.add(new KonvaImage({ ...look, image: layerShape(layer.paint, colour, width, height) }));
  for (const { points } of layer.lines)
    for (const [stroke, across] of [[kShade, 5.5], [chosen ? "#fff" : colour, 2.4]] as const)
      sheet.add(new Arrow({ points: flat(points), stroke, fill: stroke, strokeWidth: across / scale, pointerLength: 9 / scale, pointerWidth: 8 / scale, lineCap: "round", listening: false }));
}

export const sceneTool: Tool = {
  ...kPlainTool,
  pen: () => (view.layerTool.value === "line" ? "arrow" : view.layerTool.value === "area" ? "area" : "brush"),
  colour: (erasing) => ((view.layerTool.value === "erase") !== erasing ? kTakes : view.clipColour(view.layer.value)),
  press: () => !!chosenLayer(),
  finish({ runs, points, area, isClick, erasing }) {
    const tool = view.layerTool.value;
    if (tool !== "line") paintLayer(runs.map((run) => ({ ...run, adds: (tool !== "erase") !== erasing, area })));
    else if (!isClick) addLayerLine(points);
  },
  show(sheet) {
    void view.foundLayers.value; // shapes that come later
    state.doc.value?.scene.layers.forEach((layer, i) => showLayer(layer, i, sheet));
  },
};

// Lines along the flow, a brush of direction, and the pace at which clips play.
import { Arrow } from "konva/lib/shapes/Arrow";
import { flat, lengthOf } from "../pen";
import * as state from "../state";
import type { Drawn, Stroke } from "../types";
import * as view from "../view";
import { accent, brushed, kPlainTool, kShade, kTakes, type Sheet, showHandles, type Tool } from "./tool";

/** Slower is blue, faster orange: told apart by those who see fewer hues. */
const tempoColour = (factor: number): string => (factor === 1 ? "#c9d3d6" : factor < 1 ? "#4f8fe6" : "#f28f3b");

function showDirections(lines: Drawn[], sheet: Sheet): void {
  const strong = view.flowTool.value === "direction";
  for (const { points, width, adds } of lines) {
    sheet.add(brushed(points, width, adds ? accent() : kShade, strong ? 0.3 : 0.14));
    if (adds && points.length > 1) sheet.add(new Arrow({ points: flat(points), stroke: "#fff", fill: "#fff", strokeWidth: 1.6 / sheet.scale, pointerLength: 9 / sheet.scale, pointerWidth: 8 / sheet.scale, opacity: strong ? 0.9 : 0.5, listening: false }));
  }
}

function showStroke(stroke: Stroke, index: number, sheet: Sheet): void {
  const { scale } = sheet;
  const chosen = view.selected.value === index;
  const shape = {
    points: flat(stroke.points),
    tension: stroke.points.length > 2 ? 0.35 : 0,
    pointerLength: 11 / scale,
    pointerWidth: 10 / scale,
    lineCap: "round" as const,
    lineJoin: "round" as const,
  };
  sheet.add(new Arrow({ ...shape, stroke: kShade, fill: kShade, strokeWidth: 6 / scale, opacity: 0.55, listening: false }));
  const colour = chosen ? accent() : "#fff";
  const arrow = new Arrow({ ...shape, stroke: colour, fill: colour, strokeWidth: 2.6 / scale, hitStrokeWidth: 18 / scale });
  arrow.on("pointerdown", (event) => {
    if (view.panning.value || event.evt.button !== 0 || view.flowTool.value !== "line") return;
    event.cancelBubble = true;
    view.selected.value = index;
  });
  sheet.add(arrow);
  if (!chosen || view.flowTool.value !== "line") return;
  showHandles(stroke.points, sheet, (points) => {
    const strokes = state.doc.value?.strokes ?? [];
    state.edit({ strokes: strokes.map((each, i) => (i === index ? { ...each, points } : each)) });
  });
}

export const flowTool: Tool = {
  ...kPlainTool,
  showsStreaks: true,
  pen: () => (view.flowTool.value === "line" ? "arrow" : "brush"),
  colour(erasing) {
    if (view.flowTool.value === "direction") return erasing ? kTakes : accent();
    return tempoColour(erasing ? 1 : view.tempo.value);
  },
  press() {
    view.selected.value = null;
    return true;
  },
  finish({ runs, points, isClick, erasing }) {
    const document = state.doc.value;
    if (!document) return;
    const tool = view.flowTool.value;
    if (tool === "tempo") {
      const factor = erasing ? 1 : view.tempo.value;
      state.edit({ tempo: [...document.tempo, ...runs.map((run) => ({ ...run, factor }))] });
    } else if (tool === "direction") {
      // A dot has no direction; it can take away.
      if (!isClick || erasing) state.edit({ directions: [...document.directions, ...runs.map((run) => ({ ...run, adds: !erasing, area: false }))] });
    } else if (!isClick) {
      const speed = view.fastByLength.value ? Math.round(lengthOf(points)) : null;
      state.edit({ strokes: [...document.strokes, { points, speed }] });
      view.selected.value = document.strokes.length;
    }
  },
  show(sheet) {
    const document = state.doc.value;
    if (!document) return;
    showDirections(document.directions, sheet);
    if (view.flowTool.value === "tempo") for (const { points, width, factor } of document.tempo) sheet.add(brushed(points, width, tempoColour(factor), 0.5));
    document.strokes.forEach((stroke, i) => showStroke(stroke, i, sheet));
  },
};

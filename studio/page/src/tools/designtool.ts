// Sources, obstacles and winds of a motion of one's own.
import { Arrow } from "konva/lib/shapes/Arrow";
import { flat } from "../pen";
import * as state from "../state";
import type { Point } from "../types";
import * as view from "../view";
import { brushed, kPlainTool, type Tool } from "./tool";

const colourOf = (source: boolean): string => (source ? "#f28f3b" : "#7d8b90");

export const designTool: Tool = {
  ...kPlainTool,
  pen: () => (view.designTool.value === "wind" ? "arrow" : "brush"),
  colour: () => colourOf(view.designTool.value === "source"),
  finish({ runs, points, isClick }) {
    const design = state.doc.value?.design;
    if (!design) return;
    if (view.designTool.value !== "wind") {
      const adds = view.designTool.value === "source";
      state.edit({ design: { ...design, sources: [...design.sources, ...runs.map((run) => ({ ...run, adds, area: false }))] } });
    } else if (!isClick) {
      const ends = [points[0], points[points.length - 1]] as Point[];
      state.edit({ design: { ...design, winds: [...design.winds, { points: ends, speed: null }] } });
    }
  },
  show(sheet) {
    const design = state.doc.value?.design;
    if (!design) return;
    for (const { points, width, adds } of design.sources) sheet.add(brushed(points, width, colourOf(adds), 0.6));
    for (const { points } of design.winds)
      sheet.add(new Arrow({ points: flat(points), stroke: "#fff", fill: "#fff", strokeWidth: 2.6 / sheet.scale, pointerLength: 11 / sheet.scale, pointerWidth: 10 / sheet.scale, lineCap: "round", listening: false }));
  },
};

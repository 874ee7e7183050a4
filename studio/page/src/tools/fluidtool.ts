// Scribbles, from which the matte is found, and paint that changes it exactly.
import { regionAt } from "../region";
import * as state from "../state";
import type { Point } from "../types";
import * as view from "../view";
import { accent, kPlainTool, kTakes, showScribbles, type Tool } from "./tool";

/** What lies there is held still, up to its edge. */
function holdAt(point: Point | undefined): void {
  const [document, open, image] = [state.doc.value, state.project.value, view.picture.value];
  if (!document || !open || !image || !point) return;
  const outline = regionAt(image, open, point);
  if (outline && outline.length > 2) state.edit({ held: [...document.held, { points: outline, width: 0, adds: true, area: true }] });
  else state.toast.value = "Nothing with an edge of its own lies there: paint over what shall stand.";
}

export const fluidTool: Tool = {
  ...kPlainTool,
  showsMatte: true,
  showsStill: true,
  pen: () => (view.fluidTool.value === "area" ? "area" : "brush"),
  colour(erasing) {
    const tool = view.fluidTool.value;
    if (tool === "hold") return erasing ? "#555" : "#e9b44c";
    return (tool === "still" || tool === "erase") !== erasing ? kTakes : accent();
  },
  finish({ runs, points, area, isClick, erasing }) {
    const document = state.doc.value;
    if (!document) return;
    const tool = view.fluidTool.value;
    const adds = area ? !erasing : (tool !== "still" && tool !== "erase") !== erasing;
    const drawn = runs.map((run) => ({ ...run, adds, area }));
    if (tool === "fluid" || tool === "still") state.edit({ scribbles: [...document.scribbles, ...drawn], ...(document.matte_base === "whole" ? { matte_base: "scribbles" as const } : {}) });
    else if (tool === "hold" && isClick && !erasing) holdAt(points[0]);
    else if (tool === "hold") state.edit({ held: [...document.held, ...drawn] });
    else state.edit({ paint: [...document.paint, ...drawn] });
  },
  show: (sheet) => showScribbles(state.doc.value?.scribbles ?? [], sheet),
};

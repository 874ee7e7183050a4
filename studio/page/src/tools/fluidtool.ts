// Scribbles, from which the matte is found, and paint that changes it exactly.
import { Line } from "konva/lib/shapes/Line";
import { flat } from "../pen";
import { holds, regionAt } from "../region";
import * as state from "../state";
import type { Point } from "../types";
import * as view from "../view";
import { accent, kPlainTool, kTakes, showScribbles, type Tool } from "./tool";

const kHeld = "#e9b44c";

export function hold(outlines: Point[][]): void {
  const document = state.doc.value;
  if (!document) return;
  state.edit({ held: [...document.held, ...outlines.map((points) => ({ points, width: 0, adds: true, area: true }))] });
  state.offered.value = state.offered.value.filter((each) => !outlines.includes(each));
}

/** What is offered there is held still, or else what lies there, up to its edge. */
function holdAt(point: Point | undefined): void {
  const [open, image] = [state.project.value, view.picture.value];
  if (!open || !image || !point) return;
  const outline = state.offered.value.find((each) => holds(each, point)) ?? regionAt(image, open, point);
  if (outline && outline.length > 2) hold([outline]);
  else state.toast.value = "Nothing with an edge of its own lies there: paint over what shall stand.";
}

export const fluidTool: Tool = {
  ...kPlainTool,
  showsMatte: true,
  showsStill: true,
  pen: () => (view.fluidTool.value === "area" ? "area" : "brush"),
  colour(erasing) {
    const tool = view.fluidTool.value;
    if (tool === "hold") return erasing ? "#555" : kHeld;
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
  show(sheet) {
    showScribbles(state.doc.value?.scribbles ?? [], sheet);
    if (view.fluidTool.value !== "hold") return;
    const [thin, dash] = [2 / sheet.scale, 6 / sheet.scale];
    for (const points of state.offered.value)
      sheet.add(new Line({ points: flat(points), closed: true, fill: kHeld + "40", stroke: kHeld, strokeWidth: thin, dash: [dash, dash], listening: false }));
  },
};

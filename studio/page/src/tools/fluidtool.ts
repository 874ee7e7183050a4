// Scribbles, from which the matte is found, and paint that changes it exactly.
import { Line } from "konva/lib/shapes/Line";
import * as api from "../api";
import { flat, paired } from "../pen";
import { holds } from "../region";
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

/** What is offered there is held still, or else what lies there; what is held there already is let go. */
function holdAt(point: Point | undefined): void {
  const document = state.doc.value;
  if (!document || !point) return;
  const outline = state.offered.value.find((each) => holds(each, point));
  if (outline) hold([outline]);
  else takeAt({ at: point, size: 1, before: document.held });
}

/** Its marks are drawn anew, of a size times what a click takes by itself. */
export function takeAt(click: Omit<state.Click, "after">): void {
  const open = state.project.value;
  if (!open) return;
  const shown = state.doc.value?.held;
  api.lying(open.id, click.at, click.size, click.before).then(
    ({ holds: adds, outlines }) => {
      if (state.project.value !== open || state.doc.value?.held !== shown) return;
      const taken = outlines.map((outline) => ({ points: paired(outline), width: 0, adds, area: true }));
      if (taken.length === 0) state.toast.value = "There is no fluid to hold still.";
      else {
        state.edit({ held: [...click.before, ...taken] }, `click ${click.at.join()}`);
        state.clicked.value = { ...click, after: state.doc.value?.held ?? [] };
      }
    },
    (fault: Error) => (state.toast.value = fault.message),
  );
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

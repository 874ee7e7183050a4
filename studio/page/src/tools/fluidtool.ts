// Scribbles, from which the matte is found, and paint that changes it exactly.
import * as state from "../state";
import * as view from "../view";
import { accent, kPlainTool, kTakes, showScribbles, type Tool } from "./tool";

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
  finish({ runs, area, erasing }) {
    const document = state.doc.value;
    if (!document) return;
    const tool = view.fluidTool.value;
    const adds = area ? !erasing : (tool !== "still" && tool !== "erase") !== erasing;
    const drawn = runs.map((run) => ({ ...run, adds, area }));
    if (tool === "fluid" || tool === "still") state.edit({ scribbles: [...document.scribbles, ...drawn], ...(document.matte_base === "whole" ? { matte_base: "scribbles" as const } : {}) });
    else if (tool === "hold") state.edit({ held: [...document.held, ...drawn] });
    else state.edit({ paint: [...document.paint, ...drawn] });
  },
  show: (sheet) => showScribbles(state.doc.value?.scribbles ?? [], sheet),
};

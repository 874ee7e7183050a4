// The modes of the work area: a row for each, in the order of their keys, 1 and so on.
import type { JSX } from "preact";
import { DesignPanel } from "./designpanel";
import { FlowlinesPanel } from "./flowlinespanel";
import { FlowPanel, FluidPanel, LookPanel, WhyPanel } from "./panels";
import { ScenePanel } from "./scenepanel";
import { StillsPanel } from "./stillspanel";
import { designTool } from "./tools/designtool";
import { flowlinesTool } from "./tools/flowlinestool";
import { flowTool } from "./tools/flowtool";
import { fluidTool } from "./tools/fluidtool";
import { sceneTool } from "./tools/scenetool";
import { stillsTool } from "./tools/stillstool";
import { kPanTool, type Tool } from "./tools/tool";
import { whyTool } from "./tools/whytool";
import type { Document, Mode } from "./types";

export interface ModeRow {
  label: string;
  tool: Tool;
  panel: (props: { document: Document }) => JSX.Element;
  way: boolean; // it makes a film of its own, by the way of its name
}

export const kModes: Record<Mode, ModeRow> = {
  fluid: { label: "Fluid", tool: fluidTool, panel: FluidPanel, way: false },
  flow: { label: "Flow", tool: flowTool, panel: FlowPanel, way: false },
  look: { label: "Look", tool: kPanTool, panel: LookPanel, way: false },
  why: { label: "Why", tool: whyTool, panel: WhyPanel, way: false },
  design: { label: "Design", tool: designTool, panel: DesignPanel, way: true },
  stills: { label: "Stills", tool: stillsTool, panel: StillsPanel, way: true },
  flowlines: { label: "Flow lines", tool: flowlinesTool, panel: FlowlinesPanel, way: true },
  scene: { label: "Scene", tool: sceneTool, panel: ScenePanel, way: true },
};
export const kModeNames = Object.keys(kModes) as Mode[];

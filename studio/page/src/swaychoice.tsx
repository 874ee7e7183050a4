// A clip in which a plant sways as a layer's shall, and where the plant stands in it.
import type { JSX } from "preact";
import { useState } from "preact/hooks";
import * as api from "./api";
import { changeLayer, changeLayerOf } from "./layers";
import { DropClip, useOwnClips } from "./ownclips";
import { Select } from "./parts";
import * as state from "./state";
import type { DrawnLayer, Point } from "./types";

const kLeast = 4; // px of a line, as a scene file takes it

export function SwayChoice({ layer }: { layer: DrawnLayer }): JSX.Element {
  const own = useOwnClips(layer.sway_clip);
  const stored = state.store.value?.clips.map(({ name }) => name) ?? [];
  const value = layer.sway_clip ? `${layer.sway_dropped ? "own" : "store"}:${layer.sway_clip}` : "";
  const chosen = (clip: string, dropped: boolean): Partial<DrawnLayer> => ({ sway_clip: clip, sway_dropped: dropped, sway_lines: [] });
  const choose = (text: string): void => changeLayer(chosen(text.slice(text.indexOf(":") + 1), !text.startsWith("store:")));
  return (
    <>
      <Select label="Sways as in" value={value} options={[["", "no film: as such plants do"], ...own.map((name) => [`own:${name}`, name] as const), ...stored.map((name) => [`store:${name}`, name] as const)]} onChange={choose} />
      <DropClip words="Drop a film of such a plant" label="Choose a plant's film" taken={(clip) => changeLayerOf(layer.name, chosen(clip, true))} />
      {layer.sway_clip && <Plants key={value} layer={layer} />}
    </>
  );
}

/** The clip's first frame, with a line for each of its plants. */
function Plants({ layer }: { layer: DrawnLayer }): JSX.Element {
  const [size, setSize] = useState<[number, number]>([0, 0]);
  const [line, setLine] = useState<Point[]>([]);
  const at = (event: PointerEvent): Point => {
    const { left, top, width, height } = (event.currentTarget as Element).getBoundingClientRect();
    return [((event.clientX - left) / width) * size[0], ((event.clientY - top) / height) * size[1]];
  };
  const end = (event: PointerEvent): void => {
    const [from, to] = [line[0], at(event)];
    if (from && Math.hypot(to[0] - from[0], to[1] - from[1]) >= kLeast) changeLayer({ sway_lines: [...layer.sway_lines, { points: [from, to], speed: null }] });
    setLine([]);
  };
  const lines = [...layer.sway_lines.map(({ points }) => points), ...(line.length > 1 ? [line] : [])];
  return (
    <>
      <p class="hint">Draw on it from the plant's root to its tip. The film of the layers shows how it sways.</p>
      <div
        class="plants"
        role="img"
        aria-label="The film's plant"
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          setLine([at(event)]);
        }}
        onPointerMove={(event) => line[0] && setLine([line[0], at(event)])}
        onPointerUp={end}
        onPointerCancel={() => setLine([])}
      >
        <img src={api.address.clipFrame(state.project.value?.id ?? "", layer.sway_clip, layer.sway_dropped)} alt="" draggable={false} onLoad={({ currentTarget }) => setSize([currentTarget.naturalWidth, currentTarget.naturalHeight])} />
        <svg viewBox={`0 0 ${size[0]} ${size[1]}`} aria-hidden>
          {lines.map(([from, to], i) => from && to && <line key={i} x1={from[0]} y1={from[1]} x2={to[0]} y2={to[1]} />)}
        </svg>
      </div>
      <button type="button" class="quiet" disabled={layer.sway_lines.length === 0} onClick={() => changeLayer({ sway_lines: [] })}>
        Clear the plant's lines
      </button>
    </>
  );
}

// The panels beside the picture of the animation: what can be said and seen of it.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { Brush, Eraser, Hand, Pencil, Pin as PinIcon, Shapes, Spline, Trash2, X } from "lucide-preact";
import * as api from "./api";
import { KindSection } from "./kindsection";
import { Choice, IconButton, named, Section, Select, Slider, Strip, Switch } from "./parts";
import { lengthOf, paired } from "./pen";
import * as state from "./state";
import { hold, takeAt } from "./tools/fluidtool";
import { SweepSection } from "./sweepsection";
import type { Candidate, Candidates, Document, Edge, MatteBase } from "./types";
import * as view from "./view";

const percent = (share: number): string => `${Math.round(share * 100)} %`;

export function FluidPanel({ document }: { document: Document }): JSX.Element {
  const tool = view.fluidTool.value;
  const found = state.matte.value;
  const alpha = state.project.value?.alpha ?? false;
  const bases: [MatteBase, string][] = [["scribbles", "Scribbles"], ["whole", "All of it"]];
  if (alpha) bases.push(["alpha", "Its alpha"]);
  if (document.matte_base === "file") bases.push(["file", "A file"]);
  const tools = [
    ["fluid", "Fluid", Pencil, "B"],
    ["still", "Not fluid", X, "N"],
    ["paint", "Paint", Brush, "P"],
    ["erase", "Erase", Eraser, "E"],
    ["area", "Area", Shapes, "A"],
    ["hold", "Hold still", Hand, "H"],
  ] as const;
  const hints: Record<view.FluidTool, string> = {
    fluid: "Scribble on what flows. The rest is found.",
    still: "Scribble on what stands, where too much was found.",
    paint: "Paint onto the matte, exactly.",
    erase: "Take away from the matte, exactly.",
    area: "Draw around an area, or click its corners and then the first one again. Alt takes it away.",
    hold: "Click what stands in front of the fluid, or paint over it: it stays as it is. Click it again to let go.",
  };
  return (
    <>
      <Section title="What flows" aside={found && <span class="figure">{percent(found.share)}</span>}>
        <div class="tools" role="group" aria-label="Drawing tools">
          {tools.map(([id, label, Drawn, key]) => (
            <button key={id} type="button" class="tool" aria-pressed={tool === id} title={`${label}  (${key})`} onClick={() => (view.fluidTool.value = id)}>
              <Drawn size={18} strokeWidth={1.75} aria-hidden />
              <span>{label}</span>
            </button>
          ))}
        </div>
        <p class="hint">{hints[tool]}</p>
        {tool === "hold" && <Sized />}
        {tool === "hold" && <Offered />}
        {tool !== "area" && (
          <Slider label="Brush" value={view.brush.value} min={2} max={400} logarithmic shown={`${Math.round(view.brush.value)} px`} onInput={(value) => (view.brush.value = value)} />
        )}
      </Section>
      <KindSection document={document} />
      <Section title="Matte">
        <Choice label="Where the matte comes from" value={document.matte_base} options={bases} onChange={(matte_base) => state.edit({ matte_base })} />
        <Choice
          label="How the matte is shown"
          value={view.matteLook.value}
          options={[["tint", "Tint"], ["edge", "Edge"], ["cutout", "Cut-out"], ["off", "Off"]] as const}
          onChange={(look) => (view.matteLook.value = look)}
        />
        {document.matte_base === "scribbles" && (
          <label class="field">
            <span>Edge</span>
            <select value={document.edge} onChange={(event) => state.edit({ edge: event.currentTarget.value as Edge })}>
              <option value="guided">Soft, along the picture</option>
              <option value="information-flow">Fine detail (slower)</option>
              <option value="none">Hard</option>
            </select>
          </label>
        )}
        {found?.notices.map((notice) => (
          <p class="hint" key={notice}>
            {notice}
          </p>
        ))}
        <div class="row">
          <GiveMatte />
          <button
            type="button"
            class="quiet"
            disabled={document.scribbles.length + document.paint.length + document.held.length === 0}
            onClick={() => state.edit({ scribbles: [], paint: [], held: [] })}
          >
            Clear
          </button>
        </div>
      </Section>
    </>
  );
}

/** Of what the last click took, more or less. */
function Sized(): JSX.Element | null {
  const click = state.clicked.value;
  if (!click || state.doc.value?.held !== click.after) return null;
  const resize = (times: number): void => takeAt({ ...click, size: click.size * times });
  return (
    <div class="row">
      <button type="button" class="quiet" disabled={click.size < 0.05} onClick={() => resize(0.5)}>
        Less
      </button>
      <button type="button" class="quiet" disabled={click.size > 20} onClick={() => resize(2)}>
        More
      </button>
    </div>
  );
}

/** What looks as if it stood, to be held by a click or all at once. */
function Offered(): JSX.Element {
  const offered = state.offered.value;
  const find = (): void => {
    const open = state.project.value;
    if (!open) return;
    api.standing(open.id).then(
      (outlines) => {
        if (state.project.value !== open) return;
        state.offered.value = outlines.map(paired);
        if (outlines.length === 0) state.toast.value = "Nothing looks as if it stood in the fluid: click it, or paint over it.";
      },
      (fault: Error) => (state.toast.value = fault.message),
    );
  };
  if (offered.length === 0)
    return (
      <button type="button" class="quiet" disabled={!state.matte.value} onClick={find}>
        Find what stands
      </button>
    );
  return (
    <div class="row">
      <button type="button" class="quiet" title="Or click one of them on the picture" onClick={() => hold(offered)}>
        {offered.length === 1 ? "Hold it" : `Hold all ${offered.length}`}
      </button>
      <button type="button" class="quiet" onClick={() => (state.offered.value = [])}>
        None
      </button>
    </div>
  );
}

function GiveMatte(): JSX.Element {
  return (
    <label class="button quiet">
      Use a file…
      <input
        type="file"
        accept="image/*"
        class="unseen"
        onChange={(event) => {
          const file = event.currentTarget.files?.[0];
          const id = state.project.value?.id;
          event.currentTarget.value = "";
          if (!file || !id) return;
          api.giveMatte(id, file).then(
            () => state.edit({ matte_base: "file", scribbles: [], paint: [] }),
            (fault: Error) => (state.toast.value = fault.message),
          );
        }}
      />
    </label>
  );
}

const kDirections: readonly (readonly [string, number, number, string])[] = [
  ["↖", -1, -1, "up and left"],
  ["↑", 0, -1, "up"],
  ["↗", 1, -1, "up and right"],
  ["←", -1, 0, "left"],
  ["", 0, 0, ""],
  ["→", 1, 0, "right"],
  ["↙", -1, 1, "down and left"],
  ["↓", 0, 1, "down"],
  ["↘", 1, 1, "down and right"],
];

function oneDirection(dx: number, dy: number): void {
  const open = state.project.value;
  if (!open) return;
  const reach = 0.3 * Math.min(open.width, open.height);
  const length = Math.hypot(dx, dy) || 1;
  const [x, y] = [open.width / 2, open.height / 2];
  state.edit({
    strokes: [
      {
        points: [
          [Math.round(x - (reach * dx) / length), Math.round(y - (reach * dy) / length)],
          [Math.round(x + (reach * dx) / length), Math.round(y + (reach * dy) / length)],
        ],
        speed: null,
      },
    ],
  });
}

export function FlowPanel({ document }: { document: Document }): JSX.Element {
  const chosen = view.selected.value;
  const stroke = chosen === null ? undefined : document.strokes[chosen];
  const change = (speed: number | null, key = ""): void =>
    state.edit({ strokes: document.strokes.map((each, i) => (i === chosen ? { ...each, speed } : each)) }, key);
  return (
    <>
      <Section title="Where it flows" aside={<span class="figure">{document.strokes.length}</span>}>
        <p class="hint">
          {document.strokes.length === 0
            ? "Draw a line along the flow, and it moves that way. A few lines are enough; without any, the way is guessed."
            : "Click a line to change it. Delete removes it."}
        </p>
        <Choice label="What the pointer draws" value={view.flowTool.value} options={[["line", "Lines"], ["direction", "Brush"], ["tempo", "Pace"]] as const} onChange={(tool) => (view.flowTool.value = tool)} />
        {document.strokes.length + document.directions.length === 0 && (
          <div class="compass" role="group" aria-label="All of it goes one way">
            {kDirections.map(([arrow, dx, dy, words]) =>
              arrow ? (
                <button key={arrow} type="button" aria-label={`All goes ${words}`} title={`All goes ${words}`} onClick={() => oneDirection(dx, dy)}>
                  {arrow}
                </button>
              ) : (
                <span key="middle" aria-hidden />
              ),
            )}
          </div>
        )}
        <Switch label="Streaks" hint="The motion as it is understood" checked={view.streaks.value} onChange={(on) => (view.streaks.value = on)} />
        <Switch label="Longer is faster" hint="New lines: px per second as long as drawn" checked={view.fastByLength.value} onChange={(on) => (view.fastByLength.value = on)} />
        {document.strokes.length > 0 && (
          <button type="button" class="quiet" onClick={() => { state.edit({ strokes: [] }); view.selected.value = null; }}>
            Clear all lines
          </button>
        )}
      </Section>
      {view.flowTool.value === "direction" && <DirectionSection document={document} />}
      {view.flowTool.value === "tempo" && <TempoSection document={document} />}
      {stroke && chosen !== null && (
        <Section
          title={`Line ${chosen + 1}`}
          aside={
            <IconButton
              icon={Trash2}
              label="Remove this line"
              shortcut="Delete"
              onClick={() => {
                state.edit({ strokes: document.strokes.filter((_, i) => i !== chosen) });
                view.selected.value = null;
              }}
            />
          }
        >
          <Switch label="As fast as its clips" checked={stroke.speed === null} onChange={(own) => change(own ? null : Math.max(10, Math.round(lengthOf(stroke.points))))} />
          {stroke.speed !== null && (
            <Slider label="Speed" value={Math.max(1, stroke.speed)} min={1} max={1000} logarithmic shown={`${Math.round(stroke.speed)} px/s`} onInput={(value) => change(Math.round(value), "speed")} />
          )}
          <button
            type="button"
            class="quiet"
            onClick={() => state.edit({ strokes: document.strokes.map((each, i) => (i === chosen ? { ...each, points: [...each.points].reverse() } : each)) })}
          >
            <Spline size={16} aria-hidden /> Turn round
          </button>
        </Section>
      )}
    </>
  );
}

function DirectionSection({ document }: { document: Document }): JSX.Element {
  return (
    <Section title="Brush">
      <p class="hint">Brush along the flow: all that the brush covers goes that way. The right button or Alt takes it away.</p>
      <Slider label="Brush" value={view.brush.value} min={2} max={400} logarithmic shown={`${Math.round(view.brush.value)} px`} onInput={(value) => (view.brush.value = value)} />
      {document.directions.length > 0 && (
        <button type="button" class="quiet" onClick={() => state.edit({ directions: [] })}>
          Clear what was brushed
        </button>
      )}
    </Section>
  );
}

function TempoSection({ document }: { document: Document }): JSX.Element {
  return (
    <Section title="Pace">
      <p class="hint">Paint where it plays slower or faster than it was filmed. The right button or Alt paints it as filmed again.</p>
      <Slider label="Pace" value={view.tempo.value} min={0.5} max={2} logarithmic shown={`${view.tempo.value.toFixed(2)} ×`} onInput={(value) => (view.tempo.value = Math.round(value * 100) / 100)} />
      <Slider label="Brush" value={view.brush.value} min={2} max={400} logarithmic shown={`${Math.round(view.brush.value)} px`} onInput={(value) => (view.brush.value = value)} />
      {document.tempo.length > 0 && (
        <button type="button" class="quiet" onClick={() => state.edit({ tempo: [] })}>
          As filmed everywhere
        </button>
      )}
    </Section>
  );
}

export function LookPanel({ document }: { document: Document }): JSX.Element {
  const stores = state.home.value?.stores ?? [];
  const store = state.store.value;
  const classes = state.classesOf(store);
  const seconds = document.frames / document.fps;
  const speed = document.speed || (state.pieces.value?.paces.auto ?? 1);
  return (
    <>
      <Section title="Moves like">
        <label class="field">
          <span>Store</span>
          <select value={document.store} onChange={(event) => state.edit({ store: event.currentTarget.value, class: "", excluded_clips: [], pins: [] })}>
            {!store && <option value={document.store}>{document.store ? "not open" : "Choose one"}</option>}
            {stores.map((each) => (
              <option key={each.id} value={each.path}>
                {each.name} · {each.clips.length} clips
              </option>
            ))}
          </select>
        </label>
        {classes.length > 0 && (
          <Select label="Kind" value={document.class} options={[["", "As it looks"], ["any", "Any"], ...named(classes)]} onChange={(kind) => state.edit({ class: kind })} />
        )}
        {document.excluded_clips.length > 0 && (
          <ul class="chips" aria-label="Clips that are left out">
            {document.excluded_clips.map((clip) => (
              <li key={clip}>
                {clip}
                <button type="button" aria-label={`Use ${clip} again`} onClick={() => state.edit({ excluded_clips: document.excluded_clips.filter((each) => each !== clip) })}>
                  <X size={14} aria-hidden />
                </button>
              </li>
            ))}
          </ul>
        )}
      </Section>
      <Section title="Time">
        <Slider
          label="Length"
          value={seconds}
          min={0.5}
          max={20}
          step={0.5}
          shown={`${seconds.toFixed(1)} s · ${document.frames} frames`}
          onInput={(value) => state.edit({ frames: Math.max(2, Math.round(value * document.fps)) }, "frames")}
        />
        <Slider label="Speed" value={speed} min={0.1} max={4} logarithmic shown={`${speed.toFixed(2)} ×`} onInput={(value) => state.edit({ speed: Math.abs(value - 1) < 0.04 ? 1 : Math.round(value * 100) / 100 }, "speed-all")} />
        <label class="field">
          <span>Frames per second</span>
          <select value={String(document.fps)} onChange={(event) => state.edit({ fps: Number(event.currentTarget.value), frames: Math.max(2, Math.round(seconds * Number(event.currentTarget.value))) })}>
            {[...new Set([12, 24, 25, 30, 50, 60, document.fps])].sort((a, b) => a - b).map((rate) => (
              <option key={rate} value={String(rate)}>
                {rate}
              </option>
            ))}
          </select>
        </label>
        <Switch label="Seamless loop" checked={document.loop} onChange={(loop) => state.edit({ loop })} />
      </Section>
      <Section title="Outline">
        <Switch label="Moves with the fluid" hint="For fire and smoke" checked={document.moving_outline} onChange={(moving_outline) => state.edit({ moving_outline })} />
      </Section>
      <Section title="Horizon">
        <Switch label="Water ends at its straight border" hint="Towards it everything goes slower" checked={document.horizon === "auto"} onChange={(found) => state.edit({ horizon: found ? "auto" : "none" })} />
      </Section>
      <SweepSection document={document} />
    </>
  );
}

export function WhyPanel({ document }: { document: Document }): JSX.Element {
  const found = state.pieces.value;
  const id = state.project.value?.id;
  const index = view.piece.value;
  const labels = state.labelsNumber.value;
  const [answer, setAnswer] = useState<Candidates | null>(null);
  useEffect(() => {
    if (index === null || !id) return setAnswer(null);
    let alive = true;
    api.candidates(id, index).then(
      (candidates) => alive && setAnswer(candidates),
      () => alive && setAnswer(null),
    );
    return () => {
      alive = false;
    };
  }, [id, index, labels]);
  if (!found || !id) return <Section title="Why it moves so"><p class="hint">There is nothing to ask about yet: say what flows first.</p></Section>;
  const total = Math.max(1, found.pieces.length);
  return (
    <>
      {!answer && (
        <Section title="Why it moves so">
          <p class="hint">Click the picture to see which piece of which clip moves there, and what else could.</p>
        </Section>
      )}
      {answer && <PieceSection answer={answer} document={document} id={id} labels={labels} />}
      <Section title="From these clips">
        <Choice
          label="Map over the picture"
          value={view.pieceMap.value}
          options={[["none", "None"], ["clip", "Clip"], ["score", "Likeness"], ["sure", "How sure"]] as const}
          onChange={(map) => (view.pieceMap.value = map)}
        />
        {view.pieceMap.value === "sure" && <p class="hint">Red: another patch would do there about as well. Green: nothing else fits.</p>}
        {view.pieceMap.value === "score" && <p class="hint">Red: the patch looks little like the picture there. Green: much.</p>}
        <ul class="shares">
          {found.clips
            .map((clip, i) => ({ ...clip, i }))
            .sort((a, b) => b.pieces - a.pieces)
            .map((clip) => (
              <li key={clip.name}>
                <span class="swatch" style={{ background: view.clipColour(clip.i) }} aria-hidden />
                <span class="name">
                  {clip.name}
                  <small>{clip.licence || "no licence recorded"}</small>
                </span>
                <span class="figure">{percent(clip.pieces / total)}</span>
                <button type="button" class="quiet small" onClick={() => ban(document, clip.name)} aria-label={`Leave out ${clip.name}`}>
                  Leave out
                </button>
              </li>
            ))}
        </ul>
        {document.excluded_clips.length > 0 && (
          <button type="button" class="quiet" onClick={() => state.edit({ excluded_clips: [] })}>
            Use the {document.excluded_clips.length} left out again
          </button>
        )}
        <a class="button quiet" href={api.address.credits(id)} download="credits.txt">
          Credits as a file
        </a>
      </Section>
      {found.notices.length > 0 && (
        <Section title="Good to know">
          {found.notices.map((notice) => (
            <p class="hint" key={notice}>
              {notice}
            </p>
          ))}
        </Section>
      )}
    </>
  );
}

function ban(document: Document, clip: string): void {
  if (!document.excluded_clips.includes(clip)) state.edit({ excluded_clips: [...document.excluded_clips, clip] });
}

function PieceSection(props: { answer: Candidates; document: Document; id: string; labels: number }): JSX.Element {
  const { answer, document, id, labels } = props;
  const chosen = answer.candidates.find((each) => each.place === answer.chosen);
  const store = state.store.value;
  const clip = store?.clips.find((each) => each.name === chosen?.clip);
  const index = store?.clips.findIndex((each) => each.name === chosen?.clip) ?? -1;
  const others = document.pins.filter((pin) => pin.x !== answer.x || pin.y !== answer.y);
  const take = (candidate: Candidate): void =>
    state.edit({ pins: [...others, { x: answer.x, y: answer.y, clip: candidate.clip, variant: candidate.variant, patch_x: candidate.x, patch_y: candidate.y }] });
  return (
    <Section
      title="This piece"
      aside={
        answer.pinned ? (
          <button type="button" class="quiet small" onClick={() => state.edit({ pins: others })}>
            <PinIcon size={14} aria-hidden /> Let go
          </button>
        ) : (
          chosen && (
            <button type="button" class="quiet small" onClick={() => take(chosen)}>
              <PinIcon size={14} aria-hidden /> Pin
            </button>
          )
        )
      }
    >
      {chosen && (
        <>
          {store && clip && (
            <figure class="in-clip">
              <Strip source={api.address.clip(store.id, index)} aspect={clip.width / clip.height} label={`The clip ${clip.name}, playing`} />
              <svg viewBox="0 0 1 1" preserveAspectRatio="none" aria-hidden>
                <polygon points={chosen.corners.map((corner) => corner.join(",")).join(" ")} vector-effect="non-scaling-stroke" />
              </svg>
            </figure>
          )}
          <div class="row facts">
            <span class="name">
              {chosen.clip}
              <small>
                {[chosen.scale !== 1 && `at ${percent(chosen.scale)}`, chosen.rotation !== 0 && `turned ${chosen.rotation}°`, chosen.flip && "mirrored"].filter(Boolean).join(", ") || "as it was filmed"}
              </small>
            </span>
            <span class="figure" title="How alike it looks, 0 to 1; above 0.2 is good">
              {chosen.score.toFixed(2)}
            </span>
          </div>
          <button type="button" class="quiet" onClick={() => ban(document, chosen.clip)}>
            Leave this clip out
          </button>
        </>
      )}
      <h4>It could also be</h4>
      <div class="candidates">
        {answer.candidates.map((candidate) => (
          <button
            key={candidate.place}
            type="button"
            class="candidate"
            aria-pressed={candidate.place === answer.chosen}
            title={`${candidate.clip}, ${candidate.score.toFixed(2)} alike`}
            aria-label={`Take ${candidate.clip}, ${candidate.score.toFixed(2)} alike`}
            onClick={() => take(candidate)}
          >
            <Strip source={api.address.patch(id, answer.piece, candidate.place, labels)} aspect={1} label="" />
            <span>{candidate.score.toFixed(2)}</span>
          </button>
        ))}
      </div>
    </Section>
  );
}


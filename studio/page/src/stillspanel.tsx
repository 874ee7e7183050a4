// A moving scene from some stills of it: the stills, the orders that were found in them, and what is said against
// these.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { ArrowRight, Ban, ImagePlus, X } from "lucide-preact";
import * as api from "./api";
import { FilmSection, LayOver, useWay } from "./filmsection";
import { Choice, IconButton, Section, Slider, Switch } from "./parts";
import * as state from "./state";
import { choosePair, choosePin, found, neighbours, pinBegun, reachPin, removePin } from "./stillpins";
import type { Document, FoundRegion, FoundStills, Stills, StillsPath } from "./types";
import * as view from "./view";

const kWay = "stills";
const kKinds: Record<string, string> = { independent: "moves by itself", slow: "changes slowly", standing: "stands" };

export function StillsPanel({ document }: { document: Document }): JSX.Element {
  const id = state.project.value?.id ?? "";
  const { stills } = document;
  const [names, setNames] = useState<string[]>([]);
  const way = useWay(kWay, stills);
  const news = state.filmed.value;
  useEffect(() => {
    api.stills(id).then(setNames, (fault: Error) => (state.toast.value = fault.message));
  }, [id, news]);
  const seen = way?.film ? (way.found as FoundStills | null) : null;
  useEffect(() => {
    found.value = seen; // once: what is drawn anew lets go of what is dragged
  }, [way?.film, way?.made]);
  useGround(id);
  useEffect(() => choosePair(null), [news]); // a new film is looked at
  const change = (part: Partial<Stills>, key = ""): void => state.edit({ stills: { ...stills, ...part } }, key);
  return (
    <>
      <StillsSection id={id} names={names} cleared={() => change({ paths: [], pins: [] })} />
      <Section title="How it plays">
        <Slider label="Length" value={stills.seconds} min={1} max={30} step={0.5} shown={`${stills.seconds.toFixed(1)} s`} onInput={(seconds) => change({ seconds }, "stills-seconds")} />
        <Slider label="Speed" value={stills.speed} min={0.25} max={4} logarithmic shown={`${stills.speed.toFixed(2)} ×`} onInput={(speed) => change({ speed: Number(speed.toFixed(2)) }, "stills-speed")} />
        <Slider label="Parts of each region" value={stills.split} min={1} max={8} shown={stills.split === 1 ? "whole" : String(stills.split)} onInput={(split) => change({ split }, "stills-split")} />
        <Switch label="Seamless loop" checked={stills.loop} onChange={(loop) => change({ loop })} />
        <Switch label="Full size" hint="Without it a draft, 480 px wide or high" checked={stills.full} onChange={(full) => change({ full })} />
      </Section>
      <FilmSection name={kWay} way={way} ready={names.length > 1} stale={!!view.pair.value} />
      {way?.film && <LayOver film="stills" blend="over" />}
      {(seen || stills.pins.length > 0) && <PinsSection id={id} stills={stills} />}
      {stills.paths.length > 0 && (
        <Section title="Changed orders">
          <ul class="paths">
            {stills.paths.map((path, i) => (
              <li key={i}>
                <Row id={id} names={path.names} />
                <span class="hint">
                  Region {path.region}: {path.refused ? "not walked" : "walked this way only"}
                </span>
                <IconButton icon={X} label={`Forget what was said of path ${i + 1}`} onClick={() => change({ paths: stills.paths.filter((each) => each !== path) })} />
              </li>
            ))}
          </ul>
        </Section>
      )}
      {way?.film && seen && <FoundSection id={id} found={seen} number={way.film} say={(path) => change({ paths: [...stills.paths, path] })} />}
    </>
  );
}

/** Sends pictures one after another, so that the disk and the line are not asked for all at once. */
export async function sendStills(id: string, files: File[], told: (count: number) => void = () => undefined): Promise<void> {
  for (const [i, file] of files.entries()) {
    told(i + 1);
    await api.sendStill(id, file);
  }
}

function StillsSection({ id, names, cleared }: { id: string; names: string[]; cleared: () => void }): JSX.Element {
  const [sent, setSent] = useState("");
  const take = async (files: File[]): Promise<void> => {
    try {
      await sendStills(id, files, (count) => setSent(`Sending ${count} of ${files.length}`));
    } catch (fault) {
      state.toast.value = (fault as Error).message;
    }
    setSent("");
  };
  return (
    <Section title="Stills" aside={<span class="figure">{names.length || ""}</span>}>
      <p class="hint">Ten to twenty photographs of one scene, from one place, within a minute or two, in any order.</p>
      <label class="drop small" onDragOver={(event) => event.preventDefault()} onDrop={(event) => { event.preventDefault(); void take([...(event.dataTransfer?.files ?? [])]); }}>
        <ImagePlus size={20} strokeWidth={1.5} aria-hidden />
        <strong>{sent || "Drop stills, or choose them"}</strong>
        <input type="file" multiple class="unseen" aria-label="Choose stills" accept=".png,.jpg,.jpeg,.tif,.tiff" onChange={(event) => void take([...(event.currentTarget.files ?? [])])} />
      </label>
      {names.length > 0 && (
        <>
          <Row id={id} names={names} />
          <button type="button" class="quiet small" onClick={() => { cleared(); void api.removeStills(id); }}>
            Remove all of them
          </button>
        </>
      )}
    </Section>
  );
}

/** The still of the chosen two that is shown, on the canvas in place of the picture. */
function useGround(id: string): void {
  const pair = view.pair.value;
  const side = view.pairSide.value;
  const [images, setImages] = useState<HTMLImageElement[]>([]);
  useEffect(() => {
    let alive = true;
    setImages([]);
    const wholes = (pair ?? []).map(async (name) => {
      const image = new Image();
      image.src = api.address.wholeStill(id, name);
      await image.decode();
      return image;
    });
    Promise.all(wholes).then(
      (loaded) => alive && setImages(loaded),
      () => {
        if (alive) state.toast.value = "A still cannot be shown.";
      },
    );
    return () => {
      alive = false;
    };
  }, [id, pair]);
  useEffect(() => {
    view.ground.value = images[side] ?? null;
  }, [images, side]);
  useEffect(
    () => () => {
      choosePair(null);
      view.ground.value = null;
    },
    [id],
  );
}

function PinsSection({ id, stills }: { id: string; stills: Stills }): JSX.Element {
  const pair = view.pair.value;
  const chosen = view.pin.value;
  const pin = chosen === null ? undefined : stills.pins[chosen];
  const ground = view.ground.value;
  const longest = ground ? Math.max(ground.naturalWidth, ground.naturalHeight) : 1000;
  const hint = !pair
    ? "What leaps from one still to the next is shown twice. Choose two that follow each other, and show where it goes."
    : pinBegun.value
      ? "Where is the same point in this still?"
      : "Press on a point within the frame, drag it to where it is in the other still, and let go. Or click it in both.";
  return (
    <Section title="Pins" aside={<span class="figure">{stills.pins.length || ""}</span>}>
      <p class="hint">{hint}</p>
      <div class="pairs" role="group" aria-label="Two stills">
        {neighbours().map((two) => {
          const pressed = pair !== null && two.every((name) => pair.includes(name));
          return (
            <button key={two.join()} type="button" aria-pressed={pressed} aria-label={two.join(" and ")} onClick={() => choosePair(pressed ? null : two)}>
              <Row id={id} names={two} />
            </button>
          );
        })}
      </div>
      {pair && <Choice label="Which still is shown" value={String(view.pairSide.value)} options={[["0", pair[0]], ["1", pair[1]]] as const} onChange={(side) => (view.pairSide.value = side === "0" ? 0 : 1)} />}
      {stills.pins.length > 0 && (
        <ul class="paths">
          {stills.pins.map(({ from, to, points: [[x, y], [u, v]] }, i) => (
            <li key={i}>
              <button type="button" class="quiet small" aria-pressed={i === chosen} onClick={() => choosePin(i)}>
                {i + 1}: {from} to {to}, {Math.round(Math.hypot(u - x, v - y))} px
              </button>
              <IconButton icon={X} label={`Take pin ${i + 1} out`} shortcut="Delete" onClick={() => removePin(i)} />
            </li>
          ))}
        </ul>
      )}
      {pin && chosen !== null && <Slider label="Reach" value={pin.reach} min={4} max={Math.max(longest, pin.reach)} logarithmic shown={`${Math.round(pin.reach)} px`} onInput={(reach) => reachPin(chosen, Math.round(reach))} />}
    </Section>
  );
}

/** Stills in an order. */
function Row({ id, names }: { id: string; names: readonly string[] }): JSX.Element {
  return (
    <span class="stills" role="img" aria-label={names.join(", ")}>
      {names.map((name, i) => (
        <img key={i} src={api.address.still(id, name)} alt="" title={name} loading="lazy" />
      ))}
    </span>
  );
}

function FoundSection(props: { id: string; found: FoundStills; number: string; say: (path: StillsPath) => void }): JSX.Element {
  const { id, found } = props;
  return (
    <Section
      title="What was found"
      aside={
        <a class="button small" href={api.address.wayFile(id, kWay, "page.html", props.number)} target="_blank" rel="noreferrer">
          Graphs
        </a>
      }
    >
      {found.notices.map((notice) => (
        <p key={notice} class="hint">
          {notice}
        </p>
      ))}
      <img class="sheet" src={api.address.wayFile(id, kWay, "regions.png", props.number)} alt="The regions, and what varies" />
      {found.regions.map((region) => (
        <Region key={region.name} id={id} region={region} say={props.say} />
      ))}
    </Section>
  );
}

function Region({ id, region, say }: { id: string; region: FoundRegion; say: (path: StillsPath) => void }): JSX.Element {
  return (
    <article class="region">
      <h4>
        Region {region.name} {kKinds[region.kind] ?? region.kind}
      </h4>
      <p class="hint">Shown in this order</p>
      <Row id={id} names={region.sequence} />
      <p class="hint">Orders that it may go by</p>
      <ul class="paths">
        {region.paths.map((names, i) => (
          <li key={names.join()}>
            <Row id={id} names={names} />
            <IconButton icon={ArrowRight} label={`Region ${region.name}, path ${i + 1}: this way only`} onClick={() => say({ region: region.name, names, refused: false })} />
            <IconButton icon={Ban} label={`Region ${region.name}, path ${i + 1}: not at all`} onClick={() => say({ region: region.name, names, refused: true })} />
          </li>
        ))}
      </ul>
    </article>
  );
}

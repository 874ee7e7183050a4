// A moving scene from some stills of it: the stills, the orders that were found in them, and what is said against
// these.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { ArrowRight, Ban, ImagePlus, X } from "lucide-preact";
import * as api from "./api";
import { FilmSection, LayOver, useWay } from "./filmsection";
import { IconButton, Section, Slider, Switch } from "./parts";
import * as state from "./state";
import type { Document, FoundRegion, FoundStills, Stills, StillsPath } from "./types";

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
  const change = (part: Partial<Stills>, key = ""): void => state.edit({ stills: { ...stills, ...part } }, key);
  return (
    <>
      <StillsSection id={id} names={names} />
      <Section title="How it plays">
        <Slider label="Length" value={stills.seconds} min={1} max={30} step={0.5} shown={`${stills.seconds.toFixed(1)} s`} onInput={(seconds) => change({ seconds }, "stills-seconds")} />
        <Slider label="Speed" value={stills.speed} min={0.25} max={4} logarithmic shown={`${stills.speed.toFixed(2)} ×`} onInput={(speed) => change({ speed: Number(speed.toFixed(2)) }, "stills-speed")} />
        <Slider label="Parts of each region" value={stills.split} min={1} max={8} shown={stills.split === 1 ? "whole" : String(stills.split)} onInput={(split) => change({ split }, "stills-split")} />
        <Switch label="Seamless loop" checked={stills.loop} onChange={(loop) => change({ loop })} />
        <Switch label="Full size" hint="Without it a draft, 480 px wide or high" checked={stills.full} onChange={(full) => change({ full })} />
      </Section>
      <FilmSection name={kWay} way={way} ready={names.length > 1} />
      {way?.film && <LayOver film="stills" blend="over" />}
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
      {way?.film && !!way.found && <FoundSection id={id} found={way.found as FoundStills} number={way.film} say={(path) => change({ paths: [...stills.paths, path] })} />}
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

function StillsSection({ id, names }: { id: string; names: string[] }): JSX.Element {
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
          <button type="button" class="quiet small" onClick={() => void api.removeStills(id)}>
            Remove all of them
          </button>
        </>
      )}
    </Section>
  );
}

/** Stills in an order. */
function Row({ id, names }: { id: string; names: string[] }): JSX.Element {
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

// How long does who draws in the studio wait? In Chromium or Firefox, over a real store: from opening to interactive,
// from the end of a line to the first preview that moves and to the full one, frames per second while one scrubs, and
// while one draws and a label runs; how soon a scene's layers follow its wind, how many of their frames are seen
// meanwhile, and what processor a frame takes: below 40 ms a core, 25 a second can be seen.
// Prints a table with the machine's load, and JSON with --json FILE.
// usage: FRESHET=... PAGE=... MODULES=... node bench/studio/browser_times.mjs STORE PICTURE MATTE CLASS [--times N]
// [--browser chromium|firefox] [--json FILE]
// (the environment as tests/studio/browser_test.sh sets it)
import { spawn } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { cpus, loadavg, tmpdir } from "node:os";
import { basename, join, resolve } from "node:path";

const { FRESHET, PAGE, MODULES } = process.env;
const { chromium, _bidiFirefox } = createRequire(join(MODULES, "x.js"))("playwright-core");
const words = process.argv.slice(2);
const option = (name, other) => (words.includes(name) ? words.splice(words.indexOf(name), 2)[1] : other);
const times = Number(option("--times", 20));
const browserName = option("--browser", "chromium");
const jsonFile = option("--json");
const [store, picture, matte, kind] = words;
const kPatience = 300000; // ms; a busy machine is slow, and no fault of the studio's

const folder = mkdtempSync(join(tmpdir(), "freshet_studio_bench_"));
const server = spawn(FRESHET, ["studio", resolve(store), "--folder", folder, "--page", PAGE, "--no-browser"], { stdio: ["ignore", "pipe", "inherit"] });
const url = await new Promise((done) => server.stdout.once("data", (data) => done(String(data).trim())));
const browser = await (browserName === "firefox"
  ? _bidiFirefox.launch({ executablePath: "/usr/bin/firefox-esr" })
  : chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox"] }));

const sorted = (values) => [...values].sort((a, b) => a - b);
const quantile = (values, share) => sorted(values)[Math.min(values.length - 1, Math.floor(share * values.length))];
const median = (values) => quantile(values, 0.5);

/** Of a process or a thread: its parent, and the seconds of user and system that it has taken. */
function taken(path) {
  const fields = readFileSync(path, "utf8").split(") ")[1].split(" ");
  return { parent: Number(fields[1]), seconds: (Number(fields[11]) + Number(fields[12])) / 100 };
}
const serverSeconds = () => taken(`/proc/${server.pid}/stat`).seconds;

/** What the server's threads have taken, each. */
function threadSeconds() {
  const folder = `/proc/${server.pid}/task`;
  return Object.fromEntries(readdirSync(folder).map((thread) => [thread, taken(`${folder}/${thread}/stat`).seconds]));
}

/** What the browser has taken: all processes that we or it began, but for the server. */
function browserSeconds() {
  const all = new Map();
  for (const id of readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
    try {
      all.set(Number(id), taken(`/proc/${id}/stat`));
    } catch {
      // it has ended
    }
  }
  const isOurs = (id) => id !== server.pid && (id === process.pid || (all.has(id) && isOurs(all.get(id).parent)));
  return [...all].filter(([id]) => id !== process.pid && isOurs(id)).reduce((sum, [, { seconds }]) => sum + seconds, 0);
}

const api = async (rest, init) => (await fetch(`${url}api/${rest}`, init)).json();
const { id } = await api(`projects?name=${basename(picture)}`, { method: "POST", body: readFileSync(picture) });
await fetch(`${url}api/projects/${id}/matte`, { method: "POST", body: readFileSync(matte) });
const { document, version, width, height } = await api(`projects/${id}`);
await api(`projects/${id}/document?base=${version}&page=bench`, { method: "PUT", body: JSON.stringify({ ...document, matte_base: "file", class: kind }) });

const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
page.setDefaultTimeout(kPatience);

/** Milliseconds of the page's clock until something holds there, looked at in every frame. */
const until = (holds, given) =>
  page.evaluate(
    ([source, argument]) =>
      new Promise((done, fail) => {
        const test = new Function("argument", `return (${source})(argument)`);
        const look = () => {
          try {
            if (test(argument)) done(performance.now());
            else requestAnimationFrame(look);
          } catch (fault) {
            fail(fault);
          }
        };
        look();
      }),
    [String(holds), given],
  );
const now = () => page.evaluate(() => performance.now());
const reel = () => page.evaluate(() => Number(globalThis.document.querySelector("[data-reel]").dataset.reel));

async function open() {
  await page.goto("about:blank");
  await page.goto(`${url}#/${id}`, { waitUntil: "commit" });
  return until(() => globalThis.document.querySelector(".canvas")?.dataset.view && globalThis.document.querySelector(".panel"));
}

async function settle() {
  await until(() => {
    const problem = globalThis.document.querySelector(".status.problem");
    if (problem) throw new Error(problem.textContent);
    return globalThis.document.querySelector("[data-state]")?.dataset.state === "full";
  });
}

/** A line beside the ones before, so that no labelling is known already. Returns when it ended, ms of the page. */
async function drawLine(i) {
  const view = await page.evaluate(() => JSON.parse(globalThis.document.querySelector(".canvas").dataset.view));
  const at = (x, y) => [view.x + (x / 640) * width * view.scale, view.y + (y / 480) * height * view.scale];
  const x = 200 + 9 * i;
  await page.mouse.move(...at(x, 150));
  await page.mouse.down();
  await page.mouse.move(...at(x + 4, 220), { steps: 4 });
  await page.mouse.move(...at(x, 300), { steps: 4 });
  const ended = await now();
  await page.mouse.up();
  return ended;
}

async function strokeTimes() {
  const found = { first: [], full: [], firstCpu: [], cpu: [], busiest: [], browser: [] };
  for (let i = 0; i < times; ++i) {
    const before = await reel();
    const [cpu, threads, page0] = [serverSeconds(), threadSeconds(), browserSeconds()];
    const started = performance.now();
    const ended = await drawLine(i);
    const first = await until((known) => Number(globalThis.document.querySelector("[data-reel]").dataset.reel) > known, before);
    const moves = await page.evaluate(() => globalThis.document.querySelector("[aria-label=Frame]").value);
    const moving = await until((frame) => globalThis.document.querySelector("[aria-label=Frame]").value !== frame, moves);
    found.firstCpu.push(serverSeconds() - cpu);
    await settle();
    found.first.push(Math.max(first, moving) - ended);
    found.full.push((await now()) - ended);
    found.cpu.push(serverSeconds() - cpu);
    const each = Object.entries(threadSeconds()).map(([thread, seconds]) => seconds - (threads[thread] ?? 0));
    found.busiest.push(Math.max(...each) / found.cpu.at(-1));
    found.browser.push((1000 * (browserSeconds() - page0)) / (performance.now() - started));
    await page.keyboard.press("Control+z");
    await settle();
  }
  return found;
}

/** Frames that the page draws, ms apart, while `work` goes on. */
async function frameTimes(work) {
  await page.evaluate(() => {
    globalThis.frameTimes = [];
    const note = (time) => {
      globalThis.frameTimes?.push(time);
      if (globalThis.frameTimes) requestAnimationFrame(note);
    };
    requestAnimationFrame(note);
  });
  await work();
  const at = await page.evaluate(() => {
    const { frameTimes } = globalThis;
    globalThis.frameTimes = null;
    return frameTimes;
  });
  return at.slice(1).map((time, i) => time - at[i]);
}

/** The play head is pulled along, a frame further whenever the one before has been drawn. */
async function scrubTimes() {
  return frameTimes(() =>
    page.evaluate(async () => {
      const head = globalThis.document.querySelector("[aria-label=Frame]");
      for (let i = 0; i < 200; ++i) {
        head.value = String(i % (Number(head.max) + 1));
        head.dispatchEvent(new Event("input", { bubbles: true }));
        await new Promise(requestAnimationFrame);
      }
    }),
  );
}

async function drawingTimes() {
  await drawLine(30); // its label runs while the next line is drawn
  const gaps = await frameTimes(async () => {
    await page.mouse.move(300, 300);
    await page.mouse.down();
    for (const end = Date.now() + 2500; Date.now() < end; )
      await page.mouse.move(300 + 200 * Math.random(), 300 + 200 * Math.random(), { steps: 8 });
  });
  await page.mouse.up();
  return gaps;
}

/** Clouds, water and what is left, under a wind that is pulled to and fro for five seconds. */
async function sceneTimes() {
  await settle(); // a document that the page keeps meanwhile would not take the layers
  const { document: kept, version: base, width: w, height: h } = await api(`projects/${id}`);
  const usual = { matte: "painted", paint: [], lines: [], plant: "tree", shimmer: 0, waves: 0, mirrors: false, roll: 1, drift: 0, class: "", clip: "" };
  const area = (top, bottom) => [{ points: [[0, top], [w, top], [w, bottom], [0, bottom]], width: 0, adds: true, area: true }];
  const layers = [
    { ...usual, name: "water", motion: "water", paint: area(0.7 * h, h), lines: [{ points: [[0, 0.65 * h], [w, 0.65 * h]], speed: null }] },
    { ...usual, name: "clouds", motion: "clouds", paint: area(0, 0.4 * h) },
    { ...usual, name: "rest", motion: "still", matte: "rest" },
  ];
  await api(`projects/${id}/document?base=${base}&page=bench`, { method: "PUT", body: JSON.stringify({ ...kept, scene: { ...kept.scene, layers } }) });
  await page.keyboard.press("8");
  const newer = (known) => until((argument) => Number(globalThis.document.querySelector("[data-reel]").dataset.reel) !== argument, known);
  await until(() => globalThis.document.querySelector("[data-state]").dataset.state === "layers");
  const slider = page.getByRole("slider", { name: "Wind", exact: true });
  const follow = [];
  for (let i = 0; i < 10; ++i) {
    const known = await reel();
    const started = await now();
    await slider.press(i % 2 ? "ArrowLeft" : "ArrowRight");
    follow.push((await newer(known)) - started);
    await until(() => globalThis.document.querySelector("[data-state]").dataset.state === "layers");
  }
  await page.evaluate(() => {
    globalThis.seenFrames = new Set();
    const draw = CanvasRenderingContext2D.prototype.drawImage;
    CanvasRenderingContext2D.prototype.drawImage = function (image, ...rest) {
      if (image instanceof ImageBitmap) globalThis.seenFrames.add(image);
      return draw.call(this, image, ...rest);
    };
  });
  const [serverBefore, browserBefore] = [serverSeconds(), browserSeconds()];
  const started = performance.now();
  const reels = new Set([await reel()]); // a film that goes on as it was follows nothing
  for (let i = 0; performance.now() - started < 5000; ++i) {
    await slider.press(i % 20 < 10 ? "ArrowLeft" : "ArrowRight");
    reels.add(await reel());
  }
  const seen = await page.evaluate(() => globalThis.seenFrames.size);
  const seconds = (performance.now() - started) / 1000;
  const [server, page0] = [serverSeconds() - serverBefore, browserSeconds() - browserBefore];
  return { follow, seen: seen / seconds, newer: (reels.size - 1) / seconds, server: (1000 * server) / seen, browser: (1000 * page0) / seen };
}

async function measure() {
  const opening = [];
  for (let i = 0; i < 5; ++i) opening.push(await open());
  await page.keyboard.press("2");
  await settle();
  await drawLine(29);
  await settle(); // warm
  return { opening, strokes: await strokeTimes(), scrub: await scrubTimes(), drawing: await drawingTimes(), scene: await sceneTimes() };
}

async function end() {
  await browser.close();
  server.kill("SIGINT");
  await new Promise((done) => server.once("exit", done));
  rmSync(folder, { recursive: true, force: true });
}

const load = loadavg();
const { opening, strokes, scrub, drawing, scene } = await measure().finally(end);
const rate = (gaps) => 1000 / (gaps.reduce((sum, gap) => sum + gap, 0) / gaps.length);
const result = {
  browser: browserName,
  processor: cpus()[0].model,
  cores: cpus().length,
  load: { before: load[0], after: loadavg()[0] },
  picture: basename(picture),
  opening_ms: median(opening),
  first_ms: median(strokes.first),
  first_ms_p90: quantile(strokes.first, 0.9),
  full_ms: median(strokes.full),
  full_ms_p90: quantile(strokes.full, 0.9),
  first_cpu_s: median(strokes.firstCpu),
  stroke_cpu_s: median(strokes.cpu),
  busiest_thread: median(strokes.busiest),
  browser_cores: median(strokes.browser),
  scrub_per_s: rate(scrub),
  drawing_per_s: rate(drawing),
  drawing_gap_ms_p95: quantile(drawing, 0.95),
  scene_ms: median(scene.follow),
  scene_per_s: scene.seen,
  scene_newer_per_s: scene.newer,
  scene_server_cpu_ms: scene.server,
  scene_browser_cpu_ms: scene.browser,
};
const row = (what, found, asked) => console.log(`${what.padEnd(44)} ${found.padStart(10)}   ${asked}`);
console.log(`${browserName}, ${result.cores} x ${result.processor}, load ${load[0].toFixed(1)} to ${result.load.after.toFixed(1)}; ${times} lines over ${result.picture}`);
row("opening to interactive", `${result.opening_ms.toFixed(0)} ms`, "1000 ms");
row("line to first preview that moves, median", `${result.first_ms.toFixed(0)} ms`, "1000 ms");
row("line to full preview, median", `${result.full_ms.toFixed(0)} ms`, "4000 ms");
row("CPU of the server till the first one moves", `${result.first_cpu_s.toFixed(2)} s`, "");
row("CPU of the server for a line", `${result.stroke_cpu_s.toFixed(2)} s`, "");
row("of it, by the busiest thread", `${(100 * result.busiest_thread).toFixed(0)} %`, "");
row("cores that the browser takes meanwhile", result.browser_cores.toFixed(2), "");
row("scrubbing", `${result.scrub_per_s.toFixed(0)}/s`, "24/s");
row("drawing while a label runs", `${result.drawing_per_s.toFixed(0)}/s`, "60/s");
row("a wind to the layers that it moves, median", `${result.scene_ms.toFixed(0)} ms`, "");
row("their frames seen while it is pulled", `${result.scene_per_s.toFixed(0)}/s`, "25/s");
row("newer layers meanwhile", `${result.scene_newer_per_s.toFixed(1)}/s`, "");
row("CPU of the server for a frame that is seen", `${result.scene_server_cpu_ms.toFixed(0)} ms`, "");
row("of the browser", `${result.scene_browser_cpu_ms.toFixed(0)} ms`, "");
if (jsonFile) writeFileSync(jsonFile, `${JSON.stringify(result, null, 2)}\n`);

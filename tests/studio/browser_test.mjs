// The studio in a real browser, from a picture to its animation. Environment: FRESHET (the executable), PAGE (the built
// page), MODULES (node_modules of its build); BROWSER, chromium or firefox [chromium]; FRESHET_BROWSERS, which fifth of
// the walks Firefox takes beside the first one, 0 to 4, or all [drawn]; SHOTS, a folder that is given screenshots of
// every page, if it is set.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { createHash } from "node:crypto";
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { after, before, test as nodeTest } from "node:test";

const { FRESHET, PAGE, MODULES, SHOTS, BROWSER = "chromium" } = process.env;
const require = createRequire(join(MODULES, "x.js"));
const { chromium, _bidiFirefox } = require("playwright-core"); // Debian's Firefox, not a patched one
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
const kToken = "0123456789abcdef0123456789abcdef";

const folder = mkdtempSync(join(tmpdir(), "freshet_studio_"));
const at = (...parts) => join(folder, ...parts);
const kBrowsers = {
  chromium: () => chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox"] }),
  firefox: () => _bidiFirefox.launch({ executablePath: "/usr/bin/firefox-esr" }),
};
let server, url, browser;

function freshet(...words) {
  const answer = spawnSync(FRESHET, words, { cwd: folder, encoding: "utf8" });
  assert.equal(answer.status, 0, answer.stderr);
  return answer;
}

/** Starts the server; on the same port and with the same token as the one before, as a person's page expects. */
async function serve(port = 0, ...given) {
  server = spawn(FRESHET, ["studio", ...given, "--folder", at("room"), "--page", PAGE, "--no-browser", "--no-starter", "--port", String(port)], {
    cwd: folder,
    env: { ...process.env, FRESHET_STUDIO_TOKEN: kToken },
    stdio: ["ignore", "pipe", "inherit"],
  });
  const line = await new Promise((resolve, reject) => {
    server.stdout.once("data", (data) => resolve(String(data).trim()));
    server.once("exit", () => reject(new Error("the server ended")));
  });
  return line;
}

function end(signal = "SIGINT") {
  return new Promise((resolve) => {
    server.once("exit", resolve);
    server.kill(signal);
  });
}

before(async () => {
  // A clip whose name is a page's source: it must be shown as text.
  const odd = "<img src=x onerror=window.broken=1>.mkv";
  mkdirSync(at("clips/fall"), { recursive: true });
  for (const seed of ["1", "2"])
    freshet("synth", "simulate", "waterfall", "--size", "192x144", "--frames", "40", "--seed", seed, "-o", `clips/fall/${seed}.mkv`);
  freshet("synth", "simulate", "waterfall", "--size", "320x200", "--frames", "1", "--seed", "12", "-o", "still.png");
  copyFileSync(at("clips/fall/2.mkv"), at("clips/fall", odd));
  rmSync(at("clips/fall/2.mkv"));
  freshet("ingest", "demo.freshet", "clips");
  url = await serve(0, "demo.freshet");
  browser = await kBrowsers[BROWSER]();
});

after(async () => {
  await browser?.close();
  if (server) await end();
  rmSync(folder, { recursive: true, force: true });
});

/** What a page shows, waits for and was refused: what a walk that failed is understood by. */
async function tellOf(page) {
  const seen = await page
    .evaluate(() => [...document.querySelectorAll("dialog[open], [role=status], [role=alert], .notice")].map((each) => each.innerText))
    .catch((fault) => [String(fault)]);
  const waiting = [...page.unanswered].map(([request, since]) => `${request.method()} ${request.url()} for ${Date.now() - since} ms`);
  console.error(JSON.stringify({ at: page.url(), seen, waiting, refused: page.refused, faults: page.faults }, null, 1));
}

const kFifth = process.env.FRESHET_BROWSERS || String(Math.floor(5 * Math.random()));
let walks = 0;

/** Why this run leaves a walk out; false: it does not. The first makes the project that others open. */
function leftOut() {
  const number = walks++;
  if (BROWSER === "chromium" || kFifth === "all" || number === 0 || number % 5 === Number(kFifth)) return false;
  return `Firefox takes fifth ${kFifth} of the walks; FRESHET_BROWSERS=all: all`;
}

/** A test, which says what its pages show where it fails, and leaves none open. */
function test(name, walk) {
  nodeTest(name, { skip: leftOut() }, async (context) => {
    try {
      await walk(context);
    } catch (fault) {
      for (const each of browser?.contexts() ?? []) await Promise.all(each.pages().map(tellOf));
      throw fault;
    } finally {
      await Promise.all((browser?.contexts() ?? []).map((each) => each.close()));
    }
  });
}

/** A page that fails its test for any error of its own, and for any request that leaves this machine. */
async function open(address, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  page.unanswered = new Map();
  page.on("request", (request) => page.unanswered.set(request, Date.now()));
  for (const end of ["requestfinished", "requestfailed"]) page.on(end, (request) => page.unanswered.delete(request));
  page.refused = [];
  page.on("requestfailed", (request) => page.refused.push(`${request.method()} ${request.url()}: ${request.failure()?.errorText}`));
  page.on("response", (response) => response.ok() || page.refused.push(`${response.request().method()} ${response.url()}: ${response.status()}`));
  page.setDefaultTimeout(120000); // a busy machine is no fault
  page.faults = [];
  page.on("pageerror", (error) => page.faults.push(error.message));
  page.on("request", (request) => {
    const { hostname, protocol } = new URL(request.url());
    if (!["blob:", "data:"].includes(protocol) && hostname !== "127.0.0.1") page.faults.push(`asked ${request.url()}`);
  });
  await page.goto(address);
  return page;
}

async function shot(page, name) {
  if (SHOTS) await page.screenshot({ path: join(SHOTS, `${name}.png`) });
}

async function expectAccessible(page, where) {
  await page.evaluate(axe);
  const found = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  const serious = found.violations.filter(({ impact }) => impact === "serious" || impact === "critical");
  assert.deepEqual(
    serious.map(({ id, nodes }) => `${where}: ${id}: ${nodes.map(({ html, failureSummary }) => html.slice(0, 160) + " " + failureSummary).join("; ")}`),
    [],
  );
}

/** Tab goes through all that can be used, in the page's order and back, and what it stands on is seen. */
async function expectKeyboard(page, where) {
  const count = await page.evaluate(() => {
    const usable = (each) => !each.disabled && each.tabIndex >= 0 && each.checkVisibility({ visibilityProperty: true });
    globalThis.stops = [...globalThis.document.querySelectorAll("a[href], button, input, select, summary, textarea, [tabindex]")].filter(usable);
    globalThis.stops[0].focus();
    return globalThis.stops.length;
  });
  const at = () =>
    page.evaluate(() => {
      const each = globalThis.document.activeElement;
      const shown = each.matches(".unseen") ? each.closest("label") : each;
      return { stop: globalThis.stops.indexOf(each), seen: getComputedStyle(shown).outlineStyle !== "none", is: each.outerHTML.slice(0, 120) };
    });
  const scrolls = () => page.evaluate(() => !globalThis.stops.includes(globalThis.document.activeElement) && /auto/.test(getComputedStyle(globalThis.document.activeElement).overflow));
  const tab = async (key) => {
    do await page.keyboard.press(key);
    while (BROWSER === "firefox" && (await scrolls())); // where Firefox stops, too
  };
  for (let stop = 1; stop < count; ++stop) {
    await tab("Tab");
    const now = await at();
    assert.equal(now.stop, stop, `${where}: Tab came to ${now.is}`);
    assert.ok(now.seen, `${where}: it is not seen that ${now.is} has the focus`);
  }
  await tab("Shift+Tab");
  assert.equal((await at()).stop, count - 2, where);
}

/** The middle of the picture as it is shown, and its size on the screen. */
async function shown(page) {
  return page.evaluate(() => {
    const box = document.querySelector(".canvas").getBoundingClientRect();
    const { x, y, scale } = JSON.parse(document.querySelector(".canvas").dataset.view);
    return { left: box.left + x, top: box.top + y, scale };
  });
}

/** Goes where only what is behind # differs. Firefox's protocol never tells of a load there, for which goto waits. */
async function goWithin(page, address) {
  if (BROWSER === "chromium") return page.goto(address);
  await page.evaluate((there) => globalThis.location.assign(there), address);
}

/** Chooses a folder of files. */
async function chooseFolder(page, selector, folder) {
  if (BROWSER === "chromium") return page.setInputFiles(selector, folder);
  // Firefox's protocol gives no folders: the page is given what the browser would have made of it.
  const files = readdirSync(folder).map((name) => ({ path: `${basename(folder)}/${name}`, base64: readFileSync(join(folder, name), "base64") }));
  await page.locator(selector).evaluate((input, given) => {
    const chosen = new DataTransfer();
    for (const { path, base64 } of given) {
      const file = new File([Uint8Array.from(atob(base64), (each) => each.charCodeAt(0))], path.split("/").at(-1));
      Object.defineProperty(file, "webkitRelativePath", { value: path });
      chosen.items.add(file);
    }
    input.files = chosen.files;
    input.dispatchEvent(new Event("change", { bubbles: true }));
  }, files);
}

/** The bytes that a link saves. */
async function saved(page, link) {
  // Firefox does not tell where they are.
  if (BROWSER !== "chromium") return Buffer.from(await (await fetch(new URL(await link.getAttribute("href"), page.url()))).arrayBuffer());
  const [download] = await Promise.all([page.waitForEvent("download"), link.click()]);
  return readFileSync(await download.path());
}

/** Chromium takes a pen and a hand by its own protocol. Firefox's has none: there the page is sent their events. */
const sendPointers = (page, events) =>
  page.evaluate((all) => {
    for (const [name, clientX, clientY, rest] of all) {
      const at = globalThis.document.elementFromPoint(clientX, clientY);
      at.dispatchEvent(new PointerEvent(name, { bubbles: true, cancelable: true, clientX, clientY, ...rest }));
    }
  }, events);
const kPenEvents = { mousePressed: "pointerdown", mouseMoved: "pointermove", mouseReleased: "pointerup" };
const kHandEvents = { touchStart: "pointerdown", touchMove: "pointermove", touchEnd: "pointerup" };

/** How a pen is put down, moved and lifted: by type, place on the page, and pressure. */
async function penAt(page) {
  const devtools = BROWSER === "chromium" && (await page.context().newCDPSession(page));
  return async (type, x, y, force) => {
    const buttons = type === "mouseReleased" ? 0 : 1;
    if (devtools) return devtools.send("Input.dispatchMouseEvent", { type, x, y, force, pointerType: "pen", button: "left", buttons, clickCount: 1 });
    await sendPointers(page, [[kPenEvents[type], x, y, { pointerType: "pen", pointerId: 7, pressure: buttons && force, button: type === "mouseMoved" ? -1 : 0, buttons }]]);
  };
}

/** How fingers are put down, moved and lifted: by type and places. */
async function handAt(page) {
  if (BROWSER === "chromium") {
    const devtools = await page.context().newCDPSession(page);
    return (type, touchPoints) => devtools.send("Input.dispatchTouchEvent", { type, touchPoints });
  }
  let down = [];
  return async (type, points) => {
    // A pen hovers there, however long the page took for the last event.
    const event = ({ x, y, id }) => [kHandEvents[type], x, y, { pointerType: "touch", pointerId: 20 + id, button: type === "touchMove" ? -1 : 0, buttons: type === "touchEnd" ? 0 : 1 }];
    const at = type === "touchEnd" ? down : points;
    await sendPointers(page, at.flatMap((each) => [["pointermove", each.x, each.y, { pointerType: "pen", pointerId: 8 }], event(each)]));
    down = points;
  };
}

async function drag(page, points) {
  const { left, top, scale } = await shown(page);
  const places = points.map(([x, y]) => [left + x * scale, top + y * scale]);
  await page.mouse.move(...places[0]);
  await page.mouse.down();
  for (const place of places.slice(1)) await page.mouse.move(...place, { steps: 5 });
  await page.mouse.up();
}

const api = async (rest, init) => fetch(`${url.split("#")[0]}api/${rest}`, init);
const document = async (id) => (await (await api(`projects/${id}`)).json()).document;

/** Waits for what is true a little later. */
async function until(holds, patience = 120000) {
  for (const end = Date.now() + patience; Date.now() < end; await new Promise((resolve) => setTimeout(resolve, 50)))
    if (await holds()) return;
  assert.fail(`it never came: ${holds}`);
}

/** Until the full preview of all that was drawn is there. */
async function settled(page, timeout = 240000) {
  await page.waitForFunction(
    () => globalThis.document.querySelector("[data-state]")?.dataset.state === "full",
    null,
    { timeout },
  );
}

/** Waits until the canvas keeps its place and size. */
async function still(page) {
  for (let before = null, now = await shown(page); JSON.stringify(before) !== JSON.stringify(now); ) {
    await page.waitForTimeout(200);
    [before, now] = [now, await shown(page)];
  }
}

test("a picture becomes an animation in nine clicks, and its export is the command line's", async () => {
  const page = await open(url);
  await page.getByText("Drop a picture").waitFor();
  await page.setInputFiles("input[type=file][accept^='image']", at("still.png")); // 1: choose a picture
  await page.locator(".bar").waitFor();
  // Shorter than usual: this project's frames are made in most walks that follow.
  await page.keyboard.press("3");
  await page.getByLabel("Length").fill("1.5");
  await until(async () => (await document("still")).frames === 38);
  await page.keyboard.press("1");
  await drag(page, [[160, 30], [165, 100], [160, 170]]); // 2: scribble on the fluid
  await page.locator(".panel .figure", { hasText: "%" }).waitFor({ timeout: 30000 });
  await shot(page, "fluid-wide");
  await page.getByRole("button", { name: "Flow", exact: true }).click(); // 3
  await drag(page, [[150, 40], [150, 160]]); // 4: a line
  await drag(page, [[180, 40], [185, 160]]); // 5: another one
  await settled(page);
  await shot(page, "flow-wide");

  // Change one line's speed, and take it back.
  await page.getByRole("switch", { name: "As fast as its clips" }).click();
  await page.getByRole("slider", { name: "Speed" }).press("End");
  await until(async () => (await document("still")).strokes[1].speed === 1000);
  await page.keyboard.press("Control+z");
  await until(async () => (await document("still")).strokes[1].speed < 1000);
  await page.keyboard.press("Control+z");
  await until(async () => (await document("still")).strokes[1].speed === null);

  // Ask why, and take another patch.
  await settled(page);
  await page.getByRole("button", { name: "Why", exact: true }).click();
  const { left, top, scale } = await shown(page);
  await page.mouse.click(left + 160 * scale, top + 100 * scale);
  const others = page.locator(".candidate[aria-pressed=false]");
  await others.nth(2).click({ timeout: 20000 });
  await page.getByRole("button", { name: "Let go" }).waitFor({ timeout: 30000 });
  await settled(page);
  await page.getByRole("radio", { name: "How sure" }).click();
  await shot(page, "why-wide");
  assert.equal((await document("still")).pins.length, 1);
  await page.keyboard.press("Control+z");
  await until(async () => (await document("still")).pins.length === 0);
  await page.keyboard.press("Control+Shift+z");
  await until(async () => (await document("still")).pins.length === 1);
  await settled(page);

  await page.getByRole("button", { name: "Export" }).click(); // 6
  await page.getByText("Lossless").click(); // 7
  await shot(page, "export-wide");
  await page.getByRole("button", { name: "Make it" }).click(); // 8
  const save = page.getByRole("link", { name: "Save" });
  await save.waitFor();
  const line = await page.locator(".command code").textContent();
  assert.match(line, /freshet synth animate --config project\.toml -o exports\/still\.mkv/);
  const bytes = await saved(page, save); // 9
  const project = at("room/projects/still");
  const again = spawnSync(FRESHET, ["synth", "animate", "--config", "project.toml", "-o", at("again.mkv")], { cwd: project, encoding: "utf8" });
  assert.equal(again.status, 0, again.stderr);
  const hash = (data) => createHash("sha256").update(data).digest("hex");
  assert.equal(hash(bytes), hash(readFileSync(at("again.mkv"))));
  assert.deepEqual(page.faults, []);
});

test("nothing is lost by a reload, nor by the end of the server", async () => {
  const page = await open(`${url}#/still`);
  await page.locator(".bar").waitFor();
  await page.keyboard.press("2");
  await drag(page, [[120, 50], [120, 150]]);
  await until(async () => (await document("still")).strokes.length === 3);
  const drawn = await document("still");
  await page.reload();
  await page.locator(".bar").waitFor();
  assert.deepEqual(await document("still"), drawn);

  await page.keyboard.press("2");
  await drag(page, [[200, 50], [200, 150]]);
  await page.waitForTimeout(900); // a second is what may be lost
  await end("SIGKILL");
  await page.getByText("server is away").waitFor();
  await drag(page, [[220, 50], [220, 150]]); // drawn on while it is away
  await serve(Number(new URL(url).port), "demo.freshet");
  await page.getByText("server is away").waitFor({ state: "detached", timeout: 120000 });
  await until(async () => (await document("still")).strokes.length === 5);
  assert.deepEqual(page.faults, []);
});

test("a project's folder and a store are dropped, and are here", async () => {
  const page = await open(url);
  await page.getByText("Drop a picture").waitFor();
  const copy = at("copied fall");
  mkdirSync(copy);
  for (const name of ["picture.png", "document.json"]) copyFileSync(at("room/projects/still", name), join(copy, name));
  await chooseFolder(page, "input[aria-label=\"Open a project's folder\"]", copy);
  await page.locator(".bar").waitFor();
  const id = decodeURIComponent(new URL(page.url()).hash.slice(2));
  assert.equal(id, "copied-fall");
  const [here, there] = [await document(id), await document("still")];
  assert.deepEqual(here, there);
  // A second time it is opened, not written over.
  await page.keyboard.press("2");
  await drag(page, [[100, 50], [100, 150]]);
  await until(async () => (await document(id)).strokes.length === here.strokes.length + 1);
  await page.getByRole("button", { name: "All projects" }).click();
  await chooseFolder(page, "input[aria-label=\"Open a project's folder\"]", copy);
  await page.getByText("is here already").waitFor();
  assert.equal((await document(id)).strokes.length, here.strokes.length + 1);
  await page.getByRole("button", { name: "All projects" }).click();
  await page.getByText("Drop a picture").waitFor();

  copyFileSync(at("demo.freshet"), at("given.freshet"));
  await page.setInputFiles("input[aria-label='Choose a picture']", at("given.freshet"));
  await page.getByRole("heading", { name: "given" }).waitFor();
  writeFileSync(at("none.freshet"), "no store");
  await page.setInputFiles("input[aria-label='Choose a picture']", at("none.freshet"));
  await page.getByText("it is no store that can be opened").waitFor();
  assert.deepEqual(page.faults, []);
  await api(`projects/${id}`, { method: "DELETE" });
});

test("steps back live over a reload", async () => {
  const page = await open(`${url}#/still`);
  await page.locator(".bar").waitFor();
  const drawn = await document("still");
  await page.keyboard.press("2");
  // Beside the lines that lie there already: a drag that begins on one of them moves it.
  for (const x of [40, 60, 80]) await drag(page, [[x, 60], [x, 150]]);
  const undo = page.getByRole("button", { name: "Undo" });
  await undo.click();
  await page.reload(); // at once: nothing waits for a timer
  await page.locator(".bar").waitFor();
  await until(async () => (await document("still")).strokes.length === drawn.strokes.length + 2);
  await page.getByRole("button", { name: "Redo" }).click();
  await until(async () => (await document("still")).strokes.length === drawn.strokes.length + 3);
  for (let left = 2; left >= 0; --left) {
    await undo.click();
    await until(async () => (await document("still")).strokes.length === drawn.strokes.length + left);
  }
  assert.deepEqual(await document("still"), drawn);
  assert.deepEqual(page.faults, []);
});

test("a pen's pressure, an area's corners, a painted pace and a brushed direction", async () => {
  const page = await open(`${url}#/still`);
  await page.locator(".bar").waitFor();
  const before = await document("still");
  await page.keyboard.press("1");
  await page.keyboard.press("p");
  const { left, top, scale } = await shown(page);
  const pen = await penAt(page);
  const press = (type, x, y, force) => pen(type, left + x * scale, top + y * scale, force);
  await press("mousePressed", 60, 60, 0.05);
  for (let i = 1; i <= 20; ++i) await press("mouseMoved", 60 + 4 * i, 60, i / 20);
  await shot(page, "pen");
  await press("mouseReleased", 140, 60, 1);
  await until(async () => (await document("still")).paint.length > before.paint.length);
  const runs = (await document("still")).paint.slice(before.paint.length);
  const widths = runs.map(({ width }) => width);
  assert.ok(runs.length > 4, `${widths}`);
  assert.ok(widths.every((width, i) => i === 0 || width > widths[i - 1]) && widths.at(-1) > 2 * widths[0], `${widths}`);
  runs.forEach(({ points }, i) => assert.deepEqual(points[0], i === 0 ? points[0] : runs[i - 1].points.at(-1)));
  await page.keyboard.press("Control+z"); // one stroke of the pen is one step
  await until(async () => (await document("still")).paint.length === before.paint.length);

  await page.keyboard.press("a");
  const click = (x, y) => page.mouse.click(left + x * scale, top + y * scale);
  for (const [x, y] of [[60, 60], [90, 60], [90, 90], [60, 90]]) await click(x, y);
  await shot(page, "corners");
  await click(60, 60);
  await until(async () => (await document("still")).paint.length === before.paint.length + 1);
  const area = (await document("still")).paint.at(-1);
  assert.ok(area.area && area.adds && area.points.length === 4, JSON.stringify(area));
  await page.keyboard.press("Control+z");

  await page.keyboard.press("2");
  await page.getByRole("radio", { name: "Pace" }).click();
  await drag(page, [[160, 20], [160, 180]]);
  await until(async () => (await document("still")).tempo.length === 1);
  assert.equal((await document("still")).tempo[0].factor, 2);
  await settled(page);
  await shot(page, "pace-wide");
  assert.match(readFileSync(at("room/projects/still/project.toml"), "utf8"), /retiming-map = "tempo.png"/);
  await page.keyboard.press("Control+z");
  await until(async () => (await document("still")).tempo.length === 0);

  await page.getByRole("radio", { name: "Brush" }).click();
  const lines = () => readFileSync(at("room/projects/still/strokes.svg"), "utf8").match(/<polyline/g).length;
  const drawn = lines();
  await drag(page, [[230, 40], [300, 60]]);
  await until(async () => (await document("still")).directions.length === 1);
  assert.equal(lines(), drawn + 5);
  await settled(page);
  await shot(page, "brush-wide");
  await page.keyboard.down("Alt");
  await drag(page, [[265, 20], [265, 90]]);
  await page.keyboard.up("Alt");
  await until(async () => (await document("still")).directions.length === 2);
  assert.equal(lines(), drawn + 10); // cut in two
  for (const left of [1, 0]) {
    await page.keyboard.press("Control+z");
    await until(async () => (await document("still")).directions.length === left);
  }
  assert.deepEqual(page.faults, []);
});

test("a sequence of some frames is a folder", async () => {
  const page = await open(`${url}#/still`);
  await page.locator(".bar").waitFor();
  await page.getByRole("button", { name: "Export" }).click();
  await page.getByText("PNG sequence").click();
  await page.getByText("Size, frames and depth").click();
  await page.getByLabel("Width").fill("160");
  await page.getByText("160 × 100 px").waitFor();
  await page.getByLabel("From frame").fill("1003");
  await page.getByLabel("To frame").fill("1004");
  await page.getByLabel("First number").fill("1001");
  await page.getByRole("combobox", { name: "Bits" }).selectOption("16");
  await page.getByRole("button", { name: "Make it" }).click();
  await page.getByText("2 pictures").waitFor();
  await shot(page, "sequence-wide");
  const line = await page.locator(".command code").textContent();
  assert.match(line, /-o 'exports\/still\/still.####.png' --depth=16 --range=1003-1004 --width=160 --start-number=1001/);
  assert.ok(readFileSync(at("room/projects/still/exports/still/still.1004.png")).length > 1000);
  const header = readFileSync(at("room/projects/still/exports/still/still.1004.png")).subarray(16, 24);
  assert.deepEqual([header.readUInt32BE(0), header.readUInt32BE(4)], [160, 100]);
  assert.deepEqual(page.faults, []);
});

test("settings are tried side by side, in step, and one of them is taken", async () => {
  const page = await open(`${url}#/still`);
  await page.locator(".bar").waitFor();
  const before = await document("still");
  await page.keyboard.press("3");
  await page.getByRole("combobox", { name: "What varies" }).selectOption({ label: "Speed" });
  await page.getByRole("textbox", { name: "Times as fast" }).fill("0.5, 2, 99");
  await page.getByRole("textbox", { name: "Times as fast" }).press("Enter");
  await until(async () => (await document("still")).sweep.axes[0]?.values.join() === "0.5,2");
  await page.getByRole("combobox", { name: "And" }).selectOption({ label: "Outline" });
  await page.getByRole("button", { name: "Try them" }).click();
  await page.getByRole("button", { name: "Look at 4" }).click();
  const films = page.locator(".swept video");
  await until(async () => (await films.count()) === 4);
  const times = () => films.evaluateAll((all) => all.map((film) => film.currentTime));
  await until(async () => (await times()).every((time) => time > 0.2));
  await until(async () => {
    const now = await times();
    return Math.max(...now) - Math.min(...now) < 0.12;
  });
  await page.getByRole("slider", { name: "Time of all" }).fill("0.5");
  await until(async () => {
    const now = await times();
    return now[0] > 0.5 && now.every((time) => Math.abs(time - now[0]) < 0.01);
  });
  await expectAccessible(page, "sweep");
  await shot(page, "sweep-wide");
  await page.getByRole("button", { name: "Take 2 × as fast, outline moves" }).click();
  await until(async () => (await document("still")).speed === 2);
  assert.ok((await document("still")).moving_outline);
  const project = at("room/projects/still");
  const film = readFileSync(join(project, "ways/sweep/04.mp4"));
  const line = await page.locator(".command code", { hasText: "synth sweep" }).textContent();
  const again = spawnSync("sh", ["-c", line.replace(/^freshet/, FRESHET)], { cwd: project, encoding: "utf8" });
  assert.equal(again.status, 0, again.stderr);
  assert.ok(film.equals(readFileSync(join(project, "ways/sweep/04.mp4"))));

  // Its outline moves now: where it was and will be can be seen.
  await settled(page);
  const answer = page.waitForResponse(/reels\/\d+\/outlines/);
  await page.getByRole("button", { name: /Outlines before/ }).click();
  const outlines = await (await answer).json();
  assert.equal(outlines.length, (await document("still")).frames);
  assert.ok(outlines.every((lines) => lines.length > 0 && lines.every((points) => points.length >= 6)));
  await until(async () =>
    page.evaluate(() => {
      const over = globalThis.document.querySelectorAll(".stage canvas")[1];
      return over.getContext("2d").getImageData(0, 0, over.width, over.height).data.some((each, i) => i % 4 === 3 && each > 0);
    }),
  );
  await shot(page, "onion-wide");
  while (JSON.stringify((await document("still")).sweep) !== JSON.stringify(before.sweep)) {
    await page.keyboard.press("Control+z");
    await page.waitForTimeout(200);
  }
  assert.equal((await document("still")).speed, before.speed);
  assert.deepEqual(page.faults, []);
});

test("a motion is drawn, simulated and given a clip's look; the command lines make it again", async () => {
  const page = await open(`${url}#/still`);
  await page.locator(".bar").waitFor();
  await page.keyboard.press("5");
  await page.getByRole("radio", { name: "Fire" }).click();
  await drag(page, [[120, 180], [200, 180]]);
  await page.getByRole("button", { name: "Obstacle" }).click();
  await drag(page, [[150, 120], [170, 115]]);
  await page.getByRole("button", { name: "Wind" }).click();
  await drag(page, [[60, 60], [110, 55]]);
  await page.getByLabel("Length").fill("0.4");
  await until(async () => (await document("still")).design.frames === 10);
  const { design } = await document("still");
  assert.deepEqual([design.fluid, design.sources.map(({ adds }) => adds), design.winds.length], ["fire", [true, false], 1]);
  await page.getByRole("button", { name: "Make it" }).click();
  const film = page.locator("video.film");
  await film.waitFor();
  await page.waitForFunction(() => globalThis.document.querySelector("video.film").currentTime > 0.1);
  await shot(page, "design-motion");
  // It lies over the picture, and the transport has it.
  assert.equal(await film.evaluate((video) => getComputedStyle(video).mixBlendMode), "screen");
  await page.getByRole("button", { name: "Pause", exact: true }).click();
  assert.ok(await film.evaluate((video) => video.paused));
  await page.getByRole("slider", { name: "Frame" }).fill("0.5");
  await until(async () => Math.abs((await film.evaluate((video) => video.currentTime / video.duration)) - 0.5) < 0.1);
  await page.keyboard.press("c");
  assert.match(await film.evaluate((video) => video.style.clipPath), /50%/);
  await page.keyboard.press("c");
  await page.keyboard.press("Space");
  await until(async () => !(await film.evaluate((video) => video.paused)));
  const project = at("room/projects/still");
  const filmed = join(project, "ways/design/film.mp4");
  await page.getByRole("combobox", { name: "Clip" }).selectOption("fall/1.mkv");
  await page.getByRole("button", { name: "Make it" }).click();
  const lines = page.locator(".command code");
  await until(async () => (await lines.count()) === 2);
  // By its film, not by *Stop*: it may be made before that is seen.
  await until(async () => existsSync(filmed));
  await page.getByRole("button", { name: "Make it" }).waitFor();
  await film.waitFor();
  await page.waitForFunction(() => globalThis.document.querySelector("video.film").currentTime > 0.1);
  await shot(page, "design-look");
  const made = readFileSync(filmed);
  for (const line of await lines.allTextContents()) {
    const again = spawnSync("sh", ["-c", line.replace(/^freshet/, FRESHET)], { cwd: project, encoding: "utf8" });
    assert.equal(again.status, 0, again.stderr);
  }
  assert.ok(made.equals(readFileSync(filmed)));
  // It becomes a layer over the picture, which plays at once.
  await page.getByRole("button", { name: "Lay it over the picture" }).click();
  await page.getByRole("slider", { name: "Begins after" }).fill("0.4");
  assert.equal(await page.getByRole("combobox", { name: "Over what lies behind it" }).inputValue(), "screen");
  await until(async () => (await document("still")).scene.layers[0]?.start === 0.4);
  const { film: source, blend } = (await document("still")).scene.layers[0];
  assert.deepEqual([source, blend], ["design", "screen"]);
  const live = join(project, "ways/live/scene.toml");
  await until(async () => existsSync(live) && /blend = "screen"\nfile = .*\nat = .*\nwidth = \d+\nstart = 0.4\n/.test(readFileSync(live, "utf8")));
  await page.getByRole("button", { name: "Pause", exact: true }).waitFor();
  await shot(page, "design-layer");
  await page.getByRole("button", { name: "Remove this layer" }).click();
  await until(async () => (await document("still")).scene.layers.length === 0);
  assert.deepEqual(page.faults, []);
});

test("stills become a moving scene, an order is refused, and the command line makes it again", async () => {
  mkdirSync(at("stills"));
  const stills = ["1", "2", "3", "4", "5", "6", "7", "8"].map((seed) => {
    freshet("synth", "simulate", "fire", "--size", "160x120", "--frames", "1", "--seed", seed, "-o", `stills/${seed}.png`);
    return at(`stills/${seed}.png`);
  });
  const page = await open(url);
  await page.getByText("Drop a picture").waitFor();
  await page.setInputFiles("input[type=file][accept^='image']", stills);
  await page.getByRole("button", { name: "Remove all of them" }).waitFor();
  const id = decodeURIComponent(new URL(page.url()).hash.slice(2));
  await page.getByLabel("Length").fill("1");
  await until(async () => (await document(id)).stills.seconds === 1);
  const film = page.locator("video.film");
  const make = async () => {
    const before = (await film.count()) && (await film.getAttribute("src"));
    await page.getByRole("button", { name: "Make it" }).click();
    await page.waitForFunction((known) => ![known, null].includes(globalThis.document.querySelector("video.film")?.getAttribute("src")), before);
    await page.getByRole("button", { name: "Make it" }).waitFor();
    await page.waitForFunction(() => globalThis.document.querySelector("video.film").currentTime > 0.1);
  };
  await make();
  await page.locator(".sheet").scrollIntoViewIfNeeded();
  await shot(page, "stills-found");
  const refuse = page.getByRole("button", { name: /path 1: not at all/ }).first();
  const names = async () => (await page.locator(".region .paths .stills").first().getAttribute("aria-label")).split(", ");
  const first = await names();
  await refuse.click();
  await page.getByText("not walked").waitFor();
  await until(async () => (await document(id)).stills.paths.length === 1);
  await make();
  await page.waitForFunction((known) => globalThis.document.querySelector(".region .paths .stills").getAttribute("aria-label") !== known, first.join(", "));
  await expectAccessible(page, "stills");
  await shot(page, "stills-changed");
  const folder = at("room/projects", id);
  const made = readFileSync(join(folder, "ways/stills/film.mp4"));
  const line = await page.locator(".command code").textContent();
  const again = spawnSync("sh", ["-c", line.replace(/^freshet/, FRESHET)], { cwd: folder, encoding: "utf8" });
  assert.equal(again.status, 0, again.stderr);
  assert.ok(made.equals(readFileSync(join(folder, "ways/stills/film.mp4"))));
  // What leaps is pinned: pressed in the one still and let go in the other, or clicked in both. The film follows.
  const pins = async () => (await document(id)).stills.pins;
  const near = (point, x, y) => assert.ok(Math.hypot(point[0] - x, point[1] - y) < 0.7, `${point} is not ${[x, y]}`);
  const click = async (x, y) => {
    const { left, top, scale } = await shown(page);
    await page.mouse.click(left + x * scale, top + y * scale);
  };
  const pair = page.getByRole("group", { name: "Two stills" }).getByRole("button").first();
  const two = (await pair.getAttribute("aria-label")).split(" and ");
  await pair.click();
  await page.getByText("Press on a point").waitFor();
  await film.waitFor({ state: "hidden" });
  await still(page);
  const view = await page.locator(".canvas").getAttribute("data-view");
  await drag(page, [[80, 70], [84, 68], [90, 66]]);
  await until(async () => (await pins()).length === 1);
  await page.getByRole("radio", { name: two[1] }).click();
  await click(60, 80);
  await page.getByText("Where is the same point").waitFor();
  await click(63, 78);
  await until(async () => (await pins()).length === 2);
  assert.equal(await page.locator(".canvas").getAttribute("data-view"), view); // looked at as closely
  const set = await pins();
  assert.deepEqual(set.map(({ from, to, reach }) => [from, to, reach]), [[...two, 13], [...two.toReversed(), 13]]);
  [[80, 70], [90, 66], [60, 80], [63, 78]].forEach((place, i) => near(set[i >> 1].points[i % 2], ...place));
  await shot(page, "stills-pinned");
  await expectAccessible(page, "stills-pinned");
  await page.keyboard.press("Delete");
  await until(async () => (await pins()).length === 1);
  await page.keyboard.press("Control+z");
  await until(async () => (await pins()).length === 2);
  await page.getByRole("button", { name: "Take pin 2 out" }).click();
  await until(async () => (await pins()).length === 1);
  await page.getByRole("button", { name: /^1: / }).click();
  await page.getByRole("slider", { name: "Reach" }).press("End");
  await until(async () => (await pins())[0].reach === 160);
  await page.keyboard.press("Control+z");
  await until(async () => (await pins())[0].reach === 13);
  await drag(page, [[90, 66], [89, 68], [88, 70]]); // its end, on the still that is shown
  await until(async () => (await pins())[0].points[1][1] > 69);
  near((await pins())[0].points[0], 80, 70);
  await page.getByRole("button", { name: "Make it" }).click();
  await until(async () => (await pair.getAttribute("aria-pressed")) === "false"); // the new film is looked at
  await page.waitForFunction(() => globalThis.document.querySelector("video.film")?.currentTime > 0.1);
  const pinned = readFileSync(join(folder, "ways/stills/film.mp4"));
  assert.ok(!pinned.equals(made));
  const [[pinAt, pinGoes]] = (await pins()).map(({ points }) => points.map((point) => `[${point.map((each) => (each - 0.5).toFixed(2)).join(", ")}]`));
  const edits = readFileSync(join(folder, "ways/stills/edits.toml"), "utf8");
  assert.ok(edits.endsWith(`[[pin]]\nfrom = "${two[0]}"\nto = "${two[1]}"\nat = ${pinAt}\ngoes = ${pinGoes}\nreach = 13\n`), edits);
  assert.equal(spawnSync("sh", ["-c", line.replace(/^freshet/, FRESHET)], { cwd: folder }).status, 0);
  assert.ok(pinned.equals(readFileSync(join(folder, "ways/stills/film.mp4"))));
  await shot(page, "stills-pinned-film");
  // It becomes a layer over the picture: placed, begun later, and seen where it is painted.
  await page.getByRole("button", { name: "Lay it over the picture" }).click();
  const layer = async () => (await document(id)).scene.layers[0];
  await until(async () => (await layer())?.film === "stills");
  assert.equal(await page.getByRole("combobox", { name: "Film", exact: true }).inputValue(), "stills");
  await drag(page, [[30, 20], [130, 95]]);
  await until(async () => (await layer()).lines.length === 1);
  await page.getByRole("slider", { name: "Begins after" }).fill("0.2");
  await page.getByRole("button", { name: "Area" }).click();
  await drag(page, [[20, 10], [85, 10], [85, 110], [20, 110]]);
  await until(async () => (await layer()).paint.length === 1);
  // Paint goes where the film goes: moved by its middle, and laid anew, half as wide.
  const places = ({ paint, lines }) => [lines[0].points, paint[0].points].map((points) => points.flat().map((each) => Math.round(each)));
  await until(async () => (await layer()).lines[0].points[1][0] > 0);
  const [[left, top], paint] = places(await layer());
  await page.getByRole("group", { name: "Drawing tools" }).getByRole("button", { name: "Line", exact: true }).click();
  await drag(page, [[80, 57.5], [84, 60], [90, 62.5]]);
  await until(async () => places(await layer())[0][0] === left + 10);
  assert.deepEqual(places(await layer())[1], paint.map((each, i) => each + (i % 2 ? 5 : 10)));
  await drag(page, [[5, 5], [30, 20], [55, 42.5]]);
  await until(async () => places(await layer())[0][0] === 5);
  places(await layer())[1].forEach((each, i) => assert.ok(Math.abs(each - (5 + (paint[i] - (i % 2 ? top : left)) / 2)) <= 1));
  // From a column of a pixel to almost all of the picture: a brush as wide as that would be is held to what a document
  // can hold, and the film is laid.
  await drag(page, [[12, 12], [12.5, 50], [13, 90]]);
  await until(async () => places(await layer())[0][2] === 13);
  await page.getByRole("group", { name: "Drawing tools" }).getByRole("button", { name: "Paint", exact: true }).click();
  await page.getByRole("slider", { name: "Brush", exact: true }).press("End");
  await drag(page, [[60, 40], [80, 60], [90, 50]]);
  await until(async () => (await layer()).paint.length === 2);
  await page.getByRole("group", { name: "Drawing tools" }).getByRole("button", { name: "Line", exact: true }).click();
  await drag(page, [[40, 10], [80, 60], [155, 110]]);
  await until(async () => places(await layer())[0][2] === 155);
  assert.equal((await layer()).paint[1].width, (await (await api("home")).json()).widest);
  for (let i = 0; i < 5; ++i) await page.keyboard.press("Control+z");
  await until(async () => places(await layer())[0][0] === left);
  assert.deepEqual(places(await layer())[1], paint);
  await page.getByLabel("Length").fill("0.8");
  await until(async () => (await document(id)).scene.frames === 20);
  await shot(page, "stills-layer-drawn");
  const live = join(folder, "ways/live/scene.toml");
  await until(async () => existsSync(live) && /file = "\.\.\/stills\/film\.mp4"\n.*\n.*\nstart = 0.2\n.*\n.*\nmatte = "layer-1\.png"\n/.test(readFileSync(live, "utf8")));
  await page.getByRole("button", { name: "Make it" }).click();
  await page.getByRole("img", { name: /The layers, their lines/ }).waitFor();
  await page.waitForFunction(() => globalThis.document.querySelector("video.film")?.currentTime > 0.1);
  await shot(page, "stills-layer");
  await expectAccessible(page, "stills-layer");
  const laid = readFileSync(join(folder, "ways/scene/film.mp4"));
  const scene = spawnSync("sh", ["-c", (await page.locator(".command code").textContent()).replace(/^freshet/, FRESHET)], { cwd: folder, encoding: "utf8" });
  assert.equal(scene.status, 0, scene.stderr);
  assert.ok(laid.equals(readFileSync(join(folder, "ways/scene/film.mp4"))));
  await page.keyboard.press("6");
  await page.getByRole("button", { name: "Remove all of them" }).click();
  await page.getByRole("button", { name: "Remove all of them" }).waitFor({ state: "detached" });
  assert.ok(await page.getByRole("button", { name: "Make it" }).isDisabled());
  await page.getByRole("switch", { name: "Seamless loop" }).click();
  await page.keyboard.press("2"); // keys go on after a switch
  await page.getByRole("button", { name: "Flow", pressed: true }).waitFor();
  assert.deepEqual(page.faults, []);
});

test("a clip's lines are found, one is moved, and it goes on without an end; the command line makes it again", async () => {
  const page = await open(`${url}#/still`);
  await page.locator(".bar").waitFor();
  await page.keyboard.press("7");
  const clips = page.getByRole("combobox", { name: "Clip", exact: true });
  await clips.selectOption({ label: "fall/1.mkv" });
  await page.getByRole("button", { name: "Find lines" }).click();
  await page.getByRole("button", { name: "Find lines" }).waitFor();
  await page.locator(".section", { hasText: "Flow lines" }).locator(".figure", { hasText: /^\d+$/ }).waitFor();
  await shot(page, "flowlines-found");
  // A line of one's own: a copy of the nearest one, beside copies of all.
  await drag(page, [[60, 20], [50, 120]]);
  await until(async () => (await document("still")).flowlines.edited.length > 1);
  const drawn = (await document("still")).flowlines;
  assert.equal(drawn.edited.length, drawn.lines.length + 1);
  assert.match(drawn.edited.at(-1).id, /^l\d+-2$/);
  await page.getByRole("slider", { name: "Pace" }).press("End");
  await until(async () => (await document("still")).flowlines.edited.at(-1).speeds[0] > 3.5);
  await page.keyboard.press("Control+z");
  await until(async () => (await document("still")).flowlines.edited.at(-1).speeds.length === 0);
  await page.keyboard.press("Delete");
  await until(async () => (await document("still")).flowlines.edited.length === drawn.lines.length);
  // One of those that are there is chosen, and dragged.
  const [first] = (await document("still")).flowlines.edited;
  const middle = [0, 1].map((axis) => (first.points[0][axis] + first.points[1][axis]) / 2);
  await drag(page, [middle, middle]);
  await page.getByRole("heading", { name: `Line ${first.id}` }).waitFor();
  await drag(page, [middle, [middle[0] + 9, middle[1]], [middle[0] + 12, middle[1]]]);
  await until(async () => Math.abs((await document("still")).flowlines.edited[0].points[0][0] - first.points[0][0]) > 8);
  // It moves in time: where it lies half a second later is dragged too.
  await page.getByRole("button", { name: "Moves in time…" }).click();
  await until(async () => (await document("still")).flowlines.edited[0].later.length === 1);
  await page.getByRole("slider", { name: "At" }).fill("0.6");
  await until(async () => (await document("still")).flowlines.edited[0].later[0].time === 0.6);
  const now = (await document("still")).flowlines.edited[0];
  const lies = [0, 1].map((axis) => (now.points[0][axis] + now.points[1][axis]) / 2);
  await drag(page, [lies, [lies[0] + 6, lies[1]], [lies[0] + 14, lies[1]]]);
  await until(async () => Math.abs((await document("still")).flowlines.edited[0].later[0].points[0][0] - now.points[0][0]) > 8);
  assert.deepEqual((await document("still")).flowlines.edited[0].points, now.points);
  await page.getByRole("slider", { name: "Length" }).press("Home");
  await until(async () => (await document("still")).flowlines.frames === 25);
  await page.getByRole("button", { name: "Make it" }).click();
  await page.getByRole("link", { name: "Save" }).waitFor();
  await page.waitForFunction(() => globalThis.document.querySelector("video.film")?.currentTime > 0.1);
  await expectAccessible(page, "flowlines");
  await shot(page, "flowlines-moved");
  const project = at("room/projects/still");
  const made = readFileSync(join(project, "ways/flowlines/film.mp4"));
  const line = await page.locator(".command code", { hasText: "film.mp4" }).textContent();
  assert.match(line, /synth flowlines .*--edited ways\/flowlines\/edited.svg/);
  const again = spawnSync("sh", ["-c", line.replace(/^freshet/, FRESHET)], { cwd: project, encoding: "utf8" });
  assert.equal(again.status, 0, again.stderr);
  assert.ok(made.equals(readFileSync(join(project, "ways/flowlines/film.mp4"))));
  // A long one is stopped in the middle.
  await page.getByRole("slider", { name: "Length" }).press("End");
  await until(async () => (await document("still")).flowlines.frames > 2000);
  await page.getByRole("button", { name: "Make it" }).click();
  await page.getByRole("button", { name: "Stop", exact: true }).click();
  await page.getByRole("button", { name: "Make it" }).waitFor();
  assert.deepEqual(page.faults, []);
});

test("a clip that is dropped becomes a project of its own", async () => {
  const page = await open(url);
  await page.getByRole("button", { name: "Add clips" }).click();
  await page.setInputFiles("input[aria-label='Choose clips']", at("clips/fall/1.mkv"));
  await page.getByRole("button", { name: "Make it endless" }).click();
  await page.getByRole("button", { name: "Find lines" }).waitFor();
  const id = decodeURIComponent(new URL(page.url()).hash.slice(2));
  assert.deepEqual((await document(id)).flowlines.clip, "1.mkv");
  await page.getByRole("button", { name: "Find lines" }).click();
  await page.locator(".section", { hasText: "Flow lines" }).locator(".figure", { hasText: /^\d+$/ }).waitFor();
  assert.deepEqual(page.faults, []);
  await api(`projects/${id}`, { method: "DELETE" });
});

test("layers of every kind are painted, one wind moves them, and the command line makes the same film", async () => {
  const page = await open(`${url}#/still`);
  await page.locator(".bar").waitFor();
  await page.keyboard.press("8");
  const tool = (name) => page.getByRole("group", { name: "Drawing tools" }).getByRole("button", { name, exact: true }).click();
  const made = async () => (await document("still")).scene.layers;
  const add = async (kind, area, line) => {
    const before = (await made()).length;
    await page.getByRole("combobox", { name: "Add a layer" }).selectOption({ label: kind });
    await until(async () => (await made()).length === before + 1);
    if (!area) return page.getByRole("radio", { name: "The rest" }).click();
    await tool("Area");
    const [left, top, right, bottom] = area;
    await drag(page, [[left, top], [right, top], [right, bottom], [left, bottom]]);
    await until(async () => (await made())[0].paint.length === 1);
    if (!line) return;
    await tool("Line");
    await drag(page, line);
    await until(async () => (await made())[0].lines.length === 1);
  };
  await add("Stands still");
  await add("Clouds", [5, 5, 315, 60]);
  await page.getByLabel("Shadows on the ground").fill("0.4");
  await until(async () => (await made())[0].shade === 0.4);
  await add("Water", [5, 100, 315, 195], [[10, 95], [310, 95]]);
  await page.getByLabel("Lights what is around it").fill("2");
  await page.getByLabel("Half as bright after").fill("30");
  await until(async () => (await made())[0].glow === 2 && (await made())[0].glow_reach === 30);
  await add("Boat", [200, 110, 250, 130], [[204, 128], [246, 128]]);
  await page.getByRole("switch", { name: "In three dimensions" }).click();
  await until(async () => (await made())[0].in_3d);
  await shot(page, "scene-boat");
  await add("Tree or plant", [20, 40, 70, 150], [[45, 148], [45, 50]]);
  // A plant of a film: where it stands is drawn on the film's picture, in its px.
  await page.getByRole("combobox", { name: "Sways as in" }).selectOption({ index: 1 });
  const plants = page.getByRole("img", { name: "The film's plant" });
  await until(async () => (await plants.locator("svg").getAttribute("viewBox")) !== "0 0 0 0");
  await plants.scrollIntoViewIfNeeded();
  const [{ x, y, width, height }, [, , wide, high]] = [await plants.boundingBox(), (await plants.locator("svg").getAttribute("viewBox")).split(" ").map(Number)];
  await page.mouse.move(x + width / 2, y + height - 10);
  await page.mouse.down();
  await page.mouse.move(x + width / 2, y + height / 4, { steps: 3 });
  await page.mouse.up();
  await until(async () => (await made())[0].sway_lines.length === 1);
  const [root, tip] = (await made())[0].sway_lines[0].points;
  assert.ok(Math.abs(root[0] - wide / 2) < 1 && Math.abs(tip[1] - high / 4) < 1 && root[1] > tip[1], `${root} ${tip}`);
  await shot(page, "scene-sway");
  await page.getByRole("combobox", { name: "Sways as in" }).selectOption({ index: 0 });
  await until(async () => (await made())[0].sway_clip === "");
  await add("Fluid of the store", [130, 70, 180, 180], [[155, 80], [155, 170]]);
  await page.getByLabel("Lights what is around it").fill("0.2");
  await until(async () => (await made())[0].glow === 0.2);
  await page.getByRole("combobox", { name: "Add a layer" }).selectOption({ label: "Film" });
  await page.setInputFiles("input[aria-label=\"Choose a clip's file\"]", at("clips/fall/1.mkv"));
  await until(async () => (await made())[0].clip === "1.mkv");
  await drag(page, [[260, 20], [310, 60]]);
  await until(async () => (await made())[0].lines.length === 1);
  // Mattes that move with it, in place of paint.
  await page.setInputFiles("input[aria-label=\"Choose a matte's file\"]", at("clips/fall/1.mkv"));
  await until(async () => (await made())[0].matte_clip === "1.mkv");
  assert.equal(await page.getByRole("combobox", { name: "Seen" }).inputValue(), "1.mkv");
  assert.equal(await page.getByRole("group", { name: "Drawing tools" }).getByRole("button", { name: "Paint" }).count(), 0);
  await page.getByRole("button", { name: "fluid Fluid of the store" }).click();
  await tool("Erase");
  await drag(page, [[135, 75], [135, 90]]);
  await until(async () => (await made())[1].paint.length === 2);
  await page.keyboard.press("Control+z");
  await until(async () => (await made())[1].paint.length === 1);
  // Scribbled, it is found while one draws.
  const found = page.waitForResponse(/layers\/1\/matte/);
  await page.getByRole("radio", { name: "Scribbled" }).click();
  assert.equal((await found).status(), 200);
  await shot(page, "scene-scribbled");
  await page.keyboard.press("Control+z");
  await until(async () => (await made())[1].matte === "painted");
  await page.getByRole("textbox", { name: "Name" }).fill('the "fall"');
  await page.getByRole("textbox", { name: "Name" }).press("Enter");
  await until(async () => (await made())[1].name === "the fall");
  await page.getByRole("button", { name: "Further" }).click();
  await until(async () => (await made())[2].name === "the fall");
  await page.getByLabel("Length").fill("0.4");
  await until(async () => (await document("still")).scene.frames === 10);
  await page.getByRole("button", { name: "Make it" }).click();
  await page.getByRole("img", { name: /The layers, their lines/ }).waitFor();
  await page.waitForFunction(() => globalThis.document.querySelector("video.film")?.currentTime > 0.1);
  await expectAccessible(page, "scene");
  await shot(page, "scene-made");
  await page.getByRole("switch", { name: "Show what is drawn" }).click();
  await shot(page, "scene-film");
  const project = at("room/projects/still");
  const film = readFileSync(join(project, "ways/scene/film.mp4"));
  const line = await page.locator(".command code").textContent();
  const again = spawnSync("sh", ["-c", line.replace(/^freshet/, FRESHET)], { cwd: project, encoding: "utf8" });
  assert.equal(again.status, 0, again.stderr);
  assert.ok(film.equals(readFileSync(join(project, "ways/scene/film.mp4"))));
  // Export makes what is on the screen: this film, not the animation.
  await page.getByRole("button", { name: "Export" }).click();
  const dialog = page.getByRole("dialog", { name: /Scene/ });
  await dialog.getByText("Lossless").click();
  await dialog.getByLabel("Name").fill("harbour");
  await dialog.getByRole("button", { name: "Make it" }).click();
  const exported = await saved(page, dialog.getByRole("listitem").filter({ hasText: "harbour.mkv" }).getByRole("link", { name: "Save" }));
  assert.match(await dialog.locator(".command code").textContent(), /freshet synth scene .* -o exports\/harbour\.mkv/);
  assert.ok(exported.equals(readFileSync(join(project, "exports/harbour.mkv"))));
  await page.keyboard.press("Escape");
  // What is missing is said.
  await page.getByRole("button", { name: "Clear lines" }).click();
  await page.getByRole("button", { name: "Clear paint" }).click();
  await until(async () => (await made())[2].paint.length === 0);
  await page.getByRole("button", { name: "Make it" }).click();
  await page.getByText("Paint where it is").waitFor();
  assert.deepEqual(page.faults, []);
});

test("layers move while the wind is changed, from the frame that is on the screen", async () => {
  const opened = await api("projects?name=live.png", { method: "POST", body: readFileSync(at("still.png")) });
  const { id } = await opened.json();
  const page = await open(`${url}#/${id}`);
  await page.locator(".bar").waitFor();
  await page.keyboard.press("8");
  await page.getByRole("combobox", { name: "Add a layer" }).selectOption({ label: "Stands still" });
  await page.getByRole("radio", { name: "The rest" }).click();
  await page.getByRole("combobox", { name: "Add a layer" }).selectOption({ label: "Clouds" });
  await page.getByRole("group", { name: "Drawing tools" }).getByRole("button", { name: "Area", exact: true }).click();
  await drag(page, [[5, 5], [315, 5], [315, 120], [5, 120]]);
  const reel = async () => Number(await page.locator(".transport").getAttribute("data-reel"));
  const shows = (state) => page.locator(`.transport[data-state="${state}"]`).waitFor();
  await shows("layers");
  const first = await reel();
  // Pulled without a pause, it is followed: newer layers come before the slider is let go. They go on where the last
  // ones were: the film runs no faster than it plays.
  const slider = page.getByRole("slider", { name: "Wind", exact: true });
  const scrub = page.getByRole("slider", { name: "Frame" });
  const frame = async () => Math.round(99 * Number(await scrub.inputValue()));
  await until(async () => (await frame()) > 0);
  await slider.focus();
  const seen = new Set();
  // From a frame that has just come: a page that was busy shows an old one, and then catches up.
  const old = await frame();
  await until(async () => (await frame()) !== old);
  const began = Date.now();
  let [shownNow, ran, looked] = [await frame(), 0, began];
  while (seen.size < 5 && Date.now() < began + 12000) {
    await page.keyboard.press((await slider.inputValue()) === (await slider.getAttribute("max")) ? "Home" : "ArrowRight");
    seen.add(await reel());
    const now = await frame();
    ran += ((now - shownNow + 150) % 100) - 50;
    [shownNow, looked] = [now, Date.now()];
  }
  assert.ok(seen.size >= 3 && [...seen].every((number) => number >= first), `${[...seen]}`);
  assert.ok(ran <= ((looked - began) * 25) / 1000 + 8, `${ran} frames in ${looked - began} ms`);
  await shows("layers");
  const stood = await scrub.inputValue();
  await until(async () => (await scrub.inputValue()) !== stood);
  // The wind becomes another by the loop's middle, and is back at its end.
  await page.getByRole("switch", { name: "The weather changes" }).click();
  await page.getByRole("slider", { name: "By the middle" }).fill("17");
  const weather = at(`room/projects/${id}/ways/live/scene.toml`);
  await until(async () => /\[\[wind.at\]\]\ntime = 2\nspeed = 17\n\[\[wind.at\]\]\ntime = 4\n/.test(readFileSync(weather, "utf8")));
  await shows("layers");
  await page.getByRole("switch", { name: "Show what is drawn" }).click();
  await shot(page, "scene-live");
  await page.getByRole("switch", { name: "Show what is drawn" }).click();
  // What is wrong is said, and goes when it is put right.
  await page.getByRole("combobox", { name: "Add a layer" }).selectOption({ label: "Tree or plant" });
  await drag(page, [[20, 130], [60, 130], [60, 190], [20, 190]]);
  await page.getByRole("group", { name: "Drawing tools" }).getByRole("button", { name: "Line", exact: true }).click();
  await drag(page, [[250, 190], [250, 140]]);
  await page.locator(".problem", { hasText: "outside" }).waitFor();
  await page.keyboard.press("Control+z");
  await page.locator(".problem", { hasText: "outside" }).waitFor({ state: "detached" });
  assert.deepEqual(page.faults, []);
  await api(`projects/${id}`, { method: "DELETE" });
});

test("a quiet page has no faults; it says that it saved, zooms by small steps, and plays on after it was moved", async () => {
  const opened = await api("projects?name=quiet.png", { method: "POST", body: readFileSync(at("still.png")) });
  const { id } = await opened.json();
  const page = await open(url);
  page.on("response", (response) => response.status() >= 400 && page.faults.push(`${response.status()} ${response.url()}`));
  page.on("console", (message) => message.type() === "error" && page.faults.push(message.text()));
  // A picture that is slow to come is said to come, and seen small meanwhile.
  await page.route(/picture\?longest/, async (route) => {
    await new Promise((resolve) => setTimeout(resolve, 4000));
    await route.continue();
  });
  await goWithin(page, `${url}#/${id}`);
  await page.getByText("Opening the picture").waitFor({ timeout: 3900 });
  await page.getByText("Opening the picture").waitFor({ state: "detached" });
  for (const name of ["Fluid", "Flow", "Look", "Why", "Design", "Stills", "Flow lines", "Scene"]) {
    const modes = page.locator(".modes");
    await modes.getByRole("button", { name, exact: true }).click();
    await modes.getByRole("button", { name, exact: true, pressed: true }).waitFor();
    await page.waitForTimeout(150);
  }
  assert.deepEqual(page.faults, []);

  await page.keyboard.press("1");
  await drag(page, [[160, 30], [165, 100], [160, 170]]);
  await page.locator(".saved", { hasText: "Saved" }).waitFor();
  await settled(page);

  const before = (await shown(page)).scale;
  await page.mouse.move(600, 400);
  await page.keyboard.down("Control");
  await page.mouse.wheel(0, -120); // a notch
  await page.keyboard.up("Control");
  await until(async () => (await shown(page)).scale > before);
  assert.ok((await shown(page)).scale < 1.3 * before);

  const play = page.getByRole("button", { name: "Play", exact: true });
  const pause = page.getByRole("button", { name: "Pause", exact: true });
  if (await play.isVisible()) await play.click();
  await pause.waitFor();
  for (const clicks of [false, true]) {
    if (clicks) {
      // The button that was clicked has the focus.
      await pause.click();
      await play.click();
    }
    const { left } = await shown(page);
    await page.mouse.move(600, 400);
    await page.keyboard.down("Space");
    await page.mouse.down();
    await page.mouse.move(640, 400, { steps: 2 });
    await page.mouse.up();
    await page.keyboard.up("Space");
    assert.ok((await shown(page)).left > left + 30, "it was moved");
    await page.waitForTimeout(100);
    assert.ok(await pause.isVisible(), "it plays on");
  }
  await page.keyboard.press("Space");
  await play.waitFor();
  await page.keyboard.press("?");
  await page.getByRole("dialog", { name: "Keys" }).getByText("Compare with the picture").waitFor();
  await expectAccessible(page, "keys");
  await page.keyboard.press("Escape");
  assert.deepEqual(page.faults, []);
});

test("three doors: an example moves at once, is guessed, told how fast, and another take of it is taken", async () => {
  const page = await open(url);
  await page.waitForFunction(() => globalThis.document.querySelector(".door img")?.naturalWidth > 0); // it moves by itself
  await page.getByRole("button", { name: "Try this one" }).click();
  await page.locator(".bar").waitFor();
  const id = "bay-in-the-evening";
  await settled(page);
  const begun = await document(id);
  assert.deepEqual([begun.matte_base, begun.strokes.length], ["file", 5]);
  await page.keyboard.press("1");
  await page.getByText("guessed").waitFor(); // of the store's one kind
  await page.getByRole("group", { name: "Kind of fluid" }).getByRole("button", { name: "fall" }).click();
  await until(async () => (await document(id)).class === "fall");
  assert.equal(begun.speed, 0);
  await page.getByRole("button", { name: "auto", pressed: true }).waitFor();
  await page.getByRole("button", { name: "fast" }).click();
  await until(async () => (await document(id)).speed !== begun.speed);
  await page.getByRole("button", { name: "fast", pressed: true }).waitFor();
  await settled(page);

  await page.keyboard.press("t");
  const others = page.getByRole("button", { name: /^Take it/ });
  await others.first().waitFor();
  await expectAccessible(page, "takes");
  await shot(page, "takes-wide");
  const { takes, marked } = await (await api(`projects/${id}/takes`)).json();
  assert.ok(takes.length >= 3 && takes.every(({ faults }) => faults >= 0), JSON.stringify(takes));
  assert.equal(await page.getByRole("switch", { name: "Mark where" }).count(), marked ? 1 : 0);
  const before = await document(id);
  const slower = takes.findIndex(({ name }) => name === "half as fast");
  await others.nth(slower - 1).click();
  await until(async () => JSON.stringify((await document(id)).strokes) !== JSON.stringify(before.strokes));
  assert.equal((await document(id)).strokes[0].speed, before.strokes[0].speed / 2);
  await page.keyboard.press("Control+z");
  await until(async () => JSON.stringify((await document(id)).strokes) === JSON.stringify(before.strokes));
  await page.keyboard.press("t");
  await others.first().waitFor({ state: "hidden" }); // the canvas grows into the strip's place
  await still(page);

  // What looks as if it stood is found, and held all at once, or left.
  await page.keyboard.press("h");
  const outlines = await (await api(`projects/${id}/standing`)).json();
  assert.ok(outlines.length > 0 && outlines.every((each) => each.length >= 6), JSON.stringify(outlines));
  await page.getByRole("button", { name: "Find what stands" }).click();
  const all = page.getByRole("button", { name: /^Hold (it|all)/ });
  await all.waitFor();
  await shot(page, "standing-offered");
  await all.click();
  await until(async () => (await document(id)).held.length === outlines.length);
  await page.keyboard.press("Control+z");
  await until(async () => (await document(id)).held.length === 0);

  // A click holds what lies there. More takes more of it in its place; another click lets go of it.
  await page.keyboard.press("h");
  await drag(page, [[100, 136], [100, 136]]);
  await until(async () => (await document(id)).held.length > 0);
  const { held } = await document(id);
  assert.ok(held.every((each) => each.area && each.adds && each.points.length > 2), JSON.stringify(held));
  await page.getByRole("button", { name: "More" }).click();
  const sum = (points) => Math.abs(points.reduce((all, [x, y], i) => { const [bx, by] = points.at(i - 1); return all + (bx * y - x * by) / 2; }, 0));
  await until(async () => sum((await document(id)).held[0].points) > 1.5 * sum(held[0].points));
  await shot(page, "held-by-a-click");
  await drag(page, [[100, 136], [100, 136]]);
  await until(async () => (await document(id)).held.some((each) => !each.adds));
  assert.deepEqual(page.faults, []);
  await api(`projects/${id}`, { method: "DELETE" });
});

test("a clip and stills of the store, and a dropped clip's frame, are begun with at the doors", async () => {
  const page = await open(url);
  await page.getByRole("button", { name: "Try this clip" }).click();
  await page.getByRole("button", { name: "Find lines" }).waitFor();
  const looped = decodeURIComponent(new URL(page.url()).hash.slice(2));
  assert.match((await document(looped)).flowlines.clip, /^fall\//);
  await page.getByRole("button", { name: "All projects" }).click();
  await page.getByRole("button", { name: "Try these stills" }).click();
  await page.getByRole("button", { name: "Remove all of them" }).waitFor();
  const filmed = decodeURIComponent(new URL(page.url()).hash.slice(2));
  assert.equal((await (await api(`projects/${filmed}/stills`)).json()).length, 12);
  await page.getByRole("button", { name: "All projects" }).click();
  await page.getByRole("button", { name: "Add clips" }).click();
  copyFileSync(at("clips/fall/1.mkv"), at("dropped.mkv"));
  await page.setInputFiles("input[aria-label='Choose clips']", at("dropped.mkv"));
  await page.getByRole("button", { name: "Animate its first frame" }).click();
  await page.getByText("Scribble on what flows").first().waitFor();
  const framed = decodeURIComponent(new URL(page.url()).hash.slice(2));
  assert.equal((await document(framed)).flowlines.clip, "");
  assert.deepEqual(page.faults, []);
  for (const id of new Set([looped, filmed, framed])) await api(`projects/${id}`, { method: "DELETE" });
});

test("projects are renamed, duplicated and found; the page can be installed", async () => {
  for (const name of ["one", "two", "three", "four", "five", "six"]) await api(`projects?name=${name}.png`, { method: "POST", body: readFileSync(at("still.png")) });
  const page = await open(url);
  const card = (name) => page.locator(".card", { has: page.getByRole("link", { name: new RegExp(`^${name} `) }) });
  await card("six").hover();
  await page.getByRole("button", { name: "Rename six" }).click();
  await page.getByRole("dialog", { name: "Rename" }).getByLabel("Name").fill("The Fall, again");
  await page.keyboard.press("Enter");
  await card("the-fall-again").waitFor();
  await page.getByRole("button", { name: "Duplicate the-fall-again" }).click();
  await card("the-fall-again-2").waitFor();
  await page.getByLabel("Find a project by name").fill("the fall");
  await until(async () => (await page.locator(".cards:not(.clips) .card").count()) === 2);
  let broken = 0; // connections; what only asks is asked again
  await page.route(/projects\/the-fall-again-2$/, (route) => (broken++ < 2 ? route.abort("connectionreset") : route.continue()));
  await page.getByRole("link", { name: /^the-fall-again-2/ }).click();
  await page.locator(".bar").waitFor();
  assert.equal(broken, 3);
  await page.getByRole("button", { name: "the-fall-again-2" }).click();
  await page.getByRole("dialog", { name: "Rename" }).getByLabel("Name").fill("one");
  await page.keyboard.press("Enter");
  await page.getByText("another project has this name").waitFor();

  const manifest = await page.evaluate(async () => (await fetch(globalThis.document.querySelector("link[rel=manifest]").href)).json());
  assert.equal(manifest.display, "standalone");
  for (const { src, sizes } of manifest.icons.filter(({ type }) => type === "image/png"))
    assert.equal(await page.evaluate(async (address) => (await createImageBitmap(await (await fetch(address)).blob())).width, src), Number(sizes.split("x")[0]));
  assert.deepEqual(page.faults, []);
  for (const id of ["one", "two", "three", "four", "five", "the-fall-again", "the-fall-again-2"]) await api(`projects/${id}`, { method: "DELETE" });
});

test("a hand beside the pen draws nothing", async () => {
  const page = await open(`${url}#/still`, { hasTouch: BROWSER === "chromium" });
  await page.locator(".bar").waitFor();
  await page.keyboard.press("1");
  await page.keyboard.press("p");
  const before = (await document("still")).paint.length;
  const { left, top, scale } = await shown(page);
  const [penOn, handOn] = [await penAt(page), await handAt(page)];
  const pen = (type, x, y) => penOn(type, left + x * scale, top + y * scale, 0.5);
  const hand = (type, points) => handOn(type, points.map(([x, y], id) => ({ x: left + x * scale, y: top + y * scale, id })));
  const view = await page.locator(".canvas").getAttribute("data-view");
  await pen("mousePressed", 60, 60);
  await hand("touchStart", [[200, 150], [240, 170]]);
  await hand("touchMove", [[190, 140], [250, 180]]);
  for (let i = 1; i <= 10; ++i) await pen("mouseMoved", 60 + 5 * i, 60);
  await hand("touchEnd", []);
  await pen("mouseReleased", 110, 60);
  if (BROWSER === "firefox") {
    await hand("touchStart", [[150, 120]]);
    await hand("touchMove", [[190, 150]]);
    await hand("touchEnd", []);
  }
  await until(async () => (await document("still")).paint.length > before);
  await page.waitForTimeout(300);
  const drawn = (await document("still")).paint.slice(before).flatMap(({ points }) => points);
  assert.ok(drawn.every(([, y]) => Math.abs(y - 60) < 2), JSON.stringify(drawn));
  assert.equal(await page.locator(".canvas").getAttribute("data-view"), view); // neither moved nor zoomed
  await page.keyboard.press("Control+z");
  await until(async () => (await document("still")).paint.length === before);
  assert.deepEqual(page.faults, []);
});

/** A picture of 24 Mpix without anything to install: a BMP of stripes, blue above and green below. */
function writeLarge(path, width = 6000, height = 4000) {
  const head = Buffer.alloc(54);
  head.write("BM");
  head.writeUInt32LE(54 + 3 * width * height, 2);
  head.writeUInt32LE(54, 10);
  head.writeUInt32LE(40, 14);
  head.writeInt32LE(width, 18);
  head.writeInt32LE(-height, 22);
  head.writeUInt16LE(1, 26);
  head.writeUInt16LE(24, 28);
  const rows = [[210, 90, 40], [60, 140, 30]].map(([blue, green, red]) => {
    const row = Buffer.alloc(3 * width);
    for (let x = 0; x < width; ++x) row.set(x % 2 ? [blue, green, red] : [255, 255, 255], 3 * x);
    return row;
  });
  writeFileSync(path, Buffer.concat([head, ...Array.from({ length: height }, (_, y) => rows[y < height / 2 ? 0 : 1])]));
}

test("a picture of 24 Mpix is drawn on, panned, and seen pixel by pixel", async () => {
  writeLarge(at("large.bmp"));
  const page = await open(url);
  await page.setInputFiles("input[type=file][accept^='image']", at("large.bmp"));
  await page.locator(".bar").waitFor();
  await page.locator(".canvas[data-view]").waitFor();
  const offer = page.getByRole("dialog", { name: "24 megapixels" });
  await offer.getByText("3840 × 2560").waitFor();
  await offer.getByRole("button", { name: "Work at 3840 px" }).click();
  await page.waitForURL(/large-3840/);
  await page.locator(".canvas[data-view]").waitFor();
  await page.goBack();
  await page.locator(".canvas[data-view]").waitFor();
  await offer.getByRole("button", { name: "Keep all pixels" }).click();
  await drag(page, [[1000, 300], [5000, 300]]);
  await page.locator(".panel .figure", { hasText: "%" }).waitFor();
  const { left, top, scale } = await shown(page);
  await page.mouse.move(left + 3000 * scale, top + 2000 * scale);
  for (let i = 0; i < 12; ++i) await page.mouse.wheel(0, -400);
  await until(async () => Number((await page.locator(".canvas").getAttribute("data-detail"))?.split(" ")[2]) < 1000);
  await page.waitForTimeout(300);
  await shot(page, "large-close");
  await page.evaluate(() => {
    globalThis.drawn = 0;
    const note = () => requestAnimationFrame(note, (globalThis.drawn += 1));
    note();
  });
  await page.keyboard.down("Space");
  await page.mouse.move(600, 400);
  await page.mouse.down();
  for (let i = 0; i < 20; ++i) await page.mouse.move(600 - 10 * i, 400 - 5 * i, { steps: 2 });
  await page.mouse.up();
  await page.keyboard.up("Space");
  assert.ok((await page.evaluate(() => globalThis.drawn)) >= 20); // a frame for each move, and none that is waited for
  assert.deepEqual(page.faults, []);
  await api("projects/large", { method: "DELETE" });
});

test("a change that is taken back in the middle of its preview, and a server that ends in it, leave no page waiting", async () => {
  const page = await open(`${url}#/still`);
  await page.locator(".bar").waitFor();
  await settled(page);
  const made = async () => (await (await api("projects/still/made")).json());
  const { small, full } = await made();
  await page.keyboard.press("3");
  await page.getByLabel("Length").fill("20");
  await until(async () => (await made()).small.number !== small.number);
  await page.keyboard.press("Control+z");
  await settled(page);
  assert.equal((await made()).full.number, full.number); // what stood still stands
  await page.getByLabel("Length").fill("20");
  await until(async () => (await made()).full.number !== full.number);
  await end("SIGKILL");
  await page.getByText("server is away").waitFor();
  await serve(Number(new URL(url).port), "demo.freshet");
  await page.getByText("server is away").waitFor({ state: "detached" });
  await page.getByLabel("Length").fill("2");
  await settled(page);
  assert.ok((await made()).full.number > full.number);
  assert.deepEqual(page.faults, []);
});

test("two pages show the same project, and a render is stopped", async () => {
  const [one, two] = [await open(`${url}#/still`), await open(`${url}#/still`)];
  for (const page of [one, two]) {
    await page.locator(".bar").waitFor();
    await page.keyboard.press("2");
  }
  await one.getByRole("button", { name: "Clear all lines" }).click();
  await two.getByText("Draw a line along the flow").waitFor();
  await drag(two, [[150, 40], [150, 160]]);
  await one.getByText("Click a line to change it").waitFor();
  await one.keyboard.press("3");
  await one.getByLabel("Length").fill("20"); // long enough to be stopped in the middle
  await until(async () => (await document("still")).frames > 300);
  await one.getByRole("button", { name: "Export" }).click();
  await one.getByRole("button", { name: "Make it" }).click();
  await one.getByRole("button", { name: "Stop" }).click();
  await one.getByRole("button", { name: "Make it" }).waitFor();
  const jobs = await (await api("jobs")).json();
  assert.ok(jobs.every(({ state, lane }) => lane !== "command" || state === "stopped" || state === "done"), JSON.stringify(jobs));
  assert.deepEqual([...one.faults, ...two.faults], []);
});

for (const [theme, size, width, height] of [
  ["dark", "wide", 1440, 900],
  ["light", "wide", 1440, 900],
  ["dark", "narrow", 390, 844],
  ["light", "narrow", 390, 844],
  ["light", "middle", 1024, 700],
])
  test(`every page can be read and used: ${theme}, ${size}`, async () => {
    const page = await open(url, { viewport: { width, height }, colorScheme: theme, reducedMotion: "reduce" });
    const look = async (name) => {
      await page.waitForTimeout(SHOTS ? 1500 : 100);
      await shot(page, `${name}-${theme}-${size}`);
      if (size !== "middle") await expectAccessible(page, name);
      if (theme === "dark" && name !== "export") await expectKeyboard(page, name);
      const beyond = await page.evaluate(() => globalThis.document.documentElement.scrollWidth - globalThis.innerWidth);
      assert.ok(beyond <= 0, `${name} is ${beyond} px wider than the window`);
    };
    await page.getByText("Drop a picture").waitFor();
    await page.locator(".strip").first().waitFor();
    await look("home");
    // A name that is a page's source is text.
    assert.ok((await page.locator(".cards.clips").first().textContent()).includes("<img src=x"));
    assert.equal(await page.evaluate(() => globalThis.broken), undefined);
    await goWithin(page, `${url}#/still`);
    await page.locator(".bar").waitFor();
    await settled(page); // what can be used no longer changes
    if (size === "narrow") await page.locator(".modes[data-more~=after]").waitFor(); // there are more beyond the edge
    // Without the pointer: a mode by its button, from where Tab comes to.
    await page.getByRole("button", { name: "Look", exact: true }).focus();
    await page.keyboard.press("Enter");
    await page.getByRole("button", { name: "Look", pressed: true }).waitFor();
    for (const [key, name] of [["1", "fluid"], ["2", "flow"], ["3", "look"], ["4", "why"], ["5", "design"], ["6", "stills"], ["7", "flowlines"], ["8", "scene"]]) {
      await page.keyboard.press(key);
      await look(name);
    }
    await page.getByRole("button", { name: "Export" }).click();
    await look("export");
    assert.deepEqual(page.faults, []);
  });

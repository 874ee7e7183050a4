// The picture on its canvas: zoomed and panned, drawn on, with what is known of it laid over.
import { effect } from "@preact/signals";
import Konva from "konva/lib/Core";
import { Arrow } from "konva/lib/shapes/Arrow";
import { Circle } from "konva/lib/shapes/Circle";
import { Image as KonvaImage } from "konva/lib/shapes/Image";
import { Line } from "konva/lib/shapes/Line";
import { address } from "./api";
import { filmPlayer } from "./filmplayer";
import { kModes } from "./modes";
import { followOutlines, outlineLook, outlinesNow } from "./onion";
import { flat, lengthOf, PenLine, rounded, widthOf } from "./pen";
import * as state from "./state";
import { Streaks } from "./streaks";
import { accent, type Gesture, kTakes, type Tool } from "./tools/tool";
import type { Point } from "./types";
import * as view from "./view";

const kLongest = 2048; // px of the copy of the picture that is always here
const kBetweenStreaks = 30; // ms
const kBetweenWaiting = 80; // ms
const kPalm = 700; // ms after the pen was seen, in which touch is the hand that holds it
const kRest = 150; // ms that a view rests before it is sharpened

function loadImage(source: string): Promise<HTMLImageElement> {
  return new Promise((resolve, reject) => {
    const image = new Image();
    image.onload = () => resolve(image);
    image.onerror = () => reject(new Error("a picture did not arrive"));
    image.src = source;
  });
}

const kWheelStep = 1.2; // times larger or smaller, at most, by one event of the wheel

/** A touchpad's pinch comes as many small turns with Ctrl, a wheel's notch as one large one. */
function wheelFactor(event: WheelEvent): number {
  const factor = Math.exp(-event.deltaY * (event.ctrlKey ? 0.01 : 0.0015));
  return Math.max(1 / kWheelStep, Math.min(kWheelStep, factor));
}

export class Canvas {
  private readonly stage: Konva.Stage;
  private readonly below = new Konva.Layer({ listening: false });
  private readonly over = new Konva.Layer({ listening: false });
  private readonly drawing = new Konva.Layer();
  private readonly cursorLayer = new Konva.Layer({ listening: false });
  private readonly picture = new KonvaImage({ image: undefined });
  private readonly moving = new KonvaImage({ image: undefined });
  private readonly ground = new KonvaImage({ image: undefined, visible: false }); // in place of all of these
  private readonly detail = new KonvaImage({ image: undefined, visible: false }); // the part that is seen, as sharp as it is
  private detailTimer = 0;
  private readonly original = new KonvaImage({ image: undefined, visible: false });
  private readonly divider = new Line({ points: [], stroke: "#fff", strokeWidth: 2, visible: false });
  private readonly tint = new KonvaImage({ image: undefined });
  private readonly held = new KonvaImage({ image: undefined });
  private readonly worst = new KonvaImage({ image: undefined, visible: false });
  private readonly onion = new Konva.Group({ listening: false });
  private readonly cursor = new Circle({ stroke: "#fff", visible: false, shadowColor: "#000" });
  private readonly overlay: HTMLCanvasElement;
  private readonly film = filmPlayer.video; // over the picture
  private readonly flowing = new Streaks();
  private readonly ends: (() => void)[] = [];
  private readonly resizer: ResizeObserver;
  private matteImage: HTMLImageElement | null = null;
  private heldImage: HTMLImageElement | null = null;
  private fitted = true;
  private line: PenLine | null = null; // being drawn
  private pointer = -1; // that draws, or moves the picture
  private penTime = -Infinity; // ms, when the pen was last seen
  private erasing = false;
  private live: (Line | Arrow)[] = []; // one for each of its runs
  private corners: Point[] = []; // of an area that is clicked together
  private cornersTake = false;
  private readonly outline: Line = new Line({ points: [], closed: true, opacity: 0.6, visible: false });
  private panFrom: { x: number; y: number; at: { x: number; y: number } } | null = null;
  private pinch: { distance: number; centre: { x: number; y: number } } | null = null;
  private last = 0; // ms, when streaks were drawn
  private streaksShown = false;

  constructor(private readonly box: HTMLDivElement) {
    const holder = document.createElement("div");
    holder.className = "stage";
    box.append(holder);
    this.overlay = document.createElement("canvas");
    this.overlay.className = "streaks";
    this.overlay.style.display = "none";
    this.stage = new Konva.Stage({ container: holder, width: box.clientWidth || 10, height: box.clientHeight || 10 });
    this.below.add(this.picture, this.moving, this.detail, this.original, this.divider, this.ground);
    this.over.add(this.tint, this.held, this.worst, this.onion);
    this.cursorLayer.add(this.outline, this.cursor);
    this.stage.add(this.below, this.over, this.drawing, this.cursorLayer);
    this.drawing.getNativeCanvasElement().before(this.overlay, this.film); // below the lines that were drawn
    this.resizer = new ResizeObserver(() => this.resize());
    this.resizer.observe(box);
    this.listenToPointers();
    this.listenToState();
    this.last = performance.now();
    const tick = (now: number): void => {
      if (!this.box.isConnected) return;
      this.drawStreaks(now);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  end(): void {
    for (const end of this.ends) end();
    window.clearTimeout(this.detailTimer);
    this.resizer.disconnect();
    this.stage.destroy();
    this.overlay.remove();
    this.film.remove();
  }

  private get tool(): Tool {
    return kModes[state.mode.value].tool;
  }

  private size(): { width: number; height: number } {
    const open = state.project.value;
    const ground = view.ground.value;
    if (ground) return { width: ground.naturalWidth, height: ground.naturalHeight };
    return open ? { width: open.width, height: open.height } : { width: 1, height: 1 };
  }

  // ---- what is shown

  private listenToState(): void {
    let shownProject = "";
    this.ends.push(
      effect(() => {
        const open = state.project.value;
        if (!open || open.id === shownProject) return;
        shownProject = open.id;
        const show = (image: HTMLImageElement): void => {
          if (state.project.value?.id !== open.id) return;
          view.picture.value = image;
          for (const node of [this.picture, this.original]) node.setAttrs({ image, width: open.width, height: open.height });
          this.below.batchDraw();
        };
        // A small one is there at once; until the whole one is, it is said that it comes.
        let whole = false;
        view.arriving.value = true;
        for (const node of [this.picture, this.original]) node.image(undefined);
        loadImage(address.thumbnail(open.id)).then((image) => !whole && show(image), () => undefined);
        void loadImage(address.picture(open.id, kLongest))
          .then((image) => {
            whole = true;
            show(image);
          })
          .finally(() => (view.arriving.value = false));
        this.fitted = true;
        queueMicrotask(() => this.resize());
      }),
      effect(() => {
        const player = state.shownPlayer.value;
        const frame = player.frame.value;
        const reel = player.reel.value;
        const split = view.compare.value;
        const { width, height } = this.size();
        void frame;
        const bitmap = player.bitmap();
        const away = !!view.ground.value; // the picture, and all that is made of it
        const moves = !away && !!reel && !!bitmap;
        this.picture.visible(!away && !moves); // which a frame covers
        this.moving.setAttrs({ image: bitmap ?? undefined, width, height, visible: moves });
        const shown = !away && split !== null;
        this.original.visible(shown);
        this.divider.visible(shown);
        if (shown) {
          const image = this.picture.image() as HTMLImageElement | undefined;
          const at = split * width;
          if (image) {
            this.original.crop({ x: 0, y: 0, width: Math.max(1, split * image.width), height: image.height });
            this.original.size({ width: Math.max(0.01, at), height });
          }
          this.divider.points([at, 0, at, height]);
          this.divider.strokeWidth(2 / this.stage.scaleX());
        }
        this.below.batchDraw();
      }),
      followOutlines(),
      effect(() => {
        void view.zoom.value;
        this.redrawOnion();
      }),
      effect(() => {
        const image = view.ground.value;
        const before = this.ground.visible() && image ? [this.ground.width(), this.ground.height()] : null;
        this.ground.setAttrs({ image: image ?? undefined, width: image?.naturalWidth ?? 1, height: image?.naturalHeight ?? 1, visible: !!image });
        this.below.batchDraw();
        if (before && before[0] === image?.naturalWidth && before[1] === image?.naturalHeight) return; // looked at as closely
        this.fitted = true;
        queueMicrotask(() => this.resize());
      }),
      effect(() => {
        const open = state.project.value;
        const made = state.matte.value;
        if (!open || !made) {
          this.matteImage = this.heldImage = null;
          this.redrawMatte();
          return;
        }
        void Promise.all([
          loadImage(address.matte(open.id, made.number, "alpha")),
          made.held ? loadImage(address.matte(open.id, made.number, "held")) : Promise.resolve(null),
        ])
          .then(([alpha, stands]) => {
            if (state.matte.value?.number !== made.number) return;
            this.matteImage = alpha;
            this.heldImage = stands;
            this.redrawMatte();
            this.flowing.set(state.field.value, this.matteImage);
          })
          .catch(() => undefined); // a newer one is on its way
      }),
      effect(() => {
        void view.matteLook.value;
        void state.mode.value;
        this.redrawMatte();
      }),
      effect(() => this.flowing.set(state.field.value, this.matteImage)),
      effect(() => {
        void state.mode.value;
        void view.fluidTool.value;
        void view.layerTool.value;
        void view.layer.value;
        this.dropCorners();
      }),
      effect(() => {
        void this.showsStill();
        this.lookCloser();
        this.below.batchDraw();
      }),
      effect(() => {
        // A design without a clip's look is light on black, or smoke: it lies over the picture as such.
        const bare = state.mode.value === "design" && state.doc.value?.design.look === "";
        this.film.style.mixBlendMode = bare ? "screen" : "";
        const split = view.compare.value;
        this.film.style.clipPath = split === null ? "" : `inset(0 0 0 ${100 * split}%)`;
      }),
      effect(() => {
        const source = view.worst.value;
        this.worst.visible(false);
        this.drawOver();
        if (!source) return;
        void loadImage(source).then(
          (image) => {
            if (view.worst.value !== source) return;
            this.worst.setAttrs({ ...this.size(), image, visible: true });
            this.drawOver();
          },
          () => undefined, // newer takes are on their way
        );
      }),
      effect(() => {
        void view.zoom.value; // on which widths depend; what else is shown, the tool reads
        this.redrawDrawing();
      }),
      effect(() => {
        this.box.style.cursor = view.panning.value ? "grab" : this.tool.pen() === "none" ? "default" : "crosshair";
      }),
    );
  }

  /** The matte in one colour, with what lies outside of it darkened, or as an outline. */
  private redrawMatte(): void {
    const { width, height } = this.size();
    const look = this.tool.showsMatte ? view.matteLook.value : "off";
    const image = this.matteImage;
    this.held.visible(false);
    if (!image || look === "off") {
      this.tint.visible(false);
      this.drawOver();
      return;
    }
    const canvas = document.createElement("canvas");
    canvas.width = image.width;
    canvas.height = image.height;
    const context = canvas.getContext("2d");
    if (!context) return;
    if (look === "tint") {
      context.drawImage(image, 0, 0);
      context.globalCompositeOperation = "source-in";
      context.globalAlpha = 0.42;
      context.fillStyle = accent();
      context.fillRect(0, 0, canvas.width, canvas.height);
    } else if (look === "cutout") {
      context.fillStyle = "rgba(8, 12, 14, 0.86)";
      context.fillRect(0, 0, canvas.width, canvas.height);
      context.globalCompositeOperation = "destination-out";
      context.drawImage(image, 0, 0);
    } else {
      const reach = Math.max(1, Math.round(canvas.width / 700));
      for (let angle = 0; angle < 8; ++angle)
        context.drawImage(image, reach * Math.cos((angle * Math.PI) / 4), reach * Math.sin((angle * Math.PI) / 4));
      context.globalCompositeOperation = "destination-out";
      context.drawImage(image, 0, 0);
      context.globalCompositeOperation = "source-in";
      context.fillStyle = accent();
      context.fillRect(0, 0, canvas.width, canvas.height);
    }
    this.tint.setAttrs({ image: canvas, width, height, visible: true });
    if (this.heldImage) {
      const stands = document.createElement("canvas");
      stands.width = this.heldImage.width;
      stands.height = this.heldImage.height;
      const paint = stands.getContext("2d");
      if (paint) {
        paint.drawImage(this.heldImage, 0, 0);
        paint.globalCompositeOperation = "source-in";
        paint.fillStyle = "rgba(233, 180, 76, 0.6)";
        paint.fillRect(0, 0, stands.width, stands.height);
        this.held.setAttrs({ image: stands, width, height, visible: true });
      }
    }
    this.drawOver();
  }

  // What is empty is no layer: each is as large as the window, and put together with the others for every frame.

  private drawOver(): void {
    this.over.visible(this.tint.visible() || this.worst.visible() || this.onion.hasChildren());
    this.over.batchDraw();
  }

  private drawCursor(): void {
    this.cursorLayer.visible(this.live.length > 0 || this.outline.visible() || this.cursor.visible());
    this.cursorLayer.batchDraw();
  }

  private redrawOnion(): void {
    const around = view.ground.value ? [] : outlinesNow();
    if (around.length === 0 && !this.onion.hasChildren()) return;
    this.onion.destroyChildren();
    const reel = state.player.reel.value?.news;
    const size = reel ? this.size().width / reel.width : 1;
    for (const { by, lines } of around)
      for (const points of lines)
        this.onion.add(new Line({ ...outlineLook(by), points: points.map((each) => (each + 0.5) * size), closed: true, strokeWidth: (by === 0 ? 2 : 1.4) / this.stage.scaleX() }));
    this.drawOver();
  }

  private redrawDrawing(): void {
    this.drawing.destroyChildren();
    const { width, height } = this.size();
    if (state.doc.value && (view.drawn.value || !(view.film.value || state.showsLayers.value)))
      this.tool.show({ scale: this.stage.scaleX(), width, height, add: (node) => this.drawing.add(node) });
    this.drawing.batchDraw();
  }

  /** Thirty times a second; less while a preview is made, for it is the same processor that makes it. */
  private drawStreaks(now: number): void {
    const shows = view.streaks.value && this.tool.showsStreaks && !this.flowing.empty;
    const between = state.previewJob.value ? kBetweenWaiting : kBetweenStreaks;
    if ((!shows && !this.streaksShown) || now - this.last < between) return;
    const seconds = Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    if (shows !== this.streaksShown) this.overlay.style.display = shows ? "" : "none";
    this.streaksShown = shows;
    const context = this.overlay.getContext("2d");
    if (!context) return;
    const ratio = window.devicePixelRatio || 1;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.overlay.width, this.overlay.height);
    if (!shows) return;
    const scale = this.stage.scaleX();
    context.setTransform(ratio * scale, 0, 0, ratio * scale, ratio * this.stage.x(), ratio * this.stage.y());
    this.flowing.draw(context, seconds, scale);
  }

  // ---- zoom and pan

  private resize(): void {
    const width = this.box.clientWidth;
    const height = this.box.clientHeight;
    if (width < 2 || height < 2) return;
    this.stage.size({ width, height });
    const ratio = window.devicePixelRatio || 1;
    this.overlay.width = Math.round(width * ratio);
    this.overlay.height = Math.round(height * ratio);
    if (this.fitted) this.fit();
  }

  /** All of the picture, as large as it goes beside the panels that float over the canvas. */
  fit(): void {
    const { width, height } = this.size();
    // Beside the panel where there is room for it, above it on a narrow screen.
    const narrow = this.stage.width() < 720;
    const panel = this.box.parentElement?.querySelector(".panel");
    const left = narrow ? 10 : 24;
    const right = narrow ? 10 : panel ? 344 : 24;
    const top = narrow ? 108 : 80;
    const transport = Math.max(86, this.box.parentElement?.querySelector<HTMLElement>(".transport")?.offsetHeight ?? 0);
    const settings = panel?.checkVisibility() ? 0.36 * this.stage.height() : 0;
    const bottom = narrow ? 14 + transport + settings : 26 + transport;
    const across = Math.max(40, this.stage.width() - left - right);
    const down = Math.max(40, this.stage.height() - top - bottom);
    const scale = Math.min(across / width, down / height);
    this.place(scale, left + (across - width * scale) / 2, top + (down - height * scale) / 2);
    this.fitted = true;
  }

  /** Again, where nobody has zoomed or panned since. */
  refit(): void {
    if (this.fitted) this.fit();
  }

  zoomBy(factor: number, centre = { x: this.stage.width() / 2, y: this.stage.height() / 2 }): void {
    const before = this.stage.scaleX();
    const scale = Math.max(0.01, Math.min(64, before * factor));
    const x = centre.x - ((centre.x - this.stage.x()) * scale) / before;
    const y = centre.y - ((centre.y - this.stage.y()) * scale) / before;
    this.place(scale, x, y);
    this.fitted = false;
  }

  zoomTo(scale: number): void {
    this.zoomBy(scale / this.stage.scaleX());
  }

  private place(scale: number, x: number, y: number): void {
    this.stage.scale({ x: scale, y: scale });
    this.stage.position({ x, y });
    this.picture.getLayer()?.batchDraw();
    // Pixels are seen as pixels where one looks closely.
    for (const layer of [this.below, this.over]) layer.imageSmoothingEnabled(scale < 4);
    const { width, height } = this.size();
    Object.assign(this.film.style, { width: `${width * scale}px`, height: `${height * scale}px`, transform: `translate(${x}px, ${y}px)` });
    view.zoom.value = scale;
    this.cursor.setAttrs({ strokeWidth: 1.5 / scale, shadowBlur: 3 / scale }); // as thin at any zoom
    this.lookCloser();
    this.box.dataset["view"] = JSON.stringify({ x, y, scale });
    this.stage.batchDraw();
  }

  /** Whether the picture as it was given is looked at, and not an animation's frame. */
  private showsStill(): boolean {
    const player = state.shownPlayer.value;
    return !player.reel.value || (this.tool.showsStill && !player.playing.value);
  }

  /** Where the picture's copy here has fewer pixels than the screen, the part that is seen is asked for, when the view rests. */
  private lookCloser(): void {
    window.clearTimeout(this.detailTimer);
    const open = state.project.value;
    const { width, height } = this.size();
    const scale = this.stage.scaleX();
    const shown = scale * (window.devicePixelRatio || 1);
    const sharp = !open || Math.max(width, height) * Math.min(1, shown) <= kLongest;
    if (sharp || view.ground.value || !this.showsStill()) {
      this.detail.visible(false);
      return;
    }
    const left = Math.floor(Math.max(0, -this.stage.x() / scale));
    const top = Math.floor(Math.max(0, -this.stage.y() / scale));
    const across = Math.ceil(Math.min(width - left, this.stage.width() / scale + 1));
    const down = Math.ceil(Math.min(height - top, this.stage.height() / scale + 1));
    if (across < 1 || down < 1) return;
    const longest = Math.ceil(Math.max(across, down) * Math.min(1, shown));
    this.detailTimer = window.setTimeout(() => {
      loadImage(address.part(open.id, left, top, across, down, longest)).then(
        (image) => {
          if (state.project.value?.id !== open.id || !this.showsStill()) return;
          this.detail.setAttrs({ image, x: left, y: top, width: across, height: down, visible: true });
          this.box.dataset["detail"] = `${left} ${top} ${across} ${down}`;
          this.below.batchDraw();
        },
        () => undefined, // the blurred one stays
      );
    }, kRest);
  }

  // ---- pointers

  private at(): Point | null {
    const point = this.stage.getRelativePointerPosition();
    return point ? [rounded(point.x), rounded(point.y)] : null;
  }

  private listenToPointers(): void {
    this.stage.on("wheel", (event) => {
      event.evt.preventDefault();
      const centre = this.stage.getPointerPosition() ?? undefined;
      if (event.evt.ctrlKey || !event.evt.shiftKey) this.zoomBy(wheelFactor(event.evt), centre);
      else this.panBy(-event.evt.deltaY, 0);
    });
    this.stage.on("pointerdown", (event) => this.begin(event.evt));
    this.stage.on("pointermove", (event) => this.go(event.evt));
    this.stage.on("pointerup pointercancel", (event) => this.finish(event.evt));
    this.stage.on("mouseleave", () => {
      this.cursor.visible(false);
      this.drawCursor();
    });
    this.stage.on("touchmove", (event) => this.twoFingers(event.evt));
    this.stage.on("touchend", () => (this.pinch = null));
    this.stage.on("dblclick dbltap", () => {
      if (this.tool.pans) this.fit();
    });
    const letGo = (event: PointerEvent): void => this.finish(event);
    window.addEventListener("pointerup", letGo);
    this.ends.push(() => window.removeEventListener("pointerup", letGo));
  }

  private panBy(dx: number, dy: number): void {
    this.place(this.stage.scaleX(), this.stage.x() + dx, this.stage.y() + dy);
    this.fitted = false;
  }

  private twoFingers(event: TouchEvent): void {
    const [a, b] = [event.touches[0], event.touches[1]];
    if (!a || !b || this.isPalm("touch")) return;
    event.preventDefault();
    this.cancel();
    const corner = this.box.getBoundingClientRect();
    const centre = { x: (a.clientX + b.clientX) / 2 - corner.left, y: (a.clientY + b.clientY) / 2 - corner.top };
    const distance = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
    if (this.pinch) {
      this.zoomBy(distance / this.pinch.distance, centre);
      this.panBy(centre.x - this.pinch.centre.x, centre.y - this.pinch.centre.y);
    }
    this.pinch = { distance, centre };
  }

  private cancel(): void {
    this.line = null;
    for (const each of this.live) each.destroy();
    this.live = [];
    this.drawCursor();
  }

  /** A hand that rests beside the pen draws nothing, and neither pans nor zooms. */
  private isPalm(pointerType: string): boolean {
    return pointerType === "touch" && performance.now() - this.penTime < kPalm;
  }

  private begin(event: PointerEvent): void {
    const point = this.at();
    if (!point || this.isPalm(event.pointerType)) return;
    if (event.pointerType === "pen") {
      this.penTime = performance.now();
      this.cancel(); // what the hand began before the pen came down
      this.panFrom = null;
    } else if (this.line && event.pointerId !== this.pointer) {
      return; // one pointer draws a line
    }
    this.pointer = event.pointerId;
    const { tool } = this;
    if (event.button === 1 || view.panning.value || tool.pans) {
      const from = this.stage.getPointerPosition();
      view.panned.value = true;
      if (from) this.panFrom = { x: from.x, y: from.y, at: { x: this.stage.x(), y: this.stage.y() } };
      this.box.style.cursor = "grabbing";
      return;
    }
    if ((event.button !== 0 && event.button !== 2) || !tool.press(point)) return;
    this.erasing = event.button === 2 || event.altKey;
    this.line = new PenLine(point, widthOf(event, view.brush.value));
    this.addLive();
  }

  /** What is seen of the run that is being drawn. */
  private addLive(): void {
    if (!this.line) return;
    const { points, width } = this.line.last;
    const scale = this.stage.scaleX();
    const ends = { points: [...flat(points), ...flat(points.slice(-1))], lineCap: "round" as const, lineJoin: "round" as const };
    const area = this.tool.pen() === "area";
    const colour = this.tool.colour(this.erasing);
    const made = this.tool.pen() === "arrow"
      ? new Arrow({ ...ends, stroke: accent(), fill: accent(), strokeWidth: 3 / scale, pointerLength: 11 / scale, pointerWidth: 10 / scale })
      : new Line({ ...ends, stroke: colour, fill: area ? colour : undefined, closed: area, strokeWidth: area ? 1.5 / scale : width, opacity: 0.6 });
    this.live.push(made);
    this.cursorLayer.add(made);
    this.drawCursor();
  }

  private go(event: PointerEvent): void {
    const point = this.at();
    if (!point || this.isPalm(event.pointerType)) return;
    if (event.pointerType === "pen") this.penTime = performance.now();
    if ((this.line || this.panFrom) && event.pointerId !== this.pointer) return;
    if (this.panFrom) {
      const now = this.stage.getPointerPosition();
      if (now) this.place(this.stage.scaleX(), this.panFrom.at.x + now.x - this.panFrom.x, this.panFrom.at.y + now.y - this.panFrom.y);
      this.fitted = false;
      return;
    }
    const scale = this.stage.scaleX();
    const isBrush = this.tool.pen() === "brush";
    const brushes = isBrush && event.pointerType !== "touch";
    this.cursor.setAttrs({ x: point[0], y: point[1], radius: widthOf(event, view.brush.value) / 2, visible: brushes && !view.panning.value });
    if (this.line) {
      const width = isBrush ? widthOf(event, view.brush.value) : this.line.last.width;
      if (this.line.add(point, width, 2 / scale)) this.addLive();
      const { points } = this.line.last;
      this.live[this.live.length - 1]?.points(flat(points.length > 1 ? points : [...points, point]));
    } else if (this.corners.length > 0) {
      this.showCorners(point);
    }
    this.drawCursor();
  }

  private finish(event: PointerEvent): void {
    if ((this.line || this.panFrom) && event.pointerId !== this.pointer) return;
    if (this.panFrom) {
      this.panFrom = null;
      this.box.style.cursor = view.panning.value ? "grab" : "";
    }
    const line = this.line;
    this.cancel();
    if (!line || !state.doc.value) return;
    const scale = this.stage.scaleX();
    const runs = line.simple(0.7 / scale);
    const area = this.tool.pen() === "area";
    const gesture: Gesture = {
      runs: area ? runs.map(({ points }) => ({ points, width: 0 })) : runs,
      points: runs.flatMap(({ points }) => points),
      area,
      isClick: lengthOf(line.points) * scale < 8,
      erasing: this.erasing,
    };
    if (area && (gesture.isClick || this.corners.length > 0)) this.addCorner(line.points[0] as Point);
    else this.tool.finish(gesture);
  }

  // ---- an area, corner by corner

  private addCorner(point: Point): void {
    const [first] = this.corners;
    const reach = 10 / this.stage.scaleX();
    if (first && this.corners.length > 2 && Math.hypot(point[0] - first[0], point[1] - first[1]) < reach) return this.closeCorners();
    this.corners.push(point);
    if (this.corners.length === 1) this.cornersTake = this.erasing;
    this.showCorners(point);
  }

  /** Enter, or a click on the first corner. */
  closeCorners(): void {
    const points = this.corners.map(([x, y]): Point => [rounded(x), rounded(y)]);
    this.dropCorners();
    if (points.length > 2 && state.doc.value) this.tool.finish({ runs: [{ points, width: 0 }], points, area: true, isClick: false, erasing: this.cornersTake });
  }

  /** Escape, or another tool. */
  dropCorners(): void {
    this.corners = [];
    view.corners.value = 0;
    this.outline.visible(false);
    this.drawCursor();
  }

  private showCorners(pointer: Point): void {
    view.corners.value = this.corners.length;
    const colour = this.cornersTake ? kTakes : accent();
    this.outline.setAttrs({ points: flat([...this.corners, pointer]), stroke: colour, fill: colour, strokeWidth: 1.5 / this.stage.scaleX(), visible: true });
    this.drawCursor();
  }
}

// The motion as it was understood, drawn as streaks that go with it.
import type { Field } from "./types";

const kStreaks = 240;
const kLife = 2.2; // s
const kTrail = 30; // px of the screen, at most
const kShown = 0.3; // s of its way that a streak shows
const kShades = 6; // of how faint it is

interface Streak {
  x: number;
  y: number;
  age: number;
}

export class Streaks {
  private streaks: Streak[] = [];
  private field: Field | null = null;
  private open: Uint8ClampedArray | null = null; // alpha of the matte, on the field's grid
  private places: number[] = []; // cells in which a streak may begin

  set(field: Field | null, matte: CanvasImageSource | null): void {
    this.field = field;
    this.streaks = [];
    this.places = [];
    this.open = null;
    if (!field) return;
    if (matte) {
      const canvas = new OffscreenCanvas(field.columns, field.rows);
      const context = canvas.getContext("2d", { willReadFrequently: true });
      if (context) {
        context.drawImage(matte, 0, 0, field.columns, field.rows);
        const pixels = context.getImageData(0, 0, field.columns, field.rows).data;
        this.open = new Uint8ClampedArray(field.columns * field.rows);
        for (let i = 0; i < this.open.length; ++i) this.open[i] = pixels[4 * i + 3] ?? 0;
      }
    }
    for (let i = 0; i < field.columns * field.rows; ++i) {
      const moves = Math.hypot(field.u[i] ?? 0, field.v[i] ?? 0) > 0.5;
      if (moves && (!this.open || (this.open[i] ?? 0) > 100)) this.places.push(i);
    }
    const count = Math.min(kStreaks, Math.max(30, this.places.length));
    if (this.places.length > 0)
      for (let i = 0; i < count; ++i) this.streaks.push(this.born(Math.random() * kLife));
  }

  private born(age: number): Streak {
    const field = this.field as Field;
    const place = this.places[Math.floor(Math.random() * this.places.length)] ?? 0;
    const x = (((place % field.columns) + Math.random()) / field.columns) * field.width;
    const y = ((Math.floor(place / field.columns) + Math.random()) / field.rows) * field.height;
    return { x, y, age };
  }

  private velocity(x: number, y: number): [number, number, boolean] {
    const field = this.field as Field;
    const column = Math.floor((x / field.width) * field.columns);
    const row = Math.floor((y / field.height) * field.rows);
    if (column < 0 || row < 0 || column >= field.columns || row >= field.rows) return [0, 0, false];
    const i = row * field.columns + column;
    return [field.u[i] ?? 0, field.v[i] ?? 0, !this.open || (this.open[i] ?? 0) > 100];
  }

  get empty(): boolean {
    return this.streaks.length === 0;
  }

  /** Moves all by so many seconds, and draws them; the context is in px of the picture. */
  draw(context: CanvasRenderingContext2D, seconds: number, scale: number): void {
    // Streaks that are as faint as each other are one path: each stroke has its price.
    const paths = Array.from({ length: kShades }, () => new Path2D());
    for (let i = 0; i < this.streaks.length; ++i) {
      const streak = this.streaks[i] as Streak;
      const [u, v, inside] = this.velocity(streak.x, streak.y);
      streak.age += seconds;
      if (!inside || streak.age > kLife) {
        this.streaks[i] = this.born(Math.random() * 0.6);
        continue;
      }
      streak.x += u * seconds;
      streak.y += v * seconds;
      const speed = Math.hypot(u, v) || 1;
      const length = Math.min(speed * kShown, kTrail / scale) / speed;
      const fade = Math.max(0, Math.min(1, streak.age * 3, (kLife - streak.age) * 2));
      const path = paths[Math.ceil(fade * kShades) - 1];
      path?.moveTo(streak.x - u * length, streak.y - v * length);
      path?.lineTo(streak.x, streak.y);
    }
    context.lineCap = "round";
    // Light on dark, so that they are seen on white water and on night alike.
    for (const [colour, alpha, width] of [["#00252b", 0.35, 3], ["#c8fcff", 0.9, 1.4]] as const) {
      context.strokeStyle = colour;
      context.lineWidth = width / scale;
      paths.forEach((path, shade) => {
        context.globalAlpha = (alpha * (shade + 1)) / kShades;
        context.stroke(path);
      });
    }
    context.globalAlpha = 1;
  }
}

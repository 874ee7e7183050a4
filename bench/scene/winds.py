#!/usr/bin/env python3
"""One water under other winds, as Chuang et al. 2005, Fig. 3: are waves rendered as they were asked for?

usage: winds.py FRESHET PICTURE MATTE OUT --horizon Y [--camera M] [--amplitude A] [--frames N] [--rows N]
                [--sheet FILE]

Speed, direction and scale (roughness) of the water take three values each, while the others are 5 m/s, 90 degrees
(away) and 4. OUT gets a scene and its frames for each; the sheet shows a row for each of the three. Each scene also
moves a picture whose values are the numbers of its rows. So every pixel says from which row it came, and how far its
water was lifted: heights in metres by the camera, laid out on the plane of the water, in the picture's lowest rows.
Prints a row a scene:
  deviation   standard deviation of heights, cm: as asked (amplitude .0525 v^2 / g / roughness), and as rendered
  direction   where waves run to, degrees: as asked, and the mean of -dh/dt grad h, the waves' momentum
  length      2 pi times the deviation of heights by that of slopes, m; and L = v^2 / g / roughness, which Eq. 11 has
"""
import argparse
import math
import pathlib
import subprocess

import cv2
import numpy

SPEEDS, DIRECTIONS, ROUGHNESSES = (3, 5, 8), (90, 45, 0), (8, 4, 2)
FPS, GRAVITY, SEA_HEIGHT = 25, 9.81, 0.0525


def film(asked, folder, name, picture, matte, wind):
    speed, direction, roughness = wind
    scene = folder / f"{name}.toml"
    scene.write_text(f"""picture = "{picture}"
frames = {asked.frames}
fps = {FPS}
[wind]
speed = {speed}
direction = {direction}
[[layer]]
name = "water"
matte = "{matte}"
motion = "water"
horizon = [0, {asked.horizon}, 100, {asked.horizon}]
camera_height = {asked.camera}
amplitude = {asked.amplitude}
roughness = {roughness}
mapping = "displacement"
""")
    frames = folder / name
    frames.mkdir(exist_ok=True)
    done = subprocess.run([asked.freshet, "synth", "scene", scene, "-o", frames / "####.png", "--overwrite"],
                          capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{scene}: {done.stderr}")
    return [cv2.imread(str(file), cv2.IMREAD_UNCHANGED) for file in sorted(frames.glob("*.png"))]


class Plane:
    """The water's plane before a pinhole whose horizon is level (synth/scene/water/camera.h)."""

    def __init__(self, asked, size):
        self.height, self.width = size
        self.focal, self.above = 1.2 * max(size), asked.camera
        pitch = math.atan((asked.horizon - self.height / 2) / self.focal)
        self.cos, self.sin = math.cos(pitch), math.sin(pitch)

    def row_of(self, far, lower):
        """px below the middle, of what lies so far away and so much lower than the camera, m."""
        return self.focal * (lower * self.cos + far * self.sin) / (far * self.cos - lower * self.sin)

    def far(self, v):
        return self.above * (v * self.sin + self.focal * self.cos) / (v * self.cos - self.focal * self.sin)

    def heights(self, source, rows):
        """m, of frames of source rows (index y: y + .5 px); on a grid whose samples are as far apart as the nearest
        row's pixels, away from the viewer and to the right."""
        v = numpy.arange(self.height) + 0.5 - self.height / 2
        far = self.far(v[-rows:])[:, None]
        nearest, farthest = far[-1, 0], far[0, 0]
        lifted = v[-rows:, None] - (source[:, -rows:] - numpy.arange(self.height)[-rows:, None])
        heights = self.above - far * (lifted * self.cos - self.focal * self.sin) / (
            self.focal * self.cos + lifted * self.sin)
        step = self.above / (v[-1] * self.cos - self.focal * self.sin)  # m a px of the nearest row
        z = numpy.arange(nearest, farthest, step)
        y = self.row_of(z, self.above) + self.height / 2 - 0.5 - (self.height - rows)
        across = numpy.linspace(-0.5, 0.5, self.width // 2) * self.width * 0.9 * step
        scale = self.focal / (z * self.cos - self.above * self.sin)
        x = across[None] * scale[:, None] + self.width / 2 - 0.5
        maps = x.astype(numpy.float32), numpy.repeat(y[:, None], x.shape[1], 1).astype(numpy.float32)
        return numpy.stack([cv2.remap(frame.astype(numpy.float32), *maps, cv2.INTER_CUBIC) for frame in heights]), (
            step, across[1] - across[0])


def measured(heights, steps):
    heights = heights - heights.mean()
    along, away, right = numpy.gradient(heights, 1 / FPS, *steps)
    direction = math.degrees(math.atan2(-(along * away).mean(), -(along * right).mean()))
    slope = math.sqrt((away ** 2 + right ** 2).mean())
    return heights.std(), direction, 2 * math.pi * heights.std() / slope


def main():
    arguments = argparse.ArgumentParser()
    for name in ("freshet", "picture", "matte", "out"):
        arguments.add_argument(name)
    arguments.add_argument("--horizon", type=float, required=True)
    arguments.add_argument("--camera", type=float, default=1.5)
    arguments.add_argument("--amplitude", type=float, default=1)
    arguments.add_argument("--frames", type=int, default=75)
    arguments.add_argument("--rows", type=int, default=40)
    arguments.add_argument("--sheet")
    asked = arguments.parse_args()
    out = pathlib.Path(asked.out)
    out.mkdir(parents=True, exist_ok=True)
    still = cv2.imread(asked.picture)
    size = still.shape[:2]
    unit = 65535 // size[0]
    ruler = numpy.repeat((unit * numpy.arange(size[0]))[:, None], size[1], 1).astype(numpy.uint16)
    cv2.imwrite(str(out / "ruler.png"), cv2.merge([ruler] * 3))
    below = int(asked.horizon) + 2
    whole = numpy.zeros(size, numpy.uint8)
    whole[below:] = 255
    cv2.imwrite(str(out / "whole.png"), whole)
    matte = cv2.imread(asked.matte, cv2.IMREAD_GRAYSCALE)
    matte[:below] = 0
    cv2.imwrite(str(out / "matte.png"), matte)
    plane = Plane(asked, size)
    print("| speed, m/s | direction | roughness | deviation asked, cm | rendered | direction rendered "
          "| L, m | length, m |\n"
          "| --: | --: | --: | --: | --: | --: | --: | --: |")
    films = {}
    for wind in [(speed, 90, 4) for speed in SPEEDS] + [(5, angle, 4) for angle in DIRECTIONS[1:]] + [
            (5, 90, roughness) for roughness in (8, 2)]:
        name = "{}_{}_{}".format(*wind)
        lifted = numpy.stack(film(asked, out, f"ruler_{name}", "ruler.png", "whole.png", wind))[..., 0] / unit
        deviation, direction, length = measured(*plane.heights(lifted, asked.rows))
        sea = wind[0] ** 2 / GRAVITY / wind[2]
        print("| {} | {} | {} | {:.1f} | {:.1f} | {:.0f} | {:.2f} | {:.2f} |".format(
            *wind, 100 * asked.amplitude * SEA_HEIGHT * sea, 100 * deviation, direction, sea, length), flush=True)
        films[wind] = film(asked, out, name, pathlib.Path(asked.picture).resolve(), "matte.png", wind)
    if asked.sheet:
        def cell(wind):
            frame = films[wind][asked.frames // 2][below - below // 8:]
            return cv2.copyMakeBorder(frame, 2, 2, 2, 2, cv2.BORDER_CONSTANT, value=(255, 255, 255))
        cv2.imwrite(asked.sheet, numpy.vstack([
            numpy.hstack([cell((speed, 90, 4)) for speed in SPEEDS]),
            numpy.hstack([cell((5, angle, 4)) for angle in DIRECTIONS]),
            numpy.hstack([cell((5, 90, roughness)) for roughness in ROUGHNESSES])]))


if __name__ == "__main__":
    main()
